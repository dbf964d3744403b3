//! Lists that vertex shaders read by index. They are textures, because WebGL has no storage
//! buffers.

use bytemuck::Pod;
use wgpu::{Origin3d, TexelCopyBufferLayout, TexelCopyTextureInfo, TextureFormat};

use crate::gpu::Gpu;

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
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(label),
            size: rows(ROW, length.div_ceil(ROW).max(1)),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self {
            view: texture.create_view(&wgpu::TextureViewDescriptor::default()),
            texture,
        }
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
        let parts = [
            (0, &items[..whole], ROW),
            (whole, &items[whole..], items.len() - whole),
        ];
        for (start, part, width) in parts {
            if part.is_empty() {
                continue;
            }
            gpu.queue.write_texture(
                TexelCopyTextureInfo {
                    texture: &self.texture,
                    mip_level: 0,
                    origin: Origin3d {
                        y: (start / ROW) as u32,
                        ..Origin3d::ZERO
                    },
                    aspect: wgpu::TextureAspect::All,
                },
                bytemuck::cast_slice(part),
                TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some((width * size_of::<T>()) as u32),
                    rows_per_image: None,
                },
                rows(width, part.len() / width),
            );
        }
    }
}

/// Returns the extent of a part of a texture, `width` items wide and `height` rows high.
fn rows(width: usize, height: usize) -> wgpu::Extent3d {
    wgpu::Extent3d {
        width: width as u32,
        height: height as u32,
        depth_or_array_layers: 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipelines::SOURCE;

    #[test]
    fn the_shader_has_rows_of_the_same_length() {
        assert!(SOURCE.contains(&format!("const ROW = {ROW}u;")));
    }
}
