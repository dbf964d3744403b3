//! What becomes of the springs' forces on some particles while these are in the nearest cache.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;

use super::{Wind, drag, gravity};

/// The forces to be added, and the masses to divide by.
#[derive(Default)]
pub(crate) struct Ending<'a> {
    pub wind: Option<(&'a Wind, f64)>,
    /// With the masses.
    pub gravity: Option<(Vector3<f64>, &'a [f64])>,
    pub drag: Option<f64>,
    pub inverse_masses: Option<&'a [f64]>,
}

impl Ending<'_> {
    /// Completes the forces on particles from the `first` on.
    #[inline(always)]
    pub fn apply(&self, first: usize, x: [&[f64]; 3], v: [&[f64]; 3], f: [&mut [f64]; 3]) {
        let [fx, fy, fz] = f;
        let particles = first..first + fx.len();
        if let Some((wind, t)) = self.wind {
            wind.add(t, x, [&mut *fx, &mut *fy, &mut *fz]);
        }
        for (axis, f) in [fx, fy, fz].into_iter().enumerate() {
            if let Some((g, masses)) = self.gravity {
                gravity::add(g[axis], &masses[particles.clone()], f);
            }
            if let Some(c) = self.drag {
                drag::add(c, v[axis], f);
            }
            if let Some(inverse_masses) = self.inverse_masses {
                for (f, w) in f.iter_mut().zip(&inverse_masses[particles.clone()]) {
                    *f *= w;
                }
            }
        }
    }
}
