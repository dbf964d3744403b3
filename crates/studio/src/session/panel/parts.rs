//! Parts of the scene: which are in the runs, and what they cost and change, in words.

use a3_files::rounding::short;
use a3_scenes::PartChange;

use super::knobs::{KNOBS, row_of};
use super::tune::leave_out;
use crate::session::{Change, Effect, Session, Turn};

/// Share of the work below which a part costs next to nothing: timings are no more accurate.
const MIN_COST: f64 = 0.01;

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

/// Describes what a part costs and changes.
pub fn effect_in_words(effect: &Effect) -> String {
    let cost = effect.cost.map(|share| {
        let percent = 100.0 * share.abs();
        if share.abs() < MIN_COST {
            "under 1 % of the work".into()
        } else if share < 0.0 {
            format!("saves {percent:.0} % of the work")
        } else {
            format!("{percent:.0} % of the work")
        }
    });
    let change = effect.change.map(|change| {
        let time = short(change.time, 2);
        if change.distance < 2.0 * change.error {
            format!("less than {} in {time} s", length(2.0 * change.error))
        } else if change.distance == 0.0 {
            format!("nothing in {time} s")
        } else {
            format!("{} in {time} s", length(change.distance))
        }
    });
    let words: Vec<_> = cost.into_iter().chain(change).collect();
    if words.is_empty() {
        "cannot be measured".into()
    } else {
        words.join(", ")
    }
}

/// Writes a length (m) with two digits, in m, cm, mm or µm.
fn length(metres: f64) -> String {
    let (factor, unit) = match metres {
        long if long >= 0.995 => (1.0, "m"),
        long if long >= 9.95e-3 => (1e2, "cm"),
        long if long >= 9.95e-5 => (1e3, "mm"),
        _ => (1e6, "µm"),
    };
    let value = factor * metres;
    let places = usize::from(value < 9.95);
    format!("{value:.places$} {unit}")
}
