//! `a3 render`: a picture without a window.

use a3_render::{Camera, Gpu, OFFSCREEN_FORMAT, Offscreen, Renderer};

use crate::app::{Pane, Readings, Text, hud, layout};
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
    progress::advance(&mut simulation, options.run.end()?, |simulation| {
        show.follow(simulation);
    })
    .map_err(Failure::run)?;
    let pixels = draw_one(&gpu, &offscreen, Pane::new(simulation, show))?;
    output::write(&options.output, &output::png(&pixels, options.size)?)
}

/// Pixels per point in a picture of this size.
pub fn scale(size: (u32, u32)) -> f32 {
    (size.1 as f32 / POINTS).max(0.5)
}

/// A run as it is now, seen from where its scene wants it.
pub fn draw_one(gpu: &Gpu, offscreen: &Offscreen, pane: Pane) -> Result<Vec<u8>, Failure> {
    let camera = show::camera(&pane.simulation);
    let scale = scale(offscreen.size());
    draw(
        gpu,
        offscreen,
        &mut [pane],
        camera,
        scale,
        &Readings::default(),
    )
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
