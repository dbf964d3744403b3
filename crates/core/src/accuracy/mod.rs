//! Accuracy of methods on a scene: true errors, against a reference that is made here and knows its
//! own error.

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

/// Question whether to go on, asked between frames.
pub type GoOn<'a> = &'a dyn Fn() -> bool;

/// The times at which runs are compared: `count` equal parts of `until`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frames {
    /// End of the last part (s).
    pub until: f64,
    /// Number of parts, a multiple of 60, so that many steps fit.
    pub count: u64,
}

impl Frames {
    /// Frames up to `until` (s): at least 60 a second, and at least 60.
    #[must_use]
    pub fn new(until: f64) -> Self {
        Self {
            until,
            count: 60 * until.ceil().max(1.0) as u64,
        }
    }

    /// Time from one frame to the next (s).
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

/// The part of a state that is compared.
#[derive(Clone, Debug, Default)]
struct Snapshot {
    positions: Vec<f64>,
    energy: f64,
    /// Length over rest length of each structural spring.
    strains: Vec<f64>,
}

impl Snapshot {
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

fn structural(network: &Network) -> impl Iterator<Item = crate::Spring> {
    network
        .springs()
        .filter(|s| s.kind == SpringKind::Structural && s.law.rest_length > 0.0)
}

/// The largest errors over the frames of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Errors {
    /// Root mean square over the particles of their distance from the reference (m).
    pub position: f64,
    /// Error of the total energy (J); 0 for a first-order scene.
    pub energy: f64,
    /// Root mean square over the structural springs of the error of length over rest length; 0
    /// without any.
    pub strain: f64,
}

impl Errors {
    fn max(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            energy: self.energy.max(other.energy),
            strain: self.strain.max(other.strain),
        }
    }
}

/// Kind of error that counts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Metric {
    /// Error of positions (m).
    #[default]
    Position,
    /// Error of the total energy (J).
    Energy,
    /// Error of length over rest length.
    Strain,
}

impl Metric {
    /// The error of this kind.
    #[must_use]
    pub fn of(self, errors: &Errors) -> f64 {
        match self {
            Self::Position => errors.position,
            Self::Energy => errors.energy,
            Self::Strain => errors.strain,
        }
    }
}

/// Outcome of a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Outcome {
    /// Errors over the frames that it reached.
    pub errors: Errors,
    /// Cost of the run.
    pub work: Work,
    /// Blow-up by which it was lost, if it was.
    pub lost: Option<BlowUp>,
}

/// Takes a run from its beginning to the end of the frames, and visits each frame at which a step
/// ends, or, under a tolerance, every frame.
///
/// Steps that neither divide the spacing of the frames nor are a multiple of it are shortened at
/// each frame. Returns where the run was lost, if it was; `None` if it was told to stop.
///
/// # Errors
/// The run cannot go on, for another reason than a blow-up.
pub fn run(
    simulation: &mut Simulation,
    frames: &Frames,
    go_on: GoOn,
    mut visit: impl FnMut(u64, &Simulation),
) -> Result<Option<Option<BlowUp>>, Error> {
    // Frames a step takes, and steps a frame takes, if whole numbers of steps and of frames fit.
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
        // Counted steps gather no sliver of one at the end of a frame.
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

/// Runs a scene and compares it with its reference. `None` if it was told to stop.
///
/// # Errors
/// The method does not serve the scene or does not take that control.
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
