//! How far surfaces stray from the straight courses that the guard takes them on.

use nalgebra::UnitQuaternion;

use super::layer::{ContactLayer, Scratch};
use crate::rigid::{ROTATION, Rotation};

/// Distance of a cubic course from its chord, over the length of the step times the difference of
/// the velocity at an end and that of the chord, at most.
const BULGE: f64 = 4.0 / 27.0;

impl ContactLayer {
    /// Largest distance (m) of a vertex from its chord in a step of h (s) from the state y0 at time
    /// t (s) to y1, over the least thickness.
    pub(crate) fn bulge(&self, (t, h): (f64, f64), [y0, y1]: [&[f64]; 2]) -> f64 {
        let (surface, obstacles) = (self.surface(), self.obstacles());
        let half = 3 * surface.particles();
        let moved = self.with_scratch(|Scratch { motion, .. }| {
            let (ends, begins) = (&mut motion.moves.points, &mut motion.x0);
            surface.place(obstacles, t, &y0[..half], begins);
            surface.place(obstacles, t + h, &y1[..half], ends);
            let (before, after) = (&mut motion.v0.points, &mut motion.v.points);
            surface.speeds(obstacles, t, &y0[half..2 * half], before);
            surface.speeds(obstacles, t + h, &y1[half..2 * half], after);
            let courses = begins.iter().zip(ends).zip(before.iter().zip(after));
            let bulges = courses.map(|((x0, x1), (v0, v1))| {
                let chord = *x1 - *x0;
                BULGE * ((*v0 * h - chord).norm() + (*v1 * h - chord).norm())
            });
            bulges.fold(0.0, f64::max)
        });
        let turned = surface.rigid().iter().enumerate().map(|(k, body)| {
            let first = 2 * half + ROTATION * k;
            let [a, b] = [y0, y1].map(|y| {
                let numbers = &y[first..first + ROTATION];
                UnitQuaternion::from_quaternion(Rotation::read(numbers).q)
            });
            body.radius() * (1.0 - (0.5 * a.angle_to(&b)).cos())
        });
        turned.fold(moved, f64::max) / surface.thinnest()
    }
}
