//! Positions and velocities of the particles of a fluid, each in three numbers.

/// A position or a velocity.
pub(super) type Triple = [f64; 3];

#[inline]
pub(super) fn minus(a: Triple, b: Triple) -> Triple {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline]
pub(super) fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline]
pub(super) fn add_scaled(to: &mut Triple, s: f64, d: Triple) {
    for (to, d) in to.iter_mut().zip(d) {
        *to += s * d;
    }
}

/// Returns the square of the distance (m2) of two points.
#[inline]
pub(super) fn squared_distance(a: &Triple, b: &Triple) -> f64 {
    let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    x * x + y * y + z * z
}
