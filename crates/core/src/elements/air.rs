//! Air that streams past triangles. With u, its velocity at the middle of a triangle less the mean of its corners', and N,
//! half the cross product of two edges, n = N / |N|, the force is
//! rho/2 \[`C_d` |u . N| u + `C_l` (u . n) (|u| N - (u . N) u / |u|)\], drag along u and lift across it, the same whichever
//! side is the front. A third of it acts on each corner. After Keckeisen, Kimmerle, Thomaszewski, Wacker, *Modelling effects of
//! wind fields in cloth animations*, 2004.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::Wind;
use crate::error::{Error, at_least};

/// How air pushes at what is in its way.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Air {
    /// rho (kg/m3).
    pub density: f64,
    /// `C_d`: about 1.2 of a plate.
    pub drag: f64,
    /// `C_l`.
    pub lift: f64,
}

impl Air {
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

    /// The force (N), and with the changes of u and N its own.
    #[inline]
    fn force(
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

/// A wind, at a time (s), on triangles.
#[derive(Clone, Copy)]
pub(crate) struct OnTriangles<'a> {
    pub wind: &'a Wind,
    pub air: Air,
    pub t: f64,
    pub triangles: &'a [[u32; 3]],
}

impl OnTriangles<'_> {
    pub fn add(&self, x: &[f64], v: &[f64], f: &mut [f64]) {
        for corners in self.triangles {
            let [a, b, c] = corners.map(|i| vector(x, i));
            let u = self.wind.at(self.t, ((a + b + c) / 3.0).into()) - mean(v, *corners);
            let [force, _] = self.air.force([u, area(a, b, c)], [Vector3::zeros(); 2]);
            spread(force, *corners, f);
        }
    }

    pub fn add_differential(&self, x: &[f64], v: &[f64], dx: &[f64], dv: &[f64], df: &mut [f64]) {
        for corners in self.triangles {
            let [a, b, c] = corners.map(|i| vector(x, i));
            let [da, db, dc] = corners.map(|i| vector(dx, i));
            let (middle, towards) = (((a + b + c) / 3.0).into(), mean(dx, *corners));
            let u = self.wind.at(self.t, middle) - mean(v, *corners);
            let du = self.wind.differential(self.t, middle, towards) - mean(dv, *corners);
            let darea = 0.5 * ((db - da).cross(&(c - a)) + (b - a).cross(&(dc - da)));
            let [_, dforce] = self.air.force([u, area(a, b, c)], [du, darea]);
            spread(dforce, *corners, df);
        }
    }
}

fn area(a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>) -> Vector3<f64> {
    0.5 * (b - a).cross(&(c - a))
}

fn vector(of: &[f64], i: u32) -> Vector3<f64> {
    let (n, i) = (of.len() / 3, i as usize);
    Vector3::new(of[i], of[n + i], of[2 * n + i])
}

fn mean(of: &[f64], corners: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners.map(|i| vector(of, i));
    (a + b + c) / 3.0
}

fn spread(force: Vector3<f64>, corners: [u32; 3], f: &mut [f64]) {
    let n = f.len() / 3;
    for i in corners {
        for axis in 0..3 {
            f[axis * n + i as usize] += force[axis] / 3.0;
        }
    }
}
