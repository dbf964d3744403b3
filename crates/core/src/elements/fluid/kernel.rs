//! The kernel of a fluid: Wendland's function W = s (1 - q)^4 (1 + 4 q), q = r / reach, of class C2
//! (Wendland, *Piecewise polynomial, positive definite and compactly supported radial functions*,
//! 1995; Dehnen, Aly, *Improving convergence in smoothed particle hydrodynamics simulations without
//! pairing instability*, 2012).

use super::triple::{Triple, dot, minus};

/// Reach of the kernel over the spacing of the particles.
const RELATIVE_REACH: f64 = 2.6;

/// Wendland's kernel. The factor s makes the density of a lattice of particles at the spacing
/// exactly one particle a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kernel {
    /// Distance (m) from which on the kernel is 0.
    pub reach: f64,
    /// Factor s (1/m^2 or 1/m^3).
    factor: f64,
}

impl Kernel {
    /// Creates the kernel in two or three dimensions for particles at a spacing (m).
    pub fn new(dimensions: u8, spacing: f64) -> Self {
        let places = || -2..=2_i32;
        let mut sum = 0.0;
        for x in places() {
            for y in places() {
                for z in places().filter(|z| dimensions == 3 || *z == 0) {
                    let square = f64::from(x * x + y * y + z * z);
                    sum += shape(square.sqrt() / RELATIVE_REACH);
                }
            }
        }
        let cell = spacing.powi(i32::from(dimensions));
        Self {
            reach: RELATIVE_REACH * spacing,
            factor: 1.0 / (sum * cell),
        }
    }

    /// Returns W at a distance r (m) less than the reach.
    #[inline]
    pub fn value(&self, r: f64) -> f64 {
        self.factor * shape(r / self.reach)
    }

    /// Returns W' / r at a distance r (m) less than the reach. The gradient of W is this times the
    /// vector of length r.
    #[inline]
    pub fn slope(&self, r: f64) -> f64 {
        let rest = 1.0 - r / self.reach;
        -20.0 * self.factor / (self.reach * self.reach) * (rest * rest * rest)
    }

    /// Returns the derivative of [`slope`](Self::slope) with respect to r.
    #[inline]
    pub fn bend(&self, r: f64) -> f64 {
        let rest = 1.0 - r / self.reach;
        60.0 * self.factor / (self.reach * self.reach * self.reach) * (rest * rest)
    }
}

/// Returns (1 - q)^4 (1 + 4 q), and 0 from q = 1 on.
#[inline]
fn shape(q: f64) -> f64 {
    let rest = (1.0 - q).max(0.0);
    let square = rest * rest;
    square * square * (1.0 + 4.0 * q)
}

/// Visits the particles within the kernel's reach of particle i: the number of each, the vector
/// from it to i, and the distance (m).
#[inline]
pub(super) fn each(
    kernel: Kernel,
    x: &[Triple],
    i: usize,
    near: &[u32],
    mut visit: impl FnMut(usize, Triple, f64),
) {
    let (here, most) = (x[i], kernel.reach * kernel.reach);
    for j in near {
        let j = *j as usize;
        let d = minus(here, x[j]);
        let square = dot(d, d);
        if square < most {
            visit(j, d, square.sqrt());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;
    use std::f64::consts::PI;

    /// The factor from the lattice is near the one that makes the integral of W 1.
    #[test]
    fn the_kernel_has_an_integral_near_one() {
        for (dimensions, integral) in [(2, PI / 7.0), (3, 2.0 * PI / 21.0)] {
            let kernel = Kernel::new(dimensions, 0.3);
            let exact = 1.0 / (integral * kernel.reach.powi(i32::from(dimensions)));
            assert_relative_eq!(kernel.factor, exact, max_relative = 0.02);
        }
    }

    #[test]
    fn slopes_are_derivatives() {
        let kernel = Kernel::new(3, 0.5);
        for r in [0.01, 0.3, 0.9, 1.29] {
            let e = 1e-6;
            let slope = (kernel.value(r + e) - kernel.value(r - e)) / (2.0 * e);
            assert_relative_eq!(kernel.slope(r) * r, slope, max_relative = 1e-5);
            let bend = (kernel.slope(r + e) - kernel.slope(r - e)) / (2.0 * e);
            assert_relative_eq!(kernel.bend(r), bend, max_relative = 1e-5);
        }
        assert_eq!(kernel.value(kernel.reach), 0.0);
    }
}
