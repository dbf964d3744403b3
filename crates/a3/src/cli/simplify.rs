//! The options of `a3 simplify`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::measures::ErrorScope;
use super::run::What;
use super::values::{error, horizon, picture_size};

/// Quantity by which models of a scene are compared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Quantity {
    /// Positions of the particles, root mean square (m)
    #[default]
    Position,
    /// Path of the centre of mass (m)
    Centre,
    /// Energy that the motion has gained or lost since the start (J)
    Energy,
}

impl Quantity {
    /// Returns the name of the quantity.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Centre => "centre",
            Self::Energy => "energy",
        }
    }
}

#[derive(Args)]
pub struct Simplify {
    #[command(flatten)]
    pub what: What,
    /// Largest allowed error, in m (J for energy), such as 1e-2; it covers omitted parts, a coarser
    /// grid and the time steps together
    #[arg(long, value_name = "E", value_parser = error, allow_negative_numbers = true)]
    pub error: f64,
    #[command(flatten)]
    pub scope: ErrorScope,
    /// Quantity that is compared; where the motion is chaotic, the centre of mass and the energy
    /// are known for longer than the positions
    #[arg(long, value_name = "QUANTITY", value_enum, default_value_t)]
    pub of: Quantity,
    /// Simulated seconds; by default, as long as errors are meaningful on this scene
    #[arg(long, value_name = "T", value_parser = horizon, allow_negative_numbers = true)]
    pub until: Option<f64>,
    /// File for the leanest scene, ending in .toml, with its solver and step
    #[arg(long, short, value_name = "FILE.toml")]
    pub output: Option<PathBuf>,
    /// File for the effects of all models, ending in .csv or .json; if it exists, models in it are
    /// not measured again
    #[arg(long, value_name = "FILE")]
    pub data: Option<PathBuf>,
    /// Chart of the error against the cost, with the grid and the step both varied, ending in .svg,
    /// .pdf or .png
    #[arg(long, value_name = "FILE")]
    pub chart: Option<PathBuf>,
    /// Width and height of the chart in pixels, 96 to the inch, or `column`, 340x360, for a column
    /// of a paper
    #[arg(long, value_name = "WxH", default_value = "1200x800", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}
