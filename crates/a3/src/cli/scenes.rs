//! The options of `a3 scenes`.

use a3_core::Grid;
use clap::Args;

use super::names::SCENE;
use super::values::grid;

#[derive(Args)]
pub struct Scenes {
    /// Print the file of a scene, as a start for one of your own
    #[arg(long, value_name = "NAME", value_parser = SCENE, hide_possible_values = true)]
    pub print: Option<String>,
    /// Print the scene as JSON with its masses, springs, pins, gravity, drag, and the positions and
    /// velocities at the start, for programs that read no scene files; a3 reads this file too
    #[arg(long, requires = "print")]
    pub list: bool,
    /// Rows and columns of the cloth in the list, such as 10x10
    #[arg(long, value_name = "ROWSxCOLS", requires = "list", value_parser = grid, allow_hyphen_values = true)]
    pub grid: Option<Grid>,
    /// Print the JSON Schema of scene files, with which editors complete and check them
    #[arg(long, conflicts_with = "print")]
    pub schema: bool,
}
