//! State of rest of a method, the state y that a step leaves as it is, and the growth of small
//! changes of it. The state is found by Newton's method. Its linear systems are solved by GMRES
//! (Saad, Schultz, *GMRES: a generalized minimal residual algorithm for solving nonsymmetric linear
//! systems*, 1986), with differences of steps.

use nalgebra::{Complex, DMatrix, DVector};

use super::eigenvalues::eigenvalues;
use super::limit::{GROWTH, tenfold_time};
use super::linearised::longest_that_holds;
use super::mode::{dot, normalise};
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Integrator, Method, add_scaled};
use crate::measure::Measure;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::system::{ParticleSystem, rigid_of};

/// Largest number of Newton steps, and of products in each of them.
const MAX_ITERATIONS: (usize, usize) = (8, 60);
/// Change of the state in a step, over the scene's radius, that is rounding.
const ROUNDING: f64 = 1e-12;
/// Length of the changes by which steps are differentiated, over the scene's radius.
const DIFFERENCE: f64 = 1e-5;
/// Singular value, over the largest, that rounding cannot tell from zero.
const SINGULAR: f64 = 1e-7;
/// Number of unknowns from which on a system counts as large.
const MIN_LARGE: usize = 100;
/// Least share of a Newton step that is taken, where all of it leads too far.
const LEAST_SHARE: f64 = 0.05;

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
        // Surfaces may be crossed there, which the steps of the method do not see.
        let Ok(mut run) = Simulation::new(scene, method, Control::Step(h)) else {
            return Ok(f64::INFINITY);
        };
        if !succeeded(run.take_steps(1))? {
            return Ok(f64::INFINITY);
        }
        let parts = run.state().iter().zip(y).zip(&lengths);
        let squares = parts.map(|((now, y), length)| (length * (now - y)).powi(2));
        Ok::<_, Error>(squares.sum::<f64>())
    };
    let is_calmer = change(&found)? < change(&scene.state)?;
    Ok(if is_calmer { found } else { scene.state.clone() })
}

/// Finds the largest step (s) of a method on a scene at rest at which no small change of the
/// method's own state of rest grows tenfold, near an expected one, from the eigenvalues of its
/// steps' derivatives. Infinite if no trial step fails, `None` if the shortest one fails too.
///
/// # Errors
/// The method does not support the scene, or a callback failed.
pub(super) fn largest_step(
    scene: &Scene,
    method: &'static Method,
    guess: f64,
) -> Result<Option<f64>, Error> {
    let large = free(&lengths(scene.model.system(), guess)).len() > MIN_LARGE;
    let mut grows = |h: f64| {
        let y = own_rest(scene, method, h)?;
        let growth = StepMap::new(scene, method, h)?.growth(&y)?;
        let holds = growth.ln() * tenfold_time(h) <= h * GROWTH.ln();
        Ok(!holds)
    };
    longest_that_holds(guess, large, &mut grows)
}

/// Returns the state near that of rest of a scene that steps of h (s) of a method change least.
fn rest_of_steps(scene: &Scene, method: &Method, h: f64) -> Result<Vec<f64>, Error> {
    let mut map = StepMap::new(scene, method, h)?;
    let radius = map.radius;
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
        let step = gmres(&towards, |z| map.derivative(&y, z))?;
        let Some(step) = step else { break };
        let mut share = 1.0;
        let found = loop {
            let next = map.moved(&y, share, &step);
            let left = map.change(&next)?;
            // A comparison with NaN is false.
            let falls = |left: &Vec<f64>| dot(left, left).sqrt() < (1.0 - 0.5 * share) * size;
            if let Some(left) = left.filter(falls) {
                break Some((next, left));
            }
            share *= 0.5;
            if share < LEAST_SHARE {
                break None;
            }
        };
        let Some(found) = found else { break };
        (y, change) = found;
    }
    Ok(y)
}

/// Step of a method as a map of states.
struct StepMap<'a> {
    system: &'a dyn ParticleSystem,
    integrator: Box<dyn Integrator>,
    h: f64,
    /// Radius of the scene (m).
    radius: f64,
    /// Displacement (m) for each unit of a number of the state; 0 for those that are not free.
    lengths: Vec<f64>,
}

