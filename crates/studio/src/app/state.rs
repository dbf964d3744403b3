//! The window: its session, its screen and its mouse, the actions that need them, and its frames:
//! advancing and drawing the session, and scheduling the next frame. When it closes, its settings
//! are saved.

use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::terminal;
use a3_render::GpuError;
use web_time::{Duration, Instant};
use winit::event::KeyEvent;
use winit::event_loop::{ActiveEventLoop, OwnedDisplayHandle};
use winit::keyboard::{Key, ModifiersState, NamedKey};

use super::graphics::{FrameOutcome, Graphics};
use super::platform::Platform;
use super::pointer::Mouse;
use super::screen::Screen;
use super::status::Status;
use super::touch::Fingers;
use super::{keyboard, platform};
use crate::hud::{self, plotting};
use crate::session::{Action, RunAction, Session, TextKey, WindowAction};
use crate::session::{action_beside, apply, is_typing, panel};
use crate::settings::Settings;
use crate::{command_line, keep};

/// The action that closes the window.
const CLOSE: Action = Action::Window(WindowAction::Close);

/// Delay after which a skipped frame is drawn again.
const RETRY_DELAY: Duration = Duration::from_millis(50);
/// Delay after which a frame shows new measurements, if nothing else moves.
const MEASURING_DELAY: Duration = Duration::from_millis(100);

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
        let opened = self.platform.open_graphics(&mut self.screen, &mut self.session);
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
            graphics.gpu.device.destroy();
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
        let pane = self.pane();
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
        let said = match action {
            WindowAction::Quit => return self.quit(),
            WindowAction::Close => return event_loop.exit(),
            WindowAction::Stay => return session.readings.asks_to_quit = false,
            WindowAction::FullScreen => return self.screen.toggle_full_screen(),
            WindowAction::Throw => return self.throw(pane),
            WindowAction::Record | WindowAction::FilmLast => {
                let past = action == WindowAction::FilmLast;
                return self.platform.films.record(session, graphics, past);
            }
            WindowAction::Undo | WindowAction::Redo => {
                let again = action == WindowAction::Redo || self.modifiers.shift_key();
                return panel::undo(session, again);
            }
            WindowAction::Picture => self.platform.save_picture(session, graphics),
            WindowAction::Follow => {
                let particle = self.particle(pane);
                let session = &mut self.session;
                session.view.follow(&session.runs.panes, pane, particle)
            }
            WindowAction::WritePlots if session.shows(RunAction::Plots) => {
                let written = plotting::write_files(session);
                written.unwrap_or_else(|failure| failure.to_string())
            }
            WindowAction::WritePlots => {
                let (panes, scene) = (&session.runs.panes, session.runs.first().scene());
                let table = hud::csv(panes).map_err(Failure::run);
                let name = &scene.name;
                said("Wrote", table.and_then(|it| output::write_new("".as_ref(), name, "csv", &it)))
            }
            WindowAction::WritePlot(file) => said("Wrote", plotting::write_one(session, file)),
            WindowAction::CommandLine => match command_line::of(session, pane) {
                Ok(line) => self.platform.copy(&line),
                Err(failure) => failure.to_string(),
            },
            WindowAction::SaveRun => {
                let saved = keep::save(session, pane);
                if let Ok(path) = &saved {
                    session.scenes.checkpoint = Some(path.clone());
                }
                said("Saved", saved)
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
                return self.scene_changed();
            }
        };
        self.session.readings.say(said);
    }

    /// Closes what is open: the help, the tools, a pane or the ruler. If nothing is, asks whether
    /// to quit.
    fn quit(&mut self) {
        let (readings, panel) = (&mut self.session.readings, &mut self.session.panel);
        let has_closed = std::mem::take(&mut readings.help)
            || std::mem::take(&mut panel.editor.open)
            || panel.close(RunAction::Measure)
            || panel.plotting.ruler.take().is_some()
            || panel.close(RunAction::Plots);
        if !has_closed && platform::CAN_QUIT {
            readings.asks_to_quit = true;
        } else if !has_closed {
            self.remember();
            let why = "The browser closes the page.";
            self.session.readings.say(why);
        }
    }

    /// Advances the session by the time since the last frame, draws it, and schedules the next
    /// frame.
    pub fn frame(&mut self, event_loop: &ActiveEventLoop) {
        if self.platform.files_changed() && self.session.reload() {
            self.last_tick = Instant::now();
            self.scene_changed();
        }
        let now = Instant::now();
        let real = now.duration_since(self.last_tick).as_secs_f64();
        self.last_tick = now;
        let session = &mut self.session;
        if let Some(graphics) = &self.screen.graphics {
            session.view.camera.set_focus(graphics.focus(session));
        }
        let long_press = self.mouse.long_press_at();
        let mut long_press = long_press.filter(|_| self.fingers.is_pressing());
        if long_press.take_if(|at| *at <= now).is_some() {
            self.fingers.end_press();
            self.long_press();
        }
        self.pull();
        let session = &mut self.session;
        session.tick(self.platform.films.time_to_advance(session, real));
        session.view.track_followed(&session.runs.panes);
        session.read_state();
        session.measuring.update();
        self.update_hover();
        let session = &mut self.session;
        let message_ends = session.readings.message_ends();
        let Some(graphics) = &mut self.screen.graphics else {
            return;
        };
        let begun = Instant::now();
        match graphics.frame(session, self.mouse.cursor) {
            Ok(FrameOutcome::Drawn(again, action)) => {
                session.count_frame(begun.elapsed());
                let filmed = self.platform.films.draw(session, Some(graphics));
                let at_once = (filmed || action.is_some()).then_some(Duration::ZERO);
                let again = at_once.or(again);
                if let Some(action) = action {
                    let acts = matches!(action, Action::Run(_) | Action::Window(_));
                    if acts && action != RunAction::Help.into() {
                        session.readings.help = false;
                    }
                    self.act(event_loop, action);
                }
                if let Some(status) = &mut self.status {
                    status.frames += 1;
                }
                let frame_time = self.screen.frame_time(self.session.panel.frame_limit);
                let session = &self.session;
                let measuring = session.measuring.progress().is_some();
                let measured = measuring.then_some(now + MEASURING_DELAY);
                let next = if self.session.animated() {
                    Some(now + frame_time)
                } else {
                    let again = again.map(|delay| now + delay.max(frame_time));
                    let checked = self.platform.next_check();
                    let all = [again, message_ends, measured, long_press, checked];
                    all.into_iter().flatten().min()
                };
                if let Some(next) = next {
                    self.screen.wait_until(event_loop, next);
                }
            }
            Ok(FrameOutcome::Skipped) => self.screen.wait_until(event_loop, now + RETRY_DELAY),
            Err(GpuError::Lost) => self.open_graphics(event_loop),
            Err(why) => self.fail(event_loop, why),
        }
        self.say_status();
    }

    /// Writes a status line, if they are enabled.
    pub fn say_status(&mut self) {
        if let Some(status) = &mut self.status {
            status.say(&self.session, &self.screen, self.mouse.cursor);
        }
    }

    /// Ends drags and live films, and shows another scene.
    pub fn scene_changed(&mut self) {
        self.mouse.abort();
        self.session.begin_plots();
        self.platform.films.finish_live(&mut self.session.readings);
        self.screen.set_scene(&self.session);
    }

    /// Saves the settings for the next window if they have changed, unless that is disabled. Warns
    /// on the terminal if that fails.
    pub fn remember(&self) {
        let (Some(before), session) = (&self.settings, &self.session) else {
            return;
        };
        let mut now = Settings {
            interface_scale: self.screen.zoom,
            full_screen: self.screen.is_full_screen(),
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
}

/// Returns a message about a file that was written or read, or about the failure.
fn said(done: &str, file: Result<PathBuf, Failure>) -> String {
    match file {
        Ok(path) => format!("{done} {}.", path.display()),
        Err(failure) => failure.to_string(),
    }
}
