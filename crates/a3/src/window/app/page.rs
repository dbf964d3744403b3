//! What the window does through a browser: the adapter that cannot be waited for, files that are
//! dropped, downloads, and links in place of command lines.

use std::cell::RefCell;
use std::path::PathBuf;

use a3_render::{Gpu, GpuError};
use web_time::Instant;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::platform::web::WindowAttributesExtWebSys;
use winit::window::{Window, WindowAttributes};

use super::adapter;
use super::graphics::Graphics;
use super::screen::Screen;
use crate::base::browser;
use crate::base::terminal;
use crate::window::session::{Action, Session};

thread_local! {
    /// The way to the event loop.
    static PROXY: RefCell<Option<EventLoopProxy<Event>>> = const { RefCell::new(None) };
}

/// The window is a canvas, as large as the page has it.
pub fn attributes() -> WindowAttributes {
    Window::default_attributes().with_canvas(browser::canvas())
}

/// Events that come from the page.
pub enum Event {
    /// An adapter was opened, or not.
    Opened(Result<(Gpu, wgpu::Surface<'static>), GpuError>),
    /// A file of the page is to be shown.
    Open(PathBuf),
    /// A button of the page was pressed.
    Act(Action),
}

/// Sends an event to the window, once it is there.
pub fn send(event: Event) {
    PROXY.with_borrow(|proxy| {
        if let Some(proxy) = proxy {
            let _ = proxy.send_event(event);
        }
    });
}

/// Makes [`send`] reach the window.
pub fn connect(proxy: EventLoopProxy<Event>) {
    PROXY.set(Some(proxy));
}

/// What the window has of the browser.
#[derive(Default)]
pub struct Platform {
    /// Whether an adapter is being opened.
    opening: bool,
    pub films: Films,
}

/// The frames that are saved: pictures. Films are for the program.
#[derive(Default)]
pub struct Films {
    /// Whether the next frame is to be saved as a picture.
    picture: bool,
}

impl Platform {
    /// Opens all that depends on the adapter, for the window that is there: an event says that it
    /// is open.
    pub fn open_graphics(
        &mut self,
        screen: &mut Screen,
        _: &mut Session,
    ) -> Option<Result<Graphics, GpuError>> {
        screen.graphics = None;
        if let (Some(window), false) = (screen.window.clone(), self.opening) {
            self.opening = true;
            let display = screen.display.clone();
            wasm_bindgen_futures::spawn_local(async move {
                send(Event::Opened(adapter::open(window, display).await));
            });
        }
        None
    }

    /// Takes the adapter that was opened, for the window that is there.
    pub fn finish_opening(
        &mut self,
        opened: Result<(Gpu, wgpu::Surface<'static>), GpuError>,
        screen: &Screen,
        session: &Session,
    ) -> Option<Result<Graphics, GpuError>> {
        self.opening = false;
        let window = screen.window.clone()?;
        let graphics =
            opened.and_then(|(gpu, surface)| Graphics::new(gpu, surface, window, session));
        if let Err(why) = &graphics {
            browser::show(&why.to_string());
        }
        Some(graphics)
    }

    /// Saves the next frame as a picture, and returns what is said of it.
    pub fn save_picture(&mut self, _: &mut Session, _: Option<&Graphics>) -> String {
        self.films.picture = true;
        "The picture is in your downloads.".into()
    }

    /// Puts the command line of now into the address, copies the address, and returns what is said
    /// of that.
    pub fn copy(&mut self, line: &str) -> String {
        let words = line.strip_prefix("a3 ").unwrap_or(line);
        browser::set_words(words);
        let link = browser::address(words);
        browser::copy(&link);
        let _ = terminal::say(line);
        format!("copied: {link}")
    }

    /// No files are watched.
    pub fn files_changed(&mut self) -> bool {
        false
    }

    /// No files are watched.
    pub fn next_check(&self) -> Option<Instant> {
        None
    }
}

impl Films {
    /// Films are for the program.
    pub fn record(&mut self, session: &mut Session, _: Option<&Graphics>) {
        session
            .readings
            .say("The program makes films: y copies the command line for it.");
    }

    /// Films are for the program.
    pub fn record_last(&mut self, session: &mut Session, graphics: Option<&Graphics>) {
        self.record(session, graphics);
    }

    /// Saves the picture that was just drawn, if that was asked for. Returns whether another frame
    /// is needed for it.
    pub fn draw(&mut self, session: &mut Session, _: Option<&Graphics>) -> bool {
        if std::mem::take(&mut self.picture) {
            let scene = &session.runs.first().scene().name;
            browser::download_picture(format!("a3-{scene}.png"));
        }
        false
    }

    /// There are no films.
    pub fn finish_live(&mut self, _: &mut Session) {}

    /// There are no films.
    pub fn complete(&mut self, _: &mut Session, _: Option<&Graphics>) {}

    /// Real time as it passes.
    pub fn time_to_advance(&self, _: &Session, real: f64) -> f64 {
        real
    }
}

/// A page is closed by the browser.
pub fn quit(_: &ActiveEventLoop) -> Option<&'static str> {
    Some("The browser closes the page.")
}

/// Opens the lessons, which lie beside the page. Returns the message to show.
pub fn open_lessons() -> String {
    browser::open("lessons/README.md");
    "The lessons are open beside this page.".into()
}
