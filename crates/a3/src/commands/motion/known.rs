//! Effects of models that were measured before, in a file.

use std::path::{Path, PathBuf};

use a3_core::accuracy::Scope;
use a3_core::{Control, Method, Scene};
use serde::{Deserialize, Serialize};

use super::track::Compared;
use crate::base::failure::Failure;
use crate::files::rows::{Row, Rows};
use crate::files::scene_file::Hash;
use crate::files::setup::Request;

/// Effect of a model of a scene, compared with the whole scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Known {
    /// Version of the program that measured it.
    pub version: String,
    /// Name of the scene, with a hash of its description.
    pub scene: String,
    /// Quantity that is compared.
    pub of: String,
    /// Particles and times that count, in words.
    pub scope: String,
    /// Simulated time (s).
    pub until: f64,
    /// Name of the solver.
    pub solver: String,
    /// Relative tolerance.
    pub tolerance: f64,
    /// Name of the model.
    pub model: String,
    /// Change of the quantity, in its unit.
    pub change: f64,
    /// Computing time of the model over that of the whole scene.
    pub time: f64,
    /// Work of the model over that of the whole scene, in evaluations of each.
    pub work: f64,
    /// Checksum of the file up to this row, as it was read.
    #[serde(default, skip_serializing)]
    pub check: String,
}

impl Row for Known {
    fn is_same(&self, other: &Self) -> bool {
        let run = |known: &Self| (known.until.to_bits(), known.tolerance.to_bits());
        (
            &self.version,
            &self.scene,
            &self.of,
            &self.scope,
            &self.solver,
            &self.model,
        ) == (
            &other.version,
            &other.scene,
            &other.of,
            &other.scope,
            &other.solver,
            &other.model,
        ) && run(self) == run(other)
    }

    fn check(&mut self) -> &mut String {
        &mut self.check
    }
}

impl Known {
    /// Creates the row of a model that is not measured yet, by a method and a tolerance. A scene is
    /// known by its name and by hashes of its files and of its description.
    pub fn new(
        request: &Request,
        scene: &Scene,
        compared: Compared,
        (method, control): (&Method, Control),
    ) -> Self {
        let mut hash = Hash::default();
        let text = request.source.description.to_toml();
        hash.add(text.unwrap_or_default().bytes());
        hash.add([u8::from(request.options.swing)]);
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: format!(
                "{} {:016x}",
                request.source.fingerprint(scene),
                hash.value()
            ),
            of: compared.quantity.name().into(),
            scope: words(compared.scope),
            until: compared.frames.until,
            solver: method.name.into(),
            tolerance: control.value(),
            ..Self::default()
        }
    }
}

/// Opens the file of known effects; without a name, none are known and none are saved.
///
/// # Errors
/// The file holds something else, or cannot be read.
pub fn open(path: Option<&Path>) -> Result<Rows<Known>, Failure> {
    Rows::open(path, "the effects of models")
}

/// Returns the name of the file of models beside one with the runs of a chart: `runs.csv` becomes
/// `runs.models.csv`.
pub fn beside(data: &Path) -> PathBuf {
    let ending = data.extension().unwrap_or_default().to_string_lossy();
    data.with_extension(format!("models.{ending}"))
}

/// Describes a scope in words.
pub fn words(scope: Scope) -> String {
    let when = if scope.at_end { " at the end" } else { "" };
    match scope.particle {
        Some(i) => format!("particle {i}{when}"),
        None => format!("all particles{when}"),
    }
}
