//! The leanest scene: the parts that it does not need. Each part is left out in turn, and
//! grids are made finer and coarser. Each such model is integrated accurately, and its motion is
//! compared with that of the whole scene. Then the leanest scene is assembled, and measured as a
//! whole.

mod chart;
mod lean;
mod models;
mod table;
mod value;

pub use value::{LeanScene, ModelEffect, SceneRun, Simplified, SimplifyOptions, measure, simplify};
