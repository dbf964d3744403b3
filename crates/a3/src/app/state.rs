//! The window's state: its session, its graphics and its mouse.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::Instant;

use a3_render::Tile;
use arboard::Clipboard;
use egui::CursorIcon;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::{Fullscreen, Window};

use super::graphics::Graphics;
use super::pointer::Mouse;
use super::status::Status;
use super::watch::Watch;
use crate::failure::Failure;
use crate::hud::panel;
use crate::recorder::Recorder;
use crate::session::{Action, Session};
use crate::settings::Settings;
use crate::show::Target;
use crate::{command_line, keep, lessons, output};

/// The window, from the first event to the last.
pub struct App {
    /// The session that is shown.
    pub session: Session,
    display: OwnedDisplayHandle,
    /// All that depends on the adapter, once it is open.
    pub graphics: Option<Graphics>,
    /// The window, once it is there.
    pub window: Option<Arc<Window>>,
    /// Time when the simulation was last brought up to date.
    pub last: Instant,
    /// The mouse.
    pub mouse: Mouse,
    /// The shape of the pointer over the picture.
    pub cursor: CursorIcon,
    /// Whether the shift key is held.
    pub shift: bool,
    /// Whether the control key is held.
    pub control: bool,
    /// The clipboard, once it was needed: what was copied is lost with it.
    clipboard: Option<Clipboard>,
    /// The settings as they were read, unless none are remembered.
    pub settings: Option<Settings>,
    /// Size of text and panel over that of the screen's own scale.
    pub zoom: f32,
    /// The film that is being made.
    pub recorder: Option<Recorder>,
    /// Whether the window can be seen.
    pub visible: bool,
    /// Number of devices opened so far.
    pub devices: u32,
    /// Lines for tests, if they are asked for.
    pub status: Option<Status>,
    /// The files of the scene, if they are watched.
    pub watch: Option<Watch>,
    /// The failure that closed the window, if there was one.
    pub failure: Option<Failure>,
}

impl App {
    /// A session in a window that is yet to be opened. When one of `files` changes, its scene is
    /// loaded again.
    pub fn new(
        session: Session,
        display: OwnedDisplayHandle,
        status: bool,
        files: Vec<PathBuf>,
        settings: Option<Settings>,
    ) -> Self {
        Self {
            session,
            display,
            graphics: None,
            window: None,
            last: Instant::now(),
            mouse: Mouse::new(),
            cursor: CursorIcon::Default,
            shift: false,
            control: false,
            clipboard: None,
            recorder: None,
            zoom: settings.as_ref().map_or(1.0, |it| it.interface_scale),
            settings,
            visible: true,
            devices: 0,
            status: status.then(Status::default),
            watch: (!files.is_empty()).then(|| Watch::new(files)),
            failure: None,
        }
    }

    /// Closes the window because of a failure.
    pub fn fail(&mut self, event_loop: &ActiveEventLoop, why: impl std::fmt::Display) {
        self.failure = Some(Failure::run(why));
        event_loop.exit();
    }

    /// Asks for another frame.
    pub fn redraw(&self) {
        if let Some(window) = &self.window {
            window.request_redraw();
        }
    }

    /// The part of the window that pane k fills.
    pub fn tile(&self, k: usize) -> Tile {
        let tiles = self
            .graphics
            .as_ref()
            .map(|graphics| graphics.tiles(&self.session));
        tiles.map_or(Tile::whole((1, 1)), |tiles| tiles[k])
    }

    /// Pixels per point.
    pub fn scale(&self) -> f32 {
        self.graphics.as_ref().map_or(1.0, Graphics::scale)
    }

    /// The pane under the pointer, or else the first.
    pub fn pointed(&self) -> usize {
        (0..self.session.panes.len())
            .find(|k| self.tile(*k).contains(self.mouse.pointer))
            .unwrap_or(0)
    }

    /// Opens all that depends on the adapter, for the window that is there.
    pub fn open_graphics(&mut self, event_loop: &ActiveEventLoop) {
        let Some(window) = self.window.clone() else {
            return;
        };
        // What was filmed is drawn by the device that goes.
        self.end_film();
        // The old surface has to go before the window can have another.
        self.graphics = None;
        match Graphics::new(window, &self.display, &self.session) {
            Ok(mut graphics) => {
                graphics.set_zoom(self.zoom);
                self.graphics = Some(graphics);
                self.devices += 1;
            }
            Err(why) => self.fail(event_loop, why),
        }
        self.redraw();
    }

