//! The state of the window: its session, its screen and its mouse. When it closes, its settings
//! are saved.

use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::terminal;
use a3_render::GpuError;
use web_time::Instant;
use winit::event::KeyEvent;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::keyboard::{Key, ModifiersState, NamedKey};

use super::graphics::Graphics;
use super::mouse::Mouse;
use super::platform::Platform;
use super::screen::Screen;
use super::status::Status;
use super::touch::Fingers;
use super::{keyboard, platform, tool};
use crate::hud::{self, plotting};
use crate::session::{Action, RunAction, Session, TextKey, WindowAction};
use crate::session::{action_beside, apply, begin_plots, is_typing, panel};
use crate::settings::Settings;
use crate::{command_line, keep};

/// The action that closes the window.
const CLOSE: Action = Action::Window(WindowAction::Close);

/// The window application.
pub struct App {
    /// The session.
    pub session: Session,
    /// The window on the screen.
    pub screen: Screen,
    /// The mouse.
    pub mouse: Mouse,
    /// The fingers.
    pub fingers: Fingers,
    /// The modifier keys that are held.
    pub modifiers: ModifiersState,
    /// Time when the session was last advanced.
    pub last_tick: Instant,
    /// The settings as they were read; `None` if they are not saved.
    pub settings: Option<Settings>,
    /// Services of the operating system or the browser.
    pub platform: Platform,
    /// Writer of status lines, if they are enabled.
    pub status: Option<Status>,
    /// The failure that closed the window, if there was one.
    pub failure: Option<Failure>,
}

impl App {
    /// Creates an application whose window is not open yet.
    pub fn new(
        session: Session,
        display: OwnedDisplayHandle,
        status: bool,
        platform: Platform,
        settings: Option<Settings>,
    ) -> Self {
        let zoom = settings.as_ref().map_or(1.0, |it| it.interface_scale);
        Self {
            session,
            screen: Screen::new(display, zoom),
            mouse: Mouse::new(),
            fingers: Fingers::default(),
            modifiers: ModifiersState::empty(),
            last_tick: Instant::now(),
            settings,
            platform,
            status: status.then(Status::default),
            failure: None,
        }
    }

    /// Closes the window because of a failure.
    pub fn fail(&mut self, event_loop: &ActiveEventLoop, why: impl std::fmt::Display) {
        self.failure = Some(Failure::run(why));
        event_loop.exit();
    }

    /// Opens the graphics, or starts to.
    pub fn open_graphics(&mut self, event_loop: &ActiveEventLoop) {
        let opened = self
            .platform
            .open_graphics(&mut self.screen, &mut self.session);
        if let Some(graphics) = opened {
            self.set_graphics(event_loop, graphics);
        }
    }

    /// Sets the graphics, or closes the window if they could not be opened.
    pub fn set_graphics(
        &mut self,
        event_loop: &ActiveEventLoop,
        graphics: Result<Graphics, GpuError>,
    ) {
        if let Err(why) = self.screen.set_graphics(graphics) {
            self.fail(event_loop, why);
        }
    }

