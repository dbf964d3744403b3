//! Consistent initial values of M y' = f(t, y). Where M is singular, some equations have no
//! derivative: they bind the numbers of a state, and the rates of change follow from f only with
//! their help. Both are limits of a step of implicit Euler, M d = a f(t + a, y + d), as a vanishes:
//! d is a jump to where the equations hold that leaves M y alone, and then a y' + a^2 y''. Steps of
//! a, a/2 and a/4 tell these parts from one another, and the jumps are those of Newton's method. If
//! the solution for some right-hand side grows as a falls, the equations do not determine the
//! numbers: the index is above 1 (Hairer, Wanner, *Solving Ordinary Differential Equations II*,
//! 1996, VI.1 and VII.1).

use std::cell::RefCell;

use super::super::sweep::add_scaled;
use super::jacobian::Jacobian;
use super::lu::Lu;
use crate::error::Error;
use crate::random::SplitMix;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Step a, over the least time in which an equation changes a number by its size. Jumps have errors
/// of its third power, and y'' has rounding errors over its square.
const SHARE: f64 = 1e-6;
/// Steps over a, and the weights of their changes d in the jump, in a y' and in a^2 y''.
const STEPS: [f64; 3] = [1.0, 0.5, 0.25];
const WEIGHTS: [[f64; 3]; 3] =
    [[1.0 / 3.0, -2.0, 8.0 / 3.0], [-2.0, 10.0, -8.0], [8.0 / 3.0, -8.0, 16.0 / 3.0]];
/// Largest number of jumps.
const MAX_JUMPS: usize = 20;
/// Jump, over the sizes of the numbers, after which only rounding is left of the next one.
const SMALL: f64 = 1e-8;
/// Jump that is rounding itself: the values are left as they are.
const ROUNDING: f64 = 1e-13;
/// Least size of a number, over the largest one.
const LEAST_SIZE: f64 = 1e-3;
/// Growth of a solution when a is halved, above which the index exceeds 1: then it is 2 or more.
const MAX_GROWTH: f64 = 1.5;

/// Rates of change at the beginning of a run with a mass matrix.
pub(super) struct Consistent {
    pub rates: Vec<f64>,
    /// Their own rates of change.
    pub seconds: Vec<f64>,
    /// Reason why there are none.
    failure: RefCell<Option<Error>>,
    factors: Lu<f64>,
}

impl Consistent {
    /// Creates the beginning of runs of a system, if it has a mass matrix.
    pub fn of(system: &dyn ParticleSystem) -> Option<Self> {
        let has_matrix = !system.mass_matrix().is_empty();
        has_matrix.then(|| Self {
            rates: vec![0.0; system.dim()],
            seconds: vec![0.0; system.dim()],
            failure: RefCell::default(),
            factors: Lu::new(system.dim()),
        })
    }

