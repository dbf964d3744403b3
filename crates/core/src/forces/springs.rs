//! Springs: with d = xi - xj, L = |d|, u = d/L and w = vi - vj, the force on i is
//! -(k (L - r) + c (w . u)) u, and its opposite on j. A spring of length zero has no direction, and no force.

use crate::spring::{Spring, SpringLaw};
use crate::system::Coupling;

/// Adds the forces of single springs.
pub(crate) fn add_list(list: &[Spring], x: &[f64], v: &[f64], f: &mut [f64]) {
    let n = x.len() / 3;
    let (x, y, z) = (&x[..n], &x[n..2 * n], &x[2 * n..]);
    let (u, v, w) = (&v[..n], &v[n..2 * n], &v[2 * n..]);
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for &Spring { i, j, law, .. } in list {
        let (dx, dy, dz) = (x[i] - x[j], y[i] - y[j], z[i] - z[j]);
        let length = (dx * dx + dy * dy + dz * dz).sqrt();
        if length == 0.0 {
            continue;
        }
        let mut pull = law.stiffness * (length - law.rest_length);
        if law.damping > 0.0 {
            let rate = (u[i] - u[j]) * dx + (v[i] - v[j]) * dy + (w[i] - w[j]) * dz;
            pull += law.damping * rate / length;
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
/// -k ((1 - r/L) dd + (r/L) u (u . dd)) - c ((dw . u + w . p) u + (w . u) p).
pub(crate) fn add_differential(
    spring: &Spring,
    x: &[f64],
    v: &[f64],
    dx: &[f64],
    dv: &[f64],
    df: &mut [f64],
) {
    let (i, j) = (spring.i, spring.j);
    let SpringLaw {
        stiffness: k,
        rest_length: r,
        damping: c,
    } = spring.law;
    let d = difference(x, i, j);
    let dd = difference(dx, i, j);
    let length = dot(d, d).sqrt();
    let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
    let u = d.map(|d| d * inverse);
    let along = dot(u, dd);
    let mut force: [f64; 3] =
        std::array::from_fn(|a| k * ((1.0 - r * inverse) * dd[a] + r * inverse * along * u[a]));
    if c > 0.0 {
        let w = difference(v, i, j);
        let dw = difference(dv, i, j);
        let p: [f64; 3] = std::array::from_fn(|a| (dd[a] - u[a] * along) * inverse);
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

/// The symmetric part of a spring's differential: k along it, k (1 - r/L) across. At length zero it has no direction.
pub(crate) fn coupling(spring: &Spring, x: &[f64]) -> Coupling {
    let (i, j) = (spring.i, spring.j);
    let SpringLaw {
        stiffness,
        rest_length,
        damping,
    } = spring.law;
    let d = difference(x, i, j);
    let length = dot(d, d).sqrt();
    let inverse = if length > 0.0 { 1.0 / length } else { 0.0 };
    Coupling {
        i,
        j,
        direction: d.map(|d| d * inverse),
        along: stiffness,
        across: stiffness * (1.0 - rest_length * inverse),
        damping,
    }
}

/// L (m).
pub(crate) fn length(x: &[f64], spring: &Spring) -> f64 {
    let d = difference(x, spring.i, spring.j);
    dot(d, d).sqrt()
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
