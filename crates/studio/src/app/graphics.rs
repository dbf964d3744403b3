//! The window's surface, with the picture and the text on it, and small pictures of the scenes for
//! their list. All of it is replaced after the loss of a device.
//!
//! Software adapters may take as long for the text as for the picture: there, the text is a layer
//! of its own, which is not drawn in every frame.

use std::collections::HashMap;
use std::sync::Arc;

use a3_core::{Simulation, integrators};
use a3_media::show::{Manner, Show};
use a3_render::{Gpu, GpuError, Renderer, Targets, Tile, Transfer};
use egui::{CursorIcon, TextureId};
use web_time::{Duration, Instant};
use wgpu::CurrentSurfaceTexture;
use winit::event::{TouchPhase, WindowEvent};
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use crate::hud::{self, Overlay, layout};
use crate::session::{Action, Session, Topic};

/// The outcome of drawing a frame.
pub enum FrameOutcome {
    /// The frame was drawn: the time after which the text must be drawn again, because it fades in,
    /// and the request of the mouse.
    Drawn(Option<Duration>, Option<Action>),
    /// The frame could not be drawn now, but a later one may be.
    Skipped,
}

/// The graphics: everything that depends on the adapter.
pub struct Graphics {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// Format of the view for the picture. The text has another view.
    format: wgpu::TextureFormat,
    renderer: Renderer,
    targets: Targets,
    /// Texture for the picture, if the surface cannot have views in two formats.
    transfer: Option<Transfer>,
    /// Layer of the text, if it is not drawn in every frame.
    layer: Option<Layer>,
    /// Version of each pane's topology.
    drawn: Vec<[usize; 2]>,
    overlay: Overlay,
    egui_winit: egui_winit::State,
    /// Pictures of scenes, once their list was opened.
    thumbnails: Option<Thumbnails>,
    /// Whether the last layout had the help, a list or a question over the picture.
    covered: bool,
    /// Scale factor of text and panel, on top of the screen's own.
    zoom: f32,
    /// Whether the next frame resizes the surface to the window.
    pub stale: bool,
    /// The adapter, for pictures outside the window, too.
    pub gpu: Gpu,
    window: Arc<Window>,
}

