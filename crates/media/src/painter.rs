//! Pictures of one run, drawn without a window.

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer, Tile};
use wgpu::{CommandBuffer, CommandEncoder, TextureView};

use crate::show::Show;

/// Height of a picture (px) in which lines are drawn at one pixel per point.
const UNSCALED_HEIGHT: f32 = 720.0;

/// Draws text over a picture of a run, with these commands and into this view. Returns the commands
/// to submit first.
pub type Caption =
    Box<dyn FnMut(&Show, &Gpu, &mut CommandEncoder, &TextureView) -> Vec<CommandBuffer>>;

/// Draws pictures of a run, seen by the camera of its scene.
pub struct Painter {
    gpu: Gpu,
    offscreen: Offscreen,
    renderer: Renderer,
    /// Number of broken springs when the topology was made.
    tears: usize,
    camera: Camera,
    caption: Option<Caption>,
}

impl Painter {
    /// Creates a painter for pictures of this run, of this size (px), with a caption or without.
    pub fn new(
        show: &Show,
        simulation: &Simulation,
        size: (u32, u32),
        caption: Option<Caption>,
    ) -> Result<Self, Failure> {
        let gpu = pollster::block_on(Gpu::headless()).map_err(Failure::run)?;
        let offscreen = Offscreen::new(&gpu, size).map_err(Failure::usage)?;
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let topology = show.topology(simulation);
        Ok(Self {
            renderer: Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &topology),
            tears: simulation.tears(),
            camera: show.camera(),
            caption,
            offscreen,
            gpu,
        })
    }

    /// Draws the present state of the run: rows from the top, with four bytes for a pixel.
    pub fn draw(&mut self, show: &mut Show, simulation: &Simulation) -> Result<Vec<u8>, Failure> {
        if simulation.tears() != self.tears {
            self.tears = simulation.tears();
            let topology = show.topology(simulation);
            self.renderer.set_topology_of(&self.gpu, 0, &topology);
        }
        show.compose(simulation);
        let size = self.offscreen.size();
        let picture = (show.picture(self.camera, scale(size)), Tile::whole(size));
        let (gpu, caption) = (&self.gpu, &mut self.caption);
        self.offscreen
            .render_tiles(gpu, &mut self.renderer, &[picture], |encoder, view| {
                caption.as_mut().map_or(vec![], |caption| caption(show, gpu, encoder, view))
            })
            .map_err(Failure::run)
    }
}

/// Returns the pixels per point in a picture of this size (px).
pub fn scale(size: (u32, u32)) -> f32 {
    (size.1 as f32 / UNSCALED_HEIGHT).max(0.5)
}
