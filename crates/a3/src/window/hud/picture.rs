//! Pictures of all panes, drawn without a window.

use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer, TEXT_FORMAT};

use super::layout;
use super::overlay::Overlay;
use super::text;
use crate::base::failure::Failure;
use crate::window::session::{Pane, Readings};

/// Draws panes as often as needed.
pub struct Studio {
    offscreen: Offscreen,
    renderer: Renderer,
    /// Number of broken springs when the topology of each pane was made, if it has its own.
    tears: Vec<Option<usize>>,
}

impl Studio {
    /// A studio for pictures of these panes, into this target.
    pub fn new(gpu: &Gpu, offscreen: Offscreen, panes: &[Pane]) -> Self {
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let topology = panes[0].topology();
        // Panes tear in their own ways: they share a topology where nothing is torn.
        let whole = panes.iter().all(|pane| pane.simulation.tears() == 0);
        Self {
            renderer: Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &topology),
            tears: vec![whole.then_some(0); panes.len()],
            offscreen,
        }
    }

    /// Size of the pictures (px).
    pub fn size(&self) -> (u32, u32) {
        self.offscreen.size()
    }

    /// A picture of the panes as they are now, at `scale` pixels per point, with the text if there
    /// are several: rows from the top, with four bytes for a pixel.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        panes: &mut [Pane],
        camera: Camera,
        scale: f32,
        readings: &Readings,
    ) -> Result<Vec<u8>, Failure> {
        let size = self.size();
        for (k, (pane, tears)) in panes.iter_mut().zip(&mut self.tears).enumerate() {
            let now = Some(pane.simulation.tears());
            if *tears != now {
                *tears = now;
                self.renderer.set_topology_of(gpu, k, &pane.topology());
            }
            // The pointer is not in the picture.
            let hovered = pane.show.hovered.take();
            pane.show.compose(&pane.simulation);
            pane.show.hovered = hovered;
        }
        let panes = &*panes;
        let pictures: Vec<_> = panes
            .iter()
            .map(|pane| pane.show.picture(camera, scale))
            .zip(layout::tiles(panes.len(), size, scale))
            .collect();
        let write = |encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView| {
            if panes.len() == 1 {
                return vec![];
            }
            let mut overlay = Overlay::new(gpu, TEXT_FORMAT);
            overlay.dark = panes[0].show.dark;
            overlay.write(gpu, encoder, view, (size, scale), |ctx| {
                text::show(ctx, panes, readings);
            })
        };
        self.offscreen
            .render_tiles(gpu, &mut self.renderer, &pictures, write)
            .map_err(Failure::run)
    }
}