impl Graphics {
    /// Creates the graphics for a session, from an open adapter and its surface. Fails if the
    /// adapter cannot draw to the window.
    pub fn new(
        gpu: Gpu,
        surface: wgpu::Surface<'static>,
        window: Arc<Window>,
        session: &Session,
    ) -> Result<Self, GpuError> {
        let size = clamped(&gpu, &window);
        let mut config = surface
            .get_default_config(&gpu.adapter, size.0, size.1)
            .ok_or_else(|| GpuError::Device("it cannot draw to this window".into()))?;
        choose_format(&gpu, &surface, &mut config);
        let format = config.format.add_srgb_suffix();
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        let samples = window_samples(&gpu, format);
        let overlay = Overlay::new(&gpu, config.format);
        let egui_winit = egui_winit::State::new(
            overlay.context.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.largest_side() as usize),
        );
        Ok(Self {
            renderer: Renderer::new(&gpu, format, samples, &session.runs.panes[0].topology()),
            targets: Targets::new(&gpu, size, format, samples),
            transfer: transfer(&gpu, &config),
            layer: Layer::new(&gpu, &config),
            drawn: vec![],
            overlay,
            egui_winit,
            surface,
            config,
            format,
            thumbnails: None,
            covered: false,
            zoom: 1.0,
            stale: false,
            gpu,
            window,
        })
    }

    /// Returns the size of the surface (px).
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Returns the parts of the window that the panes fill.
    pub fn tiles(&self, session: &Session) -> Vec<Tile> {
        let size = layout::picture_size(session, self.size(), self.scale());
        layout::tiles(session.runs.panes.len(), size, self.scale())
    }

    /// Returns the part of each pane in which no text hides the scene, as shares of the pane.
    pub fn focus(&self, session: &Session) -> [f32; 4] {
        let tile = self.tiles(session)[0];
        layout::focus(session.runs.panes.len(), layout::points(tile, self.scale()))
    }

    /// Returns the number of pixels per point.
    pub fn scale(&self) -> f32 {
        self.window.scale_factor() as f32 * self.zoom
    }

    /// Sets the scale factor of text and panel, on top of the screen's own.
    pub fn set_zoom(&mut self, zoom: f32) {
        self.zoom = zoom;
        self.overlay.context.set_zoom_factor(zoom);
    }

    /// Passes an event to egui, and returns whether egui takes it. The pointer is at a `position`
    /// (px), which egui knows only since its next layout.
    pub fn on_event(&mut self, event: &WindowEvent, position: [f32; 2]) -> bool {
        let passed = self.egui_winit.on_window_event(&self.window, event);
        let consumed = passed.consumed;
        let is_press = match event {
            WindowEvent::MouseInput { state, .. } => state.is_pressed(),
            WindowEvent::Touch(touch) => touch.phase == TouchPhase::Started,
            _ => false,
        };
        if !is_press && !matches!(event, WindowEvent::MouseWheel { .. }) {
            return consumed;
        }
        self.covers(position) || self.overlay.context.egui_is_using_pointer()
    }

    /// Returns whether text or a button is at a position (px), so that presses there are not for
    /// the scene.
    pub fn covers(&self, position: [f32; 2]) -> bool {
        let (context, scale) = (&self.overlay.context, self.scale());
        let layer = context.layer_id_at(position.map(|px| px / scale).into());
        layer.is_some_and(|layer| layer.order != egui::Order::Background)
    }

    /// Has the text drawn again in the next frame, because it may have changed.
    pub fn invalidate_text(&mut self) {
        if let Some(layer) = &mut self.layer {
            layer.due = None;
        }
    }

    /// Uploads the topology of another scene.
    pub fn set_scene(&mut self, session: &Session) {
        self.renderer.set_topology(&self.gpu, &session.runs.panes[0].topology());
        self.drawn.clear();
    }

    /// Uploads the topology of panes with newly torn springs.
    fn update_topology(&mut self, session: &Session) {
        self.drawn.resize(session.runs.panes.len(), [0; 2]);
        for (k, (pane, drawn)) in session.runs.panes.iter().zip(&mut self.drawn).enumerate() {
            let now = pane.topology_version();
            if *drawn != now {
                *drawn = now;
                let topology = pane.topology();
                self.renderer.set_topology_of(&self.gpu, k, &topology);
            }
        }
    }

    /// Resizes the surface, and everything of its size, to the window.
    fn reconfigure(&mut self) {
        self.stale = false;
        let size = clamped(&self.gpu, &self.window);
        (self.config.width, self.config.height) = size;
        self.surface.configure(&self.gpu.device, &self.config);
        if self.targets.size() != size {
            let samples = window_samples(&self.gpu, self.format);
            self.targets = Targets::new(&self.gpu, size, self.format, samples);
            self.transfer = transfer(&self.gpu, &self.config);
            self.layer = Layer::new(&self.gpu, &self.config);
        }
    }

    /// Draws the session to the window, if that is possible now. The pointer has the shape
    /// `cursor`, unless egui sets another. Fails if the device was lost.
    pub fn frame(
        &mut self,
        session: &mut Session,
        cursor: CursorIcon,
    ) -> Result<FrameOutcome, GpuError> {
        let inner = self.window.inner_size();
        if inner.width == 0 || inner.height == 0 {
            return Ok(FrameOutcome::Skipped);
        }
        if self.stale {
            self.reconfigure();
        }
        let frame = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(frame) => frame,
            CurrentSurfaceTexture::Suboptimal(frame) => {
                // Configuring the surface panics while a frame is alive.
                drop(frame);
                self.reconfigure();
                return Ok(FrameOutcome::Skipped);
            }
            CurrentSurfaceTexture::Outdated => {
                self.reconfigure();
                return Ok(FrameOutcome::Skipped);
            }
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => {
                return Ok(FrameOutcome::Skipped);
            }
            // A lost device may also return `Validation`: check it.
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => {
                self.gpu.check()?;
                return Err(GpuError::Lost);
            }
        };
        self.update_topology(session);
        for pane in &mut session.runs.panes {
            pane.show.compose(&pane.simulation);
        }
        let (camera, scale) = (session.view.camera, self.scale());
        let pictures = session.runs.panes.iter().zip(self.tiles(session));
        let pictures = pictures.map(|(pane, tile)| (pane.show.picture(camera, scale), tile));
        let pictures: Vec<_> = pictures.collect();
        self.renderer.prepare(&self.gpu, &pictures);
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = self.gpu.device.create_command_encoder(&descriptor);
        let view = |format| {
            frame.texture.create_view(&wgpu::TextureViewDescriptor {
                format: Some(format),
                ..Default::default()
            })
        };
        let text_view = view(self.config.format);
        if let Some(transfer) = &self.transfer {
            self.renderer.draw(&mut self.targets.pass(&mut encoder, transfer.picture()));
            transfer.copy(&mut encoder, &text_view);
        } else {
            self.renderer.draw(&mut self.targets.pass(&mut encoder, &view(self.format)));
        }
        // egui's renderer panics on a device that has just been lost.
        self.gpu.check()?;
        let more = self.draw_thumbnail(session);
        let (before, again) = self.draw_text(&mut encoder, &text_view, session, cursor);
        let again = if more { Some(Duration::ZERO) } else { again };
        self.gpu.queue.submit(before.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        self.gpu.queue.present(frame);
        self.gpu.check()?;
        let asked = hud::asked(&self.overlay.context);
        Ok(FrameOutcome::Drawn(again, asked))
    }

    /// Draws the next missing picture of the list of scenes, if that is open, and returns whether
    /// there was one.
    fn draw_thumbnail(&mut self, session: &Session) -> bool {
        if session.list.is_none() {
            return false;
        }
        let (gpu, all) = (&self.gpu, &mut self.thumbnails);
        let thumbnails = all.get_or_insert_with(|| Thumbnails::new(gpu, session));
        let more = thumbnails.draw_next(gpu, session, &mut self.overlay);
        if more {
            self.invalidate_text();
        }
        more
    }

    /// Draws the text over the picture, by way of its layer if it has one. Returns the commands to
    /// submit first, and the time after which the text must be drawn again.
    fn draw_text(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        session: &Session,
        cursor: CursorIcon,
    ) -> (Vec<wgpu::CommandBuffer>, Option<Duration>) {
        let Some(mut layer) = self.layer.take() else {
            return self.draw_text_to(encoder, view, wgpu::LoadOp::Load, session, cursor);
        };
        let written = if let Some(left) = layer.time_left() {
            (vec![], Some(left))
        } else {
            let empty = wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT);
            let on_layer = layer.texture.picture();
            let written = self.draw_text_to(encoder, on_layer, empty, session, cursor);
            layer.drawn(written.1);
            written
        };
        layer.texture.copy_parts(encoder, view, &self.overlay.filled);
        self.layer = Some(layer);
        written
    }

    /// Lays out the text and draws it in its own pass, over what `below` keeps of the view. Returns
    /// what [`Self::draw_text`] does.
    fn draw_text_to(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        below: wgpu::LoadOp<wgpu::Color>,
        session: &Session,
        cursor: CursorIcon,
    ) -> (Vec<wgpu::CommandBuffer>, Option<Duration>) {
        let mut input = self.egui_winit.take_egui_input(&self.window);
        let [right, bottom] = layout::insets(session, self.size(), self.scale());
        input.safe_area_insets = Some(egui::SafeAreaInsets(egui::epaint::MarginF32 {
            right,
            bottom,
            ..Default::default()
        }));
        let pictures = self.thumbnails.as_ref().map(Thumbnails::pictures);
        let pictures = pictures.unwrap_or_default();
        let mut output = self.overlay.lay_out(&self.gpu, input, |ctx| {
            hud::show_all(ctx, session, &pictures);
        });
        let mut answer = std::mem::take(&mut output.platform_output);
        if answer.cursor_icon == CursorIcon::Default {
            answer.cursor_icon = cursor;
        }
        self.egui_winit.handle_platform_output(&self.window, answer);
        let root = output.viewport_output.get(&egui::ViewportId::ROOT);
        let again = root.map(|viewport| viewport.repaint_delay);
        let again = again.filter(|delay| *delay < Duration::from_mins(1));
        // For egui, what has just been closed is under the pointer for one more layout.
        let (readings, was_covered) = (&session.readings, self.covered);
        self.covered = readings.help || readings.asks_to_quit || session.list.is_some();
        let is_uncovered = was_covered && !self.covered;
        let again = is_uncovered.then_some(Duration::ZERO).or(again);
        let size = (self.config.width, self.config.height);
        self.overlay.dark = session.runs.panes[0].show.dark;
        let target = (view, below);
        let before = self.overlay.paint(&self.gpu, encoder, target, size, output);
        (before, again)
    }
}

