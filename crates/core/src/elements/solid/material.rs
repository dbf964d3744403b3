//! Materials of solids: an energy of the deformation gradient F, and viscosity. With J = det F, I =
//! F : F and the strain E = (FT F - 1) / 2, the energy of a volume is
//!
//! - after Saint Venant and Kirchhoff mu E : E + lambda/2 (tr E)2, Hooke's law for large rotations;
//!   a tetrahedron and its mirror image have the same energy;
//! - stable neo-Hookean m/2 (I - 3) + l/2 (J - a)2 - m/2 log(I + 1), which is finite for every F,
//!   with m = 4 mu / 3, l = lambda + 5 mu / 6 and a = 1 + 3 m / (4 l): it rests at F = 1, and has
//!   Hooke's law there (Smith, de Goes, Kim, *Stable Neo-Hookean Flesh Simulation*, 2018).
//!
//! Viscosity after Kelvin and Voigt adds tau (lambda tr E' 1 + 2 mu E') to the second
//! Piola-Kirchhoff stress. In a rigid motion E' is zero.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use super::number::{
    Matrix, Number, cofactors, contraction, dot, plus, product, scaled, sum, symmetric,
};
use crate::error::{Error, at_least, positive};

/// Energy of an elastic material.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Hyperelastic {
    /// Stable neo-Hookean energy, which turns an inverted tetrahedron back.
    #[default]
    NeoHookean,
    /// Energy after Saint Venant and Kirchhoff, by which an inverted tetrahedron can be at rest,
    /// too.
    StVenantKirchhoff,
}

/// Elastic material with viscosity.
///
/// ```
/// use a3_core::elements::{Hyperelastic, Material};
///
/// let model = Hyperelastic::StVenantKirchhoff;
/// let rubber = Material { model, young: 1e6, poisson: 0.45, damping: 0.0 };
/// // mu = E / (2 (1 + nu)).
/// assert!(rubber.lame().iter().any(|it| (it / (1e6 / 2.9) - 1.0).abs() < 1e-12));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Material {
    /// Energy of the deformation.
    pub model: Hyperelastic,
    /// Young's modulus (Pa).
    pub young: f64,
    /// Poisson's ratio.
    pub poisson: f64,
    /// Viscosity over stiffness, tau (s).
    pub damping: f64,
}

impl Material {
    /// Checks the numbers of the material.
    ///
    /// # Errors
    /// Young's modulus is not a finite number above 0, Poisson's ratio not one between -1 and 0.5,
    /// or the damping not one of at least 0.
    pub fn check(&self) -> Result<(), Error> {
        positive("Young's modulus", self.young)?;
        if !(self.poisson > -1.0 && self.poisson < 0.5) {
            return Err(Error::Invalid(format!(
                "Poisson's ratio must be above -1 and below 0.5, such as 0.3, not {}",
                self.poisson
            )));
        }
        at_least(0.0, "the damping", self.damping)?;
        let moduli = self.lame();
        if moduli.iter().all(|k| (k * (1.0 + self.damping)).is_finite()) && moduli[1] > 0.0 {
            return Ok(());
        }
        Err(Error::Invalid(format!(
            "Young's modulus {:e} with Poisson's ratio {} and damping {:e} is beyond all numbers",
            self.young, self.poisson, self.damping
        )))
    }

    /// Returns the parameters lambda and mu of Lamé (Pa).
    #[must_use]
    pub fn lame(&self) -> [f64; 2] {
        let Self { young, poisson, .. } = *self;
        [
            young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)),
            young / (2.0 * (1.0 + poisson)),
        ]
    }

    /// Returns the parameters m, l and a of the neo-Hookean energy (Pa, Pa, 1).
    pub(super) fn neo_hookean(&self) -> [f64; 3] {
        let [lambda, mu] = self.lame();
        let (m, l) = (4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu);
        [m, l, 1.0 + 0.75 * m / l]
    }

    /// Returns the energy per volume above that at rest (J/m3).
    pub(super) fn energy(&self, f: &Matrix<f64>) -> f64 {
        match self.model {
            Hyperelastic::NeoHookean => {
                let [m, l, _] = self.neo_hookean();
                let (longer, larger) = (contraction(f, f) - 3.0, dot(f[0], cofactors(f)[0]) - 1.0);
                0.5 * m * (longer - libm::log1p(0.25 * longer) - 1.5 * larger)
                    + 0.5 * l * larger * larger
            }
            Hyperelastic::StVenantKirchhoff => {
                let [lambda, mu] = self.lame();
                let strain = strain(f);
                let trace = trace(&strain);
                mu * contraction(&strain, &strain) + 0.5 * lambda * trace * trace
            }
        }
    }

    /// Returns the first Piola-Kirchhoff stress (Pa) at a deformation gradient F, with its rate F'
    /// (1/s) if the material is viscous.
    #[inline(always)]
    pub(super) fn stress<N: Number>(&self, f: &Matrix<N>, rate: Option<&Matrix<N>>) -> Matrix<N> {
        let [lambda, mu] = self.lame();
        let viscous = match rate {
            Some(rate) => {
                let tau = self.damping;
                Some(hooke([tau * lambda, tau * mu], &symmetric(f, rate)))
            }
            None => None,
        };
        match self.model {
            Hyperelastic::NeoHookean => {
                let [m, l, a] = self.neo_hookean();
                let cofactors = cofactors(f);
                let (one, m) = (f[0][0].constant(1.0), f[0][0].constant(m));
                let along = m - m / (contraction(f, f) + one);
                let volume = dot(f[0], cofactors[0]);
                let pressure = one.constant(l) * (volume - one.constant(a));
                let elastic = plus(&scaled(along, f), pressure, &cofactors);
                match viscous {
                    Some(viscous) => sum(&elastic, &product(f, &viscous)),
                    None => elastic,
                }
            }
            Hyperelastic::StVenantKirchhoff => {
                let elastic = hooke([lambda, mu], &strain(f));
                let second = match viscous {
                    Some(viscous) => sum(&elastic, &viscous),
                    None => elastic,
                };
                product(f, &second)
            }
        }
    }
}

/// Returns the strain E of Green and Saint Venant.
#[inline(always)]
fn strain<N: Number>(f: &Matrix<N>) -> Matrix<N> {
    let half = f[0][0].constant(0.5);
    let mut strain = scaled(half, &symmetric(f, f));
    strain[0][0] = strain[0][0] - half;
    strain[1][1] = strain[1][1] - half;
    strain[2][2] = strain[2][2] - half;
    strain
}

#[inline(always)]
fn trace<N: Number>(a: &Matrix<N>) -> N {
    a[0][0] + a[1][1] + a[2][2]
}

/// Returns the stress by Hooke's law, lambda tr E 1 + 2 mu E.
#[inline(always)]
fn hooke<N: Number>([lambda, mu]: [f64; 2], strain: &Matrix<N>) -> Matrix<N> {
    let trace = trace(strain);
    let pressure = trace.constant(lambda) * trace;
    let mut stress = scaled(trace.constant(2.0 * mu), strain);
    stress[0][0] = stress[0][0] + pressure;
    stress[1][1] = stress[1][1] + pressure;
    stress[2][2] = stress[2][2] + pressure;
    stress
}
