//! Undoing what the user changed.

use super::knobs::KNOBS;
use crate::window::session::{Change, Session};

/// Undoes the last change, or with `again` does again what was undone last, and says so.
pub fn undo(session: &mut Session, again: bool) {
    let Some(change) = session.history.step(again) else {
        let what = if again { "do again" } else { "undo" };
        return session.readings.say(format!("There is nothing to {what}."));
    };
    let what = match change {
        Change::Pins { particles, pinned } => {
            session.runs.set_pins(&particles, pinned == again);
            match (particles.len(), pinned) {
                (1, true) => format!("pin of particle {}", particles[0]),
                (1, false) => format!("letting go of particle {}", particles[0]),
                (n, true) => format!("{n} pins"),
                (n, false) => format!("letting go of {n} pins"),
            }
        }
        Change::Push { obstacle, paths } => {
            // Where surfaces would cross, the obstacle stays where it is.
            if let Err(why) = session.runs.put_back(obstacle, paths[usize::from(again)]) {
                return session.readings.say(why);
            }
            "push".into()
        }
        Change::Knob {
            row,
            pane,
            from,
            to,
        } => {
            let value = if again { to } else { from };
            let now = (KNOBS[row].read)(session, pane);
            // A key may have changed it meanwhile.
            if now.is_some_and(|dial| dial.value != value) {
                (KNOBS[row].set)(session, pane, value);
            }
            let now = (KNOBS[row].read)(session, pane);
            let words = now.map_or(String::new(), |dial| dial.words);
            format!("{} {words}", KNOBS[row].name)
        }
    };
    let did = if again { "done again" } else { "undone" };
    session.readings.say(format!("{did}: {what}"));
}
