//! The window's surface, the picture on it and the text over it. All of it can be dropped and made again.

use std::sync::Arc;
use std::time::Duration;

use a3_render::{Gpu, GpuError, Offscreen, Renderer, Targets, Tile};
use wgpu::CurrentSurfaceTexture;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use crate::failure::Failure;
use crate::hud::panel::{self, Request};
use crate::hud::{self, Overlay, layout};
use crate::session::{Readings, Session};
use crate::{output, show};

/// What became of a frame.
pub enum Outcome {
    /// The text wants to be drawn again after this time, if ever: it fades in.
    Drawn(Option<Duration>),
    /// Not now: ask again at the next event, or soon.
    Skipped,
}

pub struct Graphics {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    /// Of the view that the picture is drawn to. The text wants another.
    format: wgpu::TextureFormat,
    renderer: Renderer,
    targets: Targets,
    /// Springs that had broken when each pane's topology was made.
    tears: Vec<usize>,
    text: Overlay,
    egui_winit: egui_winit::State,
    /// The surface no longer has the size of the window.
    stale: bool,
    gpu: Gpu,
    window: Arc<Window>,
}

impl Graphics {
    pub fn new(
        window: Arc<Window>,
        display: &OwnedDisplayHandle,
        session: &Session,
    ) -> Result<Self, GpuError> {
        let (gpu, surface) = open(&window, display)?;
        let size = clamped(&gpu, &window);
        let mut config = surface
            .get_default_config(&gpu.adapter, size.0, size.1)
            .ok_or_else(|| GpuError::Device("it cannot draw to this window".into()))?;
        let format = choose_formats(&gpu, &surface, &mut config);
        config.present_mode = wgpu::PresentMode::AutoVsync;
        surface.configure(&gpu.device, &config);
        let samples = window_samples(&gpu, format);
        let text = Overlay::new(&gpu, config.format);
        let egui_winit = egui_winit::State::new(
            text.context.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.largest_side() as usize),
        );
        Ok(Self {
            renderer: Renderer::new(&gpu, format, samples, &show::topology(session.first())),
            targets: Targets::new(&gpu, size, format, samples),
            tears: vec![],
            text,
            egui_winit,
            surface,
            config,
            format,
            stale: false,
            gpu,
            window,
        })
    }

    /// In px.
    pub fn size(&self) -> (u32, u32) {
        (self.config.width, self.config.height)
    }

    /// Where the panes are.
    pub fn tiles(&self, session: &Session) -> Vec<Tile> {
        let size = panel::leaves(session, self.size(), self.scale());
        layout::tiles(session.panes.len(), size, self.scale())
    }

    /// Pixels per point.
    pub fn scale(&self) -> f32 {
        self.window.scale_factor() as f32
    }

    /// The adapter in use.
    pub fn adapter(&self) -> String {
        self.gpu.name()
    }

    /// Lets the text see an event. Whether it kept it for itself.
    pub fn on_event(&mut self, event: &winit::event::WindowEvent) -> bool {
        self.egui_winit
            .on_window_event(&self.window, event)
            .consumed
    }

    /// The window has another size. Acted upon at the next frame, once for however many changes.
    pub fn resized(&mut self) {
        self.stale = true;
    }

    /// The scene is another one.
    pub fn set_scene(&mut self, session: &Session) {
        self.renderer
            .set_topology(&self.gpu, &show::topology(session.first()));
        self.tears.clear();
    }

    /// Leaves out what has torn.
    fn tear(&mut self, session: &Session) {
        self.tears.resize(session.panes.len(), 0);
        for (k, (pane, tears)) in session.panes.iter().zip(&mut self.tears).enumerate() {
            let now = pane.simulation.tears();
            if *tears != now {
                *tears = now;
                let topology = show::topology(&pane.simulation);
                self.renderer.set_topology_of(&self.gpu, k, &topology);
            }
        }
    }

    /// Breaks the device, to see what happens.
    pub fn lose_device(&self) {
        self.gpu.device.destroy();
    }

    fn reconfigure(&mut self) {
        self.stale = false;
        let size = clamped(&self.gpu, &self.window);
        (self.config.width, self.config.height) = size;
        self.surface.configure(&self.gpu.device, &self.config);
        if self.targets.size() != size {
            self.targets = Targets::new(
                &self.gpu,
                size,
                self.format,
                window_samples(&self.gpu, self.format),
            );
        }
    }

    /// Draws the session to the window, if that can be.
    pub fn frame(&mut self, session: &mut Session) -> Result<Outcome, GpuError> {
        let inner = self.window.inner_size();
        if inner.width == 0 || inner.height == 0 {
            return Ok(Outcome::Skipped);
        }
        if self.stale {
            self.reconfigure();
        }
        let frame = match self.surface.get_current_texture() {
            CurrentSurfaceTexture::Success(frame) => frame,
            CurrentSurfaceTexture::Suboptimal(frame) => {
                // Configuring panics while a frame is alive.
                drop(frame);
                self.reconfigure();
                return Ok(Outcome::Skipped);
            }
            CurrentSurfaceTexture::Outdated => {
                self.reconfigure();
                return Ok(Outcome::Skipped);
            }
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => {
                return Ok(Outcome::Skipped);
            }
            // A lost device says Validation too; its own word for it comes from the check.
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => {
                self.gpu.check()?;
                return Err(GpuError::Lost);
            }
        };
        self.tear(session);
        for pane in &mut session.panes {
            pane.show.compose(&pane.simulation);
        }
        let pictures: Vec<_> = session
            .panes
            .iter()
            .map(|pane| pane.show.picture(session.camera, self.scale()))
            .zip(self.tiles(session))
            .collect();
        self.renderer.prepare(&self.gpu, &pictures);
        let mut encoder = self
            .gpu
            .device
            .create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let view = frame.texture.create_view(&wgpu::TextureViewDescriptor {
            format: Some(self.format),
            ..Default::default()
        });
        self.renderer
            .draw(&mut self.targets.pass(&mut encoder, &view));
        // The text's own code panics where it meets a device that has just been lost.
        self.gpu.check()?;
        let text_view = frame
            .texture
            .create_view(&wgpu::TextureViewDescriptor::default());
        let (before, again, request) = self.write_text(&mut encoder, &text_view, session);
        self.gpu
            .queue
            .submit(before.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        self.gpu.queue.present(frame);
        self.gpu.check()?;
        if let Some(request) = request {
            panel::apply(session, request);
            return Ok(Outcome::Drawn(Some(Duration::ZERO)));
        }
        Ok(Outcome::Drawn(again))
    }

    /// The text, in a second pass over the picture: what to submit before it, when it wants to be drawn again, and what a
    /// hand in the panel wants.
    fn write_text(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        session: &Session,
    ) -> (Vec<wgpu::CommandBuffer>, Option<Duration>, Option<Request>) {
        let mut input = self.egui_winit.take_egui_input(&self.window);
        let right = panel::inset(session, self.size(), self.scale());
        input.safe_area_insets = Some(egui::SafeAreaInsets(egui::epaint::MarginF32 {
            right,
            ..Default::default()
        }));
        let mut request = None;
        let mut output = self.text.lay_out(&self.gpu, input, |ctx| {
            hud::show(ctx, &session.panes, &session.readings);
            request = panel::show(ctx, session).or(request);
        });
        self.egui_winit
            .handle_platform_output(&self.window, std::mem::take(&mut output.platform_output));
        let again = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map(|viewport| viewport.repaint_delay);
        let again = again.filter(|delay| *delay < Duration::from_mins(1));
        let size = (self.config.width, self.config.height);
        let before = self.text.paint(&self.gpu, encoder, view, size, output);
        (before, again, request)
    }

    /// Saves what is seen under the first free name: one pane without the text, several with what tells them apart.
    /// Which name that was.
    pub fn save_picture(&self, session: &mut Session) -> Result<String, Failure> {
        let size = self.size();
        let offscreen = Offscreen::new(&self.gpu, size).map_err(Failure::run)?;
        let readings = Readings {
            no_error: session.readings.no_error,
            ..Readings::default()
        };
        let panes = &mut session.panes;
        let pixels = hud::draw(
            &self.gpu,
            &offscreen,
            panes,
            session.camera,
            self.scale(),
            &readings,
        )?;
        let name = output::free_picture_name(&session.first().scene().name)?;
        output::write(name.as_ref(), &output::png(&pixels, size)?)?;
        Ok(name)
    }
}

