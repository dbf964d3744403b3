//! Drawing of cloth, balls, lines and a floor with wgpu. Knows no physics and no window.
//!
//! The same [`Renderer`] draws into the surface of a window and into an [`Offscreen`] picture.
//! [`Gpu`] opens an adapter, [`Picture`] says what is drawn, and [`Camera`] from where.

#![forbid(unsafe_code)]

mod buffers;
mod camera;
mod gpu;
mod picture;
mod pipelines;
mod renderer;
mod targets;

pub use camera::Camera;
pub use gpu::{Gpu, GpuError};
pub use picture::{
    Ball, Corner, Floor, LOOKS, Line, Liquid, Picture, STEEL_LOOK, Solid, Spring, Style, Tile,
    Topology,
};
pub use pipelines::{ramp, shaded_by};
pub use renderer::Renderer;
pub use targets::{OFFSCREEN_FORMAT, Offscreen, Part, TEXT_FORMAT, Targets, Transfer};

/// The example of the README, compiled as a test of documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
