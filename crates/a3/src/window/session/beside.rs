//! What opens beside the picture: one sheet at a time.

use super::actions::RunAction;
#[cfg(not(target_arch = "wasm32"))]
use super::plotting;
use super::state::Session;

/// Opens the panel, the measurements, the lessons or the plots beside the picture, or closes
/// it; the others are closed then.
pub fn toggle(session: &mut Session, action: RunAction) {
    if action == RunAction::Measure && session.measuring.answerer.is_none() {
        let why = "Only the program measures: key y copies the command line for it.";
        return session.readings.say(why);
    }
    let panes = [
        (RunAction::Panel, &mut session.panel.open),
        (RunAction::Measure, &mut session.measuring.open),
        (RunAction::Lessons, &mut session.panel.lessons.open),
        (RunAction::Plots, &mut session.panel.plotting.open),
    ];
    for (own, open) in panes {
        *open = own == action && !*open;
    }
    #[cfg(not(target_arch = "wasm32"))]
    if session.panel.plotting.open {
        plotting::pick_first(&mut session.runs.panes);
    }
    if action != RunAction::Panel {
        session.readings.help = false;
        session.list = None;
    }
}
