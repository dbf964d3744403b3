//! Render targets: depth and multisampled colour, pictures under and over text, and offscreen
//! pictures, drawn without a window.

use wgpu::{PipelineCompilationOptions, TextureFormat, TextureUsages};

use crate::gpu::{DEPTH, Gpu, GpuError, flat};
use crate::picture::{Picture, Tile};
use crate::renderer::Renderer;

/// The linear colour between pictures, which is that of wires.
#[rustfmt::skip]
const GAP: wgpu::Color = wgpu::Color { r: 0.035, g: 0.05, b: 0.09, a: 1.0 };

/// The depth buffer and, for several samples per pixel, the colour buffer that pictures are drawn
/// into.
pub struct Targets {
    multisampled: Option<wgpu::TextureView>,
    depth: wgpu::TextureView,
    size: (u32, u32),
}

impl Targets {
    /// Creates targets for pictures of `size` (px), which must be within the limits of the device.
    #[must_use]
    pub fn new(gpu: &Gpu, size: (u32, u32), color: TextureFormat, samples: u32) -> Self {
        let texture = |format| {
            let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
                sample_count: samples,
                ..flat("target", size, format, TextureUsages::RENDER_ATTACHMENT)
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self { multisampled: (samples > 1).then(|| texture(color)), depth: texture(DEPTH), size }
    }

    /// Returns the width and height (px).
    #[must_use]
    pub fn size(&self) -> (u32, u32) {
        self.size
    }

    /// Begins a pass that clears all targets, and whose colours are written to `destination`.
    pub fn pass<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        destination: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'e> {
        self.pass_over(encoder, destination, GAP)
    }

    /// Begins a pass like [`pass`](Self::pass), with this colour where nothing is drawn.
    fn pass_over<'e>(
        &self,
        encoder: &'e mut wgpu::CommandEncoder,
        destination: &wgpu::TextureView,
        clear: wgpu::Color,
    ) -> wgpu::RenderPass<'e> {
        let (view, resolve_target, store) = match &self.multisampled {
            Some(view) => (view, Some(destination), wgpu::StoreOp::Discard),
            None => (destination, None, wgpu::StoreOp::Store),
        };
        encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target,
                ops: wgpu::Operations { load: wgpu::LoadOp::Clear(clear), store },
            })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(1.0),
                    store: wgpu::StoreOp::Discard,
                }),
                stencil_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0),
                    store: wgpu::StoreOp::Discard,
                }),
            }),
            timestamp_writes: None,
            occlusion_query_set: None,
            multiview_mask: None,
        })
    }
}

/// A texture of linear light that pictures are drawn into, and its copy into a target whose bytes
/// are blended without conversion. Text is written to that target, because its colours, opacity and
/// edges are meant for sRGB. On other devices, one texture has a view for each format.
pub struct Transfer {
    picture: wgpu::TextureView,
    bind: wgpu::BindGroup,
    pipeline: wgpu::RenderPipeline,
    /// What happens to the previous content of the target.
    below: wgpu::LoadOp<wgpu::Color>,
}

/// Left, top, width and height of a part of a texture (px).
pub type Part = [u32; 4];

impl Transfer {
    /// Creates a texture of `size` (px) and of the sRGB format that belongs to the format of the
    /// target.
    #[must_use]
    pub fn new(gpu: &Gpu, size: (u32, u32), target: TextureFormat) -> Self {
        let clear = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
        let own = target.add_srgb_suffix();
        Self::with(gpu, size, [own, target], ("transfer_fragment", None), clear)
    }

