//! Frames: advancing and drawing the session, and scheduling the next frame.

use web_time::{Duration, Instant};

use a3_render::GpuError;
use winit::event_loop::ActiveEventLoop;

use super::graphics::FrameOutcome;
use super::state::App;
use crate::session::{Action, RunAction};

/// Delay after which a skipped frame is drawn again.
const RETRY_DELAY: Duration = Duration::from_millis(50);
/// Delay after which a frame shows new measurements, if nothing else moves.
const MEASURING_DELAY: Duration = Duration::from_millis(100);

impl App {
    /// Advances the session by the time since the last frame, draws it, and schedules the next
    /// frame.
    pub fn frame(&mut self, event_loop: &ActiveEventLoop) {
        if self.platform.files_changed() && self.session.reload() {
            self.last_tick = Instant::now();
            self.scene_changed();
        }
        let now = Instant::now();
        let real = now.duration_since(self.last_tick).as_secs_f64();
        self.last_tick = now;
        let session = &mut self.session;
        if let Some(graphics) = &self.screen.graphics {
            session.view.camera.set_focus(graphics.focus(session));
        }
        let long_press = self.mouse.long_press_at();
        let mut long_press = long_press.filter(|_| self.fingers.is_pressing());
        if long_press.take_if(|at| *at <= now).is_some() {
            self.fingers.end_press();
            self.mouse.long_press(session, &self.screen);
        }
        if let Some(target) = self.mouse.target(session, &self.screen) {
            session.runs.pull(target);
        }
        session.tick(self.platform.films.time_to_advance(session, real));
        session.view.track_followed(&session.runs.panes);
        session.read_state();
        session.measuring.update();
        self.mouse
            .update_hover(self.modifiers.shift_key(), session, &self.screen);
        let message_ends = session.readings.message_ends();
        let Some(graphics) = &mut self.screen.graphics else {
            return;
        };
        let begun = Instant::now();
        match graphics.frame(session, self.mouse.cursor) {
            Ok(FrameOutcome::Drawn(again, action)) => {
                session.count_frame(begun.elapsed());
                let filmed = self.platform.films.draw(session, Some(graphics));
                let again = if filmed || action.is_some() {
                    Some(Duration::ZERO)
                } else {
                    again
                };
                if let Some(action) = action {
                    let acts = matches!(action, Action::Run(_) | Action::Window(_));
                    if acts && action != RunAction::Help.into() {
                        session.readings.help = false;
                    }
                    self.act(event_loop, action);
                }
                if let Some(status) = &mut self.status {
                    status.frames += 1;
                }
                let frame_time = self.screen.frame_time(self.session.panel.frame_limit);
                let session = &self.session;
                let measuring = session.measuring.progress().is_some();
                let measured = measuring.then_some(now + MEASURING_DELAY);
                let next = if self.session.animated() {
                    Some(now + frame_time)
                } else {
                    let again = again.map(|delay| now + delay.max(frame_time));
                    let checked = self.platform.next_check();
                    [again, message_ends, measured, long_press, checked]
                        .into_iter()
                        .flatten()
                        .min()
                };
                if let Some(next) = next {
                    self.screen.wait_until(event_loop, next);
                }
            }
            Ok(FrameOutcome::Skipped) => self.screen.wait_until(event_loop, now + RETRY_DELAY),
            Err(GpuError::Lost) => self.open_graphics(event_loop),
            Err(why) => self.fail(event_loop, why),
        }
        self.say_status();
    }

    /// Writes a status line, if they are enabled.
    pub fn say_status(&mut self) {
        if let Some(status) = &mut self.status {
            status.say(&self.session, &self.screen, self.mouse.cursor);
        }
    }
}
