//! State of rest of a method: the state y that a step leaves as it is, by Newton's method. Its
//! linear systems are solved by GMRES (Saad, Schultz, *GMRES: a generalized minimal residual
//! algorithm for solving nonsymmetric linear systems*, 1986), with differences of steps.

use nalgebra::{DMatrix, DVector};

use super::normalised::{dot, normalise};
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Integrator, Method, add_scaled};
use crate::measure::Measure;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::system::ParticleSystem;

/// Largest number of Newton steps, and of products in each of them.
const MAX_ITERATIONS: (usize, usize) = (8, 60);
/// Change of the state in a step, over the scene's radius, that is rounding.
const ROUNDING: f64 = 1e-12;
/// Length of the changes by which steps are differentiated, over the scene's radius.
const DIFFERENCE: f64 = 1e-7;
/// Ratio of the change in a step to the one before a Newton step, from which on it ends.
const MAX_RATIO: f64 = 0.5;

/// Returns the state of rest of a method in steps of h (s), near the scene's own; the scene's own
/// if a run changes that less in a step, as where it lies on obstacles.
///
/// # Errors
/// The method does not support the scene, or a callback failed.
pub(super) fn own_rest(scene: &Scene, method: &'static Method, h: f64) -> Result<Vec<f64>, Error> {
    let found = rest_of_steps(scene, method, h)?;
    let lengths = lengths(scene.model.system(), h);
    let change = |y: &[f64]| {
        let mut scene = scene.clone();
        scene.state = y.to_vec();
        let mut run = Simulation::new(scene, method, Control::Step(h))?;
        if !succeeded(run.take_steps(1))? {
            return Ok(f64::INFINITY);
        }
        let parts = run.state().iter().zip(y).zip(&lengths);
        let squares = parts.map(|((now, y), length)| (length * (now - y)).powi(2));
        Ok::<_, Error>(squares.sum::<f64>())
    };
    let is_calmer = change(&found)? < change(&scene.state)?;
    Ok(if is_calmer {
        found
    } else {
        scene.state.clone()
    })
}

/// Returns the state near that of rest of a scene that steps of h (s) of a method change least.
fn rest_of_steps(scene: &Scene, method: &Method, h: f64) -> Result<Vec<f64>, Error> {
    let system = scene.model.system();
    let radius = scene.extent().1;
    let mut map = StepMap {
        system,
        integrator: method.integrator(system)?,
        h,
        lengths: lengths(system, h),
    };
    let mut y = scene.state.clone();
    let Some(mut change) = map.change(&y)? else {
        return Ok(y);
    };
    for _ in 0..MAX_ITERATIONS.0 {
        let size = dot(&change, &change).sqrt();
        if size < ROUNDING * radius {
            break;
        }
        let towards: Vec<_> = change.iter().map(|change| -change).collect();
        let step = gmres(&towards, |z| {
            let mut next = map.change(&map.moved(&y, DIFFERENCE * radius, z))?;
            for (next, change) in next.iter_mut().flatten().zip(&change) {
                *next = (*next - change) / (DIFFERENCE * radius);
            }
            Ok(next)
        })?;
        let Some(step) = step else { break };
        let next = map.moved(&y, 1.0, &step);
        let Some(left) = map.change(&next)? else {
            break;
        };
        // A comparison with NaN is false.
        let falls = dot(&left, &left).sqrt() < MAX_RATIO * size;
        if !falls {
            break;
        }
        (y, change) = (next, left);
    }
    Ok(y)
}

/// Step of a method as a map of states.
struct StepMap<'a> {
    system: &'a dyn ParticleSystem,
    integrator: Box<dyn Integrator>,
    h: f64,
    /// Displacement (m) for each unit of a number of the state; 0 for those that are not free.
    lengths: Vec<f64>,
}

impl StepMap<'_> {
    /// Returns the change of the state y in a step, in metres; `None` if the step fails.
    fn change(&mut self, y: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let mut next = y.to_vec();
        let stepped = self.integrator.step(self.system, 0.0, self.h, &mut next);
        if !succeeded(stepped)? {
            return Ok(None);
        }
        for ((next, y), length) in next.iter_mut().zip(y).zip(&self.lengths) {
            *next = (*next - y) * length;
        }
        Ok(Some(next))
    }

    /// Returns the state y displaced by a share of `z` (m).
    fn moved(&self, y: &[f64], share: f64, z: &[f64]) -> Vec<f64> {
        let mut moved = y.to_vec();
        for ((y, z), length) in moved.iter_mut().zip(z).zip(&self.lengths) {
            *y += if *length > 0.0 {
                share * z / length
            } else {
                0.0
            };
        }
        self.system.hold(0.0, &mut moved);
        moved
    }
}

/// Returns the displacement (m) for each unit of the numbers of a state, in steps of h (s).
fn lengths(system: &dyn ParticleSystem, h: f64) -> Vec<f64> {
    let mut lengths = vec![0.0; system.dim()];
    system.measures(&mut |numbers, measure| {
        lengths[numbers].fill(match measure {
            Measure::Plain | Measure::Position => 1.0,
            Measure::Velocity => h,
            Measure::Rotation { radius } => radius,
            Measure::Momentum { speed } => speed * h,
        });
    });
    lengths
}

/// Returns the combination d of some products with the map A that makes A d nearest to b; `None` if
/// a product fails.
fn gmres(
    b: &[f64],
    mut product: impl FnMut(&[f64]) -> Result<Option<Vec<f64>>, Error>,
) -> Result<Option<Vec<f64>>, Error> {
    let mut first = b.to_vec();
    let size = normalise(&mut first);
    let (mut basis, mut columns) = (vec![first], vec![]);
    while columns.len() < MAX_ITERATIONS.1.min(b.len()) {
        let Some(mut next) = product(&basis[columns.len()])? else {
            return Ok(None);
        };
        let mut column = vec![];
        let whole = dot(&next, &next).sqrt();
        for z in &basis {
            let share = dot(z, &next);
            add_scaled(&mut next, -share, z);
            column.push(share);
        }
        let length = normalise(&mut next);
        column.push(length);
        columns.push(column);
        if length <= 1e-8 * whole {
            break;
        }
        basis.push(next);
    }
    let count = columns.len();
    let matrix = DMatrix::from_fn(count + 1, count, |i, j| {
        columns[j].get(i).copied().unwrap_or(0.0)
    });
    if !matrix.iter().all(|a| a.is_finite()) {
        return Ok(None);
    }
    let mut right = DVector::zeros(count + 1);
    right[0] = size;
    let least = matrix.svd(true, true).solve(&right, 1e-9).ok();
    Ok(least.map(|weights| {
        let mut sum = vec![0.0; b.len()];
        for (weight, z) in weights.iter().zip(&basis) {
            add_scaled(&mut sum, *weight, z);
        }
        sum
    }))
}
