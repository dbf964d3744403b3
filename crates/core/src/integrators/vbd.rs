//! Vertex block descent (Chen, Liu, Macklin, Yang, Yuksel, *Vertex Block Descent*, 2024): implicit
//! Euler, solved by a fixed number of iterations over the particles. Each iteration takes a step of
//! Newton's method for one particle after another (Gauss-Seidel), with the others fixed. With the
//! prediction v* without springs, the mass m, and the forces F, stiffness K and damping C of the
//! springs at the particle,
//!
//! (m + h^2 K + h C) dv = m (v* - v) + h F, x += h dv.
//!
//! Stiffness across compressed springs is left out of K, so that the 3 x 3 matrix is positive
//! definite.
//!
//! Order 1 with any number of iterations, and implicit Euler in the limit of many. With few
//! iterations in a long step, events at one end of a chain of springs do not reach the other end;
//! nor is momentum conserved, since the ends of a spring are moved one after the other.

use super::integrator::{Integrator, check_dim};
use super::method::{Create, Method, View};
use super::prediction::{Prediction, springs_of, work};
use crate::control::Control;
use crate::error::Error;
use crate::spring::SpringLaw;
use crate::system::{Compliant, ParticleSystem};
use crate::work::Work;

/// Cost of an iteration, in evaluations of forces spring by spring: each spring is visited from
/// both ends. It was measured on cloth of 15 x 15 to 64 x 64 particles and on a jelly (see the
/// tests).
const PRICE: f64 = 6.5;
/// Number of iterations in a step.
const ITERATIONS: u32 = 10;

pub(super) const METHOD: Method = Method {
    name: "vbd",
    letter: Some('y'),
    aliases: &["vertex-block-descent"],
    title: "vertex block descent, 10 iterations",
    order: 1,
    default_control: Control::Step(0.02),
    evaluations: ITERATIONS,
    damped_evaluations: ITERATIONS,
    view: View::Springs,
    create: Create::Step(|system| Vbd::of(system, ITERATIONS)),
};

struct Vbd {
    iterations: u32,
    prediction: Prediction,
    /// Velocities v* (m/s).
    predicted: Vec<f64>,
    ends: SpringEnds,
}

impl Vbd {
    fn of(system: &dyn ParticleSystem, iterations: u32) -> Box<dyn Integrator> {
        let mut vbd = Self {
            iterations,
            prediction: Prediction::new(system.dim() / 6),
            predicted: vec![0.0; system.dim() / 2],
            ends: SpringEnds::default(),
        };
        if let Ok(system) = springs_of(system, METHOD.name) {
            vbd.ends.list(system);
        }
        Box::new(vbd)
    }
}

/// The ends of all springs, particle by particle.
#[derive(Default)]
struct SpringEnds {
    /// End index in `springs` of the springs of each particle.
    until: Vec<usize>,
    /// The particle at the other end, and the law.
    springs: Vec<(usize, SpringLaw)>,
}

impl SpringEnds {
    /// Lists the springs of a system by their ends.
    fn list(&mut self, system: &dyn Compliant) {
        let Self { until, springs } = self;
        until.clear();
        until.resize(system.inverse_masses().len(), 0);
        system.springs(&mut |ends, _| ends.into_iter().for_each(|i| until[i] += 1));
        let mut sum = 0;
        for until in until.iter_mut() {
            let count = std::mem::replace(until, sum);
            sum += count;
        }
        let none = SpringLaw { stiffness: 0.0, rest_length: 0.0, damping: 0.0 };
        springs.resize(sum, (0, none));
        system.springs(&mut |[i, j], law| {
            for (end, other) in [(i, j), (j, i)] {
                springs[until[end]] = (other, law);
                until[end] += 1;
            }
        });
    }

    /// Lists the springs of each particle, in the order of particles.
    fn by_particle(&self) -> impl Iterator<Item = &[(usize, SpringLaw)]> {
        let starts = std::iter::once(0).chain(self.until.iter().copied());
        starts.zip(&self.until).map(|(start, until)| &self.springs[start..*until])
    }
}

