//! Pictures drawn without a window: of all panes, and the legend over those of one run.

use a3_files::failure::Failure;
use a3_media::painter::{self, Caption};
use a3_media::show::Show;
use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer, Style, TEXT_FORMAT};
use egui::Align2;

use super::legend::legend;
use super::overlay::Overlay;
use super::style::{MARGIN, column, sheet};
use super::{layout, text};
use crate::session::{Pane, Readings};

/// A renderer of panes without a window, for one picture or many.
pub struct Studio {
    offscreen: Offscreen,
    renderer: Renderer,
    /// Version of each pane's topology; `None` if it must be uploaded.
    drawn: Vec<Option<[usize; 2]>>,
}

impl Studio {
    /// Creates a studio for pictures of panes, into a target.
    pub fn new(gpu: &Gpu, offscreen: Offscreen, panes: &[Pane]) -> Self {
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let topology = panes[0].topology();
        // Untorn panes share a topology.
        let whole = panes.iter().all(|pane| pane.simulation.tears() == 0);
        Self {
            renderer: Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &topology),
            drawn: vec![whole.then(|| panes[0].topology_version()); panes.len()],
            offscreen,
        }
    }

    /// Returns the size of the pictures (px).
    pub fn size(&self) -> (u32, u32) {
        self.offscreen.size()
    }

    /// Draws the present state of the panes, at `scale` pixels per point, with text if there are
    /// several. Returns rows from the top, four bytes per pixel. Fails if the device does.
    pub fn draw(
        &mut self,
        gpu: &Gpu,
        panes: &mut [Pane],
        camera: Camera,
        scale: f32,
        readings: &Readings,
    ) -> Result<Vec<u8>, Failure> {
        let size = self.size();
        for (k, (pane, drawn)) in panes.iter_mut().zip(&mut self.drawn).enumerate() {
            let now = Some(pane.topology_version());
            if *drawn != now {
                *drawn = now;
                self.renderer.set_topology_of(gpu, k, &pane.topology());
            }
            // A picture has no highlight under the pointer.
            let hovered = pane.show.hovered.take();
            pane.show.compose(&pane.simulation);
            pane.show.hovered = hovered;
        }
        let panes = &*panes;
        let tiles = layout::tiles(panes.len(), size, scale);
        let mut camera = camera;
        camera.set_focus(if panes.len() == 1 {
            [0.0, 0.0, 1.0, 1.0]
        } else {
            layout::focus(panes.len(), layout::points(tiles[0], scale))
        });
        let pictures = panes.iter().map(|pane| pane.show.picture(camera, scale));
        let pictures: Vec<_> = pictures.zip(tiles).collect();
        let write = |encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView| {
            if panes.len() == 1 {
                return vec![];
            }
            let mut overlay = Overlay::new(gpu, TEXT_FORMAT);
            overlay.dark = panes[0].show.dark;
            overlay.write(gpu, encoder, view, (size, scale), |ctx| {
                text::show_text(ctx, panes, readings);
            })
        };
        self.offscreen.render_tiles(gpu, &mut self.renderer, &pictures, write).map_err(Failure::run)
    }
}

/// Returns the legend as the caption of pictures of this size (px), for a show that has colours,
/// arrows or kinds of springs. A transparent picture has none: it is laid over another one.
pub fn caption(show: &Show, size: (u32, u32)) -> Option<Caption> {
    let explains = show.colouring.quantity.is_some()
        || show.field.arrows.is_some()
        || show.style == Style::Springs;
    // Do not shrink text below its normal size: it would be illegible.
    let scale = painter::scale(size).max(1.0);
    let mut overlay = None;
    let write: Caption = Box::new(move |show, gpu, encoder, view| {
        let overlay = overlay.get_or_insert_with(|| Overlay::new(gpu, TEXT_FORMAT));
        overlay.dark = show.dark;
        overlay.write(gpu, encoder, view, (size, scale), |ctx| {
            let corner = [MARGIN, -MARGIN];
            column(ctx, "legend", Align2::LEFT_BOTTOM, corner, |ui| {
                sheet(ui, |ui| legend(ui, show));
            });
        })
    });
    (explains && !show.transparent).then_some(write)
}
