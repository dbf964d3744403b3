//! A session, independent of a window: one run or several side by side in real time, the
//! interaction with them, their reference, the timeline, and the actions of keys.

mod action;
mod acts;
mod apply;
pub mod asking;
pub mod begin;
mod continued;
mod dial;
mod editor;
pub mod exchange;
mod hands;
mod history;
mod keys;
mod lessons;
mod list;
pub mod looks;
mod measuring;
mod opening;
mod origin;
mod pane;
pub mod panel;
pub mod panes;
mod passage;
pub mod plotting;
mod question;
mod reference;
mod replace;
mod rows;
mod runs;
mod samples;
mod save;
mod scenes;
mod state;
mod timeline;
mod traces;
mod tuning;
mod view;
mod words;

pub use action::{Action, RunAction, WindowAction};
pub use action::{LessonRequest, MeasureRequest, PanelKey, PanelRequest};
pub use apply::{action_beside, apply, begin_plots, is_typing};
pub use dial::{Dial, DialScale, Turn};
pub use editor::{Measure, Tool};
pub use history::{Change, EditChange, Recorded};
pub use keys::{Binding, FINGERS, GROUPS, Group, IS_PAGE, MOUSE, action, is_here};
pub use lessons::{Given, Lessons};
pub use list::{Entry, TextKey, Topic};
pub use measuring::Progress;
pub use opening::Opening;
pub use origin::{Origin, begins_crossed};
pub use pane::Pane;
pub use passage::Passage;
pub use question::{Answer, Answerer, Diagram, MethodSetting, Question, Task};
pub use replace::show_edited;
pub use samples::{SPAN, Sample, Samples};
pub use save::write_scene;
pub use state::{Beginning, Session};
pub use state::{FilmProgress, Readings, Selection};
pub use timeline::TimelinePosition;
pub use traces::{Kind, Mode, Pick, PlotFile, Row, SPANS, Trigger, Variable};
pub use traces::{PlotRequest, Quantity, RulerEnd};
pub use tuning::{DEFAULT_FILM_SECONDS, Hidden, Tuning};

#[cfg(test)]
pub use keys::bindings;
#[cfg(test)]
pub use pane::Cost;
#[cfg(test)]
pub use tests::{compared, frames, session, times};
pub use words::read;

#[cfg(test)]
mod tests {
    //! Sessions for tests.

    use super::{Session, begin, words};

    /// Creates the session of a command line.
    pub fn session(words: &[&str]) -> Session {
        let owned: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
        begin::session(&words::read(&owned).unwrap()).unwrap()
    }

    /// Creates a comparison, advanced to a time (s) in frames of 60 Hz.
    pub fn compared(words: &[&str], time: f64) -> Session {
        let mut session = session(&[&["compare"], words].concat());
        frames(&mut session, time);
        session
    }

    /// Advances a session by a time (s) in frames of 60 Hz.
    pub fn frames(session: &mut Session, time: f64) {
        for _ in 0..(60.0 * time).round() as u32 {
            session.tick(1.0 / 60.0);
        }
    }

    /// Returns the simulated time of each run (s).
    pub fn times(session: &Session) -> Vec<f64> {
        let times = session.runs.panes.iter().map(|pane| pane.simulation.time());
        times.collect()
    }
}
