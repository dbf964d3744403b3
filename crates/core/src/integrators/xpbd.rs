//! Extended position-based dynamics, XPBD (Macklin, Mueller, Chentanez, *XPBD: Position-Based
//! Simulation of Compliant Constrained Dynamics*, 2016): implicit Euler, solved by a fixed number
//! of iterations over the springs. Each iteration corrects the springs one after another
//! (Gauss-Seidel), in their order. A spring of stiffness k, damping c, rest length r, length L and
//! rate of stretch L' receives the impulse dp along its direction, where p is the sum of its
//! previous impulses in the step:
//!
//! dp = -(h (k (L - r) + c L') + p) / (1 + (h^2 k + h c) (wi + wj)),
//!
//! with the inverse masses w of its ends. With its direction u, v += w dp u and x += h w dp u at
//! the end i, and the opposite at j. In terms of the paper, dp is the multiplier for the compliance
//! 1/k, divided by h: this form is accurate in short steps and allows a stiffness of 0. An
//! iteration conserves momentum.
//!
//! Order 1 with any number of iterations. In long steps, a single iteration (Macklin et al., *Small
//! Steps in Physics Simulation*, 2019, with many short steps) leaves springs softer than in
//! implicit Euler; more iterations make them as stiff. Even infinitely many do not quite converge
//! to implicit Euler, because springs turn between the corrections that are summed up.

use super::integrator::{Integrator, check_dim};
use super::method::{Create, Method, View};
use super::prediction::{Prediction, springs_of, work};
use crate::control::Control;
use crate::error::Error;
use crate::spring::SpringLaw;
use crate::system::ParticleSystem;
use crate::work::Work;

/// Cost of an iteration, in evaluations of forces spring by spring: each spring waits for the
/// previous one. It was measured on cloth of 15 x 15 to 64 x 64 particles and on a jelly (see the
/// tests).
const PRICE: f64 = 5.0;

pub(super) const METHOD: Method = Method {
    name: "xpbd",
    letter: Some('c'),
    aliases: &["xpbd1"],
    title: "XPBD, 1 iteration",
    order: 1,
    default_control: Control::Step(0.005),
    evaluations: 1,
    damped_evaluations: 1,
    view: View::Springs,
    create: Create::Step(|system| Xpbd::of(system, 1)),
};

pub(super) const TEN: Method = Method {
    name: "xpbd10",
    letter: Some('j'),
    aliases: &[],
    title: "XPBD, 10 iterations",
    default_control: Control::Step(0.02),
    evaluations: 10,
    damped_evaluations: 10,
    create: Create::Step(|system| Xpbd::of(system, 10)),
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
        let Self { iterations, prediction, impulses } = self;
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
        Ok(work(system, *iterations, PRICE))
    }
}

/// Corrects a spring with the sum p of its previous impulses (N s). Returns the impulse.
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
    let (wi, wj) = (inverse_masses[i[0]], inverse_masses[j[0]]);
    // Computed early, because the rest has to wait for the previous spring's effect on the ends.
    let share = 1.0 / (1.0 + h * (h * law.stiffness + law.damping) * (wi + wj));
    let mut pull = law.stiffness * (length - law.rest_length);
    if law.damping > 0.0 {
        let w: [f64; 3] = std::array::from_fn(|axis| v[i[axis]] - v[j[axis]]);
        pull += law.damping * (d[0] * w[0] + d[1] * w[1] + d[2] * w[2]) * inverse;
    }
    let impulse = -(h * pull + p) * share;
    let along = impulse * inverse;
    let (si, sj) = (wi * along, wj * along);
    for axis in 0..3 {
        let (dvi, dvj) = (si * d[axis], sj * d[axis]);
        v[i[axis]] += dvi;
        x[i[axis]] += h * dvi;
        v[j[axis]] -= dvj;
        x[j[axis]] -= h * dvj;
    }
    impulse
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{cloth, residual};
    use crate::{Grid, Network, Path, Spring, SpringKind, Vector3};

    fn step(network: &Network, h: f64, y: &[f64], iterations: u32) -> f64 {
        let mut end = y.to_vec();
        let mut xpbd = Xpbd::of(network, iterations);
        xpbd.step(network, 0.0, h, &mut end).unwrap();
        residual(network, h, y, &end)
    }

    /// On a straight chain no spring turns, and many iterations converge to implicit Euler.
    #[test]
    fn many_iterations_on_a_straight_chain_are_implicit_euler() {
        let mut network = Network::new(vec![0.1; 6]).unwrap();
        let law = SpringLaw::new(80.0, 0.5, 0.3).unwrap();
        for i in 0..5 {
            let (kind, j) = (SpringKind::Structural, i + 1);
            network.add_spring(Spring { kind, i, j, law }).unwrap();
        }
        network.pin(0, Path::Still(Vector3::zeros())).unwrap();
        network.set_gravity(Vector3::new(9.81, 0.0, 0.0));
        network.set_drag(0.05).unwrap();
        let mut y = vec![0.0; 36];
        for (i, x) in y[..6].iter_mut().enumerate() {
            *x = 0.55 * i as f64;
        }
        let [few, many] = [10, 2000].map(|iterations| step(&network, 0.05, &y, iterations));
        assert!(few > 1e-3 && many < 1e-12, "{few:e} {many:e}");
    }

    /// On a cloth springs turn between corrections: the remaining error does not vanish.
    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn many_iterations_on_a_cloth_come_close_to_implicit_euler() {
        let scene = cloth(Grid::new(6, 6).unwrap(), 1e-3);
        let network = scene.model.network().unwrap();
        let of = |iterations| step(network, 0.02, &scene.state, iterations);
        let [one, ten, many, more] = [1, 10, 1000, 2000].map(of);
        println!("{one:e} {ten:e} {many:e} {more:e}");
        assert!(ten < one && many < 0.1 * one, "{one:e} {ten:e} {many:e}");
        assert!(many > 1e-6 && (more / many - 1.0).abs() < 1e-6, "{many:e} {more:e}");
    }
}
