//! The options of `a3 stability`.

use std::path::PathBuf;

use a3_core::Method;
use clap::Args;

use super::names::SOLVER_OR_ALL;
use super::run::What;
use super::values::{picture_size, step};

#[derive(Args)]
pub struct Stability {
    #[command(flatten)]
    pub what: What,
    /// Solvers to examine, such as t,r,v; by default all that can run the scene
    #[arg(long, value_name = "SOLVERS", value_delimiter = ',', value_parser = SOLVER_OR_ALL, hide_possible_values = true)]
    pub solvers: Vec<Option<&'static Method>>,
    /// Step in seconds by which the picture multiplies the eigenvalues; by default the time in
    /// which the fastest motion turns by one radian
    #[arg(long, value_name = "STEP", value_parser = step, allow_negative_numbers = true)]
    pub step: Option<f64>,
    /// Picture to write, ending in .svg, .pdf or .png; by default a3-stability-SCENE.svg
    #[arg(long, short, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// File for all limits in seconds, ending in .json
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Width and height of the picture in pixels, 96 to the inch, or `column`, 340x360, for a
    /// column of a paper
    #[arg(long, value_name = "WxH", default_value = "1400x1000", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}
