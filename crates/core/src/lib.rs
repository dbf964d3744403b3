//! Mass-spring systems and the integrators that step them.
//!
//! The crate computes and does nothing else: it uses no files, no clock, no window and no GPU.
//!
//! * [`ParticleSystem`]: a first-order system y' = f(t, y); [`Mechanics`]: one with forces and
//!   masses.
//! * [`Integrator`]: a method that steps any [`ParticleSystem`]; [`integrators::METHODS`] lists
//!   the methods.
//! * [`Ode`], [`SecondOrder`]: own systems from functions.
//! * [`Method::from_step`], [`Method::new`]: own methods.
//! * [`Network`]: particles with pins, constraints, obstacles and force elements, such as springs.
//! * [`Scene`]: a model, the state it starts from, and what a run of it can be disturbed by.
//! * [`Simulation`]: the run of a scene by a method, which can be disturbed as it goes on.
//!
//! The example builds a network, steps it, and measures the error and the cost of three step
//! lengths.
//!
//! ```
//! use a3_core::accuracy::{Frames, Reference, measure};
//! use a3_core::{
//!     Control, Network, Path, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3,
//!     integrators,
//! };
//!
//! // A particle on a spring below a pin.
//! let mut network = Network::new(vec![1.0; 2])?;
//! let law = SpringLaw::new(50.0, 1.0, 0.0)?;
//! network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law })?;
//! network.pin(0, Path::Still(Vector3::zeros()))?;
//! network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
//! // The state holds all x, all y and all z (m), and then the velocities (m/s) in the same order.
//! let state = vec![0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
//! let scene = Scene::new("pendulum", network, state);
//!
//! let rk4 = integrators::find("rk4").unwrap();
//! let mut run = Simulation::new(scene.clone(), rk4, Control::Step(0.01))?;
//! run.advance_to(1.0)?;
//! assert!(run.position(1).y < -0.9);
//!
//! // Errors against the reference, and the number of evaluations, at three step lengths.
//! let go_on = || true;
//! let reference = Reference::finest(&scene, Frames::new(1.0), &go_on)?.unwrap();
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
mod cholesky;
mod columns;
pub mod constraints;
pub mod contact;
mod control;
mod coupling;
pub mod elements;
mod energy;
mod error;
mod failure;
mod fused;
mod geometry;
mod grid;
mod held;
pub mod integrators;
mod interval;
mod lanes;
mod linear;
mod measure;
mod network;
mod own;
mod path;
mod pin;
mod products;
mod random;
mod refusal;
pub mod rigid;
mod rows;
mod scene;
mod scratch;
mod serial;
mod sets;
mod simulation;
mod sine;
mod spring;
pub mod stability;
mod sums;
mod system;
#[cfg(test)]
mod testing;
mod threads;
mod vectors;
mod views;
mod work;

pub use constraints::Constraint;
pub use control::{Control, StepLength};
pub use coupling::{
    AxialCoupling, BlockCoupling, Coupling, Diagonal, GeneralCoupling, Matrix, RankOneCoupling,
};
pub use elements::Sheet;
pub use energy::Energy;
pub use error::{BlowUp, Cause, ConstraintName, Error, Rounded, Unmet, Vertex};
pub use failure::Outcome;
pub use grid::{Grid, MAX_PARTICLES};
pub use integrators::{Integrator, Method, Work};
pub use measure::Measure;
pub use nalgebra::Vector3;
pub use network::{Element, Network, Touch, untangle};
pub use own::{Ode, SecondOrder};
pub use path::{Orientation, Path, Place, Pose, Turn, rotation};
pub use pin::Pin;
pub use products::{Products, SolverHints};
pub use refusal::Refusal;
pub use scene::{Disturbances, FirstOrder, Model, Scene, StepLimits, Swing};
pub use simulation::{
    Balance, Checkpoint, Gain, Grabbed, Passage, Progress, RunState, Simulation, Span,
};
pub use spring::{Spring, SpringKind, SpringLaw};
pub use system::{Compliant, Linearized, Mechanics, ParticleSystem, Splitting};

/// Example of the README, compiled as a documentation test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
