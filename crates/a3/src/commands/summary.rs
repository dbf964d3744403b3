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
    /// Energy that nothing put in, if it is much (J).
    energy_gained: Option<f64>,
    /// Energy gained or, below 0, lost (percent); none where the forces do not keep it.
    energy_change_percent: Option<f64>,
    /// The constraint that was farthest from being met; none if all were met.
    constraint: Option<Broken>,
    /// Largest length over rest length of a spring; none without springs.
    largest_stretch: Option<f64>,
    /// Number of springs that broke.
    torn: usize,
    /// What the guard of surfaces did; none where surfaces do not touch.
    contact: Option<Contact>,
    /// Real time (s).
    wall_time: f64,
}

/// Error of a constraint over its length from which on it is in a summary.
const BROKEN: f64 = 1e-4;

/// Constraint that was not met.
#[derive(Serialize)]
struct Broken {
    /// Number, counted from 0.
    number: usize,
    /// What it is.
    name: String,
    /// Largest error over its length (percent).
    off_by_percent: f64,
}

impl Broken {
    fn of(simulation: &Simulation) -> Option<Self> {
        let unmet = simulation.worst_constraint()?;
        (unmet.share > BROKEN).then(|| Self {
            number: unmet.number,
            name: unmet.constraint.to_string(),
            off_by_percent: 100.0 * unmet.share,
        })
    }
}

/// What the guard of surfaces did.
#[derive(Serialize)]
struct Contact {
    /// Number of impulses.
    impulses: usize,
    /// Number of vertices whose way was cut.
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

/// Writes the summary of a run that began then and has written so many frames: to a file, or for -
/// to standard output.
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
        constraint: Broken::of(simulation),
        largest_stretch: extremes.stretch,
        torn: simulation.tears(),
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
