//! The door of a session: what a user asks for, by a key or the mouse, is carried out by its part.

use super::action::{Action, MeasureRequest, PanelKey, RunAction};
use super::state::Session;
use super::{asking, begin, panel, replace};
use super::{plotting, traces::PlotRequest};

/// Carries out an action, and returns whether it changed the scene. Those on a solver are for the
/// run of pane `at`; those of the window do nothing here.
pub fn apply(session: &mut Session, action: impl Into<Action>, at: usize) -> bool {
    let own = &mut session.panel;
    match action.into() {
        Action::Run(action) => return session.act(action, at),
        Action::Window(_) => {}
        Action::Panel(request) => return panel::apply(session, request),
        Action::Measure(request) => return asking::apply(session, request, panel::pane(session)),
        Action::Learn(request) => {
            return own.lessons.apply(request, &mut own.all_marked) && begin_step(session);
        }
        Action::Plot(request) => {
            if let Some(said) = plotting::apply(&mut own.plotting, &mut session.runs.panes, request)
            {
                session.readings.say(said);
            }
        }
        Action::Type(key) if own.has(RunAction::Lessons) => {
            own.lessons.type_key(key, &mut own.all_marked);
        }
        Action::Type(key) => panel::type_key(session, key),
    }
    false
}

/// Begins the run of the step of a lesson that is shown, and returns whether that was possible.
fn begin_step(session: &mut Session) -> bool {
    let Some((_, step)) = session.panel.lessons.shown() else {
        return false;
    };
    match begin::step(step) {
        Ok(next) => replace::replace(session, next),
        Err(why) => {
            session.readings.warn(why.to_string());
            return false;
        }
    }
    true
}

/// Returns the action of a key in what is open beside the picture. With `other`, a knob turns by
/// the other step of its scale.
pub fn action_beside(session: &Session, key: PanelKey, other: bool) -> Option<Action> {
    let by = match key {
        PanelKey::Left => Some(-1),
        PanelKey::Right => Some(1),
        _ => None,
    };
    match session.panel.beside.filter(|_| !session.readings.help)? {
        RunAction::Panel => Some(panel::request(session, key, other).into()),
        RunAction::Lessons => session.panel.lessons.request(key).map(Action::Learn),
        RunAction::Measure => match (by, key) {
            (Some(by), _) => {
                let next = session.measuring.question.neighbour(by);
                Some(MeasureRequest::Ask(next).into())
            }
            (None, PanelKey::Toggle) => Some(MeasureRequest::Toggle.into()),
            _ => None,
        },
        _ => Some(PlotRequest::Mode(session.panel.plotting.mode.neighbour(by?)).into()),
    }
}

/// Returns whether keys type something: the value of a knob, or the answer to a question.
pub fn is_typing(session: &Session) -> bool {
    session.shows(RunAction::Lessons) && session.panel.lessons.typing
        || session.shows(RunAction::Panel) && session.panel.typed.is_some()
}

/// Removes the ruler of the former scene and, if the plots are open, plots what moves alone.
pub fn begin_plots(session: &mut Session) {
    session.panel.plotting.ruler = None;
    if session.panel.has(RunAction::Plots) {
        plotting::pick_first(&mut session.runs.panes);
    }
}