impl<'a> StepMap<'a> {
    fn new(scene: &'a Scene, method: &Method, h: f64) -> Result<Self, Error> {
        let system = scene.model.system();
        Ok(Self {
            system,
            integrator: method.integrator(system)?,
            h,
            radius: scene.extent().1,
            lengths: lengths(system, h),
        })
    }

    /// Returns the factor by which the fastest growing change of a state of rest grows in a step;
    /// infinite if a step fails.
    fn growth(&mut self, y: &[f64]) -> Result<f64, Error> {
        let free = free(&self.lengths);
        let mut matrix = DMatrix::identity(free.len(), free.len());
        let mut unit = vec![0.0; y.len()];
        for (column, k) in free.iter().enumerate() {
            unit[*k] = 1.0;
            let Some(change) = self.derivative(y, &unit)? else {
                return Ok(f64::INFINITY);
            };
            unit[*k] = 0.0;
            for (row, k) in free.iter().enumerate() {
                matrix[(row, column)] += change[*k];
            }
        }
        if !matrix.iter().all(|a: &f64| a.is_finite()) {
            return Ok(f64::INFINITY);
        }
        let sizes = eigenvalues(&matrix).into_iter().map(Complex::norm);
        Ok(sizes.fold(0.0, f64::max))
    }

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

    /// Returns the derivative of the change of the state y in a step along `z`, by a central
    /// difference; `None` if a step fails.
    fn derivative(&mut self, y: &[f64], z: &[f64]) -> Result<Option<Vec<f64>>, Error> {
        let length = DIFFERENCE * self.radius;
        let ends = [length, -length].map(|share| self.moved(y, share, z));
        let Some((mut ahead, behind)) = self.change(&ends[0])?.zip(self.change(&ends[1])?) else {
            return Ok(None);
        };
        for (ahead, behind) in ahead.iter_mut().zip(&behind) {
            *ahead = (*ahead - behind) / (2.0 * length);
        }
        Ok(Some(ahead))
    }

    /// Returns the state y displaced by a share of `z` (m).
    fn moved(&self, y: &[f64], share: f64, z: &[f64]) -> Vec<f64> {
        let mut moved = y.to_vec();
        for ((y, z), length) in moved.iter_mut().zip(z).zip(&self.lengths) {
            *y += if *length > 0.0 { share * z / length } else { 0.0 };
        }
        self.system.hold(0.0, &mut moved);
        moved
    }
}

/// Returns the indices of the numbers of a state that are free, of these displacements.
fn free(lengths: &[f64]) -> Vec<usize> {
    (0..lengths.len()).filter(|k| lengths[*k] > 0.0).collect()
}

/// Returns the displacement (m) for each unit of the numbers of a state, in steps of h (s).
fn lengths(system: &dyn ParticleSystem, h: f64) -> Vec<f64> {
    let mut lengths = vec![0.0; system.dim()];
    system.measures(&mut |numbers, measure| {
        lengths[numbers].fill(match measure {
            Measure::Plain | Measure::Alike | Measure::Position => 1.0,
            Measure::Velocity => h,
            Measure::Rotation { radius } => radius,
            Measure::Momentum { speed } => speed * h,
        });
    });
    if let Some(rigid) = rigid_of(system) {
        for (k, length) in lengths.iter_mut().enumerate() {
            *length *= f64::from(u8::from(!rigid.is_carried(k)));
        }
    }
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
    let matrix =
        DMatrix::from_fn(count + 1, count, |i, j| columns[j].get(i).copied().unwrap_or(0.0));
    if !matrix.iter().all(|a| a.is_finite()) {
        return Ok(None);
    }
    let mut right = DVector::zeros(count + 1);
    right[0] = size;
    let svd = matrix.svd(true, true);
    // A rotation has no change along its own length: there, a derivative is rounding.
    let least = svd.solve(&right, SINGULAR * svd.singular_values.max()).ok();
    Ok(least.map(|weights| {
        let mut sum = vec![0.0; b.len()];
        for (weight, z) in weights.iter().zip(&basis) {
            add_scaled(&mut sum, *weight, z);
        }
        sum
    }))
}
