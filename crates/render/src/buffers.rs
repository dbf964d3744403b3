//! Buffers on the GPU: shapes that are drawn many times, their instances, lists that vertex shaders
//! read by index, and meshes.

use std::f32::consts::FRAC_PI_2;
use std::sync::Arc;

use bytemuck::Pod;
use wgpu::{BufferUsages, TextureFormat, TextureUsages};

use crate::gpu::{Gpu, extent, flat};
use crate::picture::Topology;

/// A closed surface of triangles that is drawn many times.
pub(crate) struct Shape {
    pub(crate) corners: wgpu::Buffer,
    pub(crate) triangles: wgpu::Buffer,
    /// The number of corners of all triangles.
    pub(crate) indices: u32,
}

/// A buffer of instances, vertices or triangles, which grows as needed.
pub(crate) struct Instances {
    label: &'static str,
    usage: BufferUsages,
    pub(crate) buffer: wgpu::Buffer,
}

impl Shape {
    /// Creates a shape from its corners and its triangles.
    pub(crate) fn new<T: Pod>(
        gpu: &Gpu,
        label: &str,
        (corners, triangles): (Vec<T>, Vec<u16>),
    ) -> Self {
        let filled = |usage, bytes| filled(gpu, label, usage, bytes);
        Self {
            corners: filled(BufferUsages::VERTEX, bytemuck::cast_slice(&corners)),
            triangles: filled(BufferUsages::INDEX, bytemuck::cast_slice(&triangles)),
            indices: triangles.len() as u32,
        }
    }
}

impl Instances {
    pub(crate) fn new(device: &wgpu::Device, label: &'static str, usage: BufferUsages) -> Self {
        Self { label, usage, buffer: buffer(device, label, usage, 4096) }
    }

    /// Replaces the instances.
    pub(crate) fn write<T: Pod>(&mut self, gpu: &Gpu, instances: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(instances);
        if bytes.len() as u64 > self.buffer.size() {
            let size = bytes.len().next_power_of_two();
            self.buffer = buffer(&gpu.device, self.label, self.usage, size);
        }
        gpu.queue.write_buffer(&self.buffer, 0, bytes);
    }
}

/// Creates a buffer of at least 16 bytes, because a binding must not be empty.
pub(crate) fn buffer(
    device: &wgpu::Device,
    label: &str,
    usage: BufferUsages,
    bytes: usize,
) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: bytes.max(16) as u64,
        usage: usage | BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// Creates a buffer with these bytes.
pub(crate) fn filled(gpu: &Gpu, label: &str, usage: BufferUsages, bytes: &[u8]) -> wgpu::Buffer {
    // The length of a write must be a multiple of four bytes.
    let mut bytes = bytes.to_vec();
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let buffer = buffer(&gpu.device, label, usage, bytes.len());
    gpu.queue.write_buffer(&buffer, 0, &bytes);
    buffer
}

/// Returns the corners and the triangles of a unit sphere in `rings` bands of latitude.
pub(crate) fn sphere(rings: u16) -> (Vec<[f32; 3]>, Vec<u16>) {
    let sectors = 2 * rings;
    let mut corners = vec![];
    for i in 0..=rings {
        let (sin, cos) = (std::f32::consts::PI * f32::from(i) / f32::from(rings)).sin_cos();
        for j in 0..=sectors {
            let (s, c) = (std::f32::consts::TAU * f32::from(j) / f32::from(sectors)).sin_cos();
            corners.push([sin * s, cos, sin * c]);
        }
    }
    let mut triangles = vec![];
    for i in 0..rings {
        for j in 0..sectors {
            let a = i * (sectors + 1) + j;
            let b = a + sectors + 1;
            triangles.extend([a, b, a + 1, a + 1, b, b + 1]);
        }
    }
    (corners, triangles)
}

