//! The window on the screen, and the graphics that draw to it.

use std::sync::Arc;

use a3_render::{GpuError, Tile};
use web_time::{Duration, Instant};
use winit::event_loop::{ActiveEventLoop, ControlFlow, OwnedDisplayHandle};
use winit::window::{Fullscreen, Window};

use super::graphics::Graphics;
use crate::session::Session;
use crate::settings::SCALES;

/// The window and its graphics, once they are open.
pub struct Screen {
    pub display: OwnedDisplayHandle,
    pub window: Option<Arc<Window>>,
    pub graphics: Option<Graphics>,
    /// Scale factor of text and panel, on top of the screen's own.
    pub zoom: f32,
    /// Whether the window is visible.
    pub visible: bool,
    /// Number of devices opened so far.
    pub devices: u32,
}

impl Screen {
    /// Creates a screen whose window is not open yet.
    pub fn new(display: OwnedDisplayHandle, zoom: f32) -> Self {
        Self { display, window: None, graphics: None, zoom, visible: true, devices: 0 }
    }

    /// Requests another frame.
    pub fn redraw(&self) {
        if let Some(window) = &self.window {
            window.request_redraw();
        }
    }

    /// Requests a frame at a time, unless the window is hidden.
    pub fn wait_until(&self, event_loop: &ActiveEventLoop, when: Instant) {
        if !self.visible {
            event_loop.set_control_flow(ControlFlow::Wait);
        } else if when <= Instant::now() {
            self.redraw();
        } else {
            event_loop.set_control_flow(ControlFlow::WaitUntil(when));
        }
    }

    /// Returns the time between two frames: slightly less than that of the monitor, because
    /// presenting waits for the rest, if it waits at all. `limit` is the largest frame rate (1/s),
    /// 0 for none.
    pub fn frame_time(&self, limit: u32) -> Duration {
        let monitor = self.window.as_ref().and_then(|it| it.current_monitor());
        let rate = monitor.and_then(|it| it.refresh_rate_millihertz());
        let rate = rate.unwrap_or(60_000).clamp(30_000, 500_000);
        let own = Duration::from_secs_f64(0.9e3 / f64::from(rate));
        let least = Duration::from_secs(1).checked_div(limit);
        own.max(least.unwrap_or_default())
    }

    /// Returns the part of the window that pane k fills.
    pub fn tile(&self, session: &Session, k: usize) -> Tile {
        let graphics = self.graphics.as_ref();
        graphics.map_or(Tile::whole((1, 1)), |it| it.tiles(session)[k])
    }

    /// Returns the pane at a position (px), if there is one.
    pub fn pane_at(&self, session: &Session, place: [f32; 2]) -> Option<usize> {
        (0..session.runs.panes.len()).find(|k| self.tile(session, *k).contains(place))
    }

    /// Returns the number of pixels per point.
    pub fn scale(&self) -> f32 {
        self.graphics.as_ref().map_or(1.0, Graphics::scale)
    }

    /// Enlarges text and panel by a number of steps, shrinks them if it is negative, or resets
    /// their size if it is 0. Returns a message.
    pub fn scale_interface(&mut self, by: isize) -> String {
        let now = SCALES.iter().position(|scale| *scale >= self.zoom);
        let next = now.unwrap_or(0).saturating_add_signed(by);
        let scaled = SCALES[next.min(SCALES.len() - 1)];
        self.zoom = if by == 0 { 1.0 } else { scaled };
        if let Some(graphics) = &mut self.graphics {
            graphics.set_zoom(self.zoom);
        }
        self.redraw();
        let percent = (100.0 * self.zoom).round();
        format!("Text and panel are at {percent} % of their usual size.")
    }

    /// Sets the graphics of the window. Fails if they could not be opened.
    pub fn set_graphics(&mut self, graphics: Result<Graphics, GpuError>) -> Result<(), GpuError> {
        self.redraw();
        let mut graphics = graphics?;
        graphics.set_zoom(self.zoom);
        self.graphics = Some(graphics);
        self.devices += 1;
        Ok(())
    }

    /// Returns whether the window fills the screen.
    pub fn is_full_screen(&self) -> bool {
        let window = self.window.as_ref();
        window.is_some_and(|window| window.fullscreen().is_some())
    }

    /// Switches between full screen and a window.
    pub fn toggle_full_screen(&self) {
        if let Some(window) = &self.window {
            let whole = window.fullscreen().is_none();
            window.set_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
        }
    }

    /// Uploads another scene, and puts its name into the title of the window.
    pub fn set_scene(&mut self, session: &Session) {
        if let Some(graphics) = &mut self.graphics {
            graphics.set_scene(session);
        }
        self.set_title(session);
    }

    /// Puts the scene's name into the title of the window.
    pub fn set_title(&self, session: &Session) {
        if let Some(window) = &self.window {
            window.set_title(&format!("a3: {}", session.runs.first().scene().name));
        }
    }
}
