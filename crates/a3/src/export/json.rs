//! JSON: the state at full precision, or those of several frames as an array, a line each.

use std::io::Write;
use std::path::Path;

use a3_core::Simulation;
use serde::{Serialize, Serializer};

use super::Export;
use crate::Failure;
use crate::output::{self, Draft};

/// About how many bytes a particle takes.
pub const ROW: f64 = 130.0;

pub struct Json {
    /// Standard output without one.
    draft: Option<Draft>,
    several: bool,
    frames: usize,
}

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

impl Json {
    /// Of one state, to standard output.
    pub fn to_stdout() -> Self {
        Self {
            draft: None,
            several: false,
            frames: 0,
        }
    }

    pub fn new(path: &Path, several: bool) -> Result<Self, Failure> {
        Ok(Self {
            draft: Some(Draft::new(path)?),
            several,
            frames: 0,
        })
    }
}

impl Export for Json {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let velocities = simulation.velocities();
        let state = state(simulation, &velocities);
        let Some(draft) = &mut self.draft else {
            let json = serde_json::to_string(&state).map_err(Failure::run)?;
            return output::say(&format!("{json}\n"));
        };
        let before = match (self.several, self.frames) {
            (false, _) => "",
            (true, 0) => "[\n",
            (true, _) => ",\n",
        };
        self.frames += 1;
        write!(draft, "{before}")
            .and_then(|()| Ok(serde_json::to_writer(&mut *draft, &state)?))
            .map_err(|e| draft.failure(&e))
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        let Some(mut draft) = self.draft else {
            return Ok(());
        };
        let after = if self.several { "\n]\n" } else { "\n" };
        write!(draft, "{after}").map_err(|e| draft.failure(&e))?;
        draft.place()
    }
}

fn state<'a>(simulation: &'a Simulation, velocities: &'a [f64]) -> State<'a> {
    let n = simulation.particles();
    State {
        scene: &simulation.scene().name,
        solver: simulation.method().name,
        step: simulation.control().step(),
        tolerance: simulation.control().tolerance(),
        time: simulation.time(),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: simulation.energy().map(|energy| energy.total()),
        positions: Rows(&simulation.state()[..3 * n]),
        velocities: Rows(velocities),
    }
}
