//! What is under the pointer: its shape says what a press would do, and what the press would take
//! is highlighted.

use egui::CursorIcon;

use super::mouse::CLICK;
use super::pointer::Drag;
use super::state::App;
use crate::hud::panel;
use crate::show::Target;

impl App {
    /// Looks what is under the pointer, and returns whether the picture changes by that.
    pub fn look_under_pointer(&mut self) -> bool {
        let at = self.pointed();
        let (cursor, hovered) = match self.mouse.drag {
            Drag::Pull(_) => (CursorIcon::Grabbing, None),
            Drag::Orbit => (CursorIcon::AllScroll, None),
            Drag::Pan => (CursorIcon::Move, None),
            Drag::Scrub => (CursorIcon::ResizeHorizontal, None),
            Drag::Select { .. } => (CursorIcon::Crosshair, None),
            Drag::None if !self.over_picture() => (CursorIcon::Default, None),
            Drag::None if self.timeline_share(CLICK).is_some() => {
                (CursorIcon::ResizeHorizontal, None)
            }
            Drag::None if self.shift => (CursorIcon::Crosshair, None),
            Drag::None => match self.hit(at).map(|(target, _)| target) {
                Some(target @ Target::Particle(_)) => (CursorIcon::Grab, Some(target)),
                Some(target @ Target::Obstacle(_)) => (CursorIcon::Move, Some(target)),
                None => (CursorIcon::Default, None),
            },
        };
        let mut changed = self.cursor != cursor;
        self.cursor = cursor;
        for (k, pane) in self.session.runs.panes.iter_mut().enumerate() {
            let hovered = hovered.filter(|_| k == at);
            changed |= pane.show.hovered != hovered;
            pane.show.hovered = hovered;
        }
        changed
    }

    /// Whether the pointer is over the picture, where presses act on the scene.
    fn over_picture(&self) -> bool {
        let Some(graphics) = &self.graphics else {
            return false;
        };
        let session = &self.session;
        let (size, [x, y]) = (graphics.size(), self.mouse.pointer);
        let free = panel::leaves(session, size, graphics.scale());
        let inside = (0.0..free.0 as f32).contains(&x) && (0.0..free.1 as f32).contains(&y);
        inside && self.mouse.inside && session.list.is_none() && !session.readings.help
    }
}
