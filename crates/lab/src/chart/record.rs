//! The runs of a chart, each with its scene, its setting, its errors and its work; and their files,
//! which a later chart continues. The names of the fields are the keys of these files.

use std::path::Path;

use a3_core::accuracy::Metric;
use a3_files::failure::Failure;
use a3_files::output::{self, Draft};
use a3_files::rows::{Row, Rows};
use serde::{Deserialize, Serialize};

/// Run of a method on a scene, with its errors and its work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
#[expect(clippy::struct_excessive_bools, reason = "columns of a file, which say yes or no")]
pub struct Record {
    /// Version of the program that measured the run.
    pub version: String,
    /// Name of the scene; for one from a file, with a hash of its files.
    pub scene: String,
    /// Number of rows of the first cloth; 0 without one.
    pub rows: usize,
    /// Number of columns of the first cloth; 0 without one.
    pub cols: usize,
    /// Whether `--wind` was given.
    pub wind: bool,
    /// Whether `--swing` was given.
    pub swing: bool,
    /// Whether `--self-collision` was given.
    #[serde(default)]
    pub self_collision: bool,
    /// Stiffness of the springs, over that of the scene itself.
    pub stiffness: f64,
    /// Simulated time (s).
    pub until: f64,
    /// Name of the solver.
    pub solver: String,
    /// Step (s), or relative tolerance.
    pub setting: f64,
    /// Particles and times at which errors are taken, in words.
    pub scope: String,
    /// Error of the positions (m); none if the run blew up, like the other errors.
    pub error_position: Option<f64>,
    /// Error of the energy (J).
    pub error_energy: Option<f64>,
    /// Error of the springs' stretch.
    pub error_strain: Option<f64>,
    /// Error of the momentum (kg m/s).
    pub error_momentum: Option<f64>,
    /// Error of the phase (s).
    pub error_phase: Option<f64>,
    /// Error of the penetration, as a share of the thickness.
    pub error_penetration: Option<f64>,
    /// Error of the times of the first impact (s).
    pub error_impact: Option<f64>,
    /// Error of the numbers of a state without particles, in their unit; 0 with particles.
    #[serde(default)]
    pub error_state: Option<f64>,
    /// Error of the reference itself: of the positions (m).
    pub floor_position: f64,
    /// Error of the reference itself: of the energy (J).
    pub floor_energy: f64,
    /// Error of the reference itself: of the springs' stretch.
    pub floor_strain: f64,
    /// Error of the reference itself: of the momentum (kg m/s).
    pub floor_momentum: f64,
    /// Error of the reference itself: of the phase (s).
    pub floor_phase: f64,
    /// Error of the reference itself: of the penetration.
    pub floor_penetration: f64,
    /// Error of the reference itself: of the first impact (s).
    pub floor_impact: f64,
    /// Error of the reference itself: of the numbers of a state without particles.
    #[serde(default)]
    pub floor_state: f64,
    /// Error of a run in which nothing moves: of the positions (m).
    pub still_position: f64,
    /// Error of a run in which nothing moves: of the springs' stretch.
    pub still_strain: f64,
    /// Error of a run in which nothing moves: of the penetration.
    pub still_penetration: f64,
    /// Error of a run in which nothing moves: of the first impact (s).
    pub still_impact: f64,
    /// Error of a run in which nothing moves: of the numbers of a state without particles.
    #[serde(default)]
    pub still_state: f64,
    /// Simulated time at which the run blew up (s).
    pub lost_at: Option<f64>,
    /// Number of impulses of the collision safeguard.
    #[serde(default)]
    pub guard_impulses: usize,
    /// Number of times that the collision safeguard shortened the displacement of a vertex.
    #[serde(default)]
    pub guard_cuts: usize,
    /// Momentum that was lost by this (N s).
    #[serde(default)]
    pub guard_lost: f64,
    /// Computing time of the whole run (s), if it was measured.
    pub seconds: Option<f64>,
    /// Work of the whole run in evaluations, including linear algebra.
    pub work: f64,
    /// Number of evaluations of the forces.
    pub evaluations: u64,
    /// Number of linear systems that were solved.
    pub solves: u64,
    /// Number of iterations of conjugate gradients.
    pub iterations: u64,
    /// Number of factorisations.
    pub factorizations: u64,
    /// Number of steps that were rejected.
    pub rejections: u64,
    /// Observed order p from the errors of the positions, or of the state, in this run and the next
    /// coarser one: their ratio is that of the steps or, for an adaptive method, of the
    /// evaluations, to the power p.
    #[serde(default)]
    pub order: Option<f64>,
    /// For a run of `--spread`: the tolerance whose spread of errors it shows. That of the run
    /// itself is within 4 % of it.
    #[serde(default)]
    pub beside: Option<f64>,
    /// Whether the run was given up, because it took too many evaluations.
    #[serde(skip)]
    pub given_up: bool,
    /// Checksum of the file up to this run, as it was read.
    #[serde(default, skip_serializing)]
    pub check: String,
}

impl Row for Record {
    fn is_same(&self, other: &Self) -> bool {
        self.same_scene(other) && self.solver == other.solver && self.setting == other.setting
    }

    fn check(&mut self) -> &mut String {
        &mut self.check
    }
}

