//! Requests of keys and mouse to the panel.

use super::dial::{Dial, Turn};
use super::knobs::{KNOBS, Knob};
use crate::session::{Action, Session};

/// A change that the user asks for in the panel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Choose a row, by its number in the table of knobs.
    Choose(usize),
    /// Turn the knob of that number.
    Turn(usize, Turn),
    /// Do what a key does.
    Act(Action),
    /// Take the entry of this number from the list that is open.
    Take(usize),
    /// Close that list.
    CloseList,
}

/// A key with a meaning in the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKey {
    /// Chooses the row above.
    Up,
    /// Chooses the row below.
    Down,
    /// Turns the knob down.
    Left,
    /// Turns the knob up.
    Right,
    /// Toggles a switch; turns another knob to the scene's own value.
    Toggle,
}

/// Whether the panel is seen: the help hides it.
pub fn is_shown(session: &Session) -> bool {
    session.panel.open && !session.readings.help
}

/// The rows that have a meaning for the chosen pane, by their numbers in the table.
pub fn rows(session: &Session) -> Vec<(usize, &'static Knob, Dial)> {
    let at = pane(session);
    let rows = KNOBS.iter().enumerate();
    rows.filter_map(|(k, knob)| Some((k, knob, (knob.read)(session, at)?)))
        .collect()
}

/// The number of the pane that the panel is about.
pub fn pane(session: &Session) -> usize {
    session.panel.pane.min(session.panes.len() - 1)
}

/// Does what a key means while the panel is seen, and says whether it means something there. With
/// `other` a knob turns in the other steps of its scale.
pub fn press(session: &mut Session, key: PanelKey, other: bool) -> bool {
    if !is_shown(session) {
        return false;
    }
    let rows: Vec<_> = rows(session).iter().map(|(k, ..)| *k).collect();
    // In another scene the row may be gone: then the nearest one above it is chosen.
    let chosen = session.panel.row;
    let at = rows.iter().rposition(|k| *k <= chosen).unwrap_or(0);
    let turn = match key {
        PanelKey::Up => {
            session.panel.row = rows[(at + rows.len() - 1) % rows.len()];
            return true;
        }
        PanelKey::Down => {
            session.panel.row = rows[(at + 1) % rows.len()];
            return true;
        }
        PanelKey::Left => Turn::By { up: false, other },
        PanelKey::Right => Turn::By { up: true, other },
        PanelKey::Toggle => Turn::Toggle,
    };
    apply(session, Request::Turn(rows[at], turn));
    true
}

/// Makes the change that was asked for, and returns whether another scene is shown.
pub fn apply(session: &mut Session, request: Request) -> bool {
    let at = pane(session);
    match request {
        Request::Choose(row) => session.panel.row = row,
        Request::Turn(row, turn) => {
            session.panel.row = row;
            KNOBS[row].turn(session, at, turn);
        }
        Request::Act(action) => return session.act(action, at),
        Request::Take(number) => return session.take(number),
        Request::CloseList => session.list = None,
    }
    false
}
