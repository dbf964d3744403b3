//! Mass-spring systems and the integrators that step them.
//!
//! The crate computes and nothing else: no files, no clock, no window, no GPU.
//!
//! * [`ParticleSystem`] is a first-order system y' = f(t, y); [`Mechanics`] is one with forces and masses.
//! * [`Integrator`]s step any [`ParticleSystem`]; [`integrators::METHODS`] lists them.
//! * [`Network`] is particles and springs with the forces a scene asked for; [`scenes::SCENES`] lists the scenes.
//! * [`Simulation`] is scene x method x time, with the hands that pull at it.
//!
//! ```
//! use a3_core::{Simulation, integrators, scenes};
//!
//! let scene = scenes::find("chain").unwrap().build(None)?;
//! let method = integrators::find("rk4").unwrap();
//! let mut simulation = Simulation::new(scene, method, 0.01)?;
//! simulation.advance_to(1.0)?;
//! assert!(simulation.position(3).y < 0.0);
//! # Ok::<(), a3_core::Error>(())
//! ```

#![forbid(unsafe_code)]

pub mod accuracy;
pub mod colliders;
pub mod constraints;
mod error;
pub mod forces;
mod grid;
pub mod integrators;
mod linear;
mod network;
mod path;
mod random;
mod rows;
pub mod scenes;
mod sheet;
mod simulation;
mod spring;
pub mod stability;
mod system;
mod threads;

pub use constraints::Constraint;
pub use error::{BlowUp, Cause, Error};
pub use grid::{Grid, MAX_PARTICLES};
pub use integrators::{Integrator, Method, Work};
pub use nalgebra::Vector3;
pub use network::{Energy, Network};
pub use path::{Path, Place};
pub use scenes::{Model, Scene, SceneEntry, Surface, Swing, View};
pub use sheet::Sheet;
pub use simulation::Simulation;
pub use spring::{Spring, SpringKind, SpringLaw};
pub use system::{Coupling, Matrix, Mechanics, ParticleSystem};
