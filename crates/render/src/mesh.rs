//! Meshes on the GPU: the triangles, wires and springs of a topology.

use std::sync::Arc;

use wgpu::{BufferUsages, TextureFormat};

use crate::buffers::filled;
use crate::gpu::Gpu;
use crate::list::List;
use crate::picture::Topology;

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
        let filled = |label, usage, bytes| filled(gpu, label, usage, bytes);
        Self {
            first: List::filled(gpu, "first", TextureFormat::R32Uint, &first),
            around: List::filled(gpu, "around", TextureFormat::Rg32Uint, &around),
            splits: topology.splits.clone().into(),
            triangles,
            whole,
            wires: filled(
                "wires",
                BufferUsages::VERTEX,
                bytemuck::cast_slice(&topology.wires),
            ),
            points: topology.points,
            indices: 3 * topology.triangles.len() as u32,
            wire_count: topology.wires.len() as u32,
            springs: filled(
                "springs",
                BufferUsages::VERTEX,
                bytemuck::cast_slice(&topology.springs),
            ),
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
    for place in topology
        .triangles
        .iter()
        .flatten()
        .flat_map(|corner| of(*corner))
        .flatten()
    {
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

    #[test]
    fn every_point_knows_its_triangles() {
        let triangles = vec![[0, 2, 1], [1, 2, 3], [4, 1, 3]];
        let (first, around) = triangles_around(&Topology {
            points: 6,
            triangles,
            ..Topology::default()
        });
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
