//! Edits of the scene in the window, each of which is one change for undo and redo.

use std::sync::Arc;

use a3_core::Network;
use a3_scenes::Edit;

use super::tune::go_on;
use crate::window::session::{Change, EditChange, Passage, Removed, Session, exchange};

/// Edits the scene while the motion goes on, and records that as a change of this name. Fails, and
/// changes nothing, if the scene does not allow it.
pub fn edit(session: &mut Session, edit: &Edit, name: &str) -> Result<(), String> {
    let first = session.runs.first();
    let network = first.model().network().ok_or(
        "This scene has no masses: it is a first-order system, without bodies and springs.",
    )?;
    let before = session.scenes.shown.clone();
    let (after, [particles, bodies]) = before.edit(edit, network)?;
    let touches = first.touching();
    // Rigid bodies touch what there is.
    let touching = matches!(edit, Edit::AddBody(_)).then_some(true);
    let there = Passage {
        particles,
        bodies,
        returning: None,
        touching,
    };
    let back = Passage {
        particles: particles.back(),
        bodies: bodies.back(),
        returning: Some(Removed::from(first, particles, bodies)),
        touching: touching.map(|_| touches),
    };
    let origin = after.clone();
    go_on(session, touching, |session| {
        exchange::edit(session, origin, &there)
    })?;
    session.effects.forget();
    session.history.record(Change::Edit(Arc::new(EditChange {
        name: name.into(),
        origins: [before, after],
        passages: [back, there],
    })));
    Ok(())
}

/// Undoes an edit, or with `redo` does it again. Fails, and changes nothing, if surfaces touch and
/// would cross.
pub fn repeat(session: &mut Session, change: &EditChange, redo: bool) -> Result<(), String> {
    let k = usize::from(redo);
    let (origin, passage) = (change.origins[k].clone(), &change.passages[k]);
    go_on(session, passage.touching, |session| {
        exchange::edit(session, origin, passage)
    })?;
    session.effects.forget();
    Ok(())
}

/// Returns whether two particles are of the same rigid body.
pub fn of_one_body(network: &Network, [i, j]: [usize; 2]) -> bool {
    let body = network.body_of(i);
    body.is_some() && body == network.body_of(j)
}
