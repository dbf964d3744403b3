//! The law of a fluid: its viscosity, and Tait's equation of state, by which the pressure grows
//! steeply with the density.
//!
//! The kernel of a fluid: Wendland's function W = s (1 - q)^4 (1 + 4 q), q = r / reach, of class C2
//! (Wendland, *Piecewise polynomial, positive definite and compactly supported radial functions*,
//! 1995; Dehnen, Aly, *Improving convergence in smoothed particle hydrodynamics simulations without
//! pairing instability*, 2012).

use super::triple::{Triple, dot, minus};
use crate::error::{Error, at_least, positive};

/// Law of a weakly compressible fluid. With s = rho / rho0, its pressure is
/// p = rho0 c^2 / 7 (s^7 - 1), and 0 where it is less dense than at rest, as at its surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FluidLaw {
    /// Number of dimensions, 2 or 3. In two, the fluid is a sheet across z, 1 m deep.
    pub dimensions: u8,
    /// Distance of neighbouring particles at rest (m).
    pub spacing: f64,
    /// Density at rest rho0 (kg/m3).
    pub density: f64,
    /// Speed of sound c (m/s).
    pub sound: f64,
    /// Kinematic viscosity (m2/s).
    pub viscosity: f64,
}

impl FluidLaw {
    /// Checks the numbers of the law.
    ///
    /// # Errors
    /// The dimensions are not 2 or 3; the spacing, the density or the speed of sound is not a
    /// finite number above 0, or the viscosity not one of at least 0.
    pub fn check(&self) -> Result<(), Error> {
        if !matches!(self.dimensions, 2 | 3) {
            let why = format!("a fluid has 2 or 3 dimensions, not {}", self.dimensions);
            return Err(Error::Invalid(why));
        }
        positive("the spacing of a fluid", self.spacing)?;
        positive("the density of a fluid", self.density)?;
        positive("the speed of sound of a fluid", self.sound)?;
        at_least(0.0, "the viscosity of a fluid", self.viscosity)?;
        // The largest numbers in the forces on a particle, and its mass.
        let pushes = self.sound * self.sound / self.density + self.viscous_factor();
        let largest = pushes * self.kernel().bend(0.0) * self.mass();
        if largest.is_finite() && self.mass().recip().is_finite() {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "a fluid of such small particles cannot be computed: its spacing is {} m and its \
             density {} kg/m3",
            self.spacing, self.density
        )))
    }

    /// Returns the mass of each particle (kg): that of a cell of the lattice at rest.
    #[must_use]
    pub fn mass(&self) -> f64 {
        self.density * self.spacing.powi(i32::from(self.dimensions))
    }

    /// Returns the kernel of the fluid.
    pub(super) fn kernel(&self) -> Kernel {
        Kernel::new(self.dimensions, self.spacing)
    }

    /// Returns the factor of the viscous force (m^5/(kg s)): 2 (dimensions + 2) nu / rho0, with
    /// which the sum converges to the viscous force of a continuum (Monaghan, *Smoothed particle
    /// hydrodynamics*, 2005).
    pub(super) fn viscous_factor(&self) -> f64 {
        2.0 * f64::from(self.dimensions + 2) * self.viscosity / self.density
    }

    /// Returns rho0 c^2 / 7 (Pa).
    fn modulus(&self) -> f64 {
        self.density * self.sound * self.sound / 7.0
    }

    /// Returns the pressure (Pa) at a density (kg/m3).
    pub(super) fn pressure(&self, density: f64) -> f64 {
        let s = density / self.density;
        let more = (s - 1.0).max(0.0);
        self.modulus() * more * horner(s, [1.0; 7])
    }

    /// Returns p / rho^2 (m^5/(kg s^2)) at a density (kg/m3).
    #[inline]
    pub(super) fn push(&self, density: f64) -> f64 {
        self.pressure(density) / (density * density)
    }

    /// Returns the derivative of [`push`](Self::push) with respect to the density.
    #[inline]
    pub(super) fn push_slope(&self, density: f64) -> f64 {
        if density <= self.density {
            return 0.0;
        }
        let s = density / self.density;
        let square = s * s;
        let slope = self.sound * self.sound * (square * square * square);
        (slope - 2.0 * self.pressure(density) / density) / (density * density)
    }

    /// Returns the energy per mass (J/kg) at a density (kg/m3), the integral of p / rho^2: with
    /// d = s - 1, c^2 / 42 d^2 / s (6 + 5 s + 4 s^2 + 3 s^3 + 2 s^4 + s^5).
    pub(super) fn energy(&self, density: f64) -> f64 {
        let s = density / self.density;
        let more = (s - 1.0).max(0.0);
        let series = horner(s, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        self.sound * self.sound / 42.0 * (more * more) / s * series
    }
}

/// Returns the polynomial with these coefficients, that of the highest power first.
#[inline]
fn horner<const N: usize>(s: f64, coefficients: [f64; N]) -> f64 {
    coefficients.iter().fold(0.0, |sum, c| sum * s + c)
}

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
        Self { reach: RELATIVE_REACH * spacing, factor: 1.0 / (sum * cell) }
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
    use std::f64::consts::PI;

    use approx::assert_relative_eq;

    use super::*;

    const WATER: FluidLaw =
        FluidLaw { dimensions: 2, spacing: 0.05, density: 1000.0, sound: 30.0, viscosity: 0.0 };

    #[test]
    fn the_pressure_is_that_of_tait() {
        for s in [0.5_f64, 1.0, 1.001, 1.1] {
            // The rounding of powers is not specified.
            let expected = 1000.0 * 900.0 / 7.0 * (s.powi(7) - 1.0).max(0.0);
            let pressure = WATER.pressure(1000.0 * s);
            assert_relative_eq!(pressure, expected, max_relative = 1e-12, epsilon = 1e-9);
        }
        assert_eq!(WATER.push(700.0), 0.0);
        assert_eq!(WATER.energy(700.0), 0.0);
    }

    #[test]
    fn the_energy_is_the_integral_and_the_slope_the_derivative_of_the_push() {
        for density in [1003.0, 1100.0, 1500.0] {
            let e = 1e-3;
            let difference = |f: &dyn Fn(f64) -> f64| (f(density + e) - f(density - e)) / (2.0 * e);
            let push = difference(&|d| WATER.energy(d));
            assert_relative_eq!(WATER.push(density), push, max_relative = 1e-6);
            let slope = difference(&|d| WATER.push(d));
            assert_relative_eq!(WATER.push_slope(density), slope, max_relative = 1e-6);
        }
    }

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
