//! The browser's part of the window: an adapter that is opened asynchronously, downloads, and links
//! in place of command lines.

use std::cell::RefCell;
use std::path::PathBuf;

use a3_files::browser;
use a3_files::terminal;
use a3_render::{Gpu, GpuError};
use web_time::Instant;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::platform::web::WindowAttributesExtWebSys;
use winit::window::{Window, WindowAttributes};

use super::graphics::{Graphics, open_adapter};
use super::screen::Screen;
use crate::session::{Readings, Session};

thread_local! {
    /// Sender of events to the window.
    static PROXY: RefCell<Option<EventLoopProxy<Event>>> = const { RefCell::new(None) };
}

/// Returns the attributes of the window: the canvas of the page.
pub fn attributes(_: &ActiveEventLoop) -> WindowAttributes {
    Window::default_attributes().with_canvas(browser::canvas())
}

/// Whether the program closes its window; a page is closed by the browser.
pub const CAN_QUIT: bool = false;

/// Events from the page.
pub enum Event {
    /// An adapter was opened, or that failed.
    Opened(Result<(Gpu, wgpu::Surface<'static>), GpuError>),
    /// A scene file was chosen on the page.
    Open(PathBuf),
    /// The page has a message.
    Say(String),
}

/// Sends an event to the window, if it is connected.
pub fn send(event: Event) {
    PROXY.with_borrow(|proxy| {
        if let Some(proxy) = proxy {
            let _ = proxy.send_event(event);
        }
    });
}

/// Connects [`send`] with the window.
pub fn connect(proxy: EventLoopProxy<Event>) {
    PROXY.set(Some(proxy));
}

/// Services of the browser for the window.
#[derive(Default)]
pub struct Platform {
    /// Whether an adapter is being opened.
    opening: bool,
    pub films: Films,
}

/// The request for a picture. A page makes no films.
#[derive(Default)]
pub struct Films {
    /// Whether the next frame will be saved as a picture.
    picture: bool,
}

impl Platform {
    /// Starts to open an adapter for the window; an event brings the result. Always returns `None`.
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
                send(Event::Opened(open_adapter(window, display).await));
            });
        }
        None
    }

    /// Creates the graphics for the window from the opened adapter. Returns `None` if there is no
    /// window.
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

    /// Requests the next frame as a picture, and returns a message.
    pub fn save_picture(&mut self, _: &mut Session, _: Option<&Graphics>) -> String {
        self.films.picture = true;
        "The picture is in your downloads.".into()
    }

    /// Puts a command line into the address, copies the address, and returns a message.
    pub fn copy(&mut self, line: &str) -> String {
        let words = line.strip_prefix("a3 ").unwrap_or(line);
        browser::set_words(words);
        let link = browser::address(words);
        browser::copy(&link);
        let _ = terminal::say(line);
        format!("Copied: {link}")
    }

    /// Returns false: a page watches no files.
    pub fn files_changed(&mut self) -> bool {
        false
    }

    /// Returns `None`: a page watches no files.
    pub fn next_check(&self) -> Option<Instant> {
        None
    }
}

impl Films {
    /// Shows a message: a page makes no films.
    pub fn record(&mut self, session: &mut Session, _: Option<&Graphics>, _: bool) {
        session.readings.say("Only the program makes films: key y copies the command line for it.");
    }

    /// Saves the frame that was just drawn, if that was requested. Returns false: no further frame
    /// is needed.
    pub fn draw(&mut self, session: &mut Session, _: Option<&Graphics>) -> bool {
        if std::mem::take(&mut self.picture) {
            let scene = &session.runs.first().scene().name;
            browser::download_picture(format!("a3-{scene}.png"));
        }
        false
    }

    /// Does nothing: a page makes no films.
    pub fn finish_live(&mut self, _: &mut Readings) {}

    /// Does nothing: a page makes no films.
    pub fn complete(&mut self, _: &mut Session, _: Option<&Graphics>) {}

    /// Returns `real`: a page has no films.
    pub fn time_to_advance(&self, _: &Session, real: f64) -> f64 {
        real
    }
}
