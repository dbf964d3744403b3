//! Requests of keys and mouse to the panel.

use super::dial::{Dial, Turn};
use super::knobs::{KNOBS, Knob};
use crate::window::session::{Action, Session, TextKey};

/// A request of the mouse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Request {
    /// Do what a key does.
    Act(Action),
    /// Change the panel, what it tunes, or the list that is open.
    Change(PanelRequest),
}

/// A request of the mouse to the panel, or to the list that is open.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PanelRequest {
    /// Choose a row, by its number in the table of knobs.
    ChooseRow(usize),
    /// Type a value for the knob of that number.
    Type(usize),
    /// Turn the knob of that number.
    Turn(usize, Turn),
    /// Take the entry of this number from the list that is open.
    TakeEntry(usize),
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
    session.panel.pane.min(session.runs.panes.len() - 1)
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
    apply(session, PanelRequest::Turn(rows[at], turn));
    true
}

/// Makes the change that was asked for, and returns whether another scene is shown.
pub fn apply(session: &mut Session, request: PanelRequest) -> bool {
    let at = pane(session);
    // What was typed and not taken is given up.
    session.panel.typed = None;
    match request {
        PanelRequest::Type(row) => {
            session.panel.row = row;
            session.panel.typed = Some(String::new());
        }
        PanelRequest::ChooseRow(row) => session.panel.row = row,
        PanelRequest::Turn(row, turn) => {
            session.panel.row = row;
            KNOBS[row].turn(session, at, turn);
        }
        PanelRequest::TakeEntry(number) => return session.take_entry(number),
        PanelRequest::CloseList => session.list = None,
    }
    false
}

/// Does what a key means while a value is typed for the chosen row, and says whether one is.
pub fn press_text(session: &mut Session, key: TextKey) -> bool {
    if !is_shown(session) {
        session.panel.typed = None;
    }
    let Some(typed) = &mut session.panel.typed else {
        return false;
    };
    match key {
        TextKey::Type(letter) => typed.push(letter),
        TextKey::Erase => drop(typed.pop()),
        TextKey::Cancel => session.panel.typed = None,
        TextKey::Move(_) => {}
        TextKey::Accept => {
            let (typed, row) = (typed.clone(), session.panel.row);
            match value(session, row, &typed) {
                Ok(value) => {
                    apply(session, PanelRequest::Turn(row, Turn::Exactly(value)));
                }
                Err(why) => session.readings.say(format!("{}: {why}", KNOBS[row].name)),
            }
        }
    }
    true
}

/// The value that was typed for a knob: a number, or a fraction such as 1/60.
fn value(session: &Session, row: usize, typed: &str) -> Result<f64, String> {
    let dial = (KNOBS[row].read)(session, pane(session));
    let [from, to] = dial.and_then(|dial| dial.scale.ends()).ok_or("gone")?;
    if typed.contains(',') {
        let point = typed.replace(',', ".");
        return Err(format!("use a decimal point: {point}"));
    }
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match typed.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(a, b)| a / b),
        None => number(typed),
    };
    let value = value.filter(|value| (from..=to).contains(value));
    value.ok_or_else(|| format!("must be a number from {from} to {to}"))
}
