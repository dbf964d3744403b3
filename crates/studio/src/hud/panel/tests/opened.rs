//! Sessions with an open panel, and the values of its rows.

use crate::hud::panel::dial::Turn;
use crate::hud::panel::request::{PanelKey, PanelRequest, apply, part_row, press, rows};
use crate::session::{RunAction, Session, session};

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
    assert!(press(session, key, shift), "{key:?}");
}

/// Returns the names and values of all rows.
pub fn dials(session: &Session) -> Vec<(&'static str, f64)> {
    let rows = rows(session).into_iter();
    rows.map(|(_, knob, dial)| (knob.name, dial.value))
        .collect()
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
    apply(session, PanelRequest::Turn(row, Turn::Toggle));
}
