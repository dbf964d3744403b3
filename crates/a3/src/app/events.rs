//! Events of the window.

use std::sync::Arc;
use web_time::Instant;

use winit::application::ApplicationHandler;
use winit::event::{ElementState, KeyEvent, MouseButton, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow};
use winit::keyboard::{Key, NamedKey};
use winit::window::{Fullscreen, WindowId};

use super::keyboard;
use super::platform::{self, Event};
use super::pointer::Drag;
use super::state::App;
use crate::hud::panel;
use crate::session::Action;

impl App {
    /// Does what a key is for: in the panel, or by the table of keys.
    fn press_key(&mut self, event_loop: &ActiveEventLoop, event: &KeyEvent) {
        if let (Some(_), Some(graphics)) = (&self.status, &self.graphics)
            && event.logical_key == Key::Named(NamedKey::F12)
        {
            graphics.lose_device();
            self.redraw();
        }
        if let (true, Some(by)) = (self.control, keyboard::zoom(&event.logical_key)) {
            return self.scale_interface(by);
        }
        let typed = keyboard::text_key(event);
        if self.session.list.is_some() {
            if typed.is_some_and(|key| self.session.press_list(key)) {
                self.scene_changed();
            }
            self.redraw();
            return;
        }
        if typed.is_some_and(|key| panel::press_text(&mut self.session, key)) {
            self.redraw();
            return;
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
}

impl ApplicationHandler<Event> for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.window.is_some() {
            return;
        }
        event_loop.set_control_flow(ControlFlow::Wait);
        let whole = self.settings.as_ref().is_some_and(|it| it.full_screen);
        let attributes =
            platform::attributes().with_fullscreen(whole.then_some(Fullscreen::Borderless(None)));
        match event_loop.create_window(attributes) {
            Ok(window) => self.window = Some(Arc::new(window)),
            Err(why) => return self.fail(event_loop, format!("no window ({why})")),
        }
        self.title();
        self.open_graphics(event_loop);
        self.last = Instant::now();
    }

    #[cfg(target_arch = "wasm32")]
    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: Event) {
        self.take_event(event_loop, event);
    }

    fn about_to_wait(&mut self, _: &ActiveEventLoop) {
        // While all moves, each frame looks.
        if self.visible && !self.session.animated() && self.look_under_pointer() {
            self.redraw();
        }
    }

    fn exiting(&mut self, _: &ActiveEventLoop) {
        self.complete_film();
        self.remember();
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
        if !matches!(event, WindowEvent::RedrawRequested) {
            graphics.touch();
        }
        // Keys are for the table of keys: egui gets none.
        let is_key = matches!(event, WindowEvent::KeyboardInput { .. });
        let taken = !is_key && (graphics.on_event(&event) || self.session.list.is_some())
            || panel::leaves(&self.session, graphics.size(), graphics.scale()).0 as f32
                <= self.mouse.pointer[0];
        if let WindowEvent::MouseInput { state, .. } = event {
            self.session.history.hold(state == ElementState::Pressed);
        }
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
            WindowEvent::ModifiersChanged(held) => {
                self.shift = held.state().shift_key();
                self.control = held.state().control_key();
            }
            WindowEvent::Focused(false) => self.let_go(),
            WindowEvent::KeyboardInput { event, .. } if event.state == ElementState::Pressed => {
                self.press_key(event_loop, &event);
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
            } if self.mouse.button == Some(button) => {
                if button == MouseButton::Right
                    && self.mouse.is_click()
                    && self.mouse.drag == Drag::Pan
                {
                    self.click();
                }
                self.let_go();
                self.redraw();
            }
            WindowEvent::DroppedFile(path) => {
                if self.session.open(&path) {
                    self.scene_changed();
                }
                self.redraw();
            }
            WindowEvent::CursorMoved { position, .. } => {
                self.mouse.inside = true;
                self.move_to(position);
            }
            WindowEvent::CursorLeft { .. } => self.mouse.inside = false,
            WindowEvent::MouseWheel { delta, .. } if !taken => {
                self.scroll(delta);
                self.redraw();
            }
            WindowEvent::MouseInput { .. } | WindowEvent::MouseWheel { .. } => self.redraw(),
            WindowEvent::RedrawRequested if self.visible => self.frame(event_loop),
            _ => {}
        }
    }
}
