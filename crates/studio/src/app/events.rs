//! Events of the window.

use std::sync::Arc;
use web_time::Instant;

use winit::application::ApplicationHandler;
use winit::event::{ElementState, MouseButton, StartCause, Touch, TouchPhase, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::window::{Fullscreen, WindowId};

use super::platform::{self, Event};
use super::state::App;
use super::touch::{Effect, pinch, position};

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.screen.window.is_some() {
            return;
        }
        event_loop.set_control_flow(ControlFlow::Wait);
        let whole = self.settings.as_ref().is_some_and(|it| it.full_screen);
        let attributes = platform::attributes(event_loop)
            .with_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
        match event_loop.create_window(attributes) {
            Ok(window) => self.screen.window = Some(Arc::new(window)),
            Err(why) => return self.fail(event_loop, format!("no window ({why})")),
        }
        self.screen.set_title(&self.session);
        self.open_graphics(event_loop);
        self.last_tick = Instant::now();
    }

    #[cfg(target_arch = "wasm32")]
    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        match event {
            Event::Opened(opened) => {
                let opened = self.platform.finish_opening(opened, &self.screen, &self.session);
                if let Some(graphics) = opened {
                    self.set_graphics(event_loop, graphics);
                    self.last_tick = Instant::now();
                }
            }
            Event::Open(path) => {
                if self.session.open(&path) {
                    self.scene_changed();
                }
                self.screen.redraw();
            }
            Event::Say(words) => {
                self.session.readings.warn(words);
                self.screen.redraw();
            }
        }
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        // While the runs advance, each frame does this.
        if self.screen.visible && !self.session.animated() && self.update_hover() {
            self.screen.redraw();
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        let graphics = self.screen.graphics.as_ref();
        self.platform.films.complete(&mut self.session, graphics);
        self.remember();
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        if let StartCause::ResumeTimeReached { .. } = cause {
            event_loop.set_control_flow(ControlFlow::Wait);
            self.screen.redraw();
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        if let WindowEvent::Touch(touch) = &event {
            point(self, touch);
        }
        let Some(graphics) = &mut self.screen.graphics else {
            return;
        };
        if !matches!(event, WindowEvent::RedrawRequested) {
            graphics.invalidate_text();
        }
        // All keys belong to the table of keys, none to egui.
        let is_key = matches!(event, WindowEvent::KeyboardInput { .. });
        let position = self.mouse.position;
        let taken = !is_key && (graphics.on_event(&event, position) || self.session.list.is_some())
            || !self.is_in_picture();
        if let WindowEvent::MouseInput { state, .. } = event {
            self.session.readings.touch = false;
            self.session.history.set_button_held(state == ElementState::Pressed);
        }
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::Resized(_) | WindowEvent::ScaleFactorChanged { .. } => {
                let graphics = self.screen.graphics.iter_mut();
                graphics.for_each(|graphics| graphics.stale = true);
                self.screen.redraw();
            }
            WindowEvent::Occluded(hidden) => {
                self.screen.visible = !hidden;
                // Do not simulate the time for which the window was hidden.
                self.last_tick = Instant::now();
                self.session.restart_measuring();
                self.say_status();
                self.screen.redraw();
            }
            WindowEvent::ModifiersChanged(held) => self.modifiers = held.state(),
            WindowEvent::Focused(false) => self.finish(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.press_key(event_loop, &event);
            }
            WindowEvent::MouseInput { state: ElementState::Pressed, button, .. } if !taken => {
                self.press(button, self.modifiers.shift_key());
                self.screen.redraw();
            }
            WindowEvent::MouseInput { state: ElementState::Released, button, .. } => {
                self.release(button);
                self.screen.redraw();
            }
            WindowEvent::Touch(touch) => change(self, &touch, taken),
            WindowEvent::DroppedFile(path) => {
                if self.session.open(&path) {
                    self.scene_changed();
                }
                self.screen.redraw();
            }
            WindowEvent::CursorMoved { position, .. } => self.move_to(position),
            WindowEvent::CursorLeft { .. } => self.mouse.inside = false,
            WindowEvent::MouseWheel { delta, .. } if !taken => {
                self.scroll(delta);
                self.screen.redraw();
            }
            WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. } => self.screen.redraw(),
            WindowEvent::RedrawRequested if self.screen.visible => self.frame(event_loop),
            _ => {}
        }
    }
}

/// Puts the pointer where the first finger comes down.
fn point(app: &mut App, touch: &Touch) {
    if app.fingers.begins(touch) {
        app.mouse.position = position(touch);
        app.mouse.inside = true;
    }
}

/// Does what a change of a finger means, which is `taken` if text or a button is there.
fn change(app: &mut App, touch: &Touch, taken: bool) {
    let is_down = !matches!(touch.phase, TouchPhase::Ended | TouchPhase::Cancelled);
    app.session.history.set_button_held(is_down);
    app.session.readings.touch = true;
    let (id, at) = (touch.id, position(touch));
    match app.fingers.change(id, touch.phase, at, taken) {
        Effect::Nothing => {}
        Effect::Press => app.press(MouseButton::Left, false),
        Effect::Move => app.move_to(touch.location),
        Effect::Release => app.release(MouseButton::Left),
        Effect::Finish => app.finish(),
        Effect::Pinch(places) => {
            let tile = app.screen.tile(&app.session, app.pane());
            pinch(&mut app.session.view.camera, tile, places);
        }
    }
    app.mouse.inside &= is_down;
    app.screen.redraw();
}
