//! Edits of the scene in the window, and undo and redo of all of the user's changes. Each edit is
//! one change.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, reason = "the page has no tools")
)]

use std::sync::Arc;

use a3_core::{Checkpoint, Network, Simulation};
use a3_scenes::Edit;

use super::knobs::KNOBS;
use super::parts;
use super::tune::go_on;
use crate::session::{Change, EditChange, Passage, Session, exchange, go_to};

/// Undoes the last change, or with `redo` redoes the one undone last, and shows a message.
pub fn undo(session: &mut Session, redo: bool) {
    let Some(change) = session.history.step(redo) else {
        let what = if redo { "redo" } else { "undo" };
        return session.readings.say(format!("There is nothing to {what}."));
    };
    let what = match change {
        Change::Pins {
            particles,
            pinned,
            before,
        } => {
            session.runs.set_pins(&particles, pinned == redo);
            if let (Some(before), false) = (before, redo) {
                session.return_to(&before);
            }
            match (particles.len(), pinned) {
                (1, true) => format!("pin of particle {}", particles[0]),
                (1, false) => format!("release of particle {}", particles[0]),
                (n, true) => format!("{n} pins"),
                (n, false) => format!("release of {n} pins"),
            }
        }
        Change::Push { obstacle, paths } => {
            // If surfaces would cross, the obstacle does not move.
            if let Err(why) = session
                .runs
                .set_obstacle_path(obstacle, paths[usize::from(redo)])
            {
                return session.readings.say(why);
            }
            "push".into()
        }
        Change::Part { part, is_in } => {
            if let Err(why) = parts::set(session, part, is_in == redo) {
                return session.readings.say(why);
            }
            parts::name(session, part)
        }
        Change::Apart { before, after } => {
            go_to(session, if redo { &after } else { &before });
            "surfaces come apart".into()
        }
        Change::Edit { edit, before } => {
            if let Err(why) = super::undo::repeat(session, &edit, before.as_deref(), redo) {
                session.history.step(!redo);
                return session.readings.say(why);
            }
            edit.name.clone()
        }
        Change::Knob {
            row,
            pane,
            from,
            to,
        } => {
            let value = if redo { to } else { from };
            let now = (KNOBS[row].read)(session, pane);
            // A key may have changed the value in the meantime.
            if now.is_some_and(|dial| dial.value != value) {
                (KNOBS[row].set)(session, pane, value);
            }
            let now = (KNOBS[row].read)(session, pane);
            let words = now.map_or(String::new(), |dial| dial.words);
            format!("{} {words}", KNOBS[row].name)
        }
    };
    let did = if redo { "Redone" } else { "Undone" };
    session.readings.say(format!("{did}: {what}."));
}

/// Edits the scene while the motion goes on, and records that as a change of this name. Fails, and
/// changes nothing, if the scene does not allow it.
pub fn edit(session: &mut Session, edit: &Edit, name: &str) -> Result<(), String> {
    session.release();
    let first = session.runs.first();
    let network = first.model().network().ok_or(
        "This scene has no masses: it is a first-order system, without bodies and springs.",
    )?;
    let origin = session.scenes.shown.clone();
    let (after, [particles, bodies]) = origin.edit(edit, network)?;
    let touches = first.touching();
    // Rigid bodies touch what there is.
    let touching = matches!(edit, Edit::AddBody(_)).then_some(true);
    let there = Passage {
        particles,
        bodies,
        touching,
    };
    let back = Passage {
        particles: particles.back(),
        bodies: bodies.back(),
        touching: touching.map(|_| touches),
    };
    let deletes = matches!(
        edit,
        Edit::Disjoin(_) | Edit::RemoveParticle(_) | Edit::RemoveBody(_)
    );
    session.runs.align();
    let before = deletes.then(|| session.runs.all().map(Simulation::moment).collect());
    go_on(session, touching, &mut |session| {
        exchange::edit(session, after.clone(), &there, &[])
    })?;
    session.effects.forget();
    let edit = Arc::new(EditChange {
        name: name.into(),
        origins: [origin, after],
        passages: [back, there],
    });
    session.history.record(Change::Edit { edit, before });
    Ok(())
}

/// Undoes an edit, or with `redo` does it again. Undoing a deletion goes back to the states
/// `before` it. Fails, and changes nothing, if surfaces touch and would cross.
pub fn repeat(
    session: &mut Session,
    change: &EditChange,
    before: Option<&[Checkpoint]>,
    redo: bool,
) -> Result<(), String> {
    let k = usize::from(redo);
    let (origin, passage) = (&change.origins[k], &change.passages[k]);
    let then = before.filter(|_| !redo).unwrap_or_default();
    go_on(session, passage.touching, &mut |session| {
        exchange::edit(session, origin.clone(), passage, then)
    })?;
    session.effects.forget();
    Ok(())
}

/// Returns whether two particles are of the same rigid body.
pub fn of_one_body(network: &Network, [i, j]: [usize; 2]) -> bool {
    let body = network.body_of(i);
    body.is_some() && body == network.body_of(j)
}
