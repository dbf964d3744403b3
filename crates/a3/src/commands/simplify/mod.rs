//! `a3 simplify`: what a scene can do without. Each part is left out in turn, and grids are made
//! finer and coarser; each model is integrated accurately, and its motion is compared with that of
//! the whole scene. Then the leanest scene is put together, and measured as a whole.

mod chart;
mod command;
mod lean;
mod models;
mod table;

pub use command::run;
