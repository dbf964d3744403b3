//! Frames: the session is brought up to date and drawn, and the next frame is asked for.

use web_time::{Duration, Instant};

use a3_core::Vector3;
use a3_render::GpuError;
use winit::event_loop::{ActiveEventLoop, ControlFlow};

use super::graphics::FrameOutcome;
use super::pointer::Drag;
use super::state::App;
use crate::hud::panel::{self, Request};

/// Time after which a frame that could not be drawn is tried again.
const RETRY: Duration = Duration::from_millis(50);

impl App {
    /// Brings the simulation up to date and draws it.
    pub fn frame(&mut self, event_loop: &ActiveEventLoop) {
        self.look_at_files();
        let now = Instant::now();
        let real = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        if let Drag::Pull(grip) = self.mouse.drag {
            let tile = self.tile(self.mouse.pane);
            let place = tile.place(self.mouse.pointer);
            let [x, y, z] = grip
                .target(&self.session.view.camera, place, tile.aspect())
                .map(f64::from);
            self.session.runs.pull(Vector3::new(x, y, z));
        }
        self.session.tick(self.pace(real));
        self.session.view.go_along(&self.session.runs.panes);
        self.session.read_state();
        self.look_under_pointer();
        let message_ends = self.session.readings.message_ends();
        let Some(graphics) = &mut self.graphics else {
            return;
        };
        let begun = Instant::now();
        match graphics.frame(&mut self.session, self.cursor) {
            Ok(FrameOutcome::Drawn(again, request)) => {
                self.session.drawn(begun.elapsed());
                let again = if self.film() || request.is_some() {
                    Some(Duration::ZERO)
                } else {
                    again
                };
                match request {
                    Some(Request::Act(action)) => self.act(event_loop, action),
                    Some(request) if panel::apply(&mut self.session, request) => {
                        self.scene_changed();
                    }
                    _ => {}
                }
                if let Some(status) = &mut self.status {
                    status.frames += 1;
                }
                let next = if self.session.animated() {
                    Some(now + self.frame_time())
                } else {
                    let again = again.map(|delay| now + delay.max(self.frame_time()));
                    [again, message_ends, self.next_look()]
                        .into_iter()
                        .flatten()
                        .min()
                };
                if let Some(next) = next {
                    self.wait_until(event_loop, next);
                }
            }
            Ok(FrameOutcome::Skipped) => self.wait_until(event_loop, now + RETRY),
            Err(GpuError::Lost) => self.open_graphics(event_loop),
            Err(why) => self.fail(event_loop, why),
        }
        self.say_status();
    }

    /// Time from one frame to the next: a little less than that of the monitor, because presenting
    /// a frame waits for the rest, where it waits at all.
    fn frame_time(&self) -> Duration {
        let monitor = self
            .window
            .as_ref()
            .and_then(|window| window.current_monitor());
        let rate = monitor
            .and_then(|monitor| monitor.refresh_rate_millihertz())
            .unwrap_or(60_000);
        let own = Duration::from_secs_f64(0.9e3 / f64::from(rate.clamp(30_000, 500_000)));
        match self.session.panel.frame_limit {
            0 => own,
            limit => own.max(Duration::from_secs(1) / limit),
        }
    }

    /// Asks for a frame at that time, unless the window is hidden.
    fn wait_until(&self, event_loop: &ActiveEventLoop, when: Instant) {
        if !self.visible {
            event_loop.set_control_flow(ControlFlow::Wait);
        } else if when <= Instant::now() {
            self.redraw();
        } else {
            event_loop.set_control_flow(ControlFlow::WaitUntil(when));
        }
    }

    /// Writes a line for tests, if they are asked for.
    pub fn say_status(&mut self) {
        if let (Some(status), Some(graphics)) = (&mut self.status, &self.graphics) {
            status.say(
                &self.session,
                graphics,
                self.cursor,
                self.visible,
                self.devices,
            );
        }
    }
}
