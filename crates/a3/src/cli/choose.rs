//! The options of `a3 choose`.

use a3_core::accuracy::Metric;
use clap::Args;

use super::measures::{ErrorScope, WorkMeasure, metric};
use super::run::What;
use super::values::{budget, error, horizon};

#[derive(Args)]
pub struct Choose {
    #[command(flatten)]
    pub what: What,
    /// Largest error that is allowed, such as 1e-3; it is that of the positions, in m, unless --of
    /// names another
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true, required_unless_present = "budget", conflicts_with = "budget")]
    pub error: Option<f64>,
    /// What counts as the error
    #[arg(long, value_name = "QUANTITY", default_value = "position", value_parser = metric())]
    pub of: Metric,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// What counts as the cost
    #[arg(long, default_value = "time", conflicts_with = "budget")]
    pub work: WorkMeasure,
    /// Computing time in ms for each frame of 1/60 s: the most accurate solver within it is chosen
    #[arg(long, value_name = "MS_PER_FRAME", value_parser = budget, allow_negative_numbers = true)]
    pub budget: Option<f64>,
    /// Leave out the runs on finer and coarser grids that tell how much the grid itself errs
    #[arg(long)]
    pub no_model: bool,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
}
