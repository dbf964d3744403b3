//! Springs one by one. With d = xi - xj, L = |d|, u = d/L and w = vi - vj, a spring exerts the
//! force -(p(L) + c (w . u)) u on i, and the opposite force on j. p is the pull, for most springs k
//! (L - r). A spring of length zero has no direction, and no force.

use super::force::At;
use crate::coupling::{AxialCoupling, Coupling};
use crate::energy::Energy;
use crate::spring::Spring;

/// A force between two particles along the line between them, as a function of their distance (m).
pub(super) trait Elastic {
    /// Whether damping cannot make it push.
    const ONLY_PULLS: bool = false;

    /// Returns the particles at the ends.
    fn ends(&self) -> [usize; 2];

    /// Returns the pull p (N); negative if the spring pushes.
    fn pull(&self, length: f64) -> f64;

    /// Returns the stiffness dp/dL (N/m).
    fn stiffness(&self, length: f64) -> f64;

    /// Returns the energy above that at the rest length (J).
    fn energy(&self, length: f64) -> f64;

    /// Returns the damping c along it (N s/m).
    fn damping(&self, length: f64) -> f64;
}

impl Elastic for Spring {
    #[inline]
    fn ends(&self) -> [usize; 2] {
        [self.i, self.j]
    }

    #[inline]
    fn pull(&self, length: f64) -> f64 {
        self.law.stiffness * (length - self.law.rest_length)
    }

    #[inline]
    fn stiffness(&self, _: f64) -> f64 {
        self.law.stiffness
    }

    fn energy(&self, length: f64) -> f64 {
        0.5 * self.law.stiffness * (length - self.law.rest_length).powi(2)
    }

    #[inline]
    fn damping(&self, _: f64) -> f64 {
        self.law.damping
    }
}

/// Adds the forces of springs.
pub(super) fn add_all<E: Elastic>(springs: &[E], x: &[f64], v: &[f64], f: &mut [f64]) {
    let n = x.len() / 3;
    let (x, y, z) = (&x[..n], &x[n..2 * n], &x[2 * n..]);
    let (u, v, w) = (&v[..n], &v[n..2 * n], &v[2 * n..]);
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for spring in springs {
        let [i, j] = spring.ends();
        let (dx, dy, dz) = (x[i] - x[j], y[i] - y[j], z[i] - z[j]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        if length == 0.0 {
            continue;
        }
        let mut pull = spring.pull(length);
        let damping = spring.damping(length);
        if damping > 0.0 {
            let rate = (u[i] - u[j]) * dx + (v[i] - v[j]) * dy + (w[i] - w[j]) * dz;
            pull += damping * rate / length;
            if E::ONLY_PULLS {
                pull = pull.max(0.0);
            }
        }
        let s = pull / length;
        fx[i] -= s * dx;
        fy[i] -= s * dy;
        fz[i] -= s * dz;
        fx[j] += s * dx;
        fy[j] += s * dy;
        fz[j] += s * dz;
    }
}

/// Adds dF of a spring. With dd = dxi - dxj, dw = dvi - dvj and p = (dd - u (u . dd)) / L, it is
/// -(across dd + (along - across) u (u . dd)) - c ((dw . u + w . p) u + (w . u) p).
pub(super) fn add_differential<E: Elastic>(
    spring: &E,
    at: &At,
    [dx, dv]: [&[f64]; 2],
    df: &mut [f64],
) {
    let AxialCoupling { i, j, direction: u, along, across, damping: c } = axial(spring, at.x);
    let dd = difference(dx, i, j);
    let share = dot(u, dd);
    if E::ONLY_PULLS && c > 0.0 {
        let length = norm(difference(at.x, i, j));
        if spring.pull(length) + c * dot(difference(at.v, i, j), u) < 0.0 {
            return;
        }
    }
    let mut force: [f64; 3] =
        std::array::from_fn(|a| across * dd[a] + (along - across) * share * u[a]);
    if c > 0.0 {
        let length = norm(difference(at.x, i, j));
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        let w = difference(at.v, i, j);
        let dw = difference(dv, i, j);
        let p: [f64; 3] = std::array::from_fn(|a| (dd[a] - u[a] * share) * inverse);
        let (rate, turn) = (dot(dw, u) + dot(w, p), dot(w, u));
        for a in 0..3 {
            force[a] += c * (rate * u[a] + turn * p[a]);
        }
    }
    let n = df.len() / 3;
    for axis in 0..3 {
        df[axis * n + i] -= force[axis];
        df[axis * n + j] += force[axis];
    }
}

/// Returns the symmetric part of a spring's differential: dp/dL along it, p/L across. A spring of
/// length zero has no direction.
#[inline]
fn axial(spring: &impl Elastic, x: &[f64]) -> AxialCoupling {
    let [i, j] = spring.ends();
    let d = difference(x, i, j);
    let length = norm(d);
    let along = spring.stiffness(length);
    let (inverse, across) = if length > 0.0 {
        let inverse = 1.0 / length;
        (inverse, spring.pull(length) * inverse)
    } else {
        (0.0, along)
    };
    AxialCoupling {
        i,
        j,
        direction: d.map(|d| d * inverse),
        along,
        across,
        damping: spring.damping(length),
    }
}

/// Returns the coupling of a spring. With `clamped`, the negative stiffness across a compressed
/// spring is taken as 0 (Choi, Ko, *Stable but responsive cloth*, 2002).
#[inline]
pub(super) fn coupling(spring: &impl Elastic, x: &[f64], clamped: bool) -> Coupling {
    let mut axial = axial(spring, x);
    if clamped {
        axial.across = axial.across.max(0.0);
    }
    Coupling::Axial(axial)
}

/// Returns the energy of springs.
pub(super) fn energy<E: Elastic>(springs: impl IntoIterator<Item = E>, x: &[f64]) -> Energy {
    let of_one = |spring: E| {
        let [i, j] = spring.ends();
        spring.energy(norm(difference(x, i, j)))
    };
    Energy { elastic: springs.into_iter().map(of_one).sum(), ..Energy::default() }
}

#[inline]
fn difference(a: &[f64], i: usize, j: usize) -> [f64; 3] {
    let n = a.len() / 3;
    [a[i] - a[j], a[n + i] - a[n + j], a[2 * n + i] - a[2 * n + j]]
}

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
