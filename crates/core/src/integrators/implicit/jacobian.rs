//! The Jacobian of f of a small system without masses, or of rigid bodies: the system's own, or
//! central differences.

use super::newton::dot;
use crate::integrators::method::MAX_DENSE;
use crate::measure::Measure;
use crate::system::{ParticleSystem, rigid_of};
use crate::work::Work;

/// Half the step of a difference quotient, over the unit of the number.
const DIFFERENCE_SHARE: f64 = 1e-6;
/// The same for speeds, relative to that for positions: the resulting motion is tiny.
const SPEED_DIFFERENCE_SHARE: f64 = 1e-3;

/// Lists the numbers of the state that the equations are solved for: all, except those of particles
/// on rigid bodies, which f does not read.
pub(super) fn unknowns(system: &dyn ParticleSystem) -> Vec<usize> {
    let mut all = vec![];
    system.measures(&mut |numbers, _| all.extend(numbers));
    all
}

/// Jacobian with respect to the unknowns, with its scratch.
pub(super) struct Jacobian {
    pub unknowns: Vec<usize>,
    /// Unit of each unknown, in which changes are compared, and half the step of its difference
    /// quotient.
    units: Vec<[f64; 2]>,
    /// Cost of an evaluation of f, in multiplications within rows; infinite for rigid bodies, whose
    /// matrices are small.
    evaluation: f64,
    /// Slopes, row by row.
    pub matrix: Vec<f64>,
    at: Vec<f64>,
    above: Vec<f64>,
    below: Vec<f64>,
}

impl Jacobian {
    /// Creates room for the Jacobian of a system.
    pub fn new(system: &dyn ParticleSystem) -> Self {
        let (dim, unknowns) = (system.dim(), unknowns(system));
        // Systems that are too large are refused, and need no room.
        let room = Some(unknowns.len()).filter(|count| *count <= MAX_DENSE);
        let room = room.unwrap_or(0);
        Self {
            units: Vec::with_capacity(unknowns.len()),
            evaluation: match rigid_of(system) {
                Some(_) => f64::INFINITY,
                None => system.evaluation_cost(),
            },
            unknowns,
            matrix: vec![0.0; room * room],
            at: vec![0.0; dim],
            above: vec![0.0; dim],
            below: vec![0.0; dim],
        }
    }

    /// Returns the number of unknowns for which there is room.
    pub fn order(&self) -> usize {
        self.matrix.len().isqrt()
    }

    /// Returns the work of linear algebra with this number of multiplications.
    pub fn algebra(&self, multiplications: f64) -> Work {
        Work {
            algebra: multiplications / self.evaluation,
            ..Work::default()
        }
    }

    /// Returns the norm of the unknowns in a state, in their units.
    pub fn norm(&self, y: &[f64]) -> f64 {
        let numbers = self.unknowns.iter().zip(&self.units);
        let squares = numbers.map(|(i, [unit, _])| (y[*i] / unit).powi(2));
        squares.sum::<f64>().sqrt()
    }

    /// Finds the units at y. With rigid bodies they are the largest radius, the speed that covers
    /// it in a time a, the length of a quaternion, and the angular momentum at which the body's
    /// surface has that speed; without bodies, plain numbers.
    fn measure(&mut self, system: &dyn ParticleSystem, a: f64, y: &[f64]) {
        let mut length: f64 = 0.0;
        system.measures(&mut |_, measure| {
            if let Measure::Rotation { radius } = measure {
                length = length.max(radius);
            }
        });
        let speed = length / a.abs();
        self.units.clear();
        system.measures(&mut |numbers, measure| {
            let unit = match measure {
                Measure::Position => length,
                Measure::Rotation { .. } => dot(&y[numbers.clone()], &y[numbers.clone()]).sqrt(),
                Measure::Velocity => speed,
                Measure::Momentum { speed: own } => speed / own,
                Measure::Plain | Measure::Alike => 0.0,
            };
            let difference = match measure {
                Measure::Position | Measure::Rotation { .. } => DIFFERENCE_SHARE * unit,
                _ => SPEED_DIFFERENCE_SHARE * DIFFERENCE_SHARE * unit,
            };
            self.units.extend(numbers.map(|k| {
                if unit > 0.0 {
                    [unit, difference]
                } else {
                    [1.0, DIFFERENCE_SHARE * y[k].abs().max(1.0)]
                }
            }));
        });
    }

    /// Forms the Jacobian at y, for steps of about a (s). One that the system knows counts as an
    /// evaluation for each of its columns, one by differences as two.
    pub fn form(&mut self, system: &dyn ParticleSystem, t: f64, a: f64, y: &[f64]) -> Work {
        self.measure(system, a, y);
        let count = self.unknowns.len();
        let Self {
            unknowns,
            units,
            matrix,
            at,
            above,
            below,
            ..
        } = self;
        if count == y.len() && system.jacobian(t, y, matrix) {
            return Work::of(count as u64);
        }
        at.copy_from_slice(y);
        for (column, &j) in unknowns.iter().enumerate() {
            let [_, h] = units[column];
            at[j] = y[j] + h;
            system.eval_f(t, at, above);
            at[j] = y[j] - h;
            system.eval_f(t, at, below);
            at[j] = y[j];
            for (row, &i) in unknowns.iter().enumerate() {
                matrix[row * count + column] = (above[i] - below[i]) / (2.0 * h);
            }
        }
        Work::of(2 * count as u64)
    }
}
