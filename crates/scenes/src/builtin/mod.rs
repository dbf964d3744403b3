//! Built-in scenes: files like those that users write, in one table.

use a3_core::{Error, Grid};

use crate::description::Description;
use crate::setup::Setup;

/// Built-in scene.
#[derive(Debug)]
pub struct SceneEntry {
    /// Name on the command line.
    pub name: &'static str,
    /// Text of its file.
    pub text: &'static str,
}

impl SceneEntry {
    /// Reads the description in its file.
    ///
    /// # Errors
    /// Never fails for a scene of [`SCENES`].
    pub fn description(&self) -> Result<Description, Error> {
        Ok(Description::parse(self.text)?)
    }

    /// Builds the scene with this grid, or with its own.
    ///
    /// # Errors
    /// The scene has no grid, and one is given.
    pub fn build(&self, grid: Option<Grid>) -> Result<Setup, Error> {
        let no_files = &mut |name: &str| Err(format!("{name}: built-in scenes have no files"));
        Ok(self.description()?.build(grid, no_files)?)
    }
}

macro_rules! entry {
    ($name:literal) => {
        SceneEntry { name: $name, text: include_str!(concat!($name, ".toml")) }
    };
}

/// All built-in scenes, in the order in which the window shows them.
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
    entry!("t-handle"),
    entry!("boxes"),
    entry!("dominoes"),
    entry!("ball-on-cloth"),
    entry!("drop"),
    entry!("dam-break"),
    entry!("cantilever"),
];

/// Finds the scene with this name.
///
/// ```
/// use a3_core::Grid;
///
/// let entry = a3_scenes::find("cloth").unwrap();
/// let setup = entry.build(Some(Grid::new(5, 6)?))?;
/// assert_eq!(setup.scene.model.particles(), 30);
/// # Ok::<(), a3_core::Error>(())
/// ```
#[must_use]
pub fn find(name: &str) -> Option<&'static SceneEntry> {
    SCENES.iter().find(|scene| scene.name == name)
}
