//! A picture of all panes, drawn without a window.

use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer};

use super::layout;
use super::overlay::Overlay;
use super::text;
use crate::failure::Failure;
use crate::session::{Pane, Readings};

/// A picture of the panes as they are now, with the text if there are several: rows from the top,
/// with four bytes for a pixel.
pub fn draw(
    gpu: &Gpu,
    offscreen: &Offscreen,
    panes: &mut [Pane],
    camera: Camera,
    scale: f32,
    readings: &Readings,
) -> Result<Vec<u8>, Failure> {
    let size = offscreen.size();
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let topology = panes[0].topology();
    let mut renderer = Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &topology);
    for (k, pane) in panes.iter_mut().enumerate() {
        // Each run tears in its own way.
        if k > 0
            && pane
                .simulation
                .model()
                .network()
                .is_some_and(|n| n.tear_limit().is_some())
        {
            renderer.set_topology_of(gpu, k, &pane.topology());
        }
        pane.show.compose(&pane.simulation);
    }
    let panes = &*panes;
    let pictures: Vec<_> = panes
        .iter()
        .map(|pane| pane.show.picture(camera, scale))
        .zip(layout::tiles(panes.len(), size, scale))
        .collect();
    let write =
        |encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView, format| match panes.len() {
            1 => vec![],
            _ => Overlay::new(gpu, format).write(gpu, encoder, view, (size, scale), |ctx| {
                text::show(ctx, panes, readings);
            }),
        };
    offscreen
        .render_tiles(gpu, &mut renderer, &pictures, write)
        .map_err(Failure::run)
}
