//! `a3 render`: a picture without a window.

use a3_core::Simulation;
use a3_render::{Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer};

use crate::cli::{self, Render};
use crate::show::{self, Show};
use crate::{Failure, output, progress};

/// Pictures of this height (px) have lines of one point a pixel.
const POINTS: f32 = 720.0;

pub fn run(options: &Render) -> Result<(), Failure> {
    let mut simulation = options.run.simulation()?;
    cli::check_particle(&simulation, options.springs_of)?;
    output::check(&options.output, &["png"])?;
    let gpu = pollster::block_on(Gpu::headless()).map_err(Failure::run)?;
    // Before the work, not after: the device may not have pictures of this size.
    let offscreen = Offscreen::new(&gpu, options.size).map_err(Failure::usage)?;
    if let Some(i) = options.springs_of {
        output::say(&show::list_springs_of(&simulation, i))?;
    }
    let mut show = Show::new(options.wireframe, options.springs_of);
    progress::advance(&mut simulation, options.run.until, |simulation| {
        show.follow(simulation);
    })
    .map_err(Failure::run)?;
    let pixels = draw(&gpu, &offscreen, &simulation, &mut show, options.size)?;
    output::write(&options.output, &output::png(&pixels, options.size)?)
}

/// The run as it is now, seen from where its scene wants it.
pub fn draw(
    gpu: &Gpu,
    offscreen: &Offscreen,
    simulation: &Simulation,
    show: &mut Show,
    size: (u32, u32),
) -> Result<Vec<u8>, Failure> {
    let samples = gpu.samples(OFFSCREEN_FORMAT);
    let mut renderer = Renderer::new(gpu, OFFSCREEN_FORMAT, samples, &show::topology(simulation));
    show.compose(simulation);
    let scale = (size.1 as f32 / POINTS).max(0.5);
    let picture = show.picture(show::camera(simulation), scale);
    offscreen
        .render(gpu, &mut renderer, &picture)
        .map_err(Failure::run)
}
