//! `a3 render`: pictures and films without a window.

use a3_core::Simulation;
use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer};

use crate::app::{Pane, Readings, Text, hud, layout};
use crate::cli::{self, Render};
use crate::show::{self, Show};
use crate::{Failure, film, output, progress};

/// Pictures of this height (px) have lines of one point a pixel.
const POINTS: f32 = 720.0;

pub fn run(options: &Render) -> Result<(), Failure> {
    let mut simulation = options.run.simulation()?;
    cli::check_particle(&simulation, options.springs_of)?;
    let (path, size) = (&options.output, options.size);
    output::check(path, &["png", "gif", "mp4"])?;
    // Before the work, not after: there may be no ffmpeg, and the device may not have pictures of this size.
    let film = film::begin(options)?;
    let mut painter = Painter::new(&simulation, size)?;
    if let Some(i) = options.springs_of {
        output::say(&show::list_springs_of(&simulation, i))?;
    }
    let mut show = Show::new(options.wireframe, options.springs_of);
    show.transparent = options.transparent;
    if let Some(film) = film {
        return film::shoot(&mut simulation, &mut show, &mut painter, film, path);
    }
    progress::advance(&mut simulation, options.run.end()?, |simulation| {
        show.follow(simulation);
    })
    .map_err(Failure::run)?;
    let pixels = painter.draw(&mut show, &simulation)?;
    output::write(path, &output::png(&pixels, size)?)
}

/// Draws a run as often as asked, seen from where its scene wants it.
pub struct Painter {
    gpu: Gpu,
    offscreen: Offscreen,
    renderer: Renderer,
    /// Springs that had broken when the topology was made.
    tears: usize,
    camera: Camera,
}

impl Painter {
    /// For pictures of this run, of this size (px).
    pub fn new(simulation: &Simulation, size: (u32, u32)) -> Result<Self, Failure> {
        let gpu = pollster::block_on(Gpu::headless()).map_err(Failure::run)?;
        let offscreen = Offscreen::new(&gpu, size).map_err(Failure::usage)?;
        let samples = gpu.samples(OFFSCREEN_FORMAT);
        let topology = show::topology(simulation);
        Ok(Self {
            renderer: Renderer::new(&gpu, OFFSCREEN_FORMAT, samples, &topology),
            tears: simulation.tears(),
            camera: show::camera(simulation),
            offscreen,
            gpu,
        })
    }

    /// The run as it is now: rows from the top, four bytes a pixel.
    pub fn draw(&mut self, show: &mut Show, simulation: &Simulation) -> Result<Vec<u8>, Failure> {
        if simulation.tears() != self.tears {
            self.tears = simulation.tears();
            let topology = show::topology(simulation);
            self.renderer.set_topology_of(&self.gpu, 0, &topology);
        }
        show.compose(simulation);
        let picture = show.picture(self.camera, scale(self.offscreen.size()));
        self.offscreen
            .render(&self.gpu, &mut self.renderer, &picture)
            .map_err(Failure::run)
    }
}

/// Pixels per point in a picture of this size.
pub fn scale(size: (u32, u32)) -> f32 {
    (size.1 as f32 / POINTS).max(0.5)
}

/// Panes as they are now, several of them with the text over them.
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
    let topology = show::topology(&panes[0].simulation);
    let mut renderer = Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &topology);
    for (k, pane) in panes.iter_mut().enumerate() {
        // Each tears in its own way.
        if k > 0
            && pane
                .simulation
                .model()
                .network()
                .is_some_and(|n| n.tear_limit().is_some())
        {
            renderer.set_topology_of(gpu, k, &show::topology(&pane.simulation));
        }
        pane.show.compose(&pane.simulation);
    }
    let panes = &*panes;
    let pictures: Vec<_> = panes
        .iter()
        .map(|pane| pane.show.picture(camera, scale))
        .zip(layout::tiles(panes.len(), size, scale))
        .collect();
    let text =
        |encoder: &mut wgpu::CommandEncoder, view: &wgpu::TextureView, format| match panes.len() {
            1 => vec![],
            _ => Text::new(gpu, format).write(gpu, encoder, view, (size, scale), |ctx| {
                hud::show(ctx, panes, readings);
            }),
        };
    offscreen
        .render_tiles(gpu, &mut renderer, &pictures, text)
        .map_err(Failure::run)
}
