//! Offscreen pictures, drawn without a window.

use crate::gpu::{Gpu, GpuError};
use crate::picture::{Picture, Tile};
use crate::renderer::Renderer;
use crate::targets::{GAP, Targets};
use crate::transfer::Transfer;

/// The format of offscreen pictures: eight bits each of red, green, blue and opacity, in sRGB.
pub const OFFSCREEN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8UnormSrgb;
/// The format of text over them: the same bytes, blended without conversion.
pub const TEXT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

/// A texture to draw into, and the buffer for reading its pixels back from the GPU.
pub struct Offscreen {
    /// Has the format of text, and a second view in the format of pictures if possible.
    texture: wgpu::Texture,
    /// Is drawn into if the second view is impossible.
    transfer: Option<Transfer>,
    targets: Targets,
    buffer: wgpu::Buffer,
    /// The number of bytes in a row of the buffer, which is a multiple of 256.
    stride: u32,
}

impl Offscreen {
    /// Creates a texture for pictures of `size` (px).
    ///
    /// # Errors
    /// [`GpuError::Size`] if a side is zero or beyond the limit of the device.
    pub fn new(gpu: &Gpu, size: (u32, u32)) -> Result<Self, GpuError> {
        let limit = gpu.largest_side();
        let fits = |side| (1..=limit).contains(&side);
        if !fits(size.0) || !fits(size.1) {
            return Err(GpuError::Size { asked: size, limit });
        }
        let flags = gpu.adapter.get_downlevel_capabilities().flags;
        let two_views = flags.contains(wgpu::DownlevelFlags::VIEW_FORMATS);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("offscreen"),
            size: wgpu::Extent3d {
                width: size.0,
                height: size.1,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: TEXT_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: if two_views { &[OFFSCREEN_FORMAT] } else { &[] },
        });
        let stride = (size.0 * 4).next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("read-back"),
            size: u64::from(stride) * u64::from(size.1),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Ok(Self {
            transfer: (!two_views).then(|| Transfer::new(gpu, size, TEXT_FORMAT)),
            targets: Targets::new(gpu, size, OFFSCREEN_FORMAT, gpu.samples(OFFSCREEN_FORMAT)),
            texture,
            buffer,
            stride,
        })
    }

    /// Returns the width and height (px).
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.targets.size()
    }

    /// Draws a picture, and returns its pixels: rows from the top, four bytes per pixel, with
    /// colours that are not multiplied by the opacity.
    ///
    /// # Errors
    /// [`GpuError::Lost`] or [`GpuError::Refused`], as [`Gpu::check`] reports them.
    pub fn render(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        picture: &Picture,
    ) -> Result<Vec<u8>, GpuError> {
        let tile = Tile::whole(self.size());
        self.render_tiles(gpu, renderer, &[(*picture, tile)], |_, _| vec![])
    }

    /// Draws several pictures, each in its own part of the target, and returns the pixels like
    /// [`render`](Self::render). `text` draws over them, into a view of [`TEXT_FORMAT`]; the
    /// commands that it returns are submitted first.
    ///
    /// # Errors
    /// [`GpuError::Lost`] or [`GpuError::Refused`], as [`Gpu::check`] reports them.
    pub fn render_tiles(
        &self,
        gpu: &Gpu,
        renderer: &mut Renderer,
        pictures: &[(Picture, Tile)],
        text: impl FnOnce(&mut wgpu::CommandEncoder, &wgpu::TextureView) -> Vec<wgpu::CommandBuffer>,
    ) -> Result<Vec<u8>, GpuError> {
        let size = self.size();
        renderer.prepare(gpu, pictures);
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let transparent = pictures.iter().any(|(picture, _)| picture.transparent);
        let clear = if transparent {
            wgpu::Color::TRANSPARENT
        } else {
            GAP
        };
        let targets = &self.targets;
        let view = |format| {
            self.texture.create_view(&wgpu::TextureViewDescriptor {
                format: Some(format),
                ..Default::default()
            })
        };
        let bytes = view(TEXT_FORMAT);
        if let Some(transfer) = &self.transfer {
            renderer.draw(&mut targets.pass_over(&mut encoder, transfer.picture(), clear));
            transfer.copy(&mut encoder, &bytes);
        } else {
            renderer.draw(&mut targets.pass_over(&mut encoder, &view(OFFSCREEN_FORMAT), clear));
        }
        let before = text(&mut encoder, &bytes);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(self.stride),
            rows_per_image: None,
        };
        encoder.copy_texture_to_buffer(
            self.texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo {
                buffer: &self.buffer,
                layout,
            },
            self.texture.size(),
        );
        gpu.queue
            .submit(before.into_iter().chain([encoder.finish()]));
        let slice = self.buffer.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        gpu.device
            .poll(wgpu::PollType::wait_indefinitely())
            .map_err(|_| GpuError::Lost)?;
        gpu.check()?;
        let mapped = slice
            .get_mapped_range()
            .map_err(|e| GpuError::Refused(e.to_string()))?;
        let mut pixels = Vec::with_capacity(size.0 as usize * size.1 as usize * 4);
        for row in mapped.chunks_exact(self.stride as usize) {
            pixels.extend_from_slice(&row[..size.0 as usize * 4]);
        }
        drop(mapped);
        self.buffer.unmap();
        if transparent {
            straighten(&mut pixels);
        }
        Ok(pixels)
    }
}

/// Divides colours by their opacity, which they were multiplied by when they were blended over
/// nothing and averaged at edges.
fn straighten(pixels: &mut [u8]) {
    for pixel in pixels.chunks_exact_mut(4) {
        let opacity = f32::from(pixel[3]) / 255.0;
        if pixel[3] > 0 && pixel[3] < 255 {
            for channel in &mut pixel[..3] {
                *channel = encoded(linear(*channel) / opacity);
            }
        }
    }
}

/// Returns the linear light of an sRGB channel (IEC 61966-2-1).
fn linear(channel: u8) -> f32 {
    let c = f32::from(channel) / 255.0;
    if c <= 0.04045 {
        c / 12.92
    } else {
        ((c + 0.055) / 1.055).powf(2.4)
    }
}

/// Returns the sRGB channel of a linear light: the inverse of [`linear`].
fn encoded(light: f32) -> u8 {
    let light = light.min(1.0);
    let c = if light <= 0.003_130_8 {
        12.92 * light
    } else {
        1.055 * light.powf(1.0 / 2.4) - 0.055
    };
    (255.0 * c).round() as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn light_and_its_code_are_inverse() {
        for channel in 0..=255 {
            assert_eq!(encoded(linear(channel)), channel);
        }
    }

    #[test]
    fn half_covered_pixels_have_the_colour_of_what_covers_them() {
        let color = [200u8, 60, 9];
        let half = color.map(|c| encoded(0.5 * linear(c)));
        let mut pixels = [half[0], half[1], half[2], 128, 1, 2, 3, 255, 0, 0, 0, 0];
        straighten(&mut pixels);
        for (c, right) in pixels.iter().zip(color) {
            assert!(c.abs_diff(right) <= 3, "{pixels:?}");
        }
        assert_eq!(pixels[4..], [1, 2, 3, 255, 0, 0, 0, 0]);
    }
}