impl Integrator for Vbd {
    fn step(
        &mut self,
        system: &dyn ParticleSystem,
        t: f64,
        h: f64,
        y: &mut [f64],
    ) -> Result<Work, Error> {
        let Self { iterations, prediction, predicted, ends } = self;
        check_dim(2 * predicted.len(), y)?;
        let system = springs_of(system, METHOD.name)?;
        let (x, v) = y.split_at_mut(predicted.len());
        prediction.take(system, t, h, x, v);
        predicted.copy_from_slice(v);
        ends.list(system);
        for _ in 0..*iterations {
            for ((i, springs), w) in
                (ends.by_particle().enumerate()).zip(&prediction.inverse_masses)
            {
                if *w > 0.0 {
                    descend(i, springs, 1.0 / w, h, predicted, [x, v]);
                }
            }
        }
        Ok(work(system, *iterations, PRICE))
    }
}

/// Takes a step of Newton's method for particle i of mass m (kg).
fn descend(
    i: usize,
    springs: &[(usize, SpringLaw)],
    m: f64,
    h: f64,
    predicted: &[f64],
    [x, v]: [&mut [f64]; 2],
) {
    let n = x.len() / 3;
    let of = |a: &[f64], i: usize| [a[i], a[n + i], a[2 * n + i]];
    let (xi, vi, start) = (of(x, i), of(v, i), of(predicted, i));
    let mut r: [f64; 3] = std::array::from_fn(|a| m * (start[a] - vi[a]));
    let [mut xx, mut yy, mut zz, mut xy, mut xz, mut yz] = [m, m, m, 0.0, 0.0, 0.0];
    for (j, law) in springs {
        let (xj, vj) = (of(x, *j), of(v, *j));
        let d: [f64; 3] = std::array::from_fn(|a| xi[a] - xj[a]);
        let length = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        let u = d.map(|d| d * inverse);
        let mut pull = law.stiffness * (length - law.rest_length);
        if law.damping > 0.0 {
            let rate: f64 = (0..3).map(|a| u[a] * (vi[a] - vj[a])).sum();
            pull += law.damping * rate;
        }
        for a in 0..3 {
            r[a] -= h * pull * u[a];
        }
        let stretch = 1.0 - law.rest_length * inverse;
        let across = h * h * law.stiffness * stretch.max(0.0);
        let along = h * (h * law.stiffness + law.damping) - across;
        xx += across + along * u[0] * u[0];
        yy += across + along * u[1] * u[1];
        zz += across + along * u[2] * u[2];
        xy += along * u[0] * u[1];
        xz += along * u[0] * u[2];
        yz += along * u[1] * u[2];
    }
    // The inverse of the matrix by its minors.
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let scale = 1.0 / (xx * a + xy * b + xz * c);
    let (e, f, g) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
    let dv = [
        (a * r[0] + b * r[1] + c * r[2]) * scale,
        (b * r[0] + e * r[1] + f * r[2]) * scale,
        (c * r[0] + f * r[1] + g * r[2]) * scale,
    ];
    for axis in 0..3 {
        v[axis * n + i] += dv[axis];
        x[axis * n + i] += h * dv[axis];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;
    use crate::testing::{cloth, residual};

    #[test]
    #[cfg_attr(miri, ignore = "takes hours there")]
    fn many_iterations_are_implicit_euler() {
        let scene = cloth(Grid::new(6, 6).unwrap(), 1e-3);
        let network = scene.model.network().unwrap();
        let [one, ten, many] = [1, 10, 2000].map(|iterations| {
            let mut end = scene.state.clone();
            let mut vbd = Vbd::of(network, iterations);
            vbd.step(network, 0.0, 0.02, &mut end).unwrap();
            residual(network, 0.02, &scene.state, &end)
        });
        assert!(ten < one && many < 1e-11, "{one:e} {ten:e} {many:e}");
    }
}
