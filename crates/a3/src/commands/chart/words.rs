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

/// Describes the scene in words: its name, its grid, and the options that are on.
pub fn describe(what: &What, scene: &Scene) -> String {
    let grid = scene
        .grid()
        .map_or(String::new(), |g| format!(" {} × {}", g.rows(), g.cols()));
    let wind = if what.wind { ", wind" } else { "" };
    let swing = if what.swing { ", swing" } else { "" };
    let touch = if what.self_collision {
        ", self-collision"
    } else {
        ""
    };
    format!("{}{grid}{wind}{swing}{touch}", scene.name)
}
