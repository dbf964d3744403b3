//! Scenes and units of errors in words.

use a3_core::Scene;
use a3_core::accuracy::Metric;

use crate::cli::What;

/// Returns the unit of a metric, in words.
pub fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Position => "m",
        Metric::State => "in its unit",
        Metric::Energy => "J",
        Metric::Strain => "of length",
        Metric::Momentum => "kg m/s",
        Metric::Penetration => "of thickness",
        Metric::Phase | Metric::Impact => "s",
    }
}

/// Words for a scene: what its data and its chart are called.
pub struct Label {
    /// Name in the data; for a scene from a file, with a hash of its files.
    pub name: String,
    /// Description in the title.
    pub title: String,
    /// Whether the wind was turned on, for the data.
    pub wind: bool,
    /// Whether the pins were set swinging, for the data.
    pub swing: bool,
    /// Whether surfaces were made to touch, for the data.
    pub self_collision: bool,
}

impl Label {
    /// Creates the label of a scene that the command line asks for, with its name in the data.
    pub fn asked(what: &What, scene: &Scene, name: String) -> Self {
        Self {
            name,
            title: describe(what, scene),
            wind: what.wind,
            swing: what.swing,
            self_collision: what.self_collision,
        }
    }

    /// Creates the label of a scene as it is.
    pub fn of(scene: &Scene) -> Self {
        let grid = scene.grid();
        let grid = grid.map_or(String::new(), |g| format!(" {} × {}", g.rows(), g.cols()));
        Self {
            name: scene.name.clone(),
            title: format!("{}{grid}", scene.name),
            wind: false,
            swing: false,
            self_collision: false,
        }
    }
}

/// Describes the scene in words: its name, its grid, and the options that are on.
pub fn describe(what: &What, scene: &Scene) -> String {
    let scene = Label::of(scene).title;
    let wind = if what.wind { ", wind" } else { "" };
    let swing = if what.swing { ", swing" } else { "" };
    let touch = if what.self_collision {
        ", self-collision"
    } else {
        ""
    };
    format!("{scene}{wind}{swing}{touch}")
}