    /// Handles a key: in an open list, for a typed value, in the panel, or by the table of keys.
    pub fn press_key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) {
        if let (Some(_), Some(graphics)) = (&self.status, &self.screen.graphics)
            && event.logical_key == Key::Named(NamedKey::F12)
        {
            graphics.lose_device();
            self.screen.redraw();
        }
        self.screen.redraw();
        if self.session.readings.asks_to_quit {
            self.session.readings.asks_to_quit = false;
            match event.logical_key {
                Key::Named(NamedKey::Enter) => return self.act(event_loop, CLOSE),
                Key::Named(NamedKey::Escape) => return,
                _ => {}
            }
        }
        if self.modifiers.control_key() || self.modifiers.super_key() {
            if keyboard::marks_all(&event.logical_key) && self.type_key(TextKey::MarkAll) {
                return;
            }
            return self.press_with_control(event_loop, &event.logical_key);
        }
        if self.modifiers.alt_key() {
            return;
        }
        let typed = keyboard::text_key(event);
        if self.session.list.is_some() {
            if typed.is_some_and(|key| self.session.press_list(key)) {
                self.scene_changed();
            }
            return;
        }
        if typed.is_some_and(|key| self.type_key(key)) {
            return;
        }
        let key = keyboard::panel_key(&event.logical_key);
        let shift = self.modifiers.shift_key();
        if let Some(action) = key.and_then(|key| action_beside(&self.session, key, shift)) {
            return self.act(event_loop, action);
        }
        let Some(action) = keyboard::action(&event.logical_key) else {
            return;
        };
        let repeats = matches!(
            action,
            Action::Run(
                RunAction::Step
                    | RunAction::LongerStep
                    | RunAction::ShorterStep
                    | RunAction::Scrub(_)
            )
        );
        if !event.repeat || repeats {
            self.act(event_loop, action);
        }
    }

    /// Handles a key while a value or an answer is typed, and returns whether one is.
    fn type_key(&mut self, key: TextKey) -> bool {
        let is_typing = is_typing(&self.session);
        if is_typing {
            apply(&mut self.session, key, 0);
        }
        is_typing
    }

    /// Handles a key that is pressed with Ctrl, which never has the effect of the key alone.
    fn press_with_control(&mut self, event_loop: &ActiveEventLoop, key: &Key) {
        if let Some(by) = keyboard::zoom(key) {
            let said = self.screen.scale_interface(by);
            self.session.readings.say(said);
        } else if let Some(action) = keyboard::control_action(key) {
            self.act(event_loop, action);
        }
    }

    /// Performs an action.
    pub fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) {
        let pane = self.mouse.pointer.pane(&self.session, &self.screen);
        if let Action::Window(action) = action {
            self.act_in_window(event_loop, action, pane);
        } else {
            // Do not simulate the time in which the runs stood still.
            if !self.session.animated() {
                self.last_tick = Instant::now();
            }
            if apply(&mut self.session, action, pane) {
                self.scene_changed();
            }
        }
        self.screen.redraw();
    }

    /// Performs an action that needs the window. The pointer is over `pane`.
    fn act_in_window(&mut self, event_loop: &ActiveEventLoop, action: WindowAction, pane: usize) {
        let (session, graphics) = (&mut self.session, self.screen.graphics.as_ref());
        let message = match action {
            WindowAction::Quit if std::mem::take(&mut session.readings.help) => None,
            WindowAction::Quit if std::mem::take(&mut session.panel.editor.open) => None,
            WindowAction::Quit if session.panel.close(RunAction::Measure) => None,
            WindowAction::Quit if session.panel.plotting.ruler.take().is_some() => None,
            WindowAction::Quit if session.panel.close(RunAction::Plots) => None,
            WindowAction::Quit if platform::CAN_QUIT => {
                session.readings.asks_to_quit = true;
                None
            }
            WindowAction::Quit => {
                self.remember();
                Some("The browser closes the page.".into())
            }
            WindowAction::Close => {
                event_loop.exit();
                None
            }
            WindowAction::Stay => {
                session.readings.asks_to_quit = false;
                None
            }
            WindowAction::Picture => Some(self.platform.save_picture(session, graphics)),
            WindowAction::FullScreen => {
                self.screen.toggle_full_screen();
                None
            }
            WindowAction::Undo | WindowAction::Redo => {
                let again = action == WindowAction::Redo || self.modifiers.shift_key();
                panel::undo(session, again);
                None
            }
            WindowAction::Throw => {
                let heavy = self.modifiers.shift_key();
                tool::throw(&self.mouse.pointer, heavy, session, &self.screen, pane);
                None
            }
            WindowAction::Follow => {
                let hit = self.mouse.pointer.hit(session, &self.screen, pane);
                let particle = hit.and_then(|(target, _)| target.particle());
                let panes = &session.runs.panes;
                Some(session.view.follow(panes, pane, particle))
            }
            WindowAction::WritePlots if session.shows(RunAction::Plots) => {
                let written = plotting::write_files(session);
                Some(written.unwrap_or_else(|failure| failure.to_string()))
            }
            WindowAction::WritePlots => Some(said("Wrote", write_plots(session))),
            WindowAction::WritePlot(file) => {
                Some(said("Wrote", plotting::write_one(session, file)))
            }
            WindowAction::Record => {
                self.platform.films.record(session, graphics);
                None
            }
            WindowAction::FilmLast => {
                self.platform.films.record_last(session, graphics);
                None
            }
            WindowAction::CommandLine => Some(match command_line::of(session, pane) {
                Ok(line) => self.platform.copy(&line),
                Err(failure) => failure.to_string(),
            }),
            WindowAction::SaveRun => {
                let saved = keep::save(session, pane);
                if let Ok(path) = &saved {
                    session.scenes.checkpoint = Some(path.clone());
                }
                Some(said("Saved", saved))
            }
            WindowAction::LoadRun => {
                let loaded = match session.scenes.checkpoint.clone() {
                    None => "No run was saved yet: key k saves one.".into(),
                    Some(path) => {
                        let taken = keep::load(session, &path);
                        said("Loaded", taken.map(|()| path))
                    }
                };
                session.readings.say(loaded);
                self.scene_changed();
                None
            }
        };
        if let Some(message) = message {
            self.session.readings.say(message);
        }
    }

    /// Ends drags and live films, and shows another scene.
    pub fn scene_changed(&mut self) {
        self.mouse.abort();
        begin_plots(&mut self.session);
        self.platform.films.finish_live(&mut self.session.readings);
        self.screen.set_scene(&self.session);
    }

    /// Saves the settings for the next window, unless that is disabled.
    pub fn remember(&self) {
        if let Some(before) = &self.settings {
            remember(before, &self.session, &self.screen);
        }
    }
}

/// Returns a message about a file that was written or read, or about the failure.
fn said(done: &str, file: Result<PathBuf, Failure>) -> String {
    match file {
        Ok(path) => format!("{done} {}.", path.display()),
        Err(failure) => failure.to_string(),
    }
}

/// Writes the samples of all panes under the first free name, and returns the path. Fails if the
/// file cannot be written.
fn write_plots(session: &Session) -> Result<PathBuf, Failure> {
    let table = hud::csv(&session.runs.panes).map_err(Failure::run)?;
    let scene = &session.runs.first().scene().name;
    output::write_new("".as_ref(), scene, "csv", &table)
}

/// Writes the present settings, if they have changed. Warns on the terminal if that fails.
pub fn remember(before: &Settings, session: &Session, screen: &Screen) {
    let mut now = Settings {
        interface_scale: screen.zoom,
        full_screen: screen.is_full_screen(),
        dark: session.panel.dark.unwrap_or(before.dark),
        panel: session.panel.has(RunAction::Panel),
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
