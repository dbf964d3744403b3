//! The summary of a run.

use std::path::Path;
use web_time::Instant;

use a3_core::Simulation;
use serde::Serialize;

use crate::base::failure::Failure;
use crate::base::terminal;
use crate::files::checkpoint::{Energy, Extremes};
use crate::files::output;

/// Summary of a run.
#[derive(Serialize)]
struct Summary {
    scene: String,
    solver: &'static str,
    frames: usize,
    /// Simulated time (s).
    time: f64,
    steps: u64,
    evaluations: u64,
    /// Total energy; none for a system without forces.
    energy: Option<Energy>,
    /// Energy that the method added (J), if it is large enough for a warning.
    energy_gained: Option<f64>,
    /// Energy gained or, below 0, lost (percent); none where forces do not conserve energy.
    energy_change_percent: Option<f64>,
    /// Largest change (m/s) of a velocity at the start, so that it fits the constraints; none if
    /// all did.
    start_changed_by: Option<f64>,
    /// The constraint with the largest error; none if all were met.
    constraint: Option<Violation>,
    /// Largest length over rest length of a spring; none without springs.
    largest_stretch: Option<f64>,
    /// Number of springs that broke.
    torn: usize,
    /// Mass of the liquid that flowed out (kg); none without an outflow.
    flowed_out: Option<f64>,
    /// Actions of the collision safeguard; none where surfaces do not touch.
    contact: Option<Contact>,
    /// Real time (s).
    wall_time: f64,
}

/// Least error of a constraint, over its length, that a summary reports.
const MIN_REPORTED_ERROR: f64 = 1e-4;

/// Constraint that was not met.
#[derive(Serialize)]
struct Violation {
    /// Number, counted from 0.
    number: usize,
    /// Description.
    name: String,
    /// Largest error over its length (percent).
    off_by_percent: f64,
}

impl Violation {
    fn of(simulation: &Simulation) -> Option<Self> {
        let unmet = simulation.worst_constraint()?;
        (unmet.share > MIN_REPORTED_ERROR).then(|| Self {
            number: unmet.number,
            name: unmet.constraint.to_string(),
            off_by_percent: 100.0 * unmet.share,
        })
    }
}

/// Actions of the collision safeguard of surfaces.
#[derive(Serialize)]
struct Contact {
    /// Number of impulses.
    impulses: usize,
    /// Number of displacements of vertices that were cut.
    cuts: usize,
    /// Momentum that cuts took (N s).
    momentum_lost: f64,
}

impl Contact {
    fn of(simulation: &Simulation) -> Option<Self> {
        simulation.model().network()?.contact_layer()?;
        let guarded = simulation.guarded();
        Some(Self {
            impulses: guarded.impulses,
            cuts: guarded.cuts,
            momentum_lost: guarded.lost,
        })
    }
}

/// Returns the mass (kg) of the liquid that has flowed out, if there is an outflow.
fn flowed_out(simulation: &Simulation) -> Option<f64> {
    let fluid = simulation.model().network()?.fluid()?;
    let mass = fluid.members().drained().len() as f64 * fluid.law().mass();
    (!fluid.members().outflows().is_empty()).then_some(mass)
}

/// Writes the summary of a run that began at the instant `begun` and has written `frames` frames:
/// to a file, or for - to standard output.
pub fn write(
    path: &Path,
    simulation: &Simulation,
    frames: usize,
    extremes: &Extremes,
    begun: Instant,
) -> Result<(), Failure> {
    let summary = Summary {
        scene: simulation.scene().name.clone(),
        solver: simulation.method().name,
        frames,
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: extremes.energy,
        energy_gained: simulation.gained().map(|gain| gain.energy),
        energy_change_percent: simulation.energy_change().map(|share| 100.0 * share),
        start_changed_by: Some(simulation.scene().fitted).filter(|fitted| *fitted > 0.0),
        constraint: Violation::of(simulation),
        largest_stretch: extremes.stretch,
        torn: simulation.tears(),
        flowed_out: flowed_out(simulation),
        contact: Contact::of(simulation),
        wall_time: begun.elapsed().as_secs_f64(),
    };
    let text = serde_json::to_string_pretty(&summary).map_err(Failure::run)? + "\n";
    if path == Path::new("-") {
        terminal::send(&text)
    } else {
        output::write(path, text.as_bytes())
    }
}
