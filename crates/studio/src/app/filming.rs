//! Films of the session, made while its window stays in use.

use std::thread;
use std::time::Duration;

use a3_files::failure::Failure;
use a3_files::terminal;
use a3_render::Gpu;

use super::graphics::Graphics;
use crate::hud::layout;
use crate::recorder::{Format, Recorder};
use crate::session::{Readings, Session};

/// The recorder of the film, if one is being made.
#[derive(Default)]
pub struct Films {
    recorder: Option<Recorder>,
}

impl Films {
    /// Starts a live film, or completes it.
    pub fn record(&mut self, session: &mut Session, graphics: Option<&Graphics>) {
        if self.recorder.as_ref().is_some_and(Recorder::is_live) {
            return self.finish(&mut session.readings);
        }
        self.begin(session, graphics, Recorder::from_now);
    }

    /// Starts a film of the last seconds.
    pub fn record_last(&mut self, session: &mut Session, graphics: Option<&Graphics>) {
        self.begin(session, graphics, Recorder::of_past);
    }

    /// Starts a film, unless another one is being made.
    fn begin(
        &mut self,
        session: &mut Session,
        graphics: Option<&Graphics>,
        begin: impl FnOnce(&Gpu, &Session, Format) -> Result<Recorder, Failure>,
    ) {
        let Some(graphics) = graphics else {
            return;
        };
        if self.recorder.is_some() {
            session.readings.say("Another film is being made.");
            return;
        }
        let scale = graphics.scale();
        let format = Format {
            ending: session.panel.film,
            size: layout::picture_size(session, graphics.size(), scale),
            scale,
        };
        match begin(graphics.gpu(), session, format) {
            Ok(recorder) => self.recorder = Some(recorder),
            Err(why) => session.readings.warn(why.to_string()),
        }
        self.show_progress(&mut session.readings);
    }

    /// Draws the next frame of the film, if one is due. Returns whether the window must draw
    /// another frame, because the film of the last seconds continues.
    pub fn draw(&mut self, session: &mut Session, graphics: Option<&Graphics>) -> bool {
        let (Some(recorder), Some(graphics)) = (&mut self.recorder, graphics) else {
            return false;
        };
        match recorder.draw_next(graphics.gpu(), session) {
            Ok(true) => {}
            Ok(false) => self.finish(&mut session.readings),
            Err(why) => {
                self.recorder = None;
                session.readings.warn(why.to_string());
            }
        }
        self.show_progress(&mut session.readings);
        self.recorder.as_ref().is_some_and(|film| !film.is_live())
    }

    /// Completes a live film, because the scene has changed.
    pub fn finish_live(&mut self, readings: &mut Readings) {
        if self.recorder.as_ref().is_some_and(Recorder::is_live) {
            self.finish(readings);
        }
    }

    /// Returns the real time (s) by which the session may advance in a frame of `real` (s), limited
    /// by a live film.
    pub fn time_to_advance(&self, session: &Session, real: f64) -> f64 {
        let recorder = self.recorder.as_ref();
        recorder.map_or(real, |recorder| recorder.time_to_advance(session, real))
    }

    /// Completes the film, and shows a message.
    pub fn finish(&mut self, readings: &mut Readings) {
        let Some(recorder) = self.recorder.take() else {
            return;
        };
        match recorder.finish() {
            Ok(said) => readings.say(said),
            Err(why) => readings.warn(why.to_string()),
        }
        self.show_progress(readings);
    }

    /// Completes the film before the window closes. A film of the last seconds gets all of its
    /// frames.
    pub fn complete(&mut self, session: &mut Session, graphics: Option<&Graphics>) {
        while self.recorder.as_ref().is_some_and(|film| !film.is_live())
            && self.draw(session, graphics)
        {
            thread::sleep(Duration::from_millis(1));
        }
        self.finish(&mut session.readings);
        if let Some(said) = session.readings.message.take() {
            terminal::warn(&said);
        }
    }

    /// Shows the progress of the film.
    fn show_progress(&self, readings: &mut Readings) {
        readings.film = self.recorder.as_ref().map(Recorder::progress);
    }
}
