//! Opening the window.

use std::path::PathBuf;

use winit::event_loop::EventLoop;

use super::state::App;
use crate::caught::caught;
use crate::failure::Failure;
use crate::session::Session;
use crate::settings::Settings;

/// How the window ends.
pub enum End {
    /// The user closed the window.
    Closed,
    /// No window could be opened, for this reason. The session is as it was.
    NoWindow(String, Box<Session>),
}

/// Opens the window. With `status`, lines on stderr tell what is on the screen. When one of `files`
/// changes, the scene is loaded again. The `settings` are written again when the window closes.
pub fn open(
    mut session: Session,
    status: bool,
    files: Vec<PathBuf>,
    settings: Option<Settings>,
) -> Result<End, Failure> {
    let event_loop = match event_loop() {
        Ok(event_loop) => event_loop,
        Err(why) => return Ok(End::NoWindow(why, Box::new(session))),
    };
    session.readings.in_window = true;
    if let Some(settings) = &settings {
        session.panel.open = settings.panel;
        if settings.dark {
            session.set_dark(true);
        }
        session.panel.film = settings.film;
        session.panel.frame_limit = settings.frame_limit;
        session.panel.film_of = settings.film_seconds;
        session.recent.clone_from(&settings.recent);
    }
    let display = event_loop.owned_display_handle();
    let mut app = App::new(session, display, status, files, settings);
    event_loop.run_app(&mut app).map_err(Failure::run)?;
    match app.failure {
        None => Ok(End::Closed),
        Some(Failure::Run(why)) if app.devices == 0 => {
            app.session.readings.in_window = false;
            Ok(End::NoWindow(why, Box::new(app.session)))
        }
        Some(failure) => Err(failure),
    }
}

/// The event loop. Without a display winit returns an error; without a library that it needs it
/// panics, which is caught here.
fn event_loop() -> Result<EventLoop<()>, String> {
    match caught(EventLoop::new) {
        Some(Ok(event_loop)) => Ok(event_loop),
        Some(Err(_)) => {
            Err("no display (DISPLAY and WAYLAND_DISPLAY are unset or lead nowhere)".into())
        }
        None => Err(
            "no window (a library is missing: `apt install libxkbcommon-x11-0 libxcursor1 libxi6`)"
                .into(),
        ),
    }
}
