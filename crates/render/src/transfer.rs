//! Pictures under text, on devices where a texture cannot have views of two formats, and text over
//! pictures, where it is not drawn in each frame.

use wgpu::{PipelineCompilationOptions, TextureFormat, TextureUsages};

use crate::gpu::Gpu;

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
        let picture = device
            .create_texture(&wgpu::TextureDescriptor {
                label: Some("picture"),
                size: wgpu::Extent3d {
                    width: size.0,
                    height: size.1,
                    depth_or_array_layers: 1,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: own,
                usage: TextureUsages::RENDER_ATTACHMENT | TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            })
            .create_view(&wgpu::TextureViewDescriptor::default());
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
        Self {
            picture,
            bind,
            pipeline,
            below,
        }
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
                ops: wgpu::Operations {
                    load: self.below,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.bind, &[]);
        pass
    }
}
