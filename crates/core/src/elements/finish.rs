//! The last operations on the sum of forces: gravity, drag and the division by mass.

use std::ops::Range;

use nalgebra::Vector3;

use super::{drag, gravity};

/// Operations that finish a sum of forces.
#[derive(Clone, Copy, Default)]
pub(crate) struct Finish<'a> {
    /// Gravity (m/s2) that is added, with the mass of each particle (kg).
    pub gravity: Option<(Vector3<f64>, &'a [f64])>,
    /// Coefficient of the viscous drag that is added (kg/s).
    pub drag: Option<f64>,
    /// Masses (kg). If set, the result is m v - f, the product of the implicit matrix with v,
    /// instead of f.
    pub inertia: Option<&'a [f64]>,
    /// Factors of the result: one over each mass (1/kg).
    pub inverse_masses: Option<&'a [f64]>,
}

impl Finish<'_> {
    /// Finishes the forces f on some particles with velocities v, both n x 3.
    pub fn apply(&self, particles: &Range<usize>, v: &[f64], f: &mut [f64]) {
        let n = f.len() / 3;
        for (axis, column) in f.chunks_exact_mut(n).enumerate() {
            let f = &mut column[particles.clone()];
            let v = &v[axis * n..(axis + 1) * n][particles.clone()];
            if let Some((g, masses)) = self.gravity {
                gravity::add(g[axis], &masses[particles.clone()], f);
            }
            if let Some(c) = self.drag {
                drag::add(c, v, f);
            }
            if let Some(masses) = self.inertia {
                for ((f, v), m) in f.iter_mut().zip(v).zip(&masses[particles.clone()]) {
                    *f = m * v - *f;
                }
            }
            if let Some(inverse_masses) = self.inverse_masses {
                for (f, w) in f.iter_mut().zip(&inverse_masses[particles.clone()]) {
                    *f *= w;
                }
            }
        }
    }
}
