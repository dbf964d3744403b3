//! Force of air that streams past a triangle. With its velocity u relative to the triangle and the
//! area vector N, half the cross product of two edges, n = N / |N|, the force is rho/2 \[`C_d` |u .
//! N| u + `C_l` (u . n) (|u| N - (u . N) u / |u|)\], drag along u and lift across it, the same
//! whichever side is the front. After Keckeisen, Kimmerle, Thomaszewski, Wacker, *Modelling effects
//! of wind fields in cloth animations*, 2004.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::error::{Error, at_least};

/// Air, as it pushes at what is in its way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Air {
    /// Density rho (kg/m3).
    pub density: f64,
    /// Coefficient of drag `C_d`: about 1.2 of a plate.
    pub drag: f64,
    /// Coefficient of lift `C_l`.
    pub lift: f64,
}

impl Air {
    /// Air of that density (kg/m3) and those coefficients.
    ///
    /// # Errors
    /// A number is negative or not finite.
    pub fn new(density: f64, drag: f64, lift: f64) -> Result<Self, Error> {
        at_least(0.0, "the density of the air", density)?;
        at_least(0.0, "the air's coefficient of drag", drag)?;
        at_least(0.0, "the air's coefficient of lift", lift)?;
        Ok(Self {
            density,
            drag,
            lift,
        })
    }

    /// The force (N), and its differential, of the differentials of u and N.
    #[inline]
    pub(super) fn force(
        self,
        [u, area]: [Vector3<f64>; 2],
        [du, darea]: [Vector3<f64>; 2],
    ) -> [Vector3<f64>; 2] {
        let (speed, size) = (u.norm(), area.norm());
        if speed == 0.0 || size == 0.0 {
            return [Vector3::zeros(); 2];
        }
        let through = u.dot(&area);
        let dthrough = du.dot(&area) + u.dot(&darea);
        let drag = through.abs() * u;
        let ddrag = through.signum() * dthrough * u + through.abs() * du;
        let (dspeed, dsize) = (u.dot(&du) / speed, area.dot(&darea) / size);
        let (slope, share) = (through / size, through / speed);
        let (dslope, dshare) = (
            (dthrough - slope * dsize) / size,
            (dthrough - share * dspeed) / speed,
        );
        let across = speed * area - share * u;
        let dacross = dspeed * area + speed * darea - dshare * u - share * du;
        let half = 0.5 * self.density;
        [
            half * (self.drag * drag + self.lift * slope * across),
            half * (self.drag * ddrag + self.lift * (dslope * across + slope * dacross)),
        ]
    }
}
