//! Wind that blows on triangles: at each, the [force of the air](Air) that streams past its middle
//! less the mean velocity of its corners, a third of it on each corner.

use nalgebra::Vector3;

use super::air::Air;
use super::force::{At, Force};
use super::wind::Wind;

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

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        let At { t, x, v, .. } = *at;
        for corners in at.triangles {
            let [a, b, c] = corners.map(|i| vector(x, i));
            let u = self.wind.at(t, ((a + b + c) / 3.0).into()) - mean(v, *corners);
            let [force, _] = self.air.force([u, area(a, b, c)], [Vector3::zeros(); 2]);
            spread(force, *corners, f);
        }
    }

    fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        let At { t, x, v, .. } = *at;
        for corners in at.triangles {
            let [a, b, c] = corners.map(|i| vector(x, i));
            let [da, db, dc] = corners.map(|i| vector(dx, i));
            let (middle, towards) = (((a + b + c) / 3.0).into(), mean(dx, *corners));
            let u = self.wind.at(t, middle) - mean(v, *corners);
            let du = self.wind.differential(t, middle, towards) - mean(dv, *corners);
            let darea = 0.5 * ((db - da).cross(&(c - a)) + (b - a).cross(&(dc - da)));
            let [_, dforce] = self.air.force([u, area(a, b, c)], [du, darea]);
            spread(dforce, *corners, df);
        }
    }

    fn reads_velocity(&self) -> bool {
        true
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
