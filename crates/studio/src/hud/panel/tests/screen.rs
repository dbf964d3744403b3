//! The panel in a window without a display, sessions with an open panel, and values of its rows.

use egui::{Event, Pos2, Rect, pos2};

use crate::hud::panel::PANE;
use crate::hud::window::{Window, button};
use crate::session::panel::{part_row, rows};
use crate::session::{Action, PanelKey, PanelRequest, RunAction, Session, Turn};
use crate::session::{action_beside, apply, session};

/// A panel in a window.
pub struct Screen {
    pub window: Window,
    pub size: [f32; 2],
}

impl Screen {
    pub fn new(size: [f32; 2]) -> Self {
        let window = Window::new(size);
        Self { window, size }
    }

    /// Returns the width of the panel (points).
    fn width(&self) -> f32 {
        PANE.taken(self.size)[0]
    }

    /// Runs a frame, and returns the action of the mouse.
    fn frame(&mut self, session: &Session, events: Vec<Event>) -> Option<Action> {
        let pane = session.shows(RunAction::Panel).then_some(PANE);
        let taken = pane.as_ref().map_or([0.0; 2], |pane| pane.taken(self.size));
        self.window.frame(taken, events, |ctx| {
            if let Some(pane) = &pane {
                pane.show(ctx, session);
            }
        })
    }

    /// Returns all text, with its rectangle and the visible part of the screen.
    pub fn written(&mut self, session: &Session) -> Vec<(String, Rect, Rect)> {
        for later in [0.0, 0.0, 10.0] {
            self.window.time += later;
            self.frame(session, vec![]);
        }
        self.window.written()
    }

    /// Returns all text with its rectangles. Nothing may be cut off.
    pub fn read(&mut self, session: &Session) -> Vec<(String, Rect)> {
        self.written(session);
        self.window.read()
    }

    /// Drags the left button from one position to another, or clicks if they are the same, and
    /// carries out the actions.
    pub fn click(&mut self, session: &mut Session, from: Pos2, to: Pos2) {
        for event in [
            vec![Event::PointerMoved(from)],
            vec![button(from, true)],
            vec![Event::PointerMoved(to)],
            vec![button(to, false)],
            vec![],
        ] {
            if let Some(action) = self.frame(session, event) {
                apply(session, action, 0);
            }
        }
    }

    /// Returns the position of a row's value, and the ends of its slider.
    pub fn place(&mut self, session: &Session, name: &str) -> (Pos2, [Pos2; 2]) {
        let texts = self.read(session);
        let left = self.size[0] - self.width();
        let (_, row) =
            texts.iter().find(|(words, rect)| words == name && rect.left() > left).unwrap();
        let (y, margin) = (row.center().y, PANE.margins[0]);
        let at = |x: f32| pos2(left + margin + x, y);
        let wide = self.width() - 2.0 * margin;
        (at(wide - 10.0), [at(82.0), at(wide - 86.0)])
    }
}

pub fn opened(words: &[&str]) -> Session {
    let mut session = session(words);
    session.act(RunAction::Panel, 0);
    session
}

/// Returns a session with an open panel for every built-in scene.
pub fn every_scene() -> impl Iterator<Item = Session> {
    let names = a3_scenes::SCENES.iter().map(|entry| entry.name);
    names.map(|name| opened(&["r", "0.005", "--scene", name]))
}

pub fn type_key(session: &mut Session, key: PanelKey, shift: bool) {
    let action = action_beside(session, key, shift).unwrap();
    apply(session, action, 0);
}

/// Returns the names and values of all rows.
pub fn dials(session: &Session) -> Vec<(&'static str, f64)> {
    let rows = rows(session).into_iter();
    rows.map(|(_, knob, dial)| (knob.name, dial.value)).collect()
}

/// Returns the names of the rows that differ, except the colour scale, which exists only with
/// colours.
pub fn changed(before: &[(&'static str, f64)], session: &Session) -> Vec<&'static str> {
    let always = |row: &&(&'static str, f64)| row.0 != "full colour";
    let after = dials(session);
    let rows = after.iter().filter(always);
    let others = rows.filter(|row| !before.contains(row));
    others.map(|row| row.0).collect()
}

/// Returns the index of a part by its name.
pub fn part(session: &Session, name: &str) -> usize {
    let mut parts = session.tuning.parts.iter();
    parts.position(|part| part.name == name).unwrap()
}

/// Toggles a part by its name.
pub fn toggle(session: &mut Session, name: &str) {
    let row = part_row(part(session, name));
    apply(session, PanelRequest::Turn(row, Turn::Toggle), 0);
}
