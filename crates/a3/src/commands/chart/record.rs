//! A run of a chart: what was asked for, its errors and its work.

use a3_core::accuracy::{Errors, Metric};
use serde::{Deserialize, Serialize};

/// A run, with its error and its work.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Record {
    /// Version of the program that measured it.
    pub version: String,
    pub scene: String,
    pub rows: usize,
    pub cols: usize,
    pub wind: bool,
    pub swing: bool,
    /// Whether surfaces were made to touch that pass through one another in the scene itself.
    #[serde(default)]
    pub self_collision: bool,
    /// Stiffness of the springs, as a factor of the scene's own.
    pub stiffness: f64,
    /// Simulated time (s).
    pub until: f64,
    pub solver: String,
    /// Step (s), or relative tolerance.
    pub setting: f64,
    /// Particles and times that count, in words.
    pub scope: String,
    /// Error of the positions over all frames (m); none of a run that blew up.
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
    /// Error of a run in which nothing moves: of the positions (m).
    pub still_position: f64,
    /// Error of a run in which nothing moves: of the springs' stretch.
    pub still_strain: f64,
    /// Error of a run in which nothing moves: of the penetration.
    pub still_penetration: f64,
    /// Error of a run in which nothing moves: of the first impact (s).
    pub still_impact: f64,
    /// Simulated time at which the run blew up (s).
    pub lost_at: Option<f64>,
    /// Impulses by which the guard of surfaces held the run.
    #[serde(default)]
    pub guard_impulses: usize,
    /// Ways of vertices that the guard cut.
    #[serde(default)]
    pub guard_cuts: usize,
    /// Momentum that cuts took (N s).
    #[serde(default)]
    pub guard_lost: f64,
    /// Computing time of the whole run (s), if it was measured.
    pub seconds: Option<f64>,
    /// Work of the whole run in evaluations, including linear algebra.
    pub work: f64,
    pub evaluations: u64,
    pub solves: u64,
    pub iterations: u64,
    pub factorizations: u64,
    pub rejections: u64,
    /// Order by the errors of the positions of this run and the next coarser one: their ratio, as a
    /// power of the ratio of the steps or, for an adaptive method, of the evaluations.
    #[serde(default)]
    pub order: Option<f64>,
    /// For a run of `--spread`: the tolerance whose spread of errors it shows, within 4 % of its
    /// own.
    #[serde(default)]
    pub beside: Option<f64>,
    /// Checksum of the file up to here, as it was read.
    #[serde(default, skip_serializing)]
    pub check: String,
}

impl Record {
    /// Whether both runs are of the same scene, by the same version.
    pub fn same_scene(&self, other: &Self) -> bool {
        (&self.version, &self.scene, self.rows, self.cols)
            == (&other.version, &other.scene, other.rows, other.cols)
            && (self.wind, self.swing, self.self_collision)
                == (other.wind, other.swing, other.self_collision)
            && (self.stiffness, self.until, &self.scope)
                == (other.stiffness, other.until, &other.scope)
    }

    /// Whether both runs are of the same scene, method and setting.
    pub fn same_run(&self, other: &Self) -> bool {
        self.same_scene(other) && self.solver == other.solver && self.setting == other.setting
    }

    /// The order between a coarser run of the same method and this one.
    pub fn order_from(&self, coarser: &Self) -> Option<f64> {
        let is_adaptive = a3_core::integrators::find(&self.solver)?.is_adaptive();
        let refined = if is_adaptive {
            self.evaluations as f64 / coarser.evaluations as f64
        } else {
            coarser.setting / self.setting
        };
        let order = (coarser.error_position? / self.error_position?).ln() / refined.ln();
        order.is_finite().then_some(order)
    }

    /// Whether the guard of surfaces held the run.
    pub fn is_held(&self) -> bool {
        self.guard_impulses + self.guard_cuts > 0
    }

    /// The error of the run; infinite if it blew up.
    pub fn error(&self, metric: Metric) -> f64 {
        let or_lost = |error: Option<f64>| error.unwrap_or(f64::INFINITY);
        metric.of(&Errors {
            position: or_lost(self.error_position),
            state: 0.0,
            energy: or_lost(self.error_energy),
            strain: or_lost(self.error_strain),
            momentum: or_lost(self.error_momentum),
            phase: or_lost(self.error_phase),
            penetration: or_lost(self.error_penetration),
            impact: or_lost(self.error_impact),
        })
    }

    /// The least error that the reference can tell from 0: ten times its own.
    pub fn resolved(&self, metric: Metric) -> f64 {
        10.0 * self.floor(metric)
    }

    /// The error of the reference itself.
    pub fn floor(&self, metric: Metric) -> f64 {
        metric.of(&Errors {
            position: self.floor_position,
            state: 0.0,
            energy: self.floor_energy,
            strain: self.floor_strain,
            momentum: self.floor_momentum,
            phase: self.floor_phase,
            penetration: self.floor_penetration,
            impact: self.floor_impact,
        })
    }

    /// The error of a run in which nothing moves, beyond which an error says nothing; infinite for
    /// quantities that motion may conserve.
    pub fn still(&self, metric: Metric) -> f64 {
        match metric {
            Metric::Position => self.still_position,
            Metric::Strain => self.still_strain,
            Metric::Penetration => self.still_penetration,
            Metric::Impact => self.still_impact,
            Metric::Energy | Metric::Momentum | Metric::Phase | Metric::State => f64::INFINITY,
        }
    }
}