/// Returns the corners and the triangles of a unit sphere that is cut along the coordinate planes,
/// so that its eight pieces can be moved apart. A corner is given by its position and its piece;
/// the latter is -1 or 1 along each axis. Each piece has `bands` bands of latitude and of
/// longitude.
pub(crate) fn rounded_box(bands: u16) -> (Vec<[[f32; 3]; 2]>, Vec<u16>) {
    // Each border occurs twice: as the end of one piece and as the beginning of the next.
    let angles = |quarters: u16| -> Vec<(f32, u16)> {
        let share = |k| f32::from(k) / f32::from(bands);
        let angle = |q, k| (FRAC_PI_2 * (f32::from(q) + share(k)), q);
        let all = (0..quarters).flat_map(|q| (0..=bands).map(move |k| angle(q, k)));
        all.collect()
    };
    let (latitudes, longitudes) = (angles(2), angles(4));
    let mut corners = vec![];
    for (theta, half) in &latitudes {
        for (phi, quarter) in &longitudes {
            let (sin, cos) = theta.sin_cos();
            let (s, c) = phi.sin_cos();
            let is_ahead = [*quarter < 2, *half == 0, matches!(quarter, 0 | 3)];
            let piece = is_ahead.map(|is| if is { 1.0 } else { -1.0 });
            corners.push([[sin * s, cos, sin * c], piece]);
        }
    }
    let (rows, columns) = (latitudes.len() as u16, longitudes.len() as u16);
    let mut triangles = vec![];
    for i in 0..rows - 1 {
        for j in 0..columns {
            let next = (j + 1) % columns;
            let (a, b) = (i * columns, (i + 1) * columns);
            triangles.extend([a + j, b + j, a + next, a + next, b + j, b + next]);
        }
    }
    // These are the faces at the poles.
    for row in [0, (rows - 1) * columns] {
        let [a, b, c, d] = [0, 1, 2, 3].map(|quarter| row + quarter * (bands + 1));
        triangles.extend([a, b, c, a, c, d]);
    }
    (corners, triangles)
}

/// The number of items in a row of the texture, as in `scene.wgsl`: the least width that every
/// device supports.
const ROW: usize = 2048;

/// A list in the rows of a texture. Clones share it.
#[derive(Clone)]
pub(crate) struct List {
    texture: wgpu::Texture,
    pub(crate) view: wgpu::TextureView,
}

impl List {
    /// Creates a list with room for `length` items of this format.
    pub(crate) fn new(
        device: &wgpu::Device,
        label: &str,
        format: TextureFormat,
        length: usize,
    ) -> Self {
        let size = (ROW as u32, length.div_ceil(ROW).max(1) as u32);
        let usage = TextureUsages::TEXTURE_BINDING | TextureUsages::COPY_DST;
        let texture = device.create_texture(&flat(label, size, format, usage));
        Self { view: texture.create_view(&wgpu::TextureViewDescriptor::default()), texture }
    }

    /// Creates a list of these items.
    pub(crate) fn filled<T: Pod>(
        gpu: &Gpu,
        label: &str,
        format: TextureFormat,
        items: &[T],
    ) -> Self {
        let list = Self::new(&gpu.device, label, format, items.len());
        list.write(gpu, items);
        list
    }

    /// Replaces the first items of the list.
    pub(crate) fn write<T: Pod>(&self, gpu: &Gpu, items: &[T]) {
        let whole = items.len() - items.len() % ROW;
        let (rows, rest) = items.split_at(whole);
        for (start, part, width) in [(0, rows, ROW), (whole, rest, rest.len())] {
            if part.is_empty() {
                continue;
            }
            let mut place = self.texture.as_image_copy();
            place.origin.y = (start / ROW) as u32;
            let layout = wgpu::TexelCopyBufferLayout {
                bytes_per_row: Some((width * size_of::<T>()) as u32),
                ..Default::default()
            };
            let size = extent(width as u32, (part.len() / width) as u32);
            let bytes = bytemuck::cast_slice(part);
            gpu.queue.write_texture(place, bytes, layout, size);
        }
    }
}

/// The buffers of a topology. Clones share them.
#[derive(Clone)]
pub(crate) struct Mesh {
    /// For each point and each split one, the index in `around` of the first of its triangles.
    pub(crate) first: List,
    /// The triangles around each point and each split one, as their other two corners.
    pub(crate) around: List,
    /// The points of the split ones.
    pub(crate) splits: Arc<[u32]>,
    triangles: wgpu::Buffer,
    /// The triangles with points instead of split ones.
    whole: wgpu::Buffer,
    pub(crate) wires: wgpu::Buffer,
    pub(crate) points: usize,
    /// The number of corners of all triangles.
    pub(crate) indices: u32,
    pub(crate) wire_count: u32,
    pub(crate) springs: wgpu::Buffer,
    pub(crate) spring_count: u32,
}