/// Longest time for which a drawn text is reused: numbers cannot be read faster.
const MAX_TEXT_AGE: Duration = Duration::from_millis(100);

/// The layer, and the time when its text must be drawn again.
pub struct Layer {
    pub texture: Transfer,
    due: Option<Instant>,
}

impl Layer {
    /// Creates a layer over a surface, if the adapter needs one.
    pub fn new(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Self> {
        let size = (config.width, config.height);
        gpu.is_software()
            .then(|| Self { texture: Transfer::layer(gpu, size, config.format), due: None })
    }

    /// Returns the time for which the text can be reused, if it can.
    pub fn time_left(&self) -> Option<Duration> {
        let left = self.due?.saturating_duration_since(Instant::now());
        (!left.is_zero()).then_some(left)
    }

    /// Notes that the text was drawn, and must be drawn again after `again`, or after
    /// `MAX_TEXT_AGE` if that is sooner.
    pub fn drawn(&mut self, again: Option<Duration>) {
        self.due =
            Some(Instant::now() + again.map_or(MAX_TEXT_AGE, |delay| delay.min(MAX_TEXT_AGE)));
    }
}

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
        pictures.filter_map(|(name, id)| Some((name.clone(), (*id)?))).collect()
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
        let mut missing = list.entries().filter(|it| !self.drawn.contains_key(&it.name));
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
        let manner = Manner { dark: self.dark, ..Manner::default() };
        let mut show = Show::new(setup.presentation, manner);
        show.compose(&run);
        self.renderer.set_topology(gpu, &show.topology(&run));
        let picture = show.picture(show.camera(), 1.0);
        self.renderer.prepare(gpu, &[(picture, Tile::whole(SIZE))]);
        let texture = gpu.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("thumbnail"),
            size: wgpu::Extent3d { width: SIZE.0, height: SIZE.1, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let descriptor = wgpu::CommandEncoderDescriptor::default();
        let mut encoder = gpu.device.create_command_encoder(&descriptor);
        self.renderer.draw(&mut self.targets.pass(&mut encoder, self.transfer.picture()));
        self.transfer.copy(&mut encoder, &view);
        gpu.queue.submit([encoder.finish()]);
        Some(overlay.register(gpu, &view))
    }
}

