//! `a3 simulate`: the final state as JSON.

use std::path::Path;

use a3_core::Simulation;
use serde::{Serialize, Serializer};

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
    positions: Rows<'a>,
    /// In m/s.
    velocities: Rows<'a>,
}

/// An n x 3 matrix, of which each row is written as it comes.
struct Rows<'a>(&'a [f64]);

impl Serialize for Rows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let n = self.0.len() / 3;
        serializer.collect_seq((0..n).map(|i| [0, n, 2 * n].map(|column| self.0[column + i])))
    }
}

pub fn run(options: &Simulate) -> Result<(), Failure> {
    let to_stdout = options.output == Path::new("-");
    let mut simulation = options.run.simulation()?;
    if !to_stdout {
        output::check(&options.output, &["json"])?;
    }
    progress::advance(&mut simulation, options.run.end()?, |_| {}).map_err(Failure::run)?;
    let velocities = simulation.velocities();
    let state = state(&simulation, &velocities);
    if to_stdout {
        let json = serde_json::to_string(&state).map_err(Failure::run)?;
        output::say(&format!("{json}\n"))
    } else {
        output::write_with(&options.output, |file| {
            serde_json::to_writer(&mut *file, &state)?;
            writeln!(file)
        })
    }
}

fn state<'a>(simulation: &'a Simulation, velocities: &'a [f64]) -> State<'a> {
    let n = simulation.particles();
    let adaptive = simulation.method().is_adaptive();
    State {
        scene: &simulation.scene().name,
        solver: simulation.method().name,
        step: (!adaptive).then_some(simulation.setting()),
        tolerance: adaptive.then_some(simulation.setting()),
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: simulation.energy().map(|energy| energy.total()),
        positions: Rows(&simulation.state()[..3 * n]),
        velocities: Rows(velocities),
    }
}
