//! `a3 simulate`: the final state as JSON.

use std::path::Path;

use a3_core::Simulation;
use serde::Serialize;

use crate::cli::Simulate;
use crate::{Failure, output, progress};

#[derive(Serialize)]
struct State<'a> {
    scene: &'a str,
    solver: &'a str,
    /// In s, of a method with fixed steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
    /// Relative, of an adaptive method.
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    /// In s.
    time: f64,
    steps: u64,
    evaluations: u64,
    /// Total (J); none for a system without forces.
    energy: Option<f64>,
    /// In m.
    positions: Vec<[f64; 3]>,
    /// In m/s.
    velocities: Vec<[f64; 3]>,
}

pub fn run(options: &Simulate) -> Result<(), Failure> {
    let to_stdout = options.output == Path::new("-");
    let mut simulation = options.run.simulation()?;
    if !to_stdout {
        output::check(&options.output, &["json"])?;
    }
    progress::advance(&mut simulation, options.run.until, |_| {}).map_err(Failure::run)?;
    let mut json = serde_json::to_string(&state(&simulation)).map_err(Failure::run)?;
    json.push('\n');
    if to_stdout {
        output::say(&json)
    } else {
        output::write(&options.output, json.as_bytes())
    }
}

fn state(simulation: &Simulation) -> State<'_> {
    let n = simulation.particles();
    let adaptive = simulation.method().is_adaptive();
    let rows = |a: &[f64]| (0..n).map(|i| [a[i], a[n + i], a[2 * n + i]]).collect();
    State {
        scene: simulation.scene().name,
        solver: simulation.method().name,
        step: (!adaptive).then_some(simulation.setting()),
        tolerance: adaptive.then_some(simulation.setting()),
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: simulation.energy().map(|energy| energy.total()),
        positions: rows(simulation.state()),
        velocities: rows(&simulation.velocities()),
    }
}