impl Mesh {
    pub(crate) fn new(gpu: &Gpu, topology: &Topology) -> Self {
        let (first, around) = triangles_around(topology);
        let indices = |triangles: &[[u32; 3]]| {
            let bytes = bytemuck::cast_slice(triangles);
            filled(gpu, "triangles", BufferUsages::INDEX, bytes)
        };
        let triangles = indices(&topology.triangles);
        let whole = if topology.splits.is_empty() {
            triangles.clone()
        } else {
            let corners = |t: &[u32; 3]| t.map(|corner| topology.point_of(corner));
            indices(&topology.triangles.iter().map(corners).collect::<Vec<_>>())
        };
        let ends = |label, bytes| filled(gpu, label, BufferUsages::VERTEX, bytes);
        Self {
            first: List::filled(gpu, "first", TextureFormat::R32Uint, &first),
            around: List::filled(gpu, "around", TextureFormat::Rg32Uint, &around),
            splits: topology.splits.clone().into(),
            triangles,
            whole,
            wires: ends("wires", bytemuck::cast_slice(&topology.wires)),
            points: topology.points,
            indices: 3 * topology.triangles.len() as u32,
            wire_count: topology.wires.len() as u32,
            springs: ends("springs", bytemuck::cast_slice(&topology.springs)),
            spring_count: topology.springs.len() as u32,
        }
    }

    /// Draws all triangles with the pipeline that is set: with sharp edges, or as a whole.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass, sharp: bool) {
        let corners = if sharp { &self.triangles } else { &self.whole };
        pass.set_index_buffer(corners.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.indices, 0, 0..1);
    }
}

/// Returns, for each point and each split one, the index of its first triangle in a list of
/// triangles around them, and that list. A triangle in it is given by its other two corners.
fn triangles_around(topology: &Topology) -> (Vec<u32>, Vec<[u32; 2]>) {
    let places = topology.points + topology.splits.len();
    // The triangle of a split point is also one of its point.
    let of = |corner: u32| {
        let point = topology.point_of(corner);
        [Some(corner), (point != corner).then_some(point)]
    };
    let mut first = vec![0u32; places + 1];
    let corners = topology.triangles.iter().flatten();
    for place in corners.flat_map(|corner| of(*corner)).flatten() {
        first[place as usize + 1] += 1;
    }
    for i in 0..places {
        first[i + 1] += first[i];
    }
    let mut next = first.clone();
    let mut around = vec![[0; 2]; first[places] as usize];
    for &[a, b, c] in &topology.triangles {
        for (corner, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            for place in of(corner).into_iter().flatten() {
                let slot = &mut next[place as usize];
                around[*slot as usize] = others;
                *slot += 1;
            }
        }
    }
    (first, around)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipelines::SOURCE;

    /// The box stays closed when its pieces are moved apart: each edge of a triangle with an area
    /// belongs to two such triangles.
    #[test]
    fn a_rounded_box_has_no_holes() {
        let (corners, triangles) = rounded_box(3);
        let key = |k: u16| {
            let [unit, piece] = corners[usize::from(k)];
            [0, 1, 2].map(|axis| ((2.0 * piece[axis] + unit[axis]) * 1e3).round() as i32)
        };
        let mut edges = std::collections::BTreeMap::new();
        for corners in triangles.chunks(3) {
            let [a, b, c] = [0, 1, 2].map(|k| key(corners[k]));
            if a == b || b == c || c == a {
                continue;
            }
            for (from, to) in [(a, b), (b, c), (c, a)] {
                *edges.entry((from.min(to), from.max(to))).or_insert(0) += 1;
            }
        }
        assert!(edges.len() > 100);
        assert!(edges.values().all(|count| *count == 2), "{edges:?}");
    }

    #[test]
    fn the_shader_has_rows_of_the_same_length() {
        assert!(SOURCE.contains(&format!("const ROW = {ROW}u;")));
    }

    #[test]
    fn every_point_knows_its_triangles() {
        let triangles = vec![[0, 2, 1], [1, 2, 3], [4, 1, 3]];
        let (first, around) =
            triangles_around(&Topology { points: 6, triangles, ..Topology::default() });
        assert_eq!(first, [0, 1, 4, 6, 8, 9, 9]);
        let of = |i: usize| &around[first[i] as usize..first[i + 1] as usize];
        assert_eq!(of(0), [[2, 1]]);
        assert_eq!(of(1), [[0, 2], [2, 3], [3, 4]]);
        assert_eq!(of(4), [[1, 3]]);
        assert!(of(5).is_empty());
    }

    /// A split point has its own triangles, and its point has these too.
    #[test]
    fn split_points_have_some_of_the_triangles() {
        let (first, around) = triangles_around(&Topology {
            points: 4,
            triangles: vec![[0, 2, 4], [1, 2, 3]],
            splits: vec![1],
            ..Topology::default()
        });
        let of = |i: usize| &around[first[i] as usize..first[i + 1] as usize];
        assert_eq!(of(4), [[0, 2]]);
        assert_eq!(of(1), [[0, 2], [2, 3]]);
    }
}
