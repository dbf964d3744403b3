//! egui's text and shapes, drawn over a picture.

use a3_render::Gpu;
use egui::ClippedPrimitive;
use egui::epaint::Primitive;

use super::style::{context, exchanged};

/// egui's layout and its renderer.
pub struct Overlay {
    /// The layout.
    pub context: egui::Context,
    /// Whether light and dark are exchanged.
    pub dark: bool,
    renderer: egui_wgpu::Renderer,
}

impl Overlay {
    /// An overlay for views of this format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self {
            context: context(),
            dark: false,
            renderer: egui_wgpu::Renderer::new(
                &gpu.device,
                format,
                egui_wgpu::RendererOptions::default(),
            ),
        }
    }

    /// Lays out what `contents` writes, and takes new textures to the GPU.
    pub fn lay_out(
        &mut self,
        gpu: &Gpu,
        input: egui::RawInput,
        mut contents: impl FnMut(&egui::Context),
    ) -> egui::FullOutput {
        let mut output = self.context.run_ui(input, |ui| contents(ui.ctx()));
        // egui panics if a change of textures is dropped before it is drained.
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.renderer
                    .update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
        output
    }

    /// Draws the layout over a `view` of `size` (px), and returns the commands to submit before
    /// those of the encoder.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        size: (u32, u32),
        mut output: egui::FullOutput,
    ) -> Vec<wgpu::CommandBuffer> {
        let pixels_per_point = output.pixels_per_point;
        let mut shapes = self.context.tessellate(output.shapes, pixels_per_point);
        if self.dark {
            shapes.iter_mut().for_each(darken);
        }
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [size.0, size.1],
            pixels_per_point,
        };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let before = self
            .renderer
            .update_buffers(device, queue, encoder, &shapes, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("text"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.renderer
            .render(&mut pass.forget_lifetime(), &shapes, &screen);
        for id in output.textures_delta.free.drain() {
            self.renderer.free_texture(&id);
        }
        before
    }

    /// Lays out and draws without a window, at `scale` pixels per point.
    pub fn write(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        (size, scale): ((u32, u32), f32),
        mut contents: impl FnMut(&egui::Context),
    ) -> Vec<wgpu::CommandBuffer> {
        let points = egui::vec2(size.0 as f32, size.1 as f32) / scale;
        let input = |time| {
            let mut input = egui::RawInput {
                screen_rect: Some(egui::Rect::from_min_size(egui::Pos2::ZERO, points)),
                max_texture_side: Some(gpu.largest_side() as usize),
                time: Some(time),
                ..Default::default()
            };
            let root = input.viewports.entry(egui::ViewportId::ROOT).or_default();
            root.native_pixels_per_point = Some(scale);
            input
        };
        // The first pass measures; in the next ones the text fades in.
        let mut output = self.lay_out(gpu, input(0.0), &mut contents);
        for pass in 1..3 {
            output.textures_delta.free.drain().for_each(drop);
            output = self.lay_out(gpu, input(f64::from(pass)), &mut contents);
        }
        self.paint(gpu, encoder, view, size, output)
    }
}

/// Exchanges light and dark in all colours of a shape.
fn darken(shape: &mut ClippedPrimitive) {
    if let Primitive::Mesh(mesh) = &mut shape.primitive {
        for vertex in &mut mesh.vertices {
            vertex.color = exchanged(vertex.color);
        }
    }
}
