//! Data behind a chart: its runs, one line each, in a CSV or JSON file from which a later chart
//! goes on.

use std::fs;
use std::path::{Path, PathBuf};

use a3_core::accuracy::{Errors, Metric};
use serde::{Deserialize, Serialize};

use crate::failure::Failure;
use crate::output;

/// Size of the largest data file that is read (bytes).
const LARGEST_FILE: u64 = 64 << 20;

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
    /// Error of the positions over the frames that the run reached (m).
    pub error_position: f64,
    /// Error of the energy (J).
    pub error_energy: f64,
    /// Error of the springs' stretch.
    pub error_strain: f64,
    /// Error of the momentum (kg m/s).
    pub error_momentum: f64,
    /// Error of the phase (s).
    pub error_phase: f64,
    /// Error of the penetration, as a share of the thickness.
    pub error_penetration: f64,
    /// Error of the times of the first impact (s).
    pub error_impact: f64,
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
    fn same_run(&self, other: &Self) -> bool {
        self.same_scene(other) && self.solver == other.solver && self.setting == other.setting
    }

    /// Whether the guard of surfaces held the run.
    pub fn is_held(&self) -> bool {
        self.guard_impulses + self.guard_cuts > 0
    }

    /// The error of the run.
    pub fn error(&self, metric: Metric) -> f64 {
        metric.of(&Errors {
            position: self.error_position,
            energy: self.error_energy,
            strain: self.error_strain,
            momentum: self.error_momentum,
            phase: self.error_phase,
            penetration: self.error_penetration,
            impact: self.error_impact,
        })
    }

    /// The error of the reference itself.
    pub fn floor(&self, metric: Metric) -> f64 {
        metric.of(&Errors {
            position: self.floor_position,
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
            Metric::Energy | Metric::Momentum | Metric::Phase => f64::INFINITY,
        }
    }
}

/// The runs so far, and the file that keeps them.
pub struct Data {
    path: Option<PathBuf>,
    pub records: Vec<Record>,
}

impl Data {
    /// The runs in the file; none if there is no file.
    pub fn open(path: Option<&Path>) -> Result<Self, Failure> {
        let mut data = Self {
            path: path.map(Path::to_owned),
            records: vec![],
        };
        let Some(path) = path else { return Ok(data) };
        output::check(path, &["csv", "json"])?;
        let Ok(there) = fs::metadata(path) else {
            return Ok(data);
        };
        let wrong = |why: String| {
            Failure::run(format!(
                "{}: this file does not hold the data of a chart ({why}); give another name",
                path.display()
            ))
        };
        if !there.is_file() || there.len() > LARGEST_FILE {
            return Err(wrong(
                "it is not an ordinary file, or it is too large".into(),
            ));
        }
        let text = fs::read_to_string(path).map_err(|e| wrong(e.to_string()))?;
        if output::ends_in(path, "json") {
            data.records = serde_json::from_str(&text).map_err(|e| wrong(e.to_string()))?;
        } else {
            let mut reader = csv::Reader::from_reader(text.as_bytes());
            for line in reader.deserialize() {
                data.records.push(line.map_err(|e| wrong(e.to_string()))?);
            }
        }
        Ok(data)
    }

    /// The run of the same scene, method, setting and version, if there is one; if `timed`, only
    /// one that was timed or lost.
    pub fn find(&self, like: &Record, timed: bool) -> Option<&Record> {
        self.records
            .iter()
            .find(|r| r.same_run(like) && (!timed || r.seconds.is_some() || r.lost_at.is_some()))
    }

    /// Adds a run, and removes an older one of the same scene, method and setting.
    pub fn add(&mut self, record: Record) {
        self.records.retain(|r| !r.same_run(&record));
        self.records.push(record);
    }

    /// Writes the file, if the runs have one.
    pub fn save(&self) -> Result<(), Failure> {
        let Some(path) = &self.path else {
            return Ok(());
        };
        let bytes = if output::ends_in(path, "json") {
            let mut text = serde_json::to_string_pretty(&self.records).map_err(Failure::run)?;
            text.push('\n');
            text.into_bytes()
        } else {
            let mut writer = csv::Writer::from_writer(vec![]);
            for record in &self.records {
                writer.serialize(record).map_err(Failure::run)?;
            }
            writer.into_inner().map_err(Failure::run)?
        };
        output::write(path, &bytes)
    }
}

/// Version of this program.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");