/// Returns the number of samples per pixel in the window. A software adapter gets one: at 1280 x
/// 720 on two cores, an offscreen frame takes 11 ms instead of 43. Lines are smooth even then, and
/// saved pictures always use several samples.
pub fn window_samples(gpu: &Gpu, format: wgpu::TextureFormat) -> u32 {
    if gpu.is_software() { 1 } else { gpu.samples(format) }
}

/// Returns the size of the window (px), clamped to the limits of the device.
pub fn clamped(gpu: &Gpu, window: &Window) -> (u32, u32) {
    let (size, limit) = (window.inner_size(), gpu.largest_side());
    (size.width.clamp(1, limit), size.height.clamp(1, limit))
}

/// Opens an adapter that can draw to the window, and its surface. Fails if there is none.
pub async fn open_adapter(
    window: Arc<Window>,
    display: OwnedDisplayHandle,
) -> Result<(Gpu, wgpu::Surface<'static>), GpuError> {
    let mut result = Err(GpuError::no_adapter());
    for backends in Gpu::backends() {
        // GL needs the display handle to present.
        let mut descriptor =
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display.clone()));
        descriptor.backends = backends;
        let instance = wgpu::Instance::new(descriptor);
        let Ok(surface) = instance.create_surface(window.clone()) else {
            continue;
        };
        result = Gpu::open(instance, Some(&surface)).await.map(|gpu| (gpu, surface));
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Chooses the format of the surface: without sRGB conversion, because text is blended in sRGB
/// values. Pictures are drawn to an sRGB view of the same texture.
pub fn choose_format(gpu: &Gpu, surface: &wgpu::Surface, config: &mut wgpu::SurfaceConfiguration) {
    use wgpu::TextureFormat::{Bgra8Unorm, Rgba8Unorm};
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let bytes = |f: &wgpu::TextureFormat| matches!(f, Bgra8Unorm | Rgba8Unorm);
    config.format = formats.into_iter().find(bytes).unwrap_or(config.format);
    if has_two_views(gpu) {
        config.view_formats = vec![config.format.add_srgb_suffix()];
    }
}

/// Returns whether a surface can have views in two formats. On GL it cannot.
fn has_two_views(gpu: &Gpu) -> bool {
    let flags = gpu.adapter.get_downlevel_capabilities().flags;
    flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS)
}

/// Creates the texture for the picture, if the surface cannot have views in two formats.
pub fn transfer(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Transfer> {
    let size = (config.width, config.height);
    let needed = !has_two_views(gpu) && !config.format.is_srgb();
    needed.then(|| Transfer::new(gpu, size, config.format))
}
