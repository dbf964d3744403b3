//! Saving the settings when the window closes.

use super::screen::Screen;
use crate::base::terminal;
use crate::window::session::Session;
use crate::window::settings::Settings;

/// Writes the present settings, if they have changed. Warns on the terminal if that fails.
pub fn remember(before: &Settings, session: &Session, screen: &Screen) {
    let mut now = Settings {
        interface_scale: screen.zoom,
        full_screen: screen.is_full_screen(),
        dark: session.panel.dark.unwrap_or(before.dark),
        panel: session.panel.open,
        pulled: session.pulled,
        frame_limit: session.panel.frame_limit,
        film: session.panel.film,
        film_seconds: session.panel.film_seconds,
        recent: before.recent.clone(),
    };
    now.remember(session.scenes.files());
    if now == *before {
        return;
    }
    if let Err(why) = now.write() {
        terminal::warn(&why.to_string());
    }
}
