//! Draws cloth, balls, lines and a floor with wgpu: no physics, no window.
//!
//! The same [`Renderer`] draws into a window's surface and into an [`Offscreen`] picture. [`Gpu`] opens an adapter;
//! [`Picture`] says what is to be seen; [`Camera`] from where.

#![forbid(unsafe_code)]

mod buffers;
mod camera;
mod gpu;
mod offscreen;
mod picture;
mod pipelines;
mod renderer;
mod shapes;
mod targets;
mod view;

pub use camera::Camera;
pub use gpu::{Gpu, GpuError};
pub use offscreen::{OFFSCREEN_FORMAT, Offscreen};
pub use picture::{Ball, LOOKS, Line, Picture, Solid, Style, Tile, Topology};
pub use renderer::Renderer;
pub use targets::Targets;
