//! The error that a scene's grids cause, which no solver makes smaller; effects of models that
//! were measured before are kept in a file.

use std::path::{Path, PathBuf};

use a3_core::accuracy::{Frames, Scope};
use a3_core::integrators::find;
use a3_core::{Control, Method, Model, Scene};
use a3_files::failure::Failure;
use a3_files::interrupt;
use a3_files::quantity::Quantity;
use a3_files::rows::{Row, Rows};
use a3_files::scene_file::Hash;
use a3_files::setup::Request;
use a3_scenes::{Description, Regridded, regridded};
use serde::{Deserialize, Serialize};

use super::track::Compared;

/// Relative tolerance of the runs, whose errors are far below those of grids.
const TOLERANCE: f64 = 1e-5;
/// Largest number of particles of a scene that is compared with finer grids: more would take too
/// long.
const MAX_FINER: usize = 1500;
/// Largest number of particles of a scene whose grid error is measured.
const MAX_PARTICLES: usize = 20_000;

/// Error that a grid causes.
pub struct GridError {
    /// Numbers of particles along each axis, in words.
    pub grid: String,
    /// Estimated error of the positions (m); if that is not known, the difference from another
    /// grid.
    pub error: f64,
    /// Way in which the error was found.
    pub found: Found,
}

/// Way in which the error of a grid was found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Found {
    /// Extrapolated by the observed order.
    Order(f64),
    /// Difference from a grid twice as fine: grids do not converge yet.
    Finer,
    /// Difference from a grid half as fine, because a finer one would take too long. At order 1,
    /// it is the error itself.
    Coarser,
}

/// Observed order above which grids count as convergent.
const MIN_ORDER: f64 = 0.3;
/// Largest order with which the error is extrapolated.
const MAX_ORDER: f64 = 4.0;

impl GridError {
    /// Estimates the error of a grid by Richardson's extrapolation, from the differences (m) of a
    /// grid half as fine and of one twice as fine from it.
    pub fn new(grid: String, coarser: Option<f64>, finer: f64) -> Self {
        let order = coarser.map(|coarser| (coarser / finer).log2());
        let order = order.filter(|order| *order > MIN_ORDER);
        let share = order.map_or(1.0, |order| 1.0 - (-order.min(MAX_ORDER)).exp2());
        Self { grid, error: finer / share, found: order.map_or(Found::Finer, Found::Order) }
    }

    /// Returns the observed order, if grids converge.
    pub fn order(&self) -> Option<f64> {
        match self.found {
            Found::Order(order) => Some(order),
            Found::Finer | Found::Coarser => None,
        }
    }

    /// Describes the error in a sentence.
    pub fn sentence(&self) -> String {
        let Self { grid, error, found } = self;
        let how = match found {
            Found::Order(order) => {
                format!("the grid of {grid} errs by about {error:.1e} m (order {order:.1})")
            }
            Found::Finer => format!(
                "the grid of {grid} differs from one twice as fine by {error:.1e} m, and grids do not converge yet"
            ),
            Found::Coarser => {
                format!("the grid of {grid} differs from one half as fine by {error:.1e} m")
            }
        };
        format!("{how}: smaller errors describe the model, not the material\n")
    }
}

/// Measures the error of a scene's grids at frames, in a scope, unless it is known. `None` if the
/// scene has no grid that can be changed or has too many particles, if a run fails, or if the
/// command was interrupted.
pub fn grid_error(
    request: &Request,
    scene: &Scene,
    frames: Frames,
    scope: Scope,
    known: &mut Rows<Known>,
) -> Result<Option<GridError>, Failure> {
    let request = &request.described();
    let own = &*request.source.description;
    let particles = scene.model.particles();
    let Some(method) = find("verner65").filter(|m| m.check(scene.model.system()).is_ok()) else {
        return Ok(None);
    };
    if particles > MAX_PARTICLES {
        return Ok(None);
    }
    let compared = Compared { quantity: Quantity::Position, frames, scope };
    let accurate = (method, Control::Tolerance(TOLERANCE));
    let like = Known::new(request, scene, compared, accurate);
    let mut whole = None;
    let mut change = |factor: f64| {
        let Ok(Regridded { description, places }) = regridded(own, factor, particles) else {
            return Ok(None);
        };
        let like = Known { model: format!("grid of {}", grid(&description)), ..like.clone() };
        if let Some(known) = known.find(&like) {
            return Ok(Some(known.change));
        }
        let other = request.with(description).scene()?;
        let other = compared.follow(&other, accurate, Some(&places), &interrupt::go_on);
        let Some(other) = Failure::unless_stopped(other)?.flatten() else {
            return Ok(None);
        };
        if whole.is_none() {
            let own = compared.follow(scene, accurate, None, &interrupt::go_on);
            whole = Failure::unless_stopped(own)?.flatten();
        }
        let Some(whole) = &whole else {
            return Ok(None);
        };
        let change = compared.distance(whole, &other);
        known.add(Known {
            change,
            time: other.time.as_secs_f64() / whole.time.as_secs_f64(),
            work: other.work / whole.work,
            ..like
        });
        known.save()?;
        Ok::<_, Failure>(Some(change))
    };
    if particles > MAX_FINER {
        let coarser = change(0.5)?;
        return Ok(coarser.map(|error| GridError {
            grid: grid(own),
            error,
            found: Found::Coarser,
        }));
    }
    let Some(finer) = change(2.0)? else {
        return Ok(None);
    };
    Ok(Some(GridError::new(grid(own), change(0.5)?, finer)))
}

/// Describes the grid of a scene's first body that has one, as in `9 x 9`; of a fluid, the numbers
/// of particles along the edges of its box.
pub fn grid(description: &Description) -> String {
    let cloth = description.cloth.first().map(|it| it.grid.to_vec());
    let jelly = || description.jelly.first().map(|it| it.grid.to_vec());
    let solid = || description.solid.first()?.grid.map(|grid| grid.to_vec());
    let fluid = || {
        let fluid = description.fluid.first()?;
        let edges = fluid.size[..fluid.dimensions.into()].iter();
        Some(edges.map(|edge| (edge / fluid.spacing).round() as usize).collect())
    };
    let grid = cloth.or_else(jelly).or_else(solid).or_else(fluid);
    let grid = grid.unwrap_or_default();
    let grid = grid.iter().map(ToString::to_string).collect::<Vec<_>>();
    grid.join(" x ")
}

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
        (&self.version, &self.scene, &self.of, &self.scope, &self.solver, &self.model)
            == (&other.version, &other.scene, &other.of, &other.scope, &other.solver, &other.model)
            && run(self) == run(other)
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
        hash.add([u8::from(request.options.on.swing)]);
        Self {
            version: env!("CARGO_PKG_VERSION").into(),
            scene: format!("{} {:016x}", request.source.fingerprint(scene), hash.value()),
            of: compared.quantity.name().into(),
            scope: words(compared.scope, &scene.model),
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

/// Describes a scope of a model in words.
pub fn words(scope: Scope, model: &Model) -> String {
    let when = if scope.at_end { " at the end" } else { "" };
    let kind = match model.particles() {
        0 => "number",
        _ => "particle",
    };
    match scope.particle {
        Some(i) => format!("{kind} {i}{when}"),
        None => format!("all {kind}s{when}"),
    }
}
