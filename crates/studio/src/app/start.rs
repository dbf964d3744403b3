//! Opening the window, in the system or in a page.

#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;

use a3_files::failure::Failure;
use winit::event_loop::EventLoop;

use super::platform::{Event, Platform};
use super::state::App;
use crate::session::{Opening, RunAction, Session, looks};
use crate::settings::Settings;

/// The outcome of opening the window.
#[cfg(not(target_arch = "wasm32"))]
pub enum End {
    /// The user closed the window.
    Closed,
    /// No window could be opened, for this reason. The session has not advanced.
    NoWindow(String, Box<Session>),
}

/// Opens the window, and returns when it closes. Reloads the scene when one of `files` changes.
/// Writes the `settings` back at the end. Fails with the failure that closed the window.
#[cfg(not(target_arch = "wasm32"))]
pub fn open(
    mut session: Session,
    opening: &Opening,
    files: Vec<PathBuf>,
    settings: Option<Settings>,
) -> Result<End, Failure> {
    let event_loop = match event_loop() {
        Ok(event_loop) => event_loop,
        Err(why) => return Ok(End::NoWindow(why, Box::new(session))),
    };
    prepare(&mut session, opening, settings.as_ref());
    let display = event_loop.owned_display_handle();
    let platform = Platform::new(files);
    let mut app = App::new(session, display, opening.status, platform, settings);
    event_loop.run_app(&mut app).map_err(Failure::run)?;
    match app.failure {
        None => Ok(End::Closed),
        Some(Failure::Run(why)) if app.screen.devices == 0 => {
            app.session.readings.in_window = false;
            Ok(End::NoWindow(why, Box::new(app.session)))
        }
        Some(failure) => Err(failure),
    }
}

/// Opens the window in a page, and returns at once. Fails if there is no event loop.
#[cfg(target_arch = "wasm32")]
pub fn spawn(
    mut session: Session,
    opening: &Opening,
    settings: Option<Settings>,
) -> Result<(), Failure> {
    use winit::platform::web::EventLoopExtWebSys;
    let event_loop = EventLoop::<Event>::with_user_event().build();
    let event_loop = event_loop.map_err(Failure::run)?;
    super::platform::connect(event_loop.create_proxy());
    prepare(&mut session, opening, settings.as_ref());
    let display = event_loop.owned_display_handle();
    event_loop.spawn_app(App::new(session, display, opening.status, Platform::default(), settings));
    Ok(())
}

/// Applies the saved settings to a session, as far as it was not opened otherwise, and marks
/// it as being in a window.
fn prepare(session: &mut Session, opening: &Opening, settings: Option<&Settings>) {
    session.readings.in_window = true;
    if let Some(settings) = settings {
        if settings.panel && session.panel.hidden.refusal(RunAction::Panel).is_none() {
            session.panel.beside.get_or_insert(RunAction::Panel);
        }
        session.pulled = settings.pulled;
        if settings.dark && !opening.light {
            looks::each(&mut session.runs.panes, |show| show.dark = true);
        }
        session.panel.film = settings.film;
        session.panel.frame_limit = settings.frame_limit;
        session.panel.film_seconds = settings.film_seconds;
        session.scenes.recent.clone_from(&settings.recent);
    }
}

/// Creates the event loop. Fails if a display or a library is missing.
#[cfg(not(target_arch = "wasm32"))]
fn event_loop() -> Result<EventLoop<Event>, String> {
    #[cfg(all(unix, not(target_vendor = "apple")))]
    if lacks_keyboard() {
        return Err(
            "no window (a library is missing: `apt install libxkbcommon-x11-0 libxcursor1 libxi6`)"
                .into(),
        );
    }
    let built = EventLoop::with_user_event().build();
    built.map_err(|_| "no display (DISPLAY and WAYLAND_DISPLAY are unset or lead nowhere)".into())
}

/// Returns whether a library is missing with which winit reads the keyboard. Winit panics without
/// it, instead of returning an error.
#[cfg(all(unix, not(target_vendor = "apple")))]
fn lacks_keyboard() -> bool {
    use xkbcommon_dl::{x11::xkbcommon_x11_option, xkbcommon_option};
    let is_set = |name| std::env::var_os(name).is_some_and(|value| !value.is_empty());
    let wayland = is_set("WAYLAND_DISPLAY") || is_set("WAYLAND_SOCKET");
    let x11 = !wayland && is_set("DISPLAY");
    (wayland || x11) && xkbcommon_option().is_none() || x11 && xkbcommon_x11_option().is_none()
}
