//! The window: events in, frames out.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use a3_core::Vector3;
use a3_render::{GpuError, Tile};
use winit::application::ApplicationHandler;
use winit::dpi::{LogicalSize, PhysicalPosition};
use winit::event::{ElementState, MouseButton, MouseScrollDelta, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop, OwnedDisplayHandle};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Window, WindowId};

use super::graphics::{Graphics, Outcome};
use super::keyboard;
use super::pick::{self, Grip, Target};
use super::status::Status;
use super::watch::Watch;
use crate::caught::caught;
use crate::failure::Failure;
use crate::hud::{layout, panel};
use crate::session::{Action, Session};

/// A frame that could not be drawn is tried again after this.
const RETRY: Duration = Duration::from_millis(50);
/// Points around the pointer in which a particle is hit.
const REACH: f32 = 18.0;
/// Points that a click may move.
const CLICK: f32 = 4.0;
/// Between the two of a double click.
const DOUBLE: Duration = Duration::from_millis(400);
/// Radians per height of the picture.
const TURN: f32 = 4.0;

/// How it ends.
pub enum End {
    /// The user closed the window.
    Closed,
    /// There never was a window, for this reason: the session is as it was.
    NoWindow(String, Box<Session>),
}

/// Opens the window. With `status`, lines on stderr tell what is on the screen. When one of `files`
/// changes, the scene is loaded again.
pub fn open(mut session: Session, status: bool, files: Vec<PathBuf>) -> Result<End, Failure> {
    let event_loop = match event_loop() {
        Ok(event_loop) => event_loop,
        Err(why) => return Ok(End::NoWindow(why, Box::new(session))),
    };
    session.readings.in_window = true;
    let mut app = App {
        display: event_loop.owned_display_handle(),
        graphics: None,
        window: None,
        last: Instant::now(),
        pointer: [0.0; 2],
        shift: false,
        hand: Hand::Empty,
        button: None,
        pressed: ([f32::INFINITY; 2], Instant::now(), false),
        devices: 0,
        visible: true,
        held: 0,
        status: status.then(Status::default),
        watch: (!files.is_empty()).then(|| Watch::new(files)),
        failure: None,
        session,
    };
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

/// Without a display an error; without a library that winit cannot do without, a panic of its own, caught here.
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

/// What a pressed button is doing.
#[derive(Clone, Copy, PartialEq)]
enum Hand {
    Empty,
    Pull(Grip),
    Orbit,
    Pan,
    /// On the timeline.
    Scrub,
}

struct App {
    session: Session,
    display: OwnedDisplayHandle,
    graphics: Option<Graphics>,
    window: Option<Arc<Window>>,
    /// When the simulation was last brought up to date.
    last: Instant,
    /// In px from the left and from the top.
    pointer: [f32; 2],
    /// Whether that key is held.
    shift: bool,
    hand: Hand,
    /// The pane in which it began.
    held: usize,
    /// The button that holds it.
    button: Option<MouseButton>,
    /// Where and when that was pressed, and whether the pointer has stayed there.
    pressed: ([f32; 2], Instant, bool),
    visible: bool,
    /// Devices opened so far.
    devices: u32,
    status: Option<Status>,
    watch: Option<Watch>,
    failure: Option<Failure>,
}

impl App {
    fn fail(&mut self, event_loop: &ActiveEventLoop, why: impl std::fmt::Display) {
        self.failure = Some(Failure::run(why));
        event_loop.exit();
    }

    fn redraw(&self) {
        if let Some(window) = &self.window {
            window.request_redraw();
        }
    }

    /// Where pane k is.
    fn tile(&self, k: usize) -> Tile {
        let tiles = self
            .graphics
            .as_ref()
            .map(|graphics| graphics.tiles(&self.session));
        tiles.map_or(Tile::whole((1, 1)), |tiles| tiles[k])
    }

    /// The pane under the pointer, else the first.
    fn pointed(&self) -> usize {
        (0..self.session.panes.len())
            .find(|k| self.tile(*k).contains(self.pointer))
            .unwrap_or(0)
    }

    /// Everything that depends on the adapter, for the window that is there.
    fn open_graphics(&mut self, event_loop: &ActiveEventLoop) {
        let Some(window) = self.window.clone() else {
            return;
        };
        // The old surface has to go before the window can have another.
        self.graphics = None;
        match Graphics::new(window, &self.display, &self.session) {
            Ok(graphics) => {
                self.graphics = Some(graphics);
                self.devices += 1;
            }
            Err(why) => self.fail(event_loop, why),
        }
        self.redraw();
    }

    fn act(&mut self, event_loop: &ActiveEventLoop, action: Action) {
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
            action => {
                // What stood still owes nothing.
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

    /// Another scene is shown now.
    fn scene_changed(&mut self) {
        self.hand = Hand::Empty;
        self.button = None;
        if let Some(graphics) = &mut self.graphics {
            graphics.set_scene(&self.session);
        }
        self.title();
    }

    /// Loads the scene again if its file was saved.
    fn look_at_files(&mut self) {
        if self.watch.as_mut().is_some_and(Watch::changed) && self.session.reload() {
            self.last = Instant::now();
            self.scene_changed();
        }
    }

    fn title(&self) {
        if let Some(window) = &self.window {
            window.set_title(&format!("a3: {}", self.session.first().scene().name));
        }
    }

    fn press(&mut self, button: MouseButton) {
        // One button at a time.
        if self.button.is_some() {
            return;
        }
        let (held, scale) = (
            self.pointed(),
            self.graphics.as_ref().map_or(1.0, Graphics::scale),
        );
        let (_, when, still) = self.pressed;
        self.pressed = (self.pointer, Instant::now(), true);
        let again = still && when.elapsed() < DOUBLE;
        let share = self.timeline_share(CLICK);
        let hit = self.hit(held, scale);
        let session = &mut self.session;
        self.hand = match button {
            MouseButton::Left if share.is_some() => {
                session.scrub_to(share.unwrap_or(1.0));
                Hand::Scrub
            }
            MouseButton::Left => {
                let particle = hit.and_then(|(target, _)| match target {
                    Target::Particle(i) => Some(i),
                    Target::Obstacle(_) => None,
                });
                if again {
                    session.show_springs_of(particle);
                }
                match hit {
                    Some((Target::Particle(i), grip)) if session.grab(i) => Hand::Pull(grip),
                    Some((Target::Obstacle(k), grip)) if session.grab_obstacle(k) => {
                        Hand::Pull(grip)
                    }
                    _ => Hand::Orbit,
                }
            }
            MouseButton::Right | MouseButton::Middle => Hand::Pan,
            _ => return,
        };
        self.held = held;
        self.button = Some(button);
    }

    /// What is under the pointer in pane `held`. A lost run does not move, whoever pulls.
    fn hit(&self, held: usize, scale: f32) -> Option<(Target, Grip)> {
        let (tile, pane) = (self.tile(held), &self.session.panes[held]);
        let (place, reach) = (tile.place(self.pointer), REACH * scale / tile.height as f32);
        let run = Some(&pane.simulation).filter(|_| pane.alive())?;
        pick::pick(run, &self.session.camera, place, tile.aspect(), reach)
    }

    /// Where on the timeline the pointer is, if that is shown and the pointer no farther from it than `margin` (points).
    fn timeline_share(&self, margin: f32) -> Option<f32> {
        let graphics = self.graphics.as_ref()?;
        self.session.readings.rewound?;
        let (scale, size) = (graphics.scale(), graphics.size());
        let size = [size.0, size.1].map(|side| side as f32 / scale);
        let [x, y] = self.pointer.map(|px| px / scale);
        let [left, top, width, height] = layout::timeline(size);
        let (from, to) = layout::track(left, width);
        let inside = x > left - margin
            && x < left + width + margin
            && y > top - margin
            && y < top + height + margin;
        inside.then_some(((x - from) / (to - from)).clamp(0.0, 1.0))
    }

    /// A right click pins what is under it.
    fn click(&mut self) {
        let scale = self.graphics.as_ref().map_or(1.0, Graphics::scale);
        if let Some((Target::Particle(i), _)) = self.hit(self.held, scale) {
            self.session.toggle_pin(i);
        }
    }

    fn let_go(&mut self) {
        self.session.release();
        self.hand = Hand::Empty;
        self.button = None;
    }

    fn move_to(&mut self, position: PhysicalPosition<f64>) {
        let pointer = [position.x as f32, position.y as f32];
        let scale = self.graphics.as_ref().map_or(1.0, Graphics::scale);
        if self.session.panel.open {
            let panes = 0..self.session.panes.len();
            let under = panes.into_iter().find(|k| self.tile(*k).contains(pointer));
            self.session.panel.pane = under.unwrap_or(self.session.panel.pane);
            // What is under the pointer there looks so.
            self.redraw();
        }
        let tile = self.tile(self.held);
        // A click is no drag, until it has gone too far.
        self.pressed.2 &= near(self.pressed.0, pointer, CLICK * scale);
        if self.pressed.2 && self.hand == Hand::Pan {
            return;
        }
        let ([x, y], [was_x, was_y]) = (tile.place(pointer), tile.place(self.pointer));
        let (dx, dy, aspect) = (x - was_x, y - was_y, tile.aspect());
        self.pointer = pointer;
        match self.hand {
            Hand::Orbit => self.session.camera.orbit(-TURN * dx * aspect, TURN * dy),
            Hand::Pan => self.session.camera.pan(-dx * aspect, dy),
            Hand::Scrub => {
                if let Some(share) = self.timeline_share(f32::INFINITY) {
                    self.session.scrub_to(share);
                }
            }
            Hand::Pull(_) | Hand::Empty => return,
        }
        self.redraw();
    }

    /// Brings the simulation up to date and draws it.
    fn frame(&mut self, event_loop: &ActiveEventLoop) {
        self.look_at_files();
        let now = Instant::now();
        let real = now.duration_since(self.last).as_secs_f64();
        self.last = now;
        if let Hand::Pull(grip) = self.hand {
            let tile = self.tile(self.held);
            let place = tile.place(self.pointer);
            let [x, y, z] = grip
                .target(&self.session.camera, place, tile.aspect())
                .map(f64::from);
            self.session.pull(Vector3::new(x, y, z));
        }
        self.session.tick(real);
        self.session.read_state();
        let message_ends = self.session.message_ends();
        let Some(graphics) = &mut self.graphics else {
            return;
        };
        let begun = Instant::now();
        match graphics.frame(&mut self.session) {
            Ok(Outcome::Drawn(again)) => {
                self.session.drawn(begun.elapsed());
                if let Some(status) = &mut self.status {
                    status.frames += 1;
                }
                let next = if self.session.animated() {
                    Some(now + self.frame_time())
                } else {
                    let again = again.map(|delay| now + delay.max(self.frame_time()));
                    let look = self.watch.as_ref().map(Watch::next);
                    [again, message_ends, look].into_iter().flatten().min()
                };
                if let Some(next) = next {
                    self.wait_until(event_loop, next);
                }
            }
            Ok(Outcome::Skipped) => self.wait_until(event_loop, now + RETRY),
            Err(GpuError::Lost) => self.open_graphics(event_loop),
            Err(why) => self.fail(event_loop, why),
        }
        self.say_status();
    }

    /// A little less than that of the monitor: presenting waits for the rest, where it waits at all.
    fn frame_time(&self) -> Duration {
        let monitor = self
            .window
            .as_ref()
            .and_then(|window| window.current_monitor());
        let rate = monitor
            .and_then(|monitor| monitor.refresh_rate_millihertz())
            .unwrap_or(60_000);
        Duration::from_secs_f64(0.9e3 / f64::from(rate.clamp(30_000, 500_000)))
    }

    fn wait_until(&self, event_loop: &ActiveEventLoop, when: Instant) {
        if !self.visible {
            event_loop.set_control_flow(ControlFlow::Wait);
        } else if when <= Instant::now() {
            self.redraw();
        } else {
            event_loop.set_control_flow(ControlFlow::WaitUntil(when));
        }
    }

    fn say_status(&mut self) {
        if let (Some(status), Some(graphics)) = (&mut self.status, &self.graphics) {
            status.say(&self.session, graphics, self.visible, self.devices);
        }
    }
}

/// Whether two places of the window are no farther apart than `reach` (px).
fn near(a: [f32; 2], b: [f32; 2], reach: f32) -> bool {
    (a[0] - b[0]).hypot(a[1] - b[1]) <= reach
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.window.is_some() {
            return;
        }
        event_loop.set_control_flow(ControlFlow::Wait);
        let attributes = Window::default_attributes()
            .with_inner_size(LogicalSize::new(1280.0, 720.0))
            .with_min_inner_size(LogicalSize::new(64.0, 48.0));
        match event_loop.create_window(attributes) {
            Ok(window) => self.window = Some(Arc::new(window)),
            Err(why) => return self.fail(event_loop, format!("no window ({why})")),
        }
        self.title();
        self.open_graphics(event_loop);
        self.last = Instant::now();
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        if let StartCause::ResumeTimeReached { .. } = cause {
            event_loop.set_control_flow(ControlFlow::Wait);
            self.redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(graphics) = &mut self.graphics else {
            return;
        };
        // Keys are for the table of keys: the text takes none.
        let is_key = matches!(event, WindowEvent::KeyboardInput { .. });
        let taken = !is_key && graphics.on_event(&event)
            || panel::leaves(&self.session, graphics.size(), graphics.scale()).0 as f32
                <= self.pointer[0];
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                graphics.resized();
                self.redraw();
            }
            WindowEvent::Occluded(hidden) => {
                self.visible = !hidden;
                // Time spent hidden is not simulated.
                self.last = Instant::now();
                self.session.start_anew();
                self.say_status();
                self.redraw();
            }
            WindowEvent::ModifiersChanged(held) => self.shift = held.state().shift_key(),
            WindowEvent::Focused(false) => self.let_go(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                if self.status.is_some() && event.logical_key == Key::Named(NamedKey::F12) {
                    graphics.lose_device();
                    self.redraw();
                }
                let key = keyboard::panel_key(&event.logical_key);
                if key.is_some_and(|key| panel::press(&mut self.session, key, self.shift)) {
                    self.redraw();
                    return;
                }
                let Some(action) = keyboard::action(&event.logical_key) else {
                    return;
                };
                let repeats = matches!(
                    action,
                    Action::Step | Action::LongerStep | Action::ShorterStep | Action::Scrub(_)
                );
                if !event.repeat || repeats {
                    self.act(event_loop, action);
                }
            }
            WindowEvent::MouseInput {
                state: ElementState::Pressed,
                button,
                ..
            } if !taken => {
                self.press(button);
                self.redraw();
            }
            WindowEvent::MouseInput {
                state: ElementState::Released,
                button,
                ..
            } if self.button == Some(button) => {
                if button == MouseButton::Right && self.pressed.2 {
                    self.click();
                }
                self.let_go();
                self.redraw();
            }
            WindowEvent::CursorMoved { position, .. } => self.move_to(position),
            WindowEvent::MouseWheel { delta, .. } if !taken => {
                let notches = match delta {
                    MouseScrollDelta::LineDelta(_, y) => y,
                    MouseScrollDelta::PixelDelta(p) => p.y as f32 / 50.0,
                };
                self.session.camera.zoom(0.9f32.powf(notches));
                self.redraw();
            }
            WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. } => self.redraw(),
            WindowEvent::RedrawRequested if self.visible => self.frame(event_loop),
            _ => {}
        }
    }
}
