//! Accuracy of methods on a scene: errors against a reference solution of known uncertainty, and
//! the choice of the cheapest method for an error.

mod choose;
mod frames;
mod hermite;
mod horizon;
mod measure;
mod reference;
mod run;
mod shown;
mod snapshot;
mod trajectory;

pub use choose::{Candidate, Demand, SetBy, Trial, choose, choose_among, choose_by};
pub use choose::{coarser, ladder};
pub use frames::{Frames, GoOn};
pub use horizon::{Horizon, horizon};
pub use measure::{Outcome, measure, measure_by};
pub use reference::Precision;
pub use reference::Reference;
pub use run::{EnclosingStep, FrameState, Visit, run};
pub use shown::{Shown, shown};
pub use snapshot::{Errors, Metric, Scope};