    /// Creates a texture of `size` (px) in the target's format, for text that is laid over a
    /// target. Its colours are premultiplied by their opacity.
    #[must_use]
    pub fn layer(gpu: &Gpu, size: (u32, u32), target: TextureFormat) -> Self {
        let blend = Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING);
        let how = ("layer_fragment", blend);
        Self::with(gpu, size, [target, target], how, wgpu::LoadOp::Load)
    }

    fn with(
        gpu: &Gpu,
        size: (u32, u32),
        [own, target]: [TextureFormat; 2],
        (fragment, blend): (&str, Option<wgpu::BlendState>),
        below: wgpu::LoadOp<wgpu::Color>,
    ) -> Self {
        let device = &gpu.device;
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING;
        let picture = device.create_texture(&flat("picture", size, own, usage));
        let picture = picture.create_view(&wgpu::TextureViewDescriptor::default());
        let shader = device.create_shader_module(wgpu::include_wgsl!("transfer.wgsl"));
        let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some("transfer"),
            layout: None,
            vertex: wgpu::VertexState {
                module: &shader,
                entry_point: None,
                compilation_options: PipelineCompilationOptions::default(),
                buffers: &[],
            },
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
            multisample: wgpu::MultisampleState::default(),
            fragment: Some(wgpu::FragmentState {
                module: &shader,
                entry_point: Some(fragment),
                compilation_options: PipelineCompilationOptions::default(),
                targets: &[Some(wgpu::ColorTargetState {
                    format: target,
                    blend,
                    write_mask: wgpu::ColorWrites::ALL,
                })],
            }),
            multiview_mask: None,
            cache: None,
        });
        let bind = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("picture"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry {
                binding: 0,
                resource: wgpu::BindingResource::TextureView(&picture),
            }],
        });
        Self { picture, bind, pipeline, below }
    }

    /// Returns the view that pictures, or text, are drawn into.
    #[must_use]
    pub fn picture(&self) -> &wgpu::TextureView {
        &self.picture
    }

    /// Copies the picture into the target, or lays the text over it.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, target: &wgpu::TextureView) {
        self.pass(encoder, target).draw(0..3, 0..1);
    }

    /// Copies the picture, or lays the text, over parts of the target only.
    pub fn copy_parts(
        &self,
        encoder: &mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
        parts: &[Part],
    ) {
        let mut pass = self.pass(encoder, target);
        for [left, top, width, height] in parts {
            pass.set_scissor_rect(*left, *top, *width, *height);
            pass.draw(0..3, 0..1);
        }
    }

    fn pass<'a>(
        &self,
        encoder: &'a mut wgpu::CommandEncoder,
        target: &wgpu::TextureView,
    ) -> wgpu::RenderPass<'a> {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("transfer"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: target,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: self.below, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind, &[]);
        pass
    }
}

/// The format of offscreen pictures: eight bits each of red, green, blue and opacity, in sRGB.
pub const OFFSCREEN_FORMAT: TextureFormat = TextureFormat::Rgba8UnormSrgb;
/// The format of text over them: the same bytes, blended without conversion.
pub const TEXT_FORMAT: TextureFormat = TextureFormat::Rgba8Unorm;

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
        let usage = TextureUsages::RENDER_ATTACHMENT | TextureUsages::COPY_SRC;
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            view_formats: if two_views { &[OFFSCREEN_FORMAT] } else { &[] },
            ..flat("offscreen", size, TEXT_FORMAT, usage)
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
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        let transparent = pictures.iter().any(|(picture, _)| picture.transparent);
        let nothing = wgpu::Color::TRANSPARENT;
        let clear = if transparent { nothing } else { GAP };
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
            wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout },
            self.texture.size(),
        );
        gpu.queue.submit(before.into_iter().chain([encoder.finish()]));
        let slice = self.buffer.slice(..);
        slice.map_async(wgpu::MapMode::Read, |_| {});
        gpu.device.poll(wgpu::PollType::wait_indefinitely()).map_err(|_| GpuError::Lost)?;
        gpu.check()?;
        let mapped = slice.get_mapped_range();
        let mapped = mapped.map_err(|e| GpuError::Refused(e.to_string()))?;
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
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

/// Returns the sRGB channel of a linear light: the inverse of [`linear`].
fn encoded(light: f32) -> u8 {
    let light = light.min(1.0);
    let c =
        if light <= 0.003_130_8 { 12.92 * light } else { 1.055 * light.powf(1.0 / 2.4) - 0.055 };
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