impl Record {
    /// Returns whether both runs are of the same scene, by the same version.
    #[must_use]
    pub fn same_scene(&self, other: &Self) -> bool {
        (&self.version, &self.scene, self.rows, self.cols)
            == (&other.version, &other.scene, other.rows, other.cols)
            && (self.wind, self.swing, self.self_collision)
                == (other.wind, other.swing, other.self_collision)
            && (self.stiffness, self.until, &self.scope)
                == (other.stiffness, other.until, &other.scope)
    }

    /// Returns the observed order between a coarser run of the same method and this one.
    #[must_use]
    pub fn order_from(&self, coarser: &Self, is_adaptive: bool) -> Option<f64> {
        let refined = if is_adaptive {
            self.evaluations as f64 / coarser.evaluations as f64
        } else {
            coarser.setting / self.setting
        };
        let ratio = match (coarser.error_state, self.error_state) {
            (Some(coarser), Some(own)) if own > 0.0 => coarser / own,
            _ => coarser.error_position? / self.error_position?,
        };
        let order = ratio.ln() / refined.ln();
        order.is_finite().then_some(order)
    }

    /// Returns whether the collision safeguard acted in the run.
    #[must_use]
    pub fn is_held(&self) -> bool {
        self.guard_impulses + self.guard_cuts > 0
    }

    /// Returns the error of the run; infinite if it blew up.
    #[must_use]
    pub fn error(&self, metric: Metric) -> f64 {
        let error = match metric {
            Metric::Position => self.error_position,
            Metric::State => self.error_state,
            Metric::Energy => self.error_energy,
            Metric::Strain => self.error_strain,
            Metric::Momentum => self.error_momentum,
            Metric::Phase => self.error_phase,
            Metric::Penetration => self.error_penetration,
            Metric::Impact => self.error_impact,
        };
        error.unwrap_or(f64::INFINITY)
    }

    /// Returns the smallest error that the reference can tell from 0: ten times its own.
    #[must_use]
    pub fn resolved(&self, metric: Metric) -> f64 {
        10.0 * self.floor(metric)
    }

    /// Returns the error of the reference itself.
    #[must_use]
    pub fn floor(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Position => self.floor_position,
            Metric::State => self.floor_state,
            Metric::Energy => self.floor_energy,
            Metric::Strain => self.floor_strain,
            Metric::Momentum => self.floor_momentum,
            Metric::Phase => self.floor_phase,
            Metric::Penetration => self.floor_penetration,
            Metric::Impact => self.floor_impact,
        }
    }

    /// Returns the error of a run in which nothing moves, beyond which an error says nothing;
    /// infinite for the energy, the momentum and the phase.
    #[must_use]
    pub fn still(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Position => self.still_position,
            Metric::Strain => self.still_strain,
            Metric::Penetration => self.still_penetration,
            Metric::Impact => self.still_impact,
            Metric::State => self.still_state,
            Metric::Energy | Metric::Momentum | Metric::Phase => f64::INFINITY,
        }
    }
}

/// Runs that are known.
pub struct Data {
    pub runs: Rows<Record>,
    /// File for the errors of each particle in the runs that are measured, if it was asked for.
    pub each: Option<Each>,
}

impl Data {
    /// Reads the runs in a file; none if there is no file, or an empty one.
    ///
    /// # Errors
    /// The file holds something else, or cannot be read.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let runs = Rows::open(path, "the data of a chart")?;
        Ok(Self { runs, each: None })
    }

    /// Finds the run of the same scene, method, setting and version; if `timed`, only one that was
    /// timed, or that blew up.
    pub fn find(&self, like: &Record, timed: bool) -> Option<&Record> {
        let run = self.runs.find(like);
        run.filter(|run| !timed || run.seconds.is_some() || run.lost_at.is_some())
    }
}

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// CSV file that is being written, with a row for each run and particle.
pub struct Each {
    writer: csv::Writer<Draft>,
}

impl Each {
    /// Begins a file with its heading.
    pub fn new(path: &Path) -> Result<Self, Failure> {
        output::check(path, &["csv"])?;
        let mut each = Self { writer: csv::Writer::from_writer(Draft::new(path)?) };
        each.row(("stiffness", "solver", "setting", "particle", "x", "y", "z"))?;
        Ok(each)
    }

    /// Writes the largest error of each coordinate in a run (m), n x 3: all x, all y, all z.
    pub fn add(&mut self, run: &Record, coordinates: &[f64]) -> Result<(), Failure> {
        let n = coordinates.len() / 3;
        for i in 0..n {
            let of = [0, 1, 2].map(|axis| coordinates[axis * n + i]);
            self.row((run.stiffness, &run.solver, run.setting, i, of))?;
        }
        Ok(())
    }

    /// Completes the file, and moves it to its place.
    pub fn finish(mut self) -> Result<(), Failure> {
        let flushed = self.writer.flush();
        flushed.map_err(|e| self.writer.get_ref().failure(&e))?;
        self.writer.into_inner().map_err(Failure::run)?.place()
    }

    /// Writes a row.
    fn row(&mut self, row: impl serde::Serialize) -> Result<(), Failure> {
        let written = self.writer.serialize(row);
        written.map_err(|e| self.writer.get_ref().failure(&e.into()))
    }
}
