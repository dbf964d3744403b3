//! What the window does through the system: the clipboard, films, files that are watched, and the
//! adapter, which is waited for.

use std::path::PathBuf;
use std::time::Instant;

use a3_render::{GpuError, Offscreen};
use arboard::Clipboard;
use winit::dpi::LogicalSize;
use winit::event_loop::ActiveEventLoop;
#[cfg(target_os = "linux")]
use winit::platform::wayland::WindowAttributesExtWayland;
use winit::window::{Window, WindowAttributes};

use super::adapter;
use super::filming::Films;
use super::graphics::Graphics;
use super::screen::Screen;
use super::watch::Watch;
use crate::base::failure::Failure;
use crate::base::terminal;
use crate::files::lessons;
use crate::files::output;
use crate::window::hud::Studio;
use crate::window::session::{Readings, Session};

/// How the window begins.
pub fn attributes() -> WindowAttributes {
    let attributes = Window::default_attributes()
        .with_inner_size(LogicalSize::new(1280.0, 720.0))
        .with_min_inner_size(LogicalSize::new(64.0, 48.0));
    // By this name a desktop finds the icon. On X11 the window has it by itself.
    #[cfg(target_os = "linux")]
    let attributes = WindowAttributesExtWayland::with_name(attributes, "a3", "a3");
    attributes
}

/// Events that come from elsewhere: none.
pub type Event = ();

/// What the window has of the system.
#[derive(Default)]
pub struct Platform {
    /// The clipboard, once it was needed: what was copied is lost with it.
    clipboard: Option<Clipboard>,
    pub films: Films,
    /// The files of the scene, if they are watched.
    watch: Option<Watch>,
}

impl Platform {
    /// When one of `files` changes, the scene is loaded again.
    pub fn new(files: Vec<PathBuf>) -> Self {
        Self {
            watch: (!files.is_empty()).then(|| Watch::new(files)),
            ..Self::default()
        }
    }

    /// Opens all that depends on the adapter, for the window that is there, or returns none where
    /// an event will bring it.
    pub fn open_graphics(
        &mut self,
        screen: &mut Screen,
        session: &mut Session,
    ) -> Option<Result<Graphics, GpuError>> {
        let window = screen.window.clone()?;
        // What was filmed is drawn by the device that goes.
        self.films.finish(session);
        // The old surface has to go before the window can have another.
        screen.graphics = None;
        let opened = pollster::block_on(adapter::open(window.clone(), screen.display.clone()));
        Some(opened.and_then(|(gpu, surface)| Graphics::new(gpu, surface, window, session)))
    }

    /// Saves a picture, and returns what is said of it.
    #[expect(clippy::unused_self, reason = "a page saves the next frame")]
    pub fn save_picture(&mut self, session: &mut Session, graphics: Option<&Graphics>) -> String {
        match write_picture(session, graphics) {
            Ok(name) => format!("saved {name}"),
            Err(failure) => failure.message(),
        }
    }

    /// Writes the command line of now to the terminal and to the clipboard, and returns what is
    /// said of that.
    pub fn copy(&mut self, line: &str) -> String {
        // A closed terminal is no reason to lose the line.
        let _ = terminal::say(&format!("{line}\n"));
        if self.clipboard.is_none() {
            self.clipboard = Clipboard::new().ok();
        }
        let copied = self.clipboard.as_mut().map(|board| board.set_text(line));
        match copied {
            Some(Ok(())) => format!("copied: {line}"),
            _ => format!("on the terminal: {line}"),
        }
    }

    /// Whether one of the files of the scene was saved since the last look.
    pub fn files_changed(&mut self) -> bool {
        self.watch.as_mut().is_some_and(Watch::changed)
    }

    /// Time of the next look at the files that are watched.
    pub fn next_check(&self) -> Option<Instant> {
        self.watch.as_ref().map(Watch::next)
    }
}

/// Closes the window, or returns why it stays open.
pub fn quit(event_loop: &ActiveEventLoop) -> Option<&'static str> {
    event_loop.exit();
    None
}

/// Opens the lessons. Returns the message to show.
pub fn open_lessons() -> String {
    lessons::open().unwrap_or_else(Failure::message)
}

/// Writes a picture under the first free name, and returns the name: one pane without text,
/// several with the text that tells them apart.
fn write_picture(session: &mut Session, graphics: Option<&Graphics>) -> Result<String, Failure> {
    let lost = || Failure::run("the graphics adapter is not open");
    let graphics = graphics.ok_or_else(lost)?;
    let (gpu, size) = (graphics.gpu(), graphics.size());
    let offscreen = Offscreen::new(gpu, size).map_err(Failure::run)?;
    let readings = Readings {
        no_error: session.readings.no_error,
        ..Readings::default()
    };
    let (panes, scale) = (&mut session.runs.panes, graphics.scale());
    let mut studio = Studio::new(gpu, offscreen, panes);
    let pixels = studio.draw(gpu, panes, session.view.camera, scale, &readings)?;
    let scene = &session.runs.first().scene().name;
    let path = output::write_new("".as_ref(), scene, "png", &output::png(&pixels, size)?)?;
    Ok(path.display().to_string())
}
