//! The window's state: its session, its graphics and its mouse.

use std::path::PathBuf;
use std::sync::Arc;
use web_time::Instant;

use a3_render::{GpuError, Tile};
use egui::CursorIcon;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::window::{Fullscreen, Window};

use super::graphics::Graphics;
use super::platform::Outside;
use super::pointer::Mouse;
use super::status::Status;
use crate::failure::Failure;
use crate::hud::panel;
use crate::session::{Action, Session};
use crate::settings::Settings;
use crate::show::Target;
use crate::{command_line, keep, output};

/// The window, from the first event to the last.
pub struct App {
    /// The session that is shown.
    pub session: Session,
    pub display: OwnedDisplayHandle,
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
    /// The settings as they were read, unless none are remembered.
    pub settings: Option<Settings>,
    /// Size of text and panel over that of the screen's own scale.
    pub zoom: f32,
    /// Whether the window can be seen.
    pub visible: bool,
    /// Number of devices opened so far.
    pub devices: u32,
    /// What the window has of the system.
    pub outside: Outside,
    /// Lines for tests, if they are asked for.
    pub status: Option<Status>,
    /// The failure that closed the window, if there was one.
    pub failure: Option<Failure>,
}

impl App {
    /// A session in a window that is yet to be opened.
    pub fn new(
        session: Session,
        display: OwnedDisplayHandle,
        status: bool,
        outside: Outside,
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
            zoom: settings.as_ref().map_or(1.0, |it| it.interface_scale),
            settings,
            visible: true,
            devices: 0,
            status: status.then(Status::default),
            outside,
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
        (0..self.session.runs.panes.len())
            .find(|k| self.tile(*k).contains(self.mouse.pointer))
            .unwrap_or(0)
    }

    /// Takes up all that depends on the adapter.
    pub fn take_graphics(
        &mut self,
        event_loop: &ActiveEventLoop,
        graphics: Result<Graphics, GpuError>,
    ) {
        match graphics {
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
            Action::Quit => self.quit(event_loop),
            Action::Picture => {
                let message = self.save_picture();
                self.session.readings.say(message);
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
                let session = &mut self.session;
                let said = session.view.follow(&session.runs.panes, pane, hit);
                session.readings.say(said);
            }
            Action::WritePlots => {
                let message = match self.write_plots() {
                    Ok(path) => format!("wrote {}", path.display()),
                    Err(failure) => failure.message(),
                };
                self.session.readings.say(message);
            }
            Action::Record => self.record(),
            Action::FilmLast => self.film_last(),
            Action::CommandLine => {
                let message = match command_line::of(&self.session, self.pointed()) {
                    Ok(line) => self.copy(&line),
                    Err(failure) => failure.message(),
                };
                self.session.readings.say(message);
            }
            Action::Keep => {
                let at = self.pointed();
                let message = match keep::keep(&mut self.session, at) {
                    Ok(path) => format!("kept in {}", path.display()),
                    Err(failure) => failure.message(),
                };
                self.session.readings.say(message);
            }
            Action::TakeUp => {
                self.mouse.let_go();
                let message = match self.session.library.kept.clone() {
                    None => "Nothing was kept: k keeps the run in a file.".into(),
                    Some(path) => match keep::take_up(&mut self.session, &path) {
                        Ok(()) => format!("loaded {}", path.display()),
                        Err(failure) => failure.message(),
                    },
                };
                self.session.readings.say(message);
                self.scene_changed();
            }
            Action::Lessons => {
                let message = Self::open_lessons();
                self.session.readings.say(message);
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
        let table = panel::csv(&self.session.runs.panes).map_err(Failure::run)?;
        let scene = &self.session.runs.first().scene().name;
        output::write_new("".as_ref(), scene, "csv", &table)
    }

    /// Shows another scene.
    pub fn scene_changed(&mut self) {
        self.mouse.let_go();
        self.end_live_film();
        if let Some(graphics) = &mut self.graphics {
            graphics.set_scene(&self.session);
        }
        self.title();
    }

    /// Puts the scene's name into the title of the window.
    pub fn title(&self) {
        if let Some(window) = &self.window {
            window.set_title(&format!("a3: {}", self.session.runs.first().scene().name));
        }
    }
}
