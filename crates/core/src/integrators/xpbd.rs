//! Extended position-based dynamics, XPBD (Macklin, Mueller, Chentanez, *XPBD: Position-Based
//! Simulation of Compliant Constrained Dynamics*, 2016): implicit Euler, solved by a fixed number
//! of iterations over the springs. Each iteration corrects the springs one after another
//! (Gauss-Seidel), in their order. A spring of stiffness k, damping c, rest length r and length L,
//! its ends approaching with the speed -L', receives the impulse dp along its direction u, where p
//! is the sum of those before in the step:
//!
//! dp = -(h (k (L - r) + c L') + p) / (1 + (h^2 k + h c) (wi + wj)),
//!
//! with the inverse masses w of its ends; v += w dp u and x += h w dp u at the end i, and the
//! opposite at j. That is the paper's multiplier with the compliance 1/k, times h, which keeps the
//! digits of v in short steps and needs no stiffness above 0. An iteration conserves momentum.
//!
//! Order 1 with any number of iterations. With a single one in each of many short steps (Macklin et
//! al., *Small Steps in Physics Simulation*, 2019), springs are softer and less damped than implicit
//! Euler has them; only more iterations make them as stiff. Even without end these do not quite meet
//! implicit Euler, because springs turn between the corrections that are summed up.

use super::prediction::{Prediction, springs_of, work};
use super::{Integrator, Method, Work, check_dim};
use crate::control::Control;
use crate::error::Error;
use crate::spring::SpringLaw;
use crate::system::ParticleSystem;

/// Price of an iteration, in evaluations of forces spring by spring, and that of the rest of a
/// step: both measured.
const PRICES: [f64; 2] = [2.0, 0.5];

pub(super) const METHOD: Method = Method {
    name: "xpbd",
    letter: 'c',
    aliases: &["xpbd1"],
    title: "XPBD, 1 iteration",
    order: 1,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 1,
    implicit: true,
    needs_mechanics: true,
    needs_springs: true,
    create: |system| Xpbd::of(system, 1),
    trial: None,
};

pub(super) const TEN: Method = Method {
    name: "xpbd10",
    letter: 'q',
    aliases: &[],
    title: "XPBD, 10 iterations",
    default_control: Control::Step(0.02),
    evaluations: 10,
    damped_evaluations: 10,
    create: |system| Xpbd::of(system, 10),
    ..METHOD
};

struct Xpbd {
    iterations: u32,
    prediction: Prediction,
    /// Sum of the impulses of each spring (N s).
    impulses: Vec<f64>,
}

impl Xpbd {
    fn of(system: &dyn ParticleSystem, iterations: u32) -> Box<dyn Integrator> {
        let mut springs = 0;
        if let Ok(system) = springs_of(system, METHOD.name) {
            system.springs(&mut |_, _| springs += 1);
        }
        Box::new(Self {
            iterations,
            prediction: Prediction::new(system.dim() / 6),
            impulses: vec![0.0; springs],
        })
    }
}

impl Integrator for Xpbd {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let Self {
            iterations,
            prediction,
            impulses,
        } = self;
        check_dim(6 * prediction.inverse_masses.len(), y)?;
        let system = springs_of(system, METHOD.name)?;
        let (x, v) = y.split_at_mut(y.len() / 2);
        prediction.take(system, t, h, x, v);
        impulses.fill(0.0);
        for _ in 0..*iterations {
            let mut spring = 0;
            system.springs(&mut |ends, law| {
                if spring == impulses.len() {
                    impulses.push(0.0);
                }
                let p = &mut impulses[spring];
                *p += correct(ends, law, *p, h, &prediction.inverse_masses, [x, v]);
                spring += 1;
            });
        }
        Ok(work(system, *iterations, PRICES[0], PRICES[1]))
    }
}

/// Corrects a spring on which impulses of the sum p (N s) acted before. Returns the impulse.
#[inline]
fn correct(
    [i, j]: [usize; 2],
    law: SpringLaw,
    p: f64,
    h: f64,
    inverse_masses: &[f64],
    [x, v]: [&mut [f64]; 2],
) -> f64 {
    let n = inverse_masses.len();
    let (i, j) = ([i, n + i, 2 * n + i], [j, n + j, 2 * n + j]);
    let d: [f64; 3] = std::array::from_fn(|axis| x[i[axis]] - x[j[axis]]);
    let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
    if length == 0.0 {
        return 0.0;
    }
    let inverse = 1.0 / length;
    let u = d.map(|d| d * inverse);
    let (wi, wj) = (inverse_masses[i[0]], inverse_masses[j[0]]);
    let rate = if law.damping > 0.0 {
        (0..3).map(|axis| u[axis] * (v[i[axis]] - v[j[axis]])).sum()
    } else {
        0.0
    };
    let pull = law.stiffness * (length - law.rest_length) + law.damping * rate;
    let response = h * (h * law.stiffness + law.damping) * (wi + wj);
    let impulse = -(h * pull + p) / (1.0 + response);
    for axis in 0..3 {
        let (dvi, dvj) = (wi * impulse * u[axis], wj * impulse * u[axis]);
        v[i[axis]] += dvi;
        x[i[axis]] += h * dvi;
        v[j[axis]] -= dvj;
        x[j[axis]] -= h * dvj;
    }
    impulse
}
