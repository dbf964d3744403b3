//! The tuning of a scene as a whole: values of knobs, and its parts: which are in the runs, and
//! what was measured of them.

use a3_core::{Network, Simulation};
use a3_scenes::PartChange;

use super::knobs::{KNOBS, is_left_out, row_of};
use super::values::sphere;
use crate::session::{Change, Question, RunAction, Session, Turn, exchange};

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
        return (is_in(session, part) == to).then_some(()).ok_or_else(refused);
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
    let state = if is_in(session, part) { "in" } else { "left out" };
    format!("{name}: {state}")
}

/// Returns the row of a part in the table of what can be left out, if that was measured.
pub fn measured(session: &Session, part: usize) -> Option<&[String]> {
    let known = session.measuring.known_of(Question::Simplify)?;
    let mut rows = known.answer.as_ref().ok()?.report.rows.iter();
    let name = &session.tuning.parts[part].name;
    rows.find(|row| row.first() == Some(name)).map(Vec::as_slice)
}

/// Begins the name of a value that says that a part is left out.
const WITHOUT: &str = "without ";
/// Name of the knob that lets surfaces touch.
const TOUCHING: &str = "self-collision";

/// Returns the names and values of all knobs that tune the scene and differ from its own values,
/// and the parts that are left out.
pub fn tuned(session: &Session) -> Vec<(String, f64)> {
    let tuning = &session.tuning;
    let names = tuning.left_out.iter().map(|k| &tuning.parts[*k].name);
    let without = names.map(|name| (format!("{WITHOUT}{name}"), 1.0));
    let parked = tuning.parked.iter().cloned();
    knobs(session).chain(parked).chain(without).collect()
}

/// Returns the names and values of the knobs that tune parts that are there, and differ from the
/// scene's own values.
fn knobs(session: &Session) -> impl Iterator<Item = (String, f64)> {
    let knobs = KNOBS.iter().filter(|knob| knob.tunes_scene && !is_left_out(session, knob.name));
    let dials = knobs.filter_map(|knob| Some((knob.name, (knob.read)(session, 0)?)));
    let other = dials.filter(|(_, dial)| dial.value != dial.own);
    other.map(|(name, dial)| (name.into(), dial.value))
}

/// Tunes the scene of a session to `tuned`, by names and values, and resets all other knobs that
/// tune it. Leaves out the parts that are named there, and no others. Fails, and changes nothing,
/// if the parts cannot be left out.
pub fn tune(session: &mut Session, tuned: &[(String, f64)]) -> Result<(), String> {
    let is_named = |name: &str| {
        let mut names = tuned.iter().filter_map(|(name, _)| name.strip_prefix(WITHOUT));
        names.any(|other| other == name)
    };
    let parts = session.tuning.parts.iter().enumerate();
    let named = parts.filter(|(_, part)| is_named(&part.name));
    let left_out: Vec<_> = named.map(|(k, _)| k).collect();
    if left_out != session.tuning.left_out {
        if session.runs.first().blow_up().is_some() {
            session.act(RunAction::Reset, 0);
        }
        exchange::leave_out(session, left_out)?;
        // Obstacles may have other numbers now than in the changes by hand.
        session.history.clear();
    }
    turn_knobs(session, tuned);
    Ok(())
}

/// Turns all knobs that tune the scene to `tuned` or to the scene's own values. Values of knobs
/// that the scene does not have now are parked.
fn turn_knobs(session: &mut Session, tuned: &[(String, f64)]) {
    session.tuning.parked.clear();
    for knob in KNOBS.iter().filter(|knob| knob.tunes_scene) {
        let value = tuned.iter().find(|(name, _)| name == knob.name);
        let dial = (knob.read)(session, 0).filter(|_| !is_left_out(session, knob.name));
        let Some(dial) = dial else {
            session.tuning.parked.extend(value.cloned());
            continue;
        };
        let value = value.map_or(dial.own, |(_, value)| dial.scale.within(*value));
        if value != dial.value {
            (knob.set)(session, 0, value);
        }
    }
}

/// Leaves out parts, by their indices in order, and brings back all others, while the motion goes
/// on and the scene stays tuned. Fails, and changes nothing, if there is no such scene, or if
/// self-collision is on and surfaces would cross.
pub fn leave_out(session: &mut Session, parts: &[usize]) -> Result<(), String> {
    go_on(session, None, &mut |session| exchange::leave_out(session, parts.to_vec()))
}

/// Exchanges the scene, while the motion goes on and the scene stays tuned. `touching` says whether
/// surfaces touch then, if that changes. Fails, and changes nothing, if the exchange does, or if
/// surfaces touch and would cross.
pub fn go_on(
    session: &mut Session,
    touching: Option<bool>,
    exchange: &mut dyn FnMut(&mut Session) -> Result<exchange::Former, String>,
) -> Result<(), String> {
    let mut values = tuned(session);
    if let Some(on) = touching {
        values.retain(|(name, _)| name != TOUCHING);
        values.push((TOUCHING.into(), f64::from(u8::from(on))));
    }
    let own = |session: &Session| sphere(session, 0).map(|dial| dial.own);
    let first = own(session);
    let former = exchange(session)?;
    // Other spheres grow in proportion to the first, which may be another one now.
    if let (Some(before), Some(now)) = (first, own(session)) {
        let radii = values.iter_mut().filter(|(name, _)| name == "sphere");
        radii.for_each(|(_, radius)| *radius *= now / before);
    }
    turn_knobs(session, &values);
    let mut runs = session.runs.panes.iter().map(|pane| &pane.simulation);
    if let Some(why) = runs.find_map(crossing) {
        exchange::exchange(session, former);
        return Err(format!("Surfaces would cross: {why}"));
    }
    Ok(())
}

/// Returns the error that names the surfaces of a run that cross, if surfaces touch and any do.
fn crossing(run: &Simulation) -> Option<String> {
    let touches = |network: &&Network| network.contact_layer().is_some();
    let network = run.model().network().filter(touches)?;
    let apart = network.check_apart(run.time(), network.halves(run.state()).0);
    apart.err().map(|why| why.to_string())
}
