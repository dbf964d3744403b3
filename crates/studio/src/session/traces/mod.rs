//! What a user picks to be plotted, and its values over the last minute of a run.

mod pick;
mod series;
mod settings;

pub use pick::{Kind, Pick, Row, Variable};
pub use series::{MAX_PICKS, Traces, Trigger};
pub use settings::{Mode, PlotFile, PlotRequest, PlotSettings, Quantity, RulerEnd, SPANS};
