//! Small pictures of the scenes, for their list.

use std::collections::HashMap;

use a3_core::{Simulation, integrators};
use a3_render::{Gpu, Renderer, Targets, Tile, Transfer};
use egui::TextureId;
use web_time::{Duration, Instant};

use super::adapter::window_samples;
use crate::draw::show::{Manner, Show};
use crate::window::hud::Overlay;
use crate::window::session::{Session, Topic};

/// Width and height (px).
const SIZE: (u32, u32) = (192, 120);
/// Format of the textures.
const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Simulated time that a picture shows (s), if it is computed in the real time that follows.
const SHOWN_TIME: f64 = 0.6;
/// Longest real time for computing the state that a picture shows.
const MAX_COMPUTING: Duration = Duration::from_millis(30);

/// The pictures that were drawn so far.
pub struct Thumbnails {
    renderer: Renderer,
    targets: Targets,
    transfer: Transfer,
    /// The pictures by the names of scenes; `None` where a scene has none.
    drawn: HashMap<String, Option<TextureId>>,
    /// Whether they have the dark theme.
    dark: bool,
}

impl Thumbnails {
    /// Creates an empty collection.
    pub fn new(gpu: &Gpu, session: &Session) -> Self {
        let linear = FORMAT.add_srgb_suffix();
        let samples = window_samples(gpu, linear);
        let topology = session.runs.panes[0].topology();
        Self {
            renderer: Renderer::new(gpu, linear, samples, &topology),
            targets: Targets::new(gpu, SIZE, linear, samples),
            transfer: Transfer::new(gpu, SIZE, FORMAT),
            drawn: HashMap::new(),
            dark: false,
        }
    }

    /// Returns the pictures by the names of scenes.
    pub fn pictures(&self) -> HashMap<String, TextureId> {
        let pictures = self.drawn.iter();
        pictures
            .filter_map(|(name, id)| Some((name.clone(), (*id)?)))
            .collect()
    }

    /// Draws the next missing picture of the open list, and returns whether there was one.
    pub fn draw_next(&mut self, gpu: &Gpu, session: &Session, overlay: &mut Overlay) -> bool {
        let list = session.list.as_ref();
        let Some(list) = list.filter(|list| list.topic == Topic::Scenes) else {
            return false;
        };
        let dark = session.runs.panes[0].show.dark;
        if dark != self.dark {
            self.dark = dark;
            for id in self.drawn.drain().filter_map(|(_, id)| id) {
                overlay.free(id);
            }
        }
        let mut missing = list
            .entries()
            .filter(|it| !self.drawn.contains_key(&it.name));
        let Some(entry) = missing.next() else {
            return false;
        };
        let id = self.draw(gpu, session, entry.number, overlay);
        self.drawn.insert(entry.name.clone(), id);
        true
    }

    /// Draws the picture of the scene of a number; `None` if it cannot be built.
    fn draw(
        &mut self,
        gpu: &Gpu,
        session: &Session,
        number: usize,
        overlay: &mut Overlay,
    ) -> Option<TextureId> {
        let setup = session.scenes.setup(number)?;
        let usual = integrators::find("trapezoid");
        let method = setup.defaults.solver.or(usual)?;
        let control = setup.defaults.control_of(method);
        let mut run = Simulation::new(setup.scene, method, control).ok()?;
        let begun = Instant::now();
        while run.time() < SHOWN_TIME && begun.elapsed() < MAX_COMPUTING {
            let next = run.time() + 0.05;
            run.advance_to(next).ok()?;
        }
        let manner = Manner {
            dark: self.dark,
            ..Manner::default()
        };
        let mut show = Show::new(setup.presentation, manner);
        show.compose(&run);
        self.renderer.set_topology(gpu, &show.topology(&run));
        let picture = show.picture(show.camera(), 1.0);
        self.renderer.prepare(gpu, &[(picture, Tile::whole(SIZE))]);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("thumbnail"),
            size: wgpu::Extent3d {
                width: SIZE.0,
                height: SIZE.1,
                depth_or_array_layers: 1,
            },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let mut encoder = gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        self.renderer
            .draw(&mut self.targets.pass(&mut encoder, self.transfer.picture()));
        self.transfer.copy(&mut encoder, &view);
        gpu.queue.submit([encoder.finish()]);
        Some(overlay.register(gpu, &view))
    }
}
