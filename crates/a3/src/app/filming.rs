//! Films of the session, made while the window goes on.

use std::thread;
use std::time::Duration;

use super::state::App;
use crate::failure::Failure;
use crate::hud::panel;
use crate::output;
use crate::recorder::{Format, Recorder};

impl App {
    /// Films from now on, or completes that film.
    pub fn record(&mut self) {
        if self
            .outside
            .recorder
            .as_ref()
            .is_some_and(Recorder::is_live)
        {
            return self.end_film();
        }
        self.begin_film(|app, format| {
            let graphics = app.graphics.as_ref()?;
            Some(Recorder::from_now(graphics.gpu(), &app.session, format))
        });
    }

    /// Films the last seconds that are kept.
    pub fn film_last(&mut self) {
        self.begin_film(|app, format| {
            let (graphics, seconds) = (app.graphics.as_ref()?, app.session.panel.film_of);
            let gpu = graphics.gpu();
            Some(Recorder::of_kept(gpu, &app.session, format, seconds))
        });
    }

    /// Begins a film, if none is being made.
    fn begin_film(
        &mut self,
        begin: impl FnOnce(&Self, Format) -> Option<Result<Recorder, Failure>>,
    ) {
        let Some(graphics) = &self.graphics else {
            return;
        };
        if self.outside.recorder.is_some() {
            self.session.readings.say("Another film is being made.");
            return;
        }
        let scale = graphics.scale();
        let format = Format {
            ending: self.session.panel.film,
            size: panel::leaves(&self.session, graphics.size(), scale),
            scale,
        };
        match begin(self, format) {
            Some(Ok(recorder)) => self.outside.recorder = Some(recorder),
            Some(Err(why)) => self.session.readings.warn(why.message()),
            None => {}
        }
        self.tell_film();
    }

    /// Draws the next frame of the film that is being made, if it is due, and returns whether the
    /// film needs another frame of the window for the next.
    pub fn film(&mut self) -> bool {
        let (Some(recorder), Some(graphics)) = (&mut self.outside.recorder, &self.graphics) else {
            return false;
        };
        match recorder.go_on(graphics.gpu(), &mut self.session) {
            Ok(true) => {}
            Ok(false) => self.end_film(),
            Err(why) => {
                self.outside.recorder = None;
                self.session.readings.warn(why.message());
            }
        }
        self.tell_film();
        self.outside
            .recorder
            .as_ref()
            .is_some_and(|film| !film.is_live())
    }

    /// Completes a film of what happens from now on: something else is shown.
    pub fn end_live_film(&mut self) {
        if self
            .outside
            .recorder
            .as_ref()
            .is_some_and(Recorder::is_live)
        {
            self.end_film();
        }
    }

    /// Real time that passes for a session of which so much did (s), while it is filmed.
    pub fn pace(&self, real: f64) -> f64 {
        let recorder = self.outside.recorder.as_ref();
        recorder.map_or(real, |recorder| recorder.pace(&self.session, real))
    }

    /// Completes the film that is being made, and says so.
    pub fn end_film(&mut self) {
        let Some(recorder) = self.outside.recorder.take() else {
            return;
        };
        match recorder.finish() {
            Ok(said) => self.session.readings.say(said),
            Err(why) => self.session.readings.warn(why.message()),
        }
        self.tell_film();
    }

    /// Completes the film that is being made before the window closes: with all moments that it is
    /// to show.
    pub fn complete_film(&mut self) {
        while self
            .outside
            .recorder
            .as_ref()
            .is_some_and(|film| !film.is_live())
            && self.film()
        {
            thread::sleep(Duration::from_millis(1));
        }
        self.end_film();
        if let Some(said) = self.session.readings.message.take() {
            output::warn(&said);
        }
    }

    fn tell_film(&mut self) {
        self.session.readings.film = self.outside.recorder.as_ref().map(Recorder::progress);
    }
}
