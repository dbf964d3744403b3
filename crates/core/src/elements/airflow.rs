//! Wind that blows on triangles. The relative velocity of a triangle is that of the air at its
//! middle less the mean velocity of its corners, and a third of the [force of the air](Air) acts on
//! each corner. On a closed surface that force is halved: such a surface meets the air twice, at
//! its front and at its back, and has the drag of its area as seen along the wind, as a sheet has.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::ops::Range;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::air::Air;
use super::force::{At, Force};
use super::wind::{BLOCK, Wind};
use crate::columns::columns_mut;
use crate::threads::{Columns, fork, threads};
use crate::vectors::Arch;

/// A wind whose air streams past the triangles of a network.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Airflow {
    /// The wind: its gusts are velocities (m/s).
    pub wind: Wind,
    /// The air.
    pub air: Air,
}

impl Force for Airflow {
    fn name(&self) -> &'static str {
        "wind"
    }

    fn is_driven(&self) -> bool {
        true
    }

    fn is_wind(&self) -> bool {
        true
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        self.add_in(threads(at.triangles.len()), at, f);
    }

    fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let At { t, x, v, .. } = *at;
        for (triangles, parts) in surfaces(at) {
            for corners in triangles {
                let [a, b, c] = corners.map(|i| vector(x, i));
                let [da, db, dc] = corners.map(|i| vector(dx, i));
                let (middle, towards) = (((a + b + c) / 3.0).into(), mean(dx, *corners));
                let u = self.wind.at(t, middle) - mean(v, *corners);
                let du = self.wind.differential(t, middle, towards) - mean(dv, *corners);
                let darea = 0.5 * ((db - da).cross(&(c - a)) + (b - a).cross(&(dc - da)));
                let dforce = self.air.differential([u, area(a, b, c)], [du, darea]);
                spread(dforce.into(), parts, *corners, df);
            }
        }
    }

    fn reads_velocity(&self) -> bool {
        true
    }
}

impl Airflow {
    /// Returns the force (N) at a relative velocity u (m/s) on a face of a closed surface with this
    /// area vector (m2).
    pub(crate) fn on_closed(&self, u: Vector3<f64>, area: Vector3<f64>) -> Vector3<f64> {
        0.5 * Vector3::from(self.air.force(u.into(), area.into()))
    }

    /// Adds the forces in a number of bands of particles. Each band computes the forces on all
    /// triangles with a corner in it, and adds them in the order of the triangles.
    fn add_in(&self, bands: usize, at: &At, f: &mut [f64]) {
        let n = f.len() / 3;
        fork(bands, 0..n, 1, columns_mut(f), &|particles, f| {
            Arch::new().dispatch(AirflowTask { airflow: self, at, particles, f });
        });
    }
}

/// Task that adds the forces on some particles to f.
struct AirflowTask<'a> {
    airflow: &'a Airflow,
    at: &'a At<'a>,
    particles: Range<usize>,
    f: Columns<'a, 3>,
}

impl WithSimd for AirflowTask<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, _: S) {
        for (triangles, parts) in surfaces(self.at) {
            let mut rest = triangles.iter();
            while !rest.as_slice().is_empty() {
                let (mut block, mut count) = ([[0; 3]; BLOCK], 0);
                while count < BLOCK
                    && let Some(corners) = rest.next()
                {
                    let [a, b, c] = *corners;
                    if self.has(a) || self.has(b) || self.has(c) {
                        block[count] = *corners;
                        count += 1;
                    }
                }
                self.add(&block[..count], parts);
            }
        }
    }
}

