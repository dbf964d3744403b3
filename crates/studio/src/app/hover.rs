//! Hovering: the shape of the pointer tells the effect of a press, and the particle, body or
//! obstacle that a press would take is highlighted.

use a3_media::show::Target;
use egui::CursorIcon;

use super::mouse::{Drag, Mouse};
use super::screen::Screen;
use super::tool;
use crate::session::Session;

impl Mouse {
    /// Finds what is under the pointer, and sets the pointer's shape and the highlight. With
    /// `shift`, a press would draw a box. Returns whether shape or highlight changed.
    pub fn update_hover(&mut self, shift: bool, session: &mut Session, screen: &Screen) -> bool {
        let pointer = &self.pointer;
        let at = pointer.pane(session, screen);
        let (cursor, hovered) = match self.drag {
            Drag::Pull(_) => (CursorIcon::Grabbing, None),
            Drag::Orbit => (CursorIcon::AllScroll, None),
            Drag::Pan => (CursorIcon::Move, None),
            Drag::Select { .. } | Drag::Rule => (CursorIcon::Crosshair, None),
            Drag::Tool(_) => (
                CursorIcon::Crosshair,
                tool::target(pointer, session, screen, at),
            ),
            Drag::None if !pointer.is_over_picture(session, screen) => (CursorIcon::Default, None),
            Drag::None if shift || session.panel.plotting.is_ruling() => {
                (CursorIcon::Crosshair, None)
            }
            Drag::None if session.panel.editor.open => (
                CursorIcon::Crosshair,
                tool::target(pointer, session, screen, at),
            ),
            Drag::None => match pointer.hit(session, screen, at).map(|(target, _)| target) {
                Some(target @ Target::Particle(_)) => (CursorIcon::Grab, Some(target)),
                Some(target @ Target::Obstacle(_)) => (CursorIcon::Move, Some(target)),
                None => (CursorIcon::Default, None),
            },
        };
        let mut changed = self.cursor != cursor;
        self.cursor = cursor;
        for (k, pane) in session.runs.panes.iter_mut().enumerate() {
            let hovered = hovered.filter(|_| k == at);
            changed |= pane.show.hovered != hovered;
            pane.show.hovered = hovered;
        }
        changed
    }
}