    /// Takes the reason why the last beginning failed.
    pub fn check(&self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Returns whether the last beginning failed.
    pub fn has_failed(&self) -> bool {
        self.failure.borrow().is_some()
    }

    /// Makes y consistent at t (s), and finds the rates of change there. Returns the cost.
    pub fn begin(
        &mut self,
        system: &dyn ParticleSystem,
        jacobian: &mut Jacobian,
        t: f64,
        y: &mut [f64],
    ) -> Work {
        let mut work = Work::default();
        self.failure.take();
        let why = 'found: {
            for _ in 0..MAX_JUMPS {
                work += jacobian.form(system, t, f64::INFINITY, y);
                let largest = y.iter().fold(0.0_f64, |most, y| most.max(y.abs()));
                let sizes: Vec<_> = (y.iter().map(|y| y.abs().max(LEAST_SIZE * largest)))
                    .map(|size| if size > 0.0 { size } else { 1.0 })
                    .collect();
                let a = SHARE * shortest_time(jacobian);
                let mut steps = STEPS.map(|share| TinyStep::new(share * a, y.len()));
                for step in &mut steps {
                    work += step.solve(system, (&mut self.factors, jacobian), (t, y), &sizes);
                }
                let [whole, half, _] = &steps;
                // An evaluation that failed is not a matter of values.
                if whole.f.iter().any(|f| !f.is_finite()) {
                    self.rates.copy_from_slice(&whole.f);
                    return work;
                }
                if half.other > MAX_GROWTH * whole.other || !half.other.is_finite() {
                    break 'found "do not determine all numbers: differentiate them until they do";
                }
                let [jumps, rates, seconds] = WEIGHTS.map(|weights| {
                    let mut sum = vec![0.0; y.len()];
                    for (weight, step) in weights.into_iter().zip(&steps) {
                        add_scaled(&mut sum, weight, &step.d);
                    }
                    sum
                });
                for (k, (rate, second)) in rates.iter().zip(&seconds).enumerate() {
                    (self.rates[k], self.seconds[k]) = (rate / a, second / (a * a));
                }
                let sized = jumps.iter().zip(&sizes);
                let jump = sized.fold(0.0, |most, (jump, size)| f64::max(most, jump.abs() / size));
                if jump > ROUNDING {
                    add_scaled(y, 1.0, &jumps);
                }
                if jump <= SMALL {
                    return work;
                }
                if y.iter().any(|y| !y.is_finite()) {
                    break;
                }
            }
            "hold nowhere near the state: give other initial values"
        };
        self.failure.replace(Some(Error::Invalid(format!(
            "the equations without a derivative in M y' = f(t, y) {why} (at t = {t} s)"
        ))));
        work
    }
}

/// Returns the least time in which an equation with a derivative changes a number by its size.
fn shortest_time(jacobian: &Jacobian) -> f64 {
    let mut rows = vec![[0.0_f64; 2]; jacobian.order()];
    for (i, _, value) in &jacobian.mass {
        let [mass, _] = &mut rows[*i as usize];
        *mass = mass.max(value.abs());
    }
    jacobian.matrix.visit(|i, _, value| {
        let [_, slope] = &mut rows[i];
        *slope = slope.max(value.abs());
    });
    let times = rows.into_iter().map(|[mass, slope]| mass / slope);
    let times = times.filter(|time| *time > 0.0 && time.is_finite());
    times.reduce(f64::min).unwrap_or(1.0)
}

/// A step of implicit Euler, by one iteration of Newton's method.
struct TinyStep {
    a: f64,
    f: Vec<f64>,
    /// Change of the state.
    d: Vec<f64>,
    /// Size of the solution for another right-hand side: a times J times a random change.
    other: f64,
}

impl TinyStep {
    fn new(a: f64, dim: usize) -> Self {
        Self { a, f: vec![0.0; dim], d: vec![0.0; dim], other: f64::NAN }
    }

    /// Takes the step from y, whose numbers have these sizes. Returns the cost.
    fn solve(
        &mut self,
        system: &dyn ParticleSystem,
        (factors, jacobian): (&mut Lu<f64>, &Jacobian),
        (t, y): (f64, &[f64]),
        sizes: &[f64],
    ) -> Work {
        let a = self.a;
        system.eval_f(t + a, y, &mut self.f);
        let mut work = Work::of(1);
        if !jacobian.factorise(factors, 1.0, a) {
            return work;
        }
        add_scaled(&mut self.d, a, &self.f);
        factors.solve(&mut self.d);
        let (mut random, mut other) = (SplitMix(3), vec![0.0; y.len()]);
        let changes: Vec<_> = sizes.iter().map(|s| s * random.between(0.5, 1.0)).collect();
        jacobian.matrix.visit(|i, j, value| other[i] += a * value * changes[j]);
        factors.solve(&mut other);
        let shares = other.iter().zip(sizes).map(|(x, size)| (x / size).powi(2));
        self.other = shares.sum::<f64>().sqrt();
        let costs = factors.cost() + 2.0 * factors.cost_of_solution();
        work += Work { solves: 2, factorizations: 1, ..jacobian.algebra(costs) };
        work
    }
}
