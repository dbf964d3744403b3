//! Mass-spring systems and the integrators that step them.
//!
//! The crate computes and nothing else: no files, no clock, no window, no GPU.
//!
//! * [`ParticleSystem`] is a first-order system y' = f(t, y); [`Mechanics`] is one with forces and masses.
//! * [`Integrator`]s step any [`ParticleSystem`]; [`integrators::METHODS`] lists them.
//! * [`Network`] is particles and springs with the forces a scene asked for.
//! * [`Simulation`] is scene x method x time, with the hands that pull at it.
//!
//! Build a network, step it, and chart it: how far is each method off, and what does it cost?
//!
//! ```
//! use a3_core::accuracy::{Frames, Reference, measure};
//! use a3_core::{Control, Model, Network, Path, Scene, Spring, SpringKind, SpringLaw, Simulation, Vector3, integrators};
//!
//! // A particle on a spring below a pin.
//! let mut network = Network::new(vec![1.0; 2])?;
//! let law = SpringLaw::new(50.0, 1.0, 0.0)?;
//! network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law })?;
//! network.pin(0, Path::Still(Vector3::zeros()))?;
//! network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
//! // All x, all y, all z; and the velocities after them.
//! let state = vec![0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
//! let scene = Scene::new("pendulum", Model::Network(Box::new(network)), state);
//!
//! let rk4 = integrators::find("rk4").unwrap();
//! let mut run = Simulation::new(scene.clone(), rk4, Control::Step(0.01))?;
//! run.advance_to(1.0)?;
//! assert!(run.position(1).y < -0.9);
//!
//! // The true error of three steps, and their evaluations of the forces.
//! let go_on = || true;
//! let reference = Reference::new(&scene, Frames::new(1.0), &go_on)?.unwrap();
//! let chart: Vec<_> = [0.02, 0.01, 0.005]
//!     .iter()
//!     .map(|step| measure(&scene, rk4, Control::Step(*step), &reference, &go_on))
//!     .collect::<Result<Option<Vec<_>>, _>>()?
//!     .unwrap();
//! assert!(chart.windows(2).all(|w| w[1].errors.position < w[0].errors.position));
//! # Ok::<(), a3_core::Error>(())
//! ```

#![forbid(unsafe_code)]

pub mod accuracy;
mod columns;
pub mod constraints;
pub mod contact;
mod control;
pub mod elements;
mod energy;
mod error;
mod grid;
pub mod integrators;
mod linear;
mod network;
mod path;
mod random;
mod rows;
mod scene;
mod serial;
mod simulation;
mod spring;
pub mod stability;
mod system;
#[cfg(test)]
mod testing;
mod threads;
mod work;

pub use constraints::Constraint;
pub use control::Control;
pub use elements::{Element, Sheet};
pub use energy::Energy;
pub use error::{BlowUp, Cause, Error};
pub use grid::{Grid, MAX_PARTICLES};
pub use integrators::{Integrator, Method, Work};
pub use nalgebra::Vector3;
pub use network::Network;
pub use path::{Path, Place};
pub use rows::{Patch, REACH, Registers, Rows, Stage, SweepScratch, Terms};
pub use scene::{FirstOrder, Model, Scene, Swing};
pub use simulation::{Checkpoint, Grabbed, Progress, Simulation};
pub use spring::{Spring, SpringKind, SpringLaw};
pub use system::{
    AxialCoupling, BlockCoupling, Coupling, Linearized, Matrix, Mechanics, ParticleSystem,
    Splitting,
};

/// The example of the README, compiled as a test of documentation.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