    /// Does an action of the keys.
    pub fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) {
        match action {
            Action::Quit => event_loop.exit(),
            Action::Picture => {
                let Some(graphics) = &self.graphics else {
                    return;
                };
                let message = match graphics.save_picture(&mut self.session) {
                    Ok(name) => format!("saved {name}"),
                    Err(failure) => failure.message(),
                };
                self.session.say(message);
            }
            Action::FullScreen => {
                if let Some(window) = &self.window {
                    let whole = window.fullscreen().is_none();
                    window.set_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
                }
            }
            Action::Undo | Action::Redo => {
                let again = action == Action::Redo || self.shift;
                panel::undo(&mut self.session, again);
            }
            Action::Follow => {
                let pane = self.pointed();
                let hit = self.hit(pane).and_then(|(target, _)| match target {
                    Target::Particle(i) => Some(i),
                    Target::Obstacle(_) => None,
                });
                self.session.follow(pane, hit);
            }
            Action::WritePlots => {
                let message = match self.write_plots() {
                    Ok(path) => format!("wrote {}", path.display()),
                    Err(failure) => failure.message(),
                };
                self.session.say(message);
            }
            Action::Record => self.record(),
            Action::FilmLast => self.film_last(),
            Action::CommandLine => {
                let message = match command_line::of(&self.session, self.pointed()) {
                    Ok(line) => self.copy(&line),
                    Err(failure) => failure.message(),
                };
                self.session.say(message);
            }
            Action::Keep => {
                let at = self.pointed();
                let message = match keep::keep(&mut self.session, at) {
                    Ok(path) => format!("kept in {}", path.display()),
                    Err(failure) => failure.message(),
                };
                self.session.say(message);
            }
            Action::TakeUp => {
                self.mouse.let_go();
                let message = match self.session.kept.clone() {
                    None => "Nothing was kept: k keeps the run in a file.".into(),
                    Some(path) => match keep::take_up(&mut self.session, &path) {
                        Ok(()) => format!("loaded {}", path.display()),
                        Err(failure) => failure.message(),
                    },
                };
                self.session.say(message);
                self.scene_changed();
            }
            Action::Lessons => {
                let message = lessons::open().unwrap_or_else(Failure::message);
                self.session.say(message);
            }
            action => {
                // No steps are due for the time in which nothing moved.
                if !self.session.animated() {
                    self.last = Instant::now();
                }
                if self.session.act(action, self.pointed()) {
                    self.scene_changed();
                }
            }
        }
        self.redraw();
    }

    /// Writes the samples of all panes under the first name that is free.
    fn write_plots(&self) -> Result<PathBuf, Failure> {
        let table = panel::csv(&self.session.panes).map_err(Failure::run)?;
        let scene = &self.session.first().scene().name;
        output::write_new("".as_ref(), scene, "csv", &table)
    }

    /// Writes a line to the terminal and to the clipboard, and returns what is said of that.
    fn copy(&mut self, line: &str) -> String {
        // A closed terminal is no reason to lose the line.
        let _ = output::say(&format!("{line}\n"));
        if self.clipboard.is_none() {
            self.clipboard = Clipboard::new().ok();
        }
        let copied = self.clipboard.as_mut().map(|board| board.set_text(line));
        match copied {
            Some(Ok(())) => format!("copied: {line}"),
            _ => format!("on the terminal: {line}"),
        }
    }

    /// Shows another scene.
    pub fn scene_changed(&mut self) {
        self.mouse.let_go();
        if self.recorder.as_ref().is_some_and(Recorder::is_live) {
            self.end_film();
        }
        if let Some(graphics) = &mut self.graphics {
            graphics.set_scene(&self.session);
        }
        self.title();
    }

    /// Loads the scene again if one of its files was saved.
    pub fn look_at_files(&mut self) {
        if self.watch.as_mut().is_some_and(Watch::changed) && self.session.reload() {
            self.last = Instant::now();
            self.scene_changed();
        }
    }

    /// Puts the scene's name into the title of the window.
    pub fn title(&self) {
        if let Some(window) = &self.window {
            window.set_title(&format!("a3: {}", self.session.first().scene().name));
        }
    }
}
