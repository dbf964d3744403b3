//! Undo and redo of the user's changes.

use super::knobs::KNOBS;
use super::parts;
use crate::window::session::{Change, Session, go_to};

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
            if let Err(why) = super::edit::repeat(session, &edit, before.as_deref(), redo) {
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
