//! The error of a scene's own grids, which no solver makes smaller.

use a3_core::accuracy::{Frames, Scope};
use a3_core::integrators::find;
use a3_core::{Control, Scene};
use a3_scenes::{Description, Regridded};

use super::track::{Motion, Points};
use crate::base::failure::Failure;
use crate::files::setup::Request;

/// Relative tolerance of the runs: far below what grids err by.
const TOLERANCE: f64 = 1e-5;
/// Most particles of a scene whose grid is made finer without being asked for.
const MOST_PARTICLES: usize = 1500;

/// Error of a grid.
pub struct GridError {
    /// The grid in words.
    pub grid: String,
    /// Estimated error of the positions (m), or the difference from a grid twice as fine, where
    /// grids do not converge yet.
    pub error: f64,
    /// Observed order, where grids converge.
    pub order: Option<f64>,
}

/// Least order that is taken for convergence, and the largest that is extrapolated by.
const ORDERS: (f64, f64) = (0.3, 4.0);

impl GridError {
    /// Estimates the error of a grid from the differences (m) of one half and one twice as fine
    /// from it (Richardson).
    pub fn new(grid: String, coarser: Option<f64>, finer: f64) -> Self {
        let order = coarser.map(|coarser| (coarser / finer).log2());
        let order = order.filter(|order| *order > ORDERS.0);
        let share = order.map_or(1.0, |order| 1.0 - (-order.min(ORDERS.1)).exp2());
        Self {
            grid,
            error: finer / share,
            order,
        }
    }

    /// Sentence on the error.
    pub fn sentence(&self) -> String {
        let Self { grid, error, order } = self;
        let how = match order {
            Some(order) => {
                format!("the grid of {grid} errs by about {error:.1e} m (order {order:.1})")
            }
            None => format!(
                "the grid of {grid} differs from one twice as fine by {error:.1e} m, and grids do not converge yet"
            ),
        };
        format!("{how}: smaller errors describe the model, not the material\n")
    }
}

/// Measures the error of the grids of a scene up to a time (s). `None` if the scene has no grid
/// that could be finer, or too many particles, or its runs are lost or interrupted.
pub fn grid_error(
    request: &Request,
    scene: &Scene,
    until: f64,
) -> Result<Option<GridError>, Failure> {
    let request = &request.described();
    let own = &*request.source.description;
    let particles = scene.model.particles();
    let Some(method) = find("verner65").filter(|m| m.check(scene.model.system()).is_ok()) else {
        return Ok(None);
    };
    if particles > MOST_PARTICLES {
        return Ok(None);
    }
    let points = Points {
        frames: Frames::new(until),
        scope: Scope::default(),
        centre: false,
    };
    let accurate = (method, Control::Tolerance(TOLERANCE));
    let follow = |factor: f64| {
        let Ok(Regridded {
            description,
            places,
        }) = own.regridded(factor, particles)
        else {
            return Ok(None);
        };
        let scene = request.with(description).scene()?;
        points.follow(&scene, accurate, Some(&places))
    };
    let Some(Motion::Known(finer)) = follow(2.0)? else {
        return Ok(None);
    };
    let Some(Motion::Known(whole)) = points.follow(scene, accurate, None)? else {
        return Ok(None);
    };
    let coarser = match follow(0.5)? {
        Some(Motion::Known(coarser)) => Some(points.distance(&whole, &coarser)),
        _ => None,
    };
    let finer = points.distance(&whole, &finer);
    Ok(Some(GridError::new(grid(own), coarser, finer)))
}

/// The grids of a scene in words: that of its first body that has one.
pub fn grid(description: &Description) -> String {
    let cloth = description.cloth.first().map(|it| it.grid.to_vec());
    let jelly = || description.jelly.first().map(|it| it.grid.to_vec());
    let solid = || description.solid.first()?.grid.map(|grid| grid.to_vec());
    let grid = cloth.or_else(jelly).or_else(solid).unwrap_or_default();
    let grid = grid.iter().map(ToString::to_string).collect::<Vec<_>>();
    grid.join(" x ")
}
