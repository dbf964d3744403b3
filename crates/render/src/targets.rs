//! Render targets: depth and multisampled colour.

use crate::gpu::{DEPTH, Gpu};

/// The linear colour between pictures, which is that of wires.
pub(crate) const GAP: wgpu::Color = wgpu::Color {
    r: 0.035,
    g: 0.05,
    b: 0.09,
    a: 1.0,
};

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
    pub fn new(gpu: &Gpu, size: (u32, u32), color: wgpu::TextureFormat, samples: u32) -> Self {
        let texture = |format| {
            gpu.device
                .create_texture(&wgpu::TextureDescriptor {
                    label: Some("target"),
                    size: wgpu::Extent3d {
                        width: size.0,
                        height: size.1,
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: samples,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                    view_formats: &[],
                })
                .create_view(&wgpu::TextureViewDescriptor::default())
        };
        Self {
            multisampled: (samples > 1).then(|| texture(color)),
            depth: texture(DEPTH),
            size,
        }
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
    pub(crate) fn pass_over<'e>(
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
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(clear),
                    store,
                },
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
