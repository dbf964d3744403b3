//! The window's surface, the picture on it and the text over it. All of it can be dropped and made again.

use std::sync::Arc;
use std::time::Duration;

use a3_render::{Gpu, GpuError, OFFSCREEN_FORMAT, Offscreen, Renderer, Targets};
use wgpu::CurrentSurfaceTexture;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::hud;
use super::session::Session;
use crate::{Failure, output, show};

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
    egui: egui::Context,
    egui_winit: egui_winit::State,
    egui_wgpu: egui_wgpu::Renderer,
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
        let egui = egui::Context::default();
        let egui_winit = egui_winit::State::new(
            egui.clone(),
            egui::ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            None,
            Some(gpu.largest_side() as usize),
        );
        Ok(Self {
            renderer: Renderer::new(&gpu, format, samples, &show::topology(&session.simulation)),
            targets: Targets::new(&gpu, size, format, samples),
            egui_wgpu: egui_wgpu::Renderer::new(
                &gpu.device,
                config.format,
                egui_wgpu::RendererOptions::default(),
            ),
            egui,
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

    /// Width over height.
    pub fn aspect(&self) -> f32 {
        self.config.width as f32 / self.config.height as f32
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
            .set_topology(&self.gpu, &show::topology(&session.simulation));
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
        session.show.compose(&session.simulation);
        let picture = session
            .show
            .picture(session.camera, self.window.scale_factor() as f32);
        self.renderer.prepare(&self.gpu, &picture, self.size());
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
        let (before, again) = self.write_text(&mut encoder, &text_view, session);
        self.gpu
            .queue
            .submit(before.into_iter().chain([encoder.finish()]));
        self.window.pre_present_notify();
        self.gpu.queue.present(frame);
        self.gpu.check()?;
        Ok(Outcome::Drawn(again))
    }

    /// The text, in a second pass over the picture: what to submit before it, and when it wants to be drawn again.
    fn write_text(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        view: &wgpu::TextureView,
        session: &Session,
    ) -> (Vec<wgpu::CommandBuffer>, Option<Duration>) {
        let input = self.egui_winit.take_egui_input(&self.window);
        let mut output = self.egui.run_ui(input, |ui| {
            hud::show(ui.ctx(), &session.simulation, &session.readings);
        });
        self.egui_winit
            .handle_platform_output(&self.window, output.platform_output);
        let again = output
            .viewport_output
            .get(&egui::ViewportId::ROOT)
            .map(|viewport| viewport.repaint_delay);
        let again = again.filter(|delay| *delay < Duration::from_mins(1));
        let (device, queue) = (&self.gpu.device, &self.gpu.queue);
        // Dropping what is not drained panics.
        for (id, deltas) in output.textures_delta.set.drain() {
            for delta in deltas {
                self.egui_wgpu.update_texture(device, queue, id, &delta);
            }
        }
        let shapes = self.egui.tessellate(output.shapes, output.pixels_per_point);
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [self.config.width, self.config.height],
            pixels_per_point: output.pixels_per_point,
        };
        let before = self
            .egui_wgpu
            .update_buffers(device, queue, encoder, &shapes, &screen);
        let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("text"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Load,
                    store: wgpu::StoreOp::Store,
                },
            })],
            ..Default::default()
        });
        self.egui_wgpu
            .render(&mut pass.forget_lifetime(), &shapes, &screen);
        for id in output.textures_delta.free.drain() {
            self.egui_wgpu.free_texture(&id);
        }
        (before, again)
    }

    /// Saves what is seen, without the text, under the first free name. Which one that was.
    pub fn save_picture(&self, session: &mut Session) -> Result<String, Failure> {
        let size = self.size();
        let offscreen = Offscreen::new(&self.gpu, size).map_err(Failure::run)?;
        let samples = self.gpu.samples(OFFSCREEN_FORMAT);
        let topology = show::topology(&session.simulation);
        let mut renderer = Renderer::new(&self.gpu, OFFSCREEN_FORMAT, samples, &topology);
        session.show.compose(&session.simulation);
        let picture = session
            .show
            .picture(session.camera, self.window.scale_factor() as f32);
        let pixels = offscreen
            .render(&self.gpu, &mut renderer, &picture)
            .map_err(Failure::run)?;
        let name = output::free_picture_name(session.simulation.scene().name)?;
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
