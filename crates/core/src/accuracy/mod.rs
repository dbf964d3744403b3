//! Accuracy of methods on a scene: errors against a reference solution whose own uncertainty is
//! known, and the choice of the cheapest method for an error.

mod choose;
mod horizon;
mod ladder;
mod reference;

use crate::control::Control;
use crate::elements::force::distance;
use crate::error::{BlowUp, Error};
use crate::integrators::{Method, Work};
use crate::network::Network;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::spring::SpringKind;

pub use choose::{Candidate, choose};
pub use horizon::{Horizon, horizon};
pub use ladder::ladder;
pub use reference::Reference;

/// Function that is called between frames and returns whether to go on.
pub type GoOn<'a> = &'a dyn Fn() -> bool;

/// Times at which runs are compared: the ends of `count` equal parts of the time from 0 to `until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// Time of the last frame (s).
    pub until: f64,
    /// Number of frames, a multiple of 60, so that steps of many lengths fit.
    pub count: u64,
}

impl Frames {
    /// Frames up to `until` (s): at least 60 in each second, and at least 60 in all.
    #[must_use]
    pub fn new(until: f64) -> Self {
        Self {
            until,
            count: 60 * until.ceil().max(1.0) as u64,
        }
    }

    /// Interval between frames (s).
    #[must_use]
    pub fn spacing(&self) -> f64 {
        self.until / self.count as f64
    }

    /// Time of frame k (s).
    #[must_use]
    pub fn time(&self, k: u64) -> f64 {
        if k == self.count {
            self.until
        } else {
            k as f64 * self.spacing()
        }
    }
}

/// Quantities of a state that are compared.
#[derive(Clone, Debug, Default)]
struct Snapshot {
    /// Positions (m): all x, all y, all z.
    positions: Vec<f64>,
    /// Total energy (J); 0 for a first-order scene.
    energy: f64,
    /// Length over rest length of each structural spring.
    strains: Vec<f64>,
}

impl Snapshot {
    /// Quantities of the run's current state.
    fn of(run: &Simulation) -> Self {
        let positions = run.state()[..3 * run.particles()].to_vec();
        let strains = run.model().network().map_or(vec![], |network| {
            structural(network)
                .map(|s| distance(&positions, s.i, s.j) / s.law.rest_length)
                .collect()
        });
        Self {
            energy: run.energy().map_or(0.0, |energy| energy.total()),
            positions,
            strains,
        }
    }

    /// Differences from another snapshot of the same scene.
    fn errors(&self, other: &Self) -> Errors {
        let square =
            |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum() };
        let particles = (self.positions.len() / 3).max(1) as f64;
        let springs = self.strains.len().max(1) as f64;
        Errors {
            position: (square(&self.positions, &other.positions) / particles).sqrt(),
            energy: (self.energy - other.energy).abs(),
            strain: (square(&self.strains, &other.strains) / springs).sqrt(),
        }
    }
}

/// Structural springs of a network whose rest length is above 0.
fn structural(network: &Network) -> impl Iterator<Item = crate::Spring> {
    network
        .springs()
        .filter(|s| s.kind == SpringKind::Structural && s.law.rest_length > 0.0)
}

/// Errors of a state, or the largest ones over the frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square over the particles of the distance from their reference positions (m).
    pub position: f64,
    /// Absolute error of the total energy (J); 0 for a first-order scene.
    pub energy: f64,
    /// Root mean square over the structural springs of the error of length over rest length; 0
    /// without such springs.
    pub strain: f64,
}

impl Errors {
    /// Larger of both errors in each quantity.
    fn max(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            energy: self.energy.max(other.energy),
            strain: self.strain.max(other.strain),
        }
    }
}

/// Choice of one of the [`Errors`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Error of the positions (m).
    #[default]
    Position,
    /// Error of the total energy (J).
    Energy,
    /// Error of length over rest length.
    Strain,
}

impl Metric {
    /// Error that the metric chooses, in its unit.
    #[must_use]
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Position => errors.position,
            Self::Energy => errors.energy,
            Self::Strain => errors.strain,
        }
    }
}

/// Outcome of a run against the reference.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Largest errors over the frames that the run reached.
    pub errors: Errors,
    /// Work of the whole run.
    pub work: Work,
    /// Blow-up of the run, if it was lost.
    pub lost: Option<BlowUp>,
}

/// Runs a simulation from its beginning to the last frame. With a fixed step, `visit` is called at
/// each frame at which a step ends; with a tolerance, at every frame.
///
/// Steps that neither divide the interval between frames nor are a multiple of it are shortened at
/// each frame. Returns the blow-up, if the run was lost, and `None` if `go_on` returned false.
///
/// # Errors
/// The run cannot go on for a reason other than a blow-up.
pub fn run(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    mut visit: impl FnMut(u64, &Simulation),
) -> Result<Option<Option<BlowUp>>, Error> {
    // Number of frames for each step, and of steps for each frame, if both are whole numbers.
    let whole = simulation.control().step().and_then(|step| {
        let ratio = step / frames.spacing();
        let (stride, per_frame) = (ratio.round().max(1.0), (1.0 / ratio).round().max(1.0));
        let fits = (ratio - stride / per_frame).abs() < 1e-9 * ratio;
        fits.then_some((stride as u64, per_frame as u64))
    });
    let stride = whole.map_or(1, |(stride, _)| stride);
    let mut k = 0;
    while k < frames.count {
        if !go_on() {
            return Ok(None);
        }
        k = (k + stride).min(frames.count);
        // Steps are counted, so that rounding leaves no tiny step at the end of a frame.
        let result = match whole {
            Some((_, per_frame)) if k < frames.count => simulation.take_steps(per_frame),
            _ => simulation.advance_to(frames.time(k)),
        };
        match result {
            Ok(()) => visit(k, simulation),
            Err(Error::BlowUp(lost)) => return Ok(Some(Some(lost))),
            Err(error) => return Err(error),
        }
    }
    Ok(Some(None))
}

/// Runs a scene and compares the run with its reference. Returns `None` if `go_on` returned false.
///
/// # Errors
/// The method does not support the scene or the control, or the run fails without a blow-up.
pub fn measure(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    reference: &Reference,
    go_on: GoOn,
) -> Result<Option<Outcome>, Error> {
    let mut simulation = Simulation::new(scene.clone(), method, control)?;
    let mut errors = Errors::default();
    let end = run(&mut simulation, &reference.frames, go_on, |k, run| {
        errors = errors.max(reference.errors(k, run));
    })?;
    Ok(end.map(|lost| Outcome {
        errors,
        work: simulation.work(),
        lost,
    }))
}
