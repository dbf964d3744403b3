//! Buffers on the GPU.

use bytemuck::Pod;
use wgpu::BufferUsages;

use crate::gpu::Gpu;
use crate::shapes::{rounded_box, sphere};

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
    /// Creates a unit sphere with `rings` bands of latitude.
    pub(crate) fn sphere(gpu: &Gpu, rings: u16) -> Self {
        let (corners, triangles) = sphere(rings);
        Self::new(gpu, "sphere", &corners, &triangles)
    }

    /// Creates a rounded box whose pieces have `bands` bands of latitude and of longitude.
    pub(crate) fn rounded_box(gpu: &Gpu, bands: u16) -> Self {
        let (corners, triangles) = rounded_box(bands);
        Self::new(gpu, "rounded box", &corners, &triangles)
    }

    fn new<T: Pod>(gpu: &Gpu, label: &str, corners: &[T], triangles: &[u16]) -> Self {
        let filled = |usage, bytes| filled(gpu, label, usage, bytes);
        Self {
            corners: filled(BufferUsages::VERTEX, bytemuck::cast_slice(corners)),
            triangles: filled(BufferUsages::INDEX, bytemuck::cast_slice(triangles)),
            indices: triangles.len() as u32,
        }
    }
}

impl Instances {
    pub(crate) fn new(device: &wgpu::Device, label: &'static str, usage: BufferUsages) -> Self {
        Self {
            label,
            usage,
            buffer: buffer(device, label, usage, 4096),
        }
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
