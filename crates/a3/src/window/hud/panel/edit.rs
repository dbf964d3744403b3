//! Edits of the scene in the window. Each edit is one change for undo and redo.

#![cfg_attr(
    target_arch = "wasm32",
    allow(dead_code, reason = "the page has no tools")
)]

use std::sync::Arc;

use a3_core::{Checkpoint, Network, Simulation};
use a3_scenes::Edit;

use super::tune::go_on;
use crate::window::session::{Change, EditChange, Passage, Session, exchange};

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
