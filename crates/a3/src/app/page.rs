//! What the window does through a browser: the adapter that cannot be waited for, files that are
//! dropped, downloads, and links in place of command lines.

use std::cell::RefCell;
use std::path::PathBuf;

use a3_render::{Gpu, GpuError};
use web_time::Instant;
use winit::event_loop::{ActiveEventLoop, EventLoopProxy};
use winit::platform::web::WindowAttributesExtWebSys;
use winit::window::{Window, WindowAttributes};

use super::graphics::{self, Graphics};
use super::state::App;
use crate::browser;
use crate::output;
use crate::session::Action;

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
pub fn reach(proxy: EventLoopProxy<Event>) {
    PROXY.set(Some(proxy));
}

/// What the window has of the browser.
#[derive(Default)]
pub struct Outside {
    /// Whether an adapter is being opened.
    opening: bool,
    /// Whether the next frame is to be saved as a picture.
    picture: bool,
}

impl App {
    /// Opens all that depends on the adapter, for the window that is there: an event says that it
    /// is open.
    pub fn open_graphics(&mut self, _: &ActiveEventLoop) {
        self.graphics = None;
        if let (Some(window), false) = (self.window.clone(), self.outside.opening) {
            self.outside.opening = true;
            let display = self.display.clone();
            wasm_bindgen_futures::spawn_local(async move {
                send(Event::Opened(graphics::open(window, display).await));
            });
        }
    }

    /// Does what the page asks for.
    pub fn take_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        match event {
            Event::Opened(opened) => {
                self.outside.opening = false;
                let Some(window) = self.window.clone() else {
                    return;
                };
                let graphics = opened
                    .and_then(|(gpu, surface)| Graphics::new(gpu, surface, window, &self.session));
                if let Err(why) = &graphics {
                    browser::show(&why.to_string());
                }
                self.take_graphics(event_loop, graphics);
                self.last = Instant::now();
            }
            Event::Open(path) => {
                if self.session.open(&path) {
                    self.scene_changed();
                }
                self.redraw();
            }
            Event::Act(action) => self.act(event_loop, action),
        }
    }

    /// A page is closed by the browser. What is remembered is kept now.
    pub fn quit(&mut self, _: &ActiveEventLoop) {
        self.remember();
        self.session.readings.say("The browser closes the page.");
    }

    /// Saves the next frame as a picture, and returns what is said of it.
    pub fn save_picture(&mut self) -> String {
        self.outside.picture = true;
        "The picture is in your downloads.".into()
    }

    /// Puts the command line of now into the address, copies the address, and returns what is said
    /// of that.
    pub fn copy(&mut self, line: &str) -> String {
        let words = line.strip_prefix("a3 ").unwrap_or(line);
        browser::set_words(words);
        let link = browser::address(words);
        browser::copy(&link);
        let _ = output::say(line);
        format!("copied: {link}")
    }

    /// Opens the lessons, which lie beside the page, and returns what is said of that.
    pub fn open_lessons() -> String {
        browser::open("lessons/README.md");
        "The lessons are open beside this page.".into()
    }

    /// Films are for the program.
    pub fn record(&mut self) {
        self.session
            .readings
            .say("The program makes films: y copies the command line for it.");
    }

    /// Films are for the program.
    pub fn film_last(&mut self) {
        self.record();
    }

    /// Saves the picture that was just drawn, if that was asked for. Returns whether another frame
    /// is needed for it.
    pub fn film(&mut self) -> bool {
        if std::mem::take(&mut self.outside.picture) {
            let scene = &self.session.runs.first().scene().name;
            browser::download_picture(format!("a3-{scene}.png"));
        }
        false
    }

    /// There are no films.
    pub fn end_live_film(&mut self) {}

    /// There are no films.
    pub fn complete_film(&mut self) {}

    /// Real time as it passes.
    pub fn pace(&self, real: f64) -> f64 {
        real
    }

    /// No files are watched.
    pub fn look_at_files(&mut self) {}

    /// No files are watched.
    pub fn next_look(&self) -> Option<Instant> {
        None
    }
}
