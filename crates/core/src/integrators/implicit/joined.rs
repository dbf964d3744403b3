//! The constraints of an implicit stage: M (v - bv) = a F(t, x, v) + JT l with x = bx + a v, and
//! C(x) = 0, or C = 0 at the end 2 x - bx of a step of which x is the middle. The impulses l are
//! solved for together with v. Velocities then keep the rate of C at zero once a projection has
//! removed the part along the constraints: that is the index-2 form of Gear, Gupta, Leimkuhler,
//! *Automatic integration of Euler-Lagrange equations with constraints*, J. Comput. Appl. Math. 12,
//! 1985, whose orders are those of the methods without constraints.

use super::newton::Newton;
use crate::held::{Held, HeldView, Joint};
use crate::linear::{Saddle, Solver, Tangent};
use crate::system::Linearized;
use crate::work::Work;

/// The constraints of one stage, with the factorisation for it and its scratch.
pub(super) struct Joined {
    joints: Vec<Joint>,
    /// Impulses (N s), three for each joint, and the first estimate of them.
    impulses: Vec<f64>,
    estimate: Vec<f64>,
    /// Changes of the impulses, and the rates of the equations that bring these about.
    changes: Vec<f64>,
    rates: Vec<f64>,
    saddle: Option<Saddle>,
    /// Positions at the end of the step, and the constraints there.
    end: Vec<f64>,
    at_end: Vec<Joint>,
}

/// Returns the constraints of a system, if it has some.
pub(super) fn held(system: &dyn Linearized) -> Option<&dyn Held> {
    system.held().map(|HeldView(held)| held)
}

/// Moves a state to where all constraints are met and stay so.
pub(super) fn project(system: &dyn Linearized, [x, v]: [&mut [f64]; 2]) {
    if let Some(held) = held(system) {
        held.project(x, v);
    }
}

impl Joined {
    /// Creates room for the constraints of a system.
    pub fn new(held: &dyn Held, tangent: &Tangent) -> Self {
        let (mut joints, end) = (vec![], vec![0.0; 3 * tangent.particles()]);
        held.joints(&end, &mut joints);
        let zeros = || vec![0.0; 3 * joints.len()];
        Self {
            impulses: zeros(),
            estimate: zeros(),
            changes: zeros(),
            rates: zeros(),
            saddle: Saddle::new(tangent, &joints),
            end,
            at_end: joints.clone(),
            joints,
        }
    }

    /// Estimates the impulses of a stage that begins in the state (x, v) with the free forces f.
    pub fn begin(&mut self, held: &dyn Held, (t, a): (f64, f64), state: [&[f64]; 2], f: &[f64]) {
        held.joints(state[0], &mut self.joints);
        held.multipliers(t, state, f, &mut self.estimate);
        self.estimate.iter_mut().for_each(|l| *l *= a);
        self.restart();
    }

    /// Returns to the first estimate of the impulses.
    pub fn restart(&mut self) {
        self.impulses.copy_from_slice(&self.estimate);
    }

    /// Finds the constraints at x, and the rates by which v has to change for them to be met, for a
    /// change of x by the gap and a times that of v.
    pub fn evaluate(
        &mut self,
        system: &dyn Linearized,
        (t, a): (f64, f64),
        [bx, x, gap]: [&[f64]; 3],
        newton: Newton,
    ) {
        let Some(held) = held(system) else {
            return;
        };
        held.joints(x, &mut self.joints);
        if newton == Newton::Mirrored {
            for ((end, x), bx) in self.end.iter_mut().zip(x).zip(bx) {
                *end = 2.0 * x - bx;
            }
            let n = x.len() / 3;
            system.pins(t + a, &mut |i, place| {
                for axis in 0..3 {
                    self.end[axis * n + i] = place.position[axis];
                }
            });
            held.joints(&self.end, &mut self.at_end);
            // The end moves twice as far as the middle.
            for (joint, end) in self.joints.iter_mut().zip(&self.at_end) {
                joint.values = end.values.map(|c| 0.5 * c);
            }
        }
        let rates = self.rates.as_chunks_mut::<3>().0;
        for (joint, rates) in self.joints.iter().zip(rates) {
            let gap = joint.relative(gap);
            for (k, rate) in rates.iter_mut().enumerate() {
                let holds = k < joint.count;
                *rate =
                    if holds { -(joint.values[k] + joint.gradients[k].dot(&gap)) / a } else { 0.0 };
            }
        }
    }

    /// Adds the impulses, changed by the gap, to the right-hand side.
    pub fn add_impulses(&self, gap: &[f64], rhs: &mut [f64]) {
        for (joint, impulses) in self.joints.iter().zip(self.impulses.as_chunks::<3>().0) {
            let terms = joint.gradients.iter().zip(impulses).take(joint.count);
            let turned = joint.turning(impulses) * joint.relative(gap);
            joint.spread(terms.fold(turned, |sum, (g, l)| sum + g * *l), rhs);
        }
    }

    /// Factorises the matrix for the tangent that the solver has assembled. Returns the work, and
    /// whether the matrix is of use.
    pub fn factorise(
        &mut self,
        solver: &mut Solver,
        system: &dyn Linearized,
        (a, clamped): (f64, bool),
    ) -> (Work, bool) {
        solver.tangent.list(system);
        let saddle = self.saddle.take().filter(|s| s.fits(&solver.tangent));
        let saddle = saddle.or_else(|| Saddle::new(&solver.tangent, &self.joints));
        let Some(saddle) = saddle else {
            return (Work::default(), false);
        };
        let saddle = self.saddle.insert(saddle);
        let step = (a, clamped);
        let factorised = saddle.factorise(&solver.tangent, &self.joints, &self.impulses, step);
        let work = Work {
            factorizations: 1,
            algebra: saddle.prices[0] * system.hints().speed,
            ..Work::default()
        };
        (work, factorised)
    }

    /// Solves for dv, and changes the impulses.
    pub fn solve(&mut self, system: &dyn Linearized, rhs: &[f64], dv: &mut [f64]) -> Work {
        let Some(saddle) = &mut self.saddle else {
            return Work::default();
        };
        saddle.solve([rhs, &self.rates], dv, &mut self.changes);
        for (impulse, change) in self.impulses.iter_mut().zip(&self.changes) {
            *impulse += change;
        }
        Work { solves: 1, algebra: saddle.prices[1] * system.hints().speed, ..Work::default() }
    }
}
