//! A session, independent of a window: one run or several side by side in real time, the
//! interaction with them, their reference, the timeline, and the actions of keys.

mod action;
mod acts;
pub mod asking;
pub mod begin;
mod dial;
mod editor;
pub mod exchange;
mod hands;
mod history;
mod lessons;
mod list;
pub mod looks;
mod measuring;
mod origin;
mod pane;
pub mod panel;
pub mod plotting;
mod reference;
mod rows;
mod runs;
mod save;
mod scenes;
mod state;
mod timeline;
mod traces;
mod tuning;
mod view;
mod words;

pub use action::{Action, RunAction, WindowAction};
pub use action::{Binding, FINGERS, GROUPS, Group, IS_PAGE, MOUSE, action, is_here};
pub use action::{LessonRequest, MeasureRequest, PanelKey, PanelRequest};
pub use acts::{MAX_PANES, action_beside, apply, is_typing};
pub use dial::{Dial, DialScale, Turn};
pub use editor::{Measure, Tool};
pub use history::{Change, EditChange, Recorded};
pub use lessons::{Given, Lessons};
pub use list::{Entry, TextKey, Topic};
pub use measuring::{Answer, Answerer, Diagram, MethodSetting, Progress, Question, Task};
pub use origin::{Origin, Passage, begins_crossed};
pub use pane::Pane;
pub use rows::{SPAN, Sample, Samples};
pub use save::write_scene;
pub use state::{FilmProgress, Rates, Readings, Selection, Session};
pub use timeline::TimelinePosition;
pub use traces::{Kind, Mode, Pick, PlotFile, Row, SPANS, Trigger, Variable};
pub use traces::{PlotRequest, Quantity, RulerEnd};
pub use tuning::{DEFAULT_FILM_SECONDS, Hidden, Tuning};

#[cfg(test)]
pub use action::bindings;
#[cfg(test)]
pub use pane::Cost;
#[cfg(test)]
pub use tests::{compared, frames, session, times};
pub use words::{Opening, read};

#[cfg(test)]
mod tests;
