//! The options of `a3 chart`.

use std::path::PathBuf;

use a3_core::Method;
use a3_core::accuracy::Metric;
use clap::Args;

use super::measures::{ErrorScope, WorkMeasure, metric};
use super::names::SOLVER_OR_ALL;
use super::run::What;
use super::values::{factor, horizon, picture_size};

#[derive(Args)]
pub struct Chart {
    #[command(flatten)]
    pub what: What,
    /// Solvers to measure and draw, such as t,r,v, or all; by default all that can run the scene
    /// are measured, and those that are cheapest for some error, and e, t, r and i, are drawn
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = SOLVER_OR_ALL, hide_possible_values = true)]
    pub solvers: Vec<Option<&'static Method>>,
    /// Leave out the runs on finer and coarser grids that tell how much the grid itself errs
    #[arg(long)]
    pub no_model: bool,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// What counts as the error
    #[arg(long, default_value = "position", value_parser = metric())]
    pub error: Metric,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// What counts as the cost
    #[arg(long, default_value = "time")]
    pub work: WorkMeasure,
    /// Factors by which the stiffness of the springs is multiplied, such as 1,10,100; the chart
    /// has a panel for each
    #[arg(long, value_name = "FACTORS", value_delimiter = ',', default_value = "1", value_parser = factor, allow_negative_numbers = true)]
    pub stiffness: Vec<f64>,
    /// Picture to write, ending in .svg, .pdf or .png; by default a3-chart-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// File for all runs, ending in .csv or .json; if it exists, the chart continues from it
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// File for the largest errors of each particle along x, y and z, ending in .csv; runs that
    /// --data has are measured again
    #[arg(long, value_name = "FILE")]
    pub each: Option<PathBuf>,
    /// Show as a light band how much errors of adaptive solvers vary: from each tolerance to three
    /// within 4 % of it
    #[arg(long)]
    pub spread: bool,
    /// Width and height of the picture in pixels, 96 to the inch, or `column`, 340x360, for a
    /// column of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}