impl AirflowTask<'_> {
    #[inline(always)]
    fn has(&self, i: u32) -> bool {
        self.particles.contains(&(i as usize))
    }

    /// Adds the forces on a block of triangles. Each corner gets the force on its triangle divided
    /// by `parts`.
    #[inline(always)]
    fn add(&mut self, triangles: &[[u32; 3]], parts: f64) {
        let At { t, x, v, .. } = *self.at;
        let Airflow { wind, air } = self.airflow;
        let [mut middles, mut speeds, mut areas] = [[[0.0; BLOCK]; 3]; 3];
        for (m, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|i| vector(x, i));
            let (middle, speed) = ((a + b + c) / 3.0, mean(v, *corners));
            let area = area(a, b, c);
            for axis in 0..3 {
                middles[axis][m] = middle[axis];
                speeds[axis][m] = speed[axis];
                areas[axis][m] = area[axis];
            }
        }
        let winds = wind.over(t, &middles);
        let mut forces = [[0.0; BLOCK]; 3];
        for m in 0..BLOCK {
            let u = [0, 1, 2].map(|axis| winds[axis][m] - speeds[axis][m]);
            let force = air.force(u, [0, 1, 2].map(|axis| areas[axis][m]));
            for axis in 0..3 {
                forces[axis][m] = force[axis] / parts;
            }
        }
        for (m, corners) in triangles.iter().enumerate() {
            for i in corners.iter().filter(|i| self.particles.contains(&(**i as usize))) {
                let k = *i as usize - self.particles.start;
                for (f, force) in self.f.iter_mut().zip(&forces) {
                    f[k] += force[m];
                }
            }
        }
    }
}

/// Returns the triangles of open and of closed surfaces. With each list comes the number by which
/// the force on a triangle is divided for each of its three corners: 3, or 6 to halve it.
fn surfaces<'a>(at: &At<'a>) -> [(&'a [[u32; 3]], f64); 2] {
    let [open, closed] = at.triangles.open_and_closed();
    [(open, 3.0), (closed, 6.0)]
}

#[inline(always)]
fn area(a: Vector3<f64>, b: Vector3<f64>, c: Vector3<f64>) -> Vector3<f64> {
    0.5 * (b - a).cross(&(c - a))
}

#[inline(always)]
fn vector(of: &[f64], i: u32) -> Vector3<f64> {
    let (n, i) = (of.len() / 3, i as usize);
    Vector3::new(of[i], of[n + i], of[2 * n + i])
}

#[inline(always)]
fn mean(of: &[f64], corners: [u32; 3]) -> Vector3<f64> {
    let [a, b, c] = corners.map(|i| vector(of, i));
    (a + b + c) / 3.0
}

fn spread(force: [f64; 3], parts: f64, corners: [u32; 3], f: &mut [f64]) {
    let n = f.len() / 3;
    for i in corners {
        for axis in 0..3 {
            f[axis * n + i as usize] += force[axis] / parts;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Triangles;
    use crate::random::SplitMix;

    #[test]
    fn any_number_of_bands_finds_what_triangles_one_by_one_do() {
        let (n, mut random) = (3000, SplitMix(5));
        let [x, v] = [(); 2].map(|()| (0..3 * n).map(|_| random.between(-1.0, 1.0)).collect());
        let (x, v): (Vec<f64>, Vec<f64>) = (x, v);
        let corner = |k: usize| (k * 7919 % n) as u32;
        let mut triangles: Vec<_> =
            (0..9001).map(|k| [0, 1, 2].map(|c| corner(3 * k + c))).collect();
        // A triangle without an area.
        triangles[17] = [4, 4, 9];
        let triangles: Triangles = triangles.into_iter().collect();
        let at = At { t: 0.3, x: &x, v: &v, masses: &[], triangles: &triangles };
        let airflow = Airflow {
            wind: Wind::new(2, Vector3::new(0.0, 1.0, 4.0)),
            air: Air::new(1.2, 1.1, 0.6).unwrap(),
        };
        let mut expected = vec![0.0; 3 * n];
        for corners in triangles.iter() {
            let [a, b, c] = corners.map(|i| vector(&x, i));
            let u = airflow.wind.at(0.3, ((a + b + c) / 3.0).into()) - mean(&v, *corners);
            let force = airflow.air.force(u.into(), area(a, b, c).into());
            spread(force, 3.0, *corners, &mut expected);
        }
        assert!(expected.iter().all(|f| f.is_finite()));
        for bands in [1, 2, 3, 8] {
            let mut found = vec![0.0; 3 * n];
            airflow.add_in(bands, &at, &mut found);
            assert!(found == expected, "{bands}");
        }
    }
}
