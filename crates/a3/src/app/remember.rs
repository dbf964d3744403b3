//! Settings of the window: the size of its text, and what is remembered when it closes.

use super::state::App;
use crate::output;
use crate::settings::{SCALES, Settings};

impl App {
    /// Makes text and panel larger by a step, smaller if it is negative, or as at first if it is 0.
    pub fn scale_interface(&mut self, by: isize) {
        let now = SCALES.iter().position(|scale| *scale >= self.zoom);
        let next = now.unwrap_or(0).saturating_add_signed(by);
        self.zoom = if by == 0 {
            1.0
        } else {
            SCALES[next.min(SCALES.len() - 1)]
        };
        if let Some(graphics) = &mut self.graphics {
            graphics.set_zoom(self.zoom);
        }
        let percent = (100.0 * self.zoom).round();
        self.session
            .readings
            .say(format!("Text and panel have {percent} % of their size."));
        self.redraw();
    }

    /// Writes the settings as they are now, if they have changed.
    pub fn remember(&self) {
        let Some(before) = &self.settings else {
            return;
        };
        let session = &self.session;
        let window = self.window.as_ref();
        let mut now = Settings {
            interface_scale: self.zoom,
            full_screen: window.is_some_and(|window| window.fullscreen().is_some()),
            dark: session.runs.panes[0].show.dark,
            panel: session.panel.open,
            frame_limit: session.panel.frame_limit,
            film: session.panel.film,
            film_seconds: session.panel.film_of,
            recent: before.recent.clone(),
        };
        now.remember(session.library.files());
        if now == *before {
            return;
        }
        if let Err(why) = now.write() {
            output::warn(&why.message());
        }
    }
}
