//! The built-in scenes: files like those that users write, in one table.

use a3_core::{Error, Grid, Scene};

use crate::Description;

/// A row of the table of scenes.
#[derive(Debug)]
pub struct SceneEntry {
    /// As typed on the command line.
    pub name: &'static str,
    /// Its file.
    pub text: &'static str,
}

impl SceneEntry {
    /// What its file says.
    ///
    /// # Errors
    /// None: that every file can be read is tested.
    pub fn description(&self) -> Result<Description, Error> {
        Ok(Description::parse(self.text)?)
    }

    /// Builds the scene with this grid, or with its own.
    ///
    /// # Errors
    /// A grid is asked of a scene that has none.
    pub fn build(&self, grid: Option<Grid>) -> Result<Scene, Error> {
        let no_files = &mut |name: &str| Err(format!("{name}: built-in scenes have no files"));
        Ok(self.description()?.build(grid, no_files)?)
    }
}

macro_rules! entry {
    ($name:literal) => {
        SceneEntry {
            name: $name,
            text: include_str!(concat!("builtin/", $name, ".toml")),
        }
    };
}

/// Every scene, in the order in which key `t` shows them.
pub static SCENES: &[SceneEntry] = &[
    entry!("cloth"),
    entry!("simple"),
    entry!("pendulum"),
    entry!("chain"),
    entry!("mit"),
    entry!("mit-sphere"),
    entry!("double-pendulum"),
    entry!("flag"),
    entry!("jelly"),
];

/// The scene of this name.
#[must_use]
pub fn find(name: &str) -> Option<&'static SceneEntry> {
    SCENES.iter().find(|scene| scene.name == name)
}