/// A processor that draws is kept from drawing four times: at 1280 x 720 on two cores, offscreen, 11 ms a frame instead of 43.
/// Lines have smooth edges all the same, and pictures that are saved have them everywhere.
fn window_samples(gpu: &Gpu, format: wgpu::TextureFormat) -> u32 {
    if gpu.is_software() {
        1
    } else {
        gpu.samples(format)
    }
}

/// The size of the window within what the device can do (px).
fn clamped(gpu: &Gpu, window: &Window) -> (u32, u32) {
    let (size, limit) = (window.inner_size(), gpu.largest_side());
    (size.width.clamp(1, limit), size.height.clamp(1, limit))
}

/// An adapter that can draw to the window.
fn open(
    window: &Arc<Window>,
    display: &OwnedDisplayHandle,
) -> Result<(Gpu, wgpu::Surface<'static>), GpuError> {
    let mut result = Err(GpuError::no_adapter());
    for backends in Gpu::backends() {
        // GL needs the handle of the display to present.
        let mut descriptor =
            wgpu::InstanceDescriptor::new_with_display_handle_from_env(Box::new(display.clone()));
        descriptor.backends = backends;
        let instance = wgpu::Instance::new(descriptor);
        let Ok(surface) = instance.create_surface(window.clone()) else {
            continue;
        };
        result = pollster::block_on(Gpu::open(instance, Some(&surface))).map(|gpu| (gpu, surface));
        if result.is_ok() {
            break;
        }
    }
    result
}

/// Text wants a view of the surface that is not sRGB, the picture one that is: one texture with two views where the
/// backend has that, one sRGB surface for both on GL. Returns the picture's format.
fn choose_formats(
    gpu: &Gpu,
    surface: &wgpu::Surface,
    config: &mut wgpu::SurfaceConfiguration,
) -> wgpu::TextureFormat {
    use wgpu::TextureFormat::{Bgra8Unorm, Rgba8Unorm};
    let flags = gpu.adapter.get_downlevel_capabilities().flags;
    let two_views = flags.contains(wgpu::DownlevelFlags::SURFACE_VIEW_FORMATS);
    let formats = surface.get_capabilities(&gpu.adapter).formats;
    let eight_bits =
        |f: &wgpu::TextureFormat| matches!(f.remove_srgb_suffix(), Bgra8Unorm | Rgba8Unorm);
    let found = formats
        .into_iter()
        .find(|f| eight_bits(f) && f.is_srgb() != two_views);
    config.format = found.unwrap_or(config.format);
    let format = if two_views {
        config.format.add_srgb_suffix()
    } else {
        config.format
    };
    config.view_formats = if format == config.format {
        vec![]
    } else {
        vec![format]
    };
    format
}
