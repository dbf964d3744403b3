//! Meshes on the GPU: the triangles, wires and springs of a topology.

use wgpu::{BufferUsages, TextureFormat};

use crate::buffers::filled;
use crate::gpu::Gpu;
use crate::list::List;
use crate::picture::Topology;

/// The buffers of a topology. Clones share them.
#[derive(Clone)]
pub(crate) struct Mesh {
    /// For each point, the index in `around` of the first of its triangles.
    pub(crate) first: List,
    /// The triangles around each point, as their other two corners.
    pub(crate) around: List,
    triangles: wgpu::Buffer,
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
        let filled = |label, usage, bytes| filled(gpu, label, usage, bytes);
        Self {
            first: List::filled(gpu, "first", TextureFormat::R32Uint, &first),
            around: List::filled(gpu, "around", TextureFormat::Rg32Uint, &around),
            triangles: filled(
                "triangles",
                BufferUsages::INDEX,
                bytemuck::cast_slice(&topology.triangles),
            ),
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

    /// Draws all triangles with the pipeline that is set.
    pub(crate) fn draw(&self, pass: &mut wgpu::RenderPass) {
        pass.set_index_buffer(self.triangles.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.indices, 0, 0..1);
    }
}

/// For each point, the index of its first triangle in a list of triangles around points, and that
/// list. A triangle in it is given by its other two corners.
fn triangles_around(topology: &Topology) -> (Vec<u32>, Vec<[u32; 2]>) {
    let mut first = vec![0u32; topology.points + 1];
    for corner in topology.triangles.iter().flatten() {
        first[*corner as usize + 1] += 1;
    }
    for i in 0..topology.points {
        first[i + 1] += first[i];
    }
    let mut next = first.clone();
    let mut around = vec![[0; 2]; 3 * topology.triangles.len()];
    for &[a, b, c] in &topology.triangles {
        for (corner, others) in [(a, [b, c]), (b, [c, a]), (c, [a, b])] {
            let slot = &mut next[corner as usize];
            around[*slot as usize] = others;
            *slot += 1;
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
}
