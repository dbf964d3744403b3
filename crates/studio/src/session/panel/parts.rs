//! Parts of the scene: which are in the runs, and what was measured of them.

use a3_scenes::PartChange;

use super::knobs::{KNOBS, row_of};
use super::tune::leave_out;
use crate::session::{Change, Question, Session, Turn};

/// Returns the row of the knob that turns a part on and off, if there is one.
fn knob(change: PartChange) -> Option<usize> {
    let name = match change {
        PartChange::Wind => "wind",
        PartChange::SelfCollision => "self-collision",
        PartChange::Floor => "floor",
        _ => return None,
    };
    Some(row_of(name))
}

/// Returns whether a part of the scene, by its index, is in the runs as in the scene itself: wind
/// and self-collision may be off there.
pub fn is_as_in_scene(session: &Session, part: usize) -> bool {
    match knob(session.tuning.parts[part].change) {
        Some(row) => (KNOBS[row].read)(session, 0).is_some_and(|dial| dial.value == dial.own),
        None => is_in(session, part),
    }
}

/// Returns whether a part of the scene, by its index, is in the runs.
pub fn is_in(session: &Session, part: usize) -> bool {
    match knob(session.tuning.parts[part].change) {
        Some(row) => (KNOBS[row].read)(session, 0).is_some_and(|dial| dial.value != 0.0),
        None => !session.tuning.left_out.contains(&part),
    }
}

/// Leaves out a part of the scene, by its index, or brings it back, while the motion goes on.
/// Fails, and changes nothing, if that is impossible.
pub fn set(session: &mut Session, part: usize, to: bool) -> Result<(), String> {
    if is_in(session, part) == to {
        return Ok(());
    }
    if let Some(row) = knob(session.tuning.parts[part].change) {
        (KNOBS[row].set)(session, 0, f64::from(u8::from(to)));
        let refused = || session.readings.message.clone().unwrap_or_default();
        return (is_in(session, part) == to)
            .then_some(())
            .ok_or_else(refused);
    }
    let mut parts = session.tuning.left_out.clone();
    parts.retain(|other| *other != part);
    if !to {
        parts.push(part);
        parts.sort_unstable();
    }
    leave_out(session, &parts)
}

/// Leaves out a part of the scene or brings it back, by a turn of its switch, and records that in
/// the history.
pub fn turn(session: &mut Session, part: usize, turn: Turn) {
    let now = is_in(session, part);
    let to = match turn {
        Turn::By { up, .. } => up,
        Turn::Toggle => !now,
        Turn::Own => true,
        Turn::To(value) | Turn::Exactly(value) => value != 0.0,
    };
    if to == now {
        return;
    }
    let done = set(session, part, to).map(|()| {
        let change = Change::Part { part, is_in: to };
        session.history.record(change, None);
        name(session, part)
    });
    session.readings.say(done.unwrap_or_else(|why| why));
}

/// Names a part, and says whether it is in the runs.
pub fn name(session: &Session, part: usize) -> String {
    let name = &session.tuning.parts[part].name;
    let state = if is_in(session, part) {
        "in"
    } else {
        "left out"
    };
    format!("{name}: {state}")
}

/// Returns the row of a part in the table of what can be left out, if that was measured.
pub fn measured(session: &Session, part: usize) -> Option<&[String]> {
    let known = session.measuring.known_of(Question::Simplify)?;
    let mut rows = known.answer.as_ref().ok()?.report.rows.iter();
    let name = &session.tuning.parts[part].name;
    rows.find(|row| row.first() == Some(name))
        .map(Vec::as_slice)
}
