//! Scenes and units of errors in words.

use a3_core::accuracy::Metric;
use a3_core::{Disturbances, Model, Scene};

/// Returns the unit of a metric, in words.
pub fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Position => "m",
        Metric::State => "of its size",
        Metric::Energy => "J",
        Metric::Strain => "of length",
        Metric::Momentum => "kg m/s",
        Metric::Penetration => "of thickness",
        Metric::Phase | Metric::Impact => "s",
    }
}

/// Says how long runs of a model last: the time of a system of one's own may have any unit.
pub fn lasting(model: &Model, until: f64) -> String {
    match model.network() {
        Some(_) => format!("{until} s"),
        None if (1e-3..1e6).contains(&until.abs()) => format!("t = 0 to {until}"),
        None => format!("t = 0 to {until:e}"),
    }
}

/// Words for a scene: what its data and its chart are called.
pub struct Label {
    /// Name in the data; for a scene from a file, with a hash of its files.
    pub name: String,
    /// Description in the title.
    pub title: String,
    /// What was turned on, for the data.
    pub on: Disturbances,
}

impl Label {
    /// Creates the label of a scene in which these disturbances were turned on, with its name in
    /// the data.
    pub fn asked(on: Disturbances, scene: &Scene, name: String) -> Self {
        Self {
            name,
            title: describe(on, scene),
            on,
        }
    }

    /// Creates the label of a scene as it is.
    pub fn of(scene: &Scene) -> Self {
        Self::asked(Disturbances::default(), scene, scene.name.clone())
    }
}

/// Describes the scene in words: its name, its grid, and the disturbances that were turned on.
pub fn describe(on: Disturbances, scene: &Scene) -> String {
    let grid = scene.grid();
    let grid = grid.map_or(String::new(), |g| format!(" {} × {}", g.rows(), g.cols()));
    let wind = if on.wind { ", wind" } else { "" };
    let swing = if on.swing { ", swing" } else { "" };
    let touch = if on.contact { ", self-collision" } else { "" };
    format!("{}{grid}{wind}{swing}{touch}", scene.name)
}
