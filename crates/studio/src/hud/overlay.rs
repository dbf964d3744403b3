//! Drawing of egui's text and shapes over a picture.

use a3_render::{Gpu, Part};
use egui::epaint::{ClippedShape, Primitive};
use egui::{ClippedPrimitive, Pos2, Rect, vec2};

use super::style::{context, invert_lightness};

/// egui's context and its renderer.
pub struct Overlay {
    /// egui's context.
    pub context: egui::Context,
    /// Whether to invert the lightness of all colours, for the dark theme.
    pub dark: bool,
    /// The parts of the view that the last layout covers, which do not overlap.
    pub filled: Vec<Part>,
    renderer: egui_wgpu::Renderer,
}

impl Overlay {
    /// Creates an overlay for views of a format.
    pub fn new(gpu: &Gpu, format: wgpu::TextureFormat) -> Self {
        Self {
            context: context(),
            dark: false,
            filled: vec![],
            renderer: egui_wgpu::Renderer::new(
                &gpu.device,
                format,
                egui_wgpu::RendererOptions::default(),
            ),
        }
    }

    /// Makes a texture available to images, and returns its number.
    pub fn register(&mut self, gpu: &Gpu, view: &wgpu::TextureView) -> egui::TextureId {
        let filter = wgpu::FilterMode::Linear;
        self.renderer.register_native_texture(&gpu.device, view, filter)
    }

    /// Forgets a registered texture.
    pub fn free(&mut self, id: egui::TextureId) {
        self.renderer.free_texture(&id);
    }

    /// Lays out `contents`, and uploads new textures.
    pub fn lay_out(
        &mut self,
        gpu: &Gpu,
        input: egui::RawInput,
        mut contents: impl FnMut(&egui::Context),
    ) -> egui::FullOutput {
        let mut output = self.context.run_ui(input, |ui| contents(ui.ctx()));
        // egui panics if texture changes are dropped without being drained.
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.renderer.update_texture(&gpu.device, &gpu.queue, id, &delta);
            }
        }
        output
    }

    /// Draws a layout to a view of `size` (px), over what `below` keeps of the view. Returns the
    /// commands to submit before those of the encoder.
    pub fn paint(
        &mut self,
        gpu: &Gpu,
        encoder: &mut wgpu::CommandEncoder,
        (view, below): (&wgpu::TextureView, wgpu::LoadOp<wgpu::Color>),
        size: (u32, u32),
        mut output: egui::FullOutput,
    ) -> Vec<wgpu::CommandBuffer> {
        let pixels_per_point = output.pixels_per_point;
        self.filled = filled(&output.shapes, pixels_per_point, size);
        let mut shapes = self.context.tessellate(output.shapes, pixels_per_point);
        if self.dark {
            shapes.iter_mut().for_each(darken);
        }
        let screen =
            egui_wgpu::ScreenDescriptor { size_in_pixels: [size.0, size.1], pixels_per_point };
        let (device, queue) = (&gpu.device, &gpu.queue);
        let before = self.renderer.update_buffers(device, queue, encoder, &shapes, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("text"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations { load: below, store: wgpu::StoreOp::Store },
            })],
            ..Default::default()
        });
        self.renderer.render(&mut pass.forget_lifetime(), &shapes, &screen);
        for id in output.textures_delta.free.drain() {
            self.renderer.free_texture(&id);
        }
        before
    }

    /// Lays out and draws `contents` without a window, on a view of `size` (px) at `scale` pixels
    /// per point. Returns the commands to submit before those of the encoder.
    #[cfg(not(target_arch = "wasm32"))]
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
        // The first pass measures the layout; in the next ones the text fades in.
        let start = self.context.input(|input| input.time);
        let mut output = self.lay_out(gpu, input(start + 1.0), &mut contents);
        for pass in 2..4 {
            output.textures_delta.free.drain().for_each(drop);
            output = self.lay_out(gpu, input(start + f64::from(pass)), &mut contents);
        }
        self.paint(gpu, encoder, (view, wgpu::LoadOp::Load), size, output)
    }
}

/// Returns rectangles that cover all shapes in a view of `size` (px) and do not overlap.
fn filled(shapes: &[ClippedShape], pixels_per_point: f32, size: (u32, u32)) -> Vec<Part> {
    let view = Rect::from_min_size(Pos2::ZERO, vec2(size.0 as f32, size.1 as f32));
    let mut apart: Vec<Rect> = vec![];
    for ClippedShape { clip_rect, shape, transform_after_tessellation: moved } in shapes {
        let bounds = shape.visual_bounding_rect();
        let bounds = *moved * bounds;
        let bounds = bounds.intersect(*clip_rect) * pixels_per_point;
        // Smooth edges add a pixel.
        let pixel = vec2(1.0, 1.0);
        let (min, max) = (bounds.min.floor() - pixel, bounds.max.ceil() + pixel);
        let mut part = Rect::from_min_max(min, max).intersect(view);
        if !bounds.is_positive() || !part.is_positive() {
            continue;
        }
        while let Some(k) = apart.iter().position(|other| other.intersects(part)) {
            part = part.union(apart.swap_remove(k));
        }
        apart.push(part);
    }
    let part = |rect: Rect| [rect.min.x, rect.min.y, rect.width(), rect.height()].map(|a| a as u32);
    apart.into_iter().map(part).collect()
}

/// Inverts the lightness of all colours of a shape.
fn darken(shape: &mut ClippedPrimitive) {
    if let Primitive::Mesh(mesh) = &mut shape.primitive {
        for vertex in &mut mesh.vertices {
            vertex.color = invert_lightness(vertex.color);
        }
    }
}

#[cfg(test)]
mod tests {
    use egui::epaint::{RectShape, Shape};
    use egui::{Color32, pos2};

    use super::*;

    #[test]
    fn shapes_are_covered_once() {
        let shape = |[left, top, right, bottom]: [f32; 4]| {
            let rect = Rect::from_min_max(pos2(left, top), pos2(right, bottom));
            ClippedShape {
                clip_rect: Rect::from_min_max(Pos2::ZERO, pos2(100.0, 30.0)),
                shape: Shape::Rect(RectShape::filled(rect, 0.0, Color32::RED)),
                transform_after_tessellation: egui::emath::TSTransform::default(),
            }
        };
        let two = [[2.0, 2.0, 8.0, 8.0], [50.0, 20.0, 90.0, 60.0]].map(shape);
        // At two pixels per point, with a pixel around each.
        let apart = [[3, 3, 14, 14], [99, 39, 82, 22]];
        assert_eq!(filled(&two, 2.0, (200, 100)), apart);
        let bridged = [two.as_slice(), &[shape([7.0, 7.0, 51.0, 21.0])]].concat();
        assert_eq!(filled(&bridged, 2.0, (200, 100)), [[3, 3, 178, 58]]);
        // Shapes outside the view are left out.
        assert_eq!(filled(&two, 2.0, (40, 100)), [[3, 3, 14, 14]]);
        assert_eq!(filled(&[], 2.0, (40, 100)), [[0; 4]; 0]);
    }
}
