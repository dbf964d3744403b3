//! Springs: with d = xi - xj, L = |d|, u = d/L and w = vi - vj, the force on i is -(p(L) + c (w . u)) u, and its opposite
//! on j; p is its pull, k (L - r) of most. A spring of length zero has no direction, and no force.

use crate::spring::Spring;
use crate::system::Coupling;

/// What pulls two particles together, or pushes them apart, by their distance (m).
pub(crate) trait Elastic {
    fn ends(&self) -> [usize; 2];

    /// p (N).
    fn pull(&self, length: f64) -> f64;

    /// dp/dL (N/m).
    fn stiffness(&self, length: f64) -> f64;

    /// What was put into it since it had its rest length (J).
    fn energy(&self, length: f64) -> f64;

    /// c, along it (N s/m).
    fn damping(&self) -> f64;
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
    fn damping(&self) -> f64 {
        self.law.damping
    }
}

/// Adds the forces of single springs.
pub(crate) fn add_list(list: &[impl Elastic], x: &[f64], v: &[f64], f: &mut [f64]) {
    let n = x.len() / 3;
    let (x, y, z) = (&x[..n], &x[n..2 * n], &x[2 * n..]);
    let (u, v, w) = (&v[..n], &v[n..2 * n], &v[2 * n..]);
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for spring in list {
        let [i, j] = spring.ends();
        let (dx, dy, dz) = (x[i] - x[j], y[i] - y[j], z[i] - z[j]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        if length == 0.0 {
            continue;
        }
        let mut pull = spring.pull(length);
        let damping = spring.damping();
        if damping > 0.0 {
            let rate = (u[i] - u[j]) * dx + (v[i] - v[j]) * dy + (w[i] - w[j]) * dz;
            pull += damping * rate / length;
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

/// Adds dF of one spring. With dd = dxi - dxj, dw = dvi - dvj and p = (dd - u (u . dd)) / L, that is
/// -(across dd + (along - across) u (u . dd)) - c ((dw . u + w . p) u + (w . u) p).
pub(crate) fn add_differential(
    coupling: &Coupling,
    x: &[f64],
    v: &[f64],
    dx: &[f64],
    dv: &[f64],
    df: &mut [f64],
) {
    let Coupling {
        i,
        j,
        direction: u,
        along,
        across,
        damping: c,
    } = *coupling;
    let dd = difference(dx, i, j);
    let share = dot(u, dd);
    let mut force: [f64; 3] =
        std::array::from_fn(|a| across * dd[a] + (along - across) * share * u[a]);
    if c > 0.0 {
        let length = norm(difference(x, i, j));
        let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
        let w = difference(v, i, j);
        let dw = difference(dv, i, j);
        let p: [f64; 3] = std::array::from_fn(|a| (dd[a] - u[a] * share) * inverse);
        let (rate, turn) = (dot(dw, u) + dot(w, p), dot(w, u));
        for a in 0..3 {
            force[a] += c * (rate * u[a] + turn * p[a]);
        }
    }
    let n = x.len() / 3;
    for axis in 0..3 {
        df[axis * n + i] -= force[axis];
        df[axis * n + j] += force[axis];
    }
}

/// The symmetric part of a spring's differential: dp/dL along it, p/L across. At length zero it has no direction.
pub(crate) fn coupling(spring: &impl Elastic, x: &[f64]) -> Coupling {
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
    Coupling {
        i,
        j,
        direction: d.map(|d| d * inverse),
        along,
        across,
        damping: spring.damping(),
    }
}

/// The energy in a spring (J).
pub(crate) fn energy(spring: &impl Elastic, x: &[f64]) -> f64 {
    spring.energy(length(x, spring))
}

/// L (m).
pub(crate) fn length(x: &[f64], spring: &impl Elastic) -> f64 {
    let [i, j] = spring.ends();
    norm(difference(x, i, j))
}

#[inline]
fn difference(a: &[f64], i: usize, j: usize) -> [f64; 3] {
    let n = a.len() / 3;
    [
        a[i] - a[j],
        a[n + i] - a[n + j],
        a[2 * n + i] - a[2 * n + j],
    ]
}

#[inline]
fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
fn norm(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}
