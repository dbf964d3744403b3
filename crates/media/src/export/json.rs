//! JSON: the state at full precision, or the states of several frames as an array, a line each.

use std::io::Write;
use std::path::Path;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::output::Draft;
use a3_files::rounding::{DIGITS, short};
use a3_files::terminal;
use serde::{Serialize, Serializer};

use super::geometry::{Export, velocities};

/// Approximate size of a particle (bytes).
pub const ROW_SIZE: f64 = 130.0;

/// A JSON file that is being written.
pub struct Json {
    /// The file, or `None` for standard output.
    draft: Option<Draft>,
    /// Whether the frames are an array.
    several: bool,
    /// Number of frames so far.
    frames: usize,
}

/// The state of a simulation, with the keys of the file.
#[derive(Serialize)]
struct StateRecord<'a> {
    scene: &'a str,
    solver: &'a str,
    /// Step of a method with fixed steps (s).
    #[serde(skip_serializing_if = "Option::is_none")]
    step: Option<f64>,
    /// Relative tolerance of an adaptive method.
    #[serde(skip_serializing_if = "Option::is_none")]
    tolerance: Option<f64>,
    /// Simulated time (s).
    time: f64,
    steps: u64,
    evaluations: u64,
    /// Total energy (J); none for a system without forces.
    energy: Option<f64>,
    /// Positions (m), a row for each particle.
    positions: MatrixRows<'a>,
    /// Velocities (m/s), a row for each particle.
    velocities: MatrixRows<'a>,
}

/// An n x 3 matrix in column-major order, which is written row by row.
struct MatrixRows<'a>(&'a [f64]);

impl Serialize for MatrixRows<'_> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let n = self.0.len() / 3;
        serializer.collect_seq((0..n).map(|i| [0, n, 2 * n].map(|column| self.0[column + i])))
    }
}

impl Json {
    /// Creates the output of one state to standard output.
    pub fn to_stdout() -> Self {
        Self { draft: None, several: false, frames: 0 }
    }

    /// Creates a file with one state, or with an array of several.
    pub fn new(path: &Path, several: bool) -> Result<Self, Failure> {
        Ok(Self { draft: Some(Draft::new(path)?), several, frames: 0 })
    }
}

impl Export for Json {
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure> {
        let velocities = velocities(simulation)?;
        let state = state(simulation, &velocities);
        let Some(draft) = &mut self.draft else {
            let json = serde_json::to_string(&state).map_err(Failure::run)?;
            return terminal::send(&format!("{json}\n"));
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

/// Returns the state of a simulation, with its velocities.
fn state<'a>(simulation: &'a Simulation, velocities: &'a [f64]) -> StateRecord<'a> {
    let n = simulation.particles();
    StateRecord {
        scene: &simulation.scene().name,
        solver: simulation.method().name,
        step: simulation.control().step(),
        tolerance: simulation.control().tolerance(),
        time: short(simulation.time(), DIGITS),
        steps: simulation.steps(),
        evaluations: simulation.work().evaluations,
        energy: simulation.energy().map(|energy| energy.total()),
        positions: MatrixRows(&simulation.state()[..3 * n]),
        velocities: MatrixRows(velocities),
    }
}
