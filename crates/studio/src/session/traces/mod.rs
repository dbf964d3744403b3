//! What a user picks to be plotted, and its values over the last minute of a run.

mod pick;
mod section;
mod series;
mod settings;
mod variable;

pub use pick::Pick;
pub use section::Trigger;
pub use series::{MAX_PICKS, Traces};
pub use settings::{Mode, PlotFile, PlotRequest, PlotSettings, Quantity, RulerEnd, SPANS};
pub use variable::{Kind, Row, Variable};
