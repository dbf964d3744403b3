//! Force of air that streams past a triangle. With its velocity u relative to the triangle and the
//! area vector N, half the cross product of two edges, n = N / |N|, the force is rho/2 \[`C_d` |u .
//! N| u + `C_l` (u . n) (|u| N - (u . N) u / |u|)\]: drag along u and lift across it. It is the
//! same for either side in front. After Keckeisen, Kimmerle, Thomaszewski, Wacker, *Modelling
//! effects of wind fields in cloth animations*, 2004.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, at_least};

/// Air that exerts drag and lift.
///
/// ```
/// use a3_core::{Vector3, elements::{Air, Wind}};
///
/// // A wind of 3 m/s that blows on the triangles of a cloth.
/// let air = Air::new(1.2, 1.2, 0.3)?;
/// let wind = Wind::on_triangles(1, Vector3::new(3.0, 0.0, 0.0), air);
/// assert_eq!(wind.air(), Some(air));
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Air {
    /// Density rho (kg/m3).
    pub density: f64,
    /// Coefficient of drag `C_d`: about 1.2 for a plate.
    pub drag: f64,
    /// Coefficient of lift `C_l`.
    pub lift: f64,
}

impl Air {
    /// Creates air of a density (kg/m3) and coefficients of drag and lift.
    ///
    /// # Errors
    /// A number is negative or not finite.
    pub fn new(density: f64, drag: f64, lift: f64) -> Result<Self, Error> {
        at_least(0.0, "the density of the air", density)?;
        at_least(0.0, "the air's coefficient of drag", drag)?;
        at_least(0.0, "the air's coefficient of lift", lift)?;
        Ok(Self { density, drag, lift })
    }

    /// Returns the force (N) at a relative velocity u (m/s) on an area vector N (m2).
    #[inline(always)]
    pub(super) fn force(self, u: [f64; 3], area: [f64; 3]) -> [f64; 3] {
        let (speed, size) = (dot(u, u).sqrt(), dot(area, area).sqrt());
        let through = dot(u, area);
        let half = 0.5 * self.density;
        let drag = half * self.drag * through.abs();
        let lift = half * self.lift * through / size;
        let share = through / speed;
        let none = speed == 0.0 || size == 0.0;
        array::from_fn(|axis| {
            let across = speed * area[axis] - share * u[axis];
            let force = drag * u[axis] + lift * across;
            if none { 0.0 } else { force }
        })
    }

    /// Returns the differential of the force, from those of u and N.
    pub(super) fn differential(
        self,
        [u, area]: [Vector3<f64>; 2],
        [du, darea]: [Vector3<f64>; 2],
    ) -> Vector3<f64> {
        let (speed, size) = (u.norm(), area.norm());
        if speed == 0.0 || size == 0.0 {
            return Vector3::zeros();
        }
        let through = u.dot(&area);
        let dthrough = du.dot(&area) + u.dot(&darea);
        let ddrag = through.signum() * dthrough * u + through.abs() * du;
        let (dspeed, dsize) = (u.dot(&du) / speed, area.dot(&darea) / size);
        let (slope, share) = (through / size, through / speed);
        let (dslope, dshare) =
            ((dthrough - slope * dsize) / size, (dthrough - share * dspeed) / speed);
        let across = speed * area - share * u;
        let dacross = dspeed * area + speed * darea - dshare * u - share * du;
        let half = 0.5 * self.density;
        half * (self.drag * ddrag + self.lift * (dslope * across + slope * dacross))
    }
}

#[inline(always)]
fn dot([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> f64 {
    a * x + b * y + c * z
}
