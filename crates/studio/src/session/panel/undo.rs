//! Edits of the scene in the window, and undo and redo of all of the user's changes. Each edit is
//! one change.

use std::sync::Arc;

use a3_core::Network;
use a3_scenes::Edit;

use super::knobs::KNOBS;
use super::parts::{self, go_on};
use crate::session::{Change, EditChange, Passage, Recorded, Session, exchange};

/// Undoes the last change, or with `redo` redoes the one undone last, and shows a message.
pub fn undo(session: &mut Session, redo: bool) {
    if session.runs.first().grabbed_obstacle().is_some() {
        // This push is a change, too.
        session.release();
    }
    let Some(recorded) = session.history.next(redo).cloned() else {
        let what = if redo { "redo" } else { "undo" };
        return session.readings.say(format!("There is nothing to {what}."));
    };
    let now = (!redo && recorded.returns()).then(|| {
        session.release();
        session.runs.align();
        session.runs.moments()
    });
    let said = match apply(session, &recorded, redo) {
        Ok(what) => {
            session.history.step(redo, now);
            format!("{}: {what}.", if redo { "Redone" } else { "Undone" })
        }
        Err(why) => why,
    };
    session.readings.say(said);
}

/// Undoes a change, or with `redo` makes it again, and goes back to its states if they are kept.
/// Returns the name of the change. Fails, and changes nothing, if the scene does not allow it.
fn apply(session: &mut Session, recorded: &Recorded, redo: bool) -> Result<String, String> {
    let states = recorded.states[usize::from(redo)].as_deref();
    Ok(match &recorded.change {
        Change::Pins { particles, pinned } => {
            session.runs.set_pins(particles, *pinned == redo);
            if let Some(states) = states {
                session.return_to(states);
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
            let path = paths[usize::from(redo)];
            session.runs.set_obstacle_path(*obstacle, path)?;
            "push".into()
        }
        Change::Part { part, is_in } => {
            parts::set(session, *part, *is_in == redo)?;
            parts::name(session, *part)
        }
        Change::Apart => {
            session.go_to(states.unwrap_or_default());
            "surfaces come apart".into()
        }
        Change::Edit(edit) => {
            let k = usize::from(redo);
            let (origin, passage) = (&edit.origins[k], &edit.passages[k]);
            go_on(session, passage.touching, &mut |session| {
                let then = states.unwrap_or_default();
                exchange::edit(session, origin.clone(), passage, then)
            })?;
            edit.name.clone()
        }
        Change::Knob { row, pane, from, to } => {
            let (row, pane) = (*row, *pane);
            let value = if redo { *to } else { *from };
            let now = (KNOBS[row].read)(session, pane);
            // A key may have changed the value in the meantime.
            if now.is_some_and(|dial| dial.value != value) {
                (KNOBS[row].set)(session, pane, value);
            }
            let now = (KNOBS[row].read)(session, pane);
            let words = now.map_or(String::new(), |dial| dial.words);
            format!("{} {words}", KNOBS[row].name)
        }
    })
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
    let there = Passage { particles, bodies, touching };
    let back = Passage {
        particles: particles.back(),
        bodies: bodies.back(),
        touching: touching.map(|_| touches),
    };
    let deletes = matches!(edit, Edit::Disjoin(_) | Edit::RemoveParticle(_) | Edit::RemoveBody(_));
    session.runs.align();
    let before = deletes.then(|| session.runs.moments());
    go_on(session, touching, &mut |session| exchange::edit(session, after.clone(), &there, &[]))?;
    let edit = Arc::new(EditChange {
        name: name.into(),
        origins: [origin, after],
        passages: [back, there],
    });
    session.history.record(Change::Edit(edit), before);
    Ok(())
}

/// Returns whether two particles are of the same rigid body.
pub fn of_one_body(network: &Network, [i, j]: [usize; 2]) -> bool {
    let body = network.body_of(i);
    body.is_some() && body == network.body_of(j)
}
