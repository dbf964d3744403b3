//! The options of `a3 solvers`.

use clap::Args;

use super::names::SCENE;

#[derive(Args)]
pub struct Solvers {
    /// Say which solvers serve this scene, and why the others do not: a name that `a3 scenes`
    /// lists, or a file of your own
    #[arg(long, value_name = "NAME|FILE", value_parser = SCENE, hide_possible_values = true)]
    pub scene: Option<String>,
    /// Print which kinds of scenes each solver serves, as a table in Markdown
    #[arg(long, conflicts_with = "scene")]
    pub kinds: bool,
}
