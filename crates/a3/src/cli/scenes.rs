//! The options of `a3 scenes`.

use clap::Args;

use super::names::SCENE;

#[derive(Args)]
pub struct Scenes {
    /// Print the file of a scene, as a start for one of your own
    #[arg(long, value_name = "NAME", value_parser = SCENE, hide_possible_values = true)]
    pub print: Option<String>,
    /// Print the JSON Schema of scene files, with which editors complete and check them
    #[arg(long, conflicts_with = "print")]
    pub schema: bool,
}
