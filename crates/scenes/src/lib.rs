//! Scenes as text: what a scene file may say, in TOML, and the built-in scenes.
//!
//! ```
//! use a3_core::{Control, Simulation, integrators};
//!
//! let setup = a3_scenes::find("chain").unwrap().build(None)?;
//! let method = integrators::find("rk4").unwrap();
//! let mut simulation = Simulation::new(setup.scene, method, Control::Step(0.01))?;
//! simulation.advance_to(1.0)?;
//! assert!(simulation.position(3).y < 0.0);
//! # Ok::<(), a3_core::Error>(())
//! ```

#![forbid(unsafe_code)]

mod build;
mod builtin;
mod check;
mod description;
mod fault;
mod mesh;
mod setup;
mod snapshot;
mod surface;

pub use builtin::{SCENES, SceneEntry, find};
pub use description::*;
pub use fault::Fault;
pub use mesh::Mesh;
pub use setup::{Defaults, Presentation, Setup, Viewpoint};
pub use surface::Surface;
