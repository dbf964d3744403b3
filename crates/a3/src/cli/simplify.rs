//! The options of `a3 simplify`.

use std::path::PathBuf;

use clap::Args;

use super::measures::ErrorScope;
use super::run::What;
use super::values::{error, horizon, picture_size};

#[derive(Args)]
pub struct Simplify {
    #[command(flatten)]
    pub what: What,
    /// Largest allowed error of the positions, in m, such as 1e-2; it covers omitted parts, a
    /// coarser grid and the time steps together
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    pub error: f64,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// Compare the path of the centre of mass instead of the positions of the particles: it means
    /// something for longer where the motion is chaotic
    #[arg(long, conflicts_with = "particle")]
    pub centre: bool,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// File for the leanest scene, ending in .toml, with its solver and step
    #[arg(long, short, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// Chart of the error against the cost, with the grid and the step both varied, ending in .svg,
    /// .pdf or .png
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Width and height of the chart in pixels, 96 to the inch, or `column`, 340x360, for a column
    /// of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}
