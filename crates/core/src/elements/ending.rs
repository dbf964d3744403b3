//! What becomes of the springs' forces.

use nalgebra::Vector3;

use super::air::OnTriangles;
use super::{Wind, columns, columns_mut, drag, gravity};

/// The forces to be added, and the masses to divide by.
#[derive(Default)]
pub(crate) struct Ending<'a> {
    pub wind: Option<(&'a Wind, f64)>,
    /// Vectors do not know it.
    pub air: Option<OnTriangles<'a>>,
    /// With the masses.
    pub gravity: Option<(Vector3<f64>, &'a [f64])>,
    pub drag: Option<f64>,
    /// Masses: of a tangent, M times the vector less its product.
    pub inertia: Option<&'a [f64]>,
    pub inverse_masses: Option<&'a [f64]>,
}

impl Ending<'_> {
    /// Completes the forces on all particles.
    pub fn apply(&self, x: &[f64], v: &[f64], f: &mut [f64]) {
        let n = x.len() / 3;
        if let Some((wind, t)) = self.wind {
            wind.add(t, columns(x, &(0..n)), &mut columns_mut(f));
        }
        if let Some(air) = self.air {
            air.add(x, v, f);
        }
        for (axis, f) in f.chunks_exact_mut(n).enumerate() {
            if let Some((g, masses)) = self.gravity {
                gravity::add(g[axis], masses, f);
            }
            if let Some(c) = self.drag {
                drag::add(c, &v[axis * n..(axis + 1) * n], f);
            }
            if let Some(inverse_masses) = self.inverse_masses {
                for (f, w) in f.iter_mut().zip(inverse_masses) {
                    *f *= w;
                }
            }
        }
    }
}
