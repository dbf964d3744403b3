//! Distance of surfaces from the straight courses that the collision safeguard takes them along.

use nalgebra::Vector3;

use super::layer::{Buffers, ContactLayer};

/// Largest distance of a cubic course from its chord, over the step times the difference between
/// the velocity at one end and that of the chord.
const BULGE: f64 = 4.0 / 27.0;

/// Returns the largest distance of a vertex from its straight course in a step of h (s) from the
/// state y0 at time t (s) to y1, over the least thickness that is not 0. Vertices of rigid bodies
/// do not count; 0 if there are no others.
pub(crate) fn bulge(layer: &ContactLayer, (t, h): (f64, f64), [y0, y1]: [&[f64]; 2]) -> f64 {
    let (surface, obstacles) = (layer.surface(), layer.obstacles());
    let is_soft = |vertex: &&u32| surface.solid(**vertex).is_none();
    let bodies = surface.bodies.vertices.iter().filter(is_soft);
    let soft = bodies.chain(&surface.drops.vertices);
    if soft.clone().next().is_none() {
        return 0.0;
    }
    let half = 3 * surface.particles();
    let bulge = layer.scratch.lend(|Buffers { motion, .. }| {
        let (begins, ends) = (&mut motion.x0, &mut motion.moves.points);
        surface.place(obstacles, t, &y0[..half], begins);
        surface.place(obstacles, t + h, &y1[..half], ends);
        let (before, after) = (&mut motion.v0.points, &mut motion.v.points);
        surface.speeds(obstacles, t, &y0[half..2 * half], before);
        surface.speeds(obstacles, t + h, &y1[half..2 * half], after);
        let bulges = soft.chain(&surface.obstacles.vertices).map(|i| {
            let i = *i as usize;
            let chord = ends[i] - begins[i];
            let stray = |v: &[Vector3<f64>]| (v[i] * h - chord).norm();
            BULGE * (stray(before) + stray(after))
        });
        bulges.fold(0.0, f64::max)
    });
    bulge / surface.least_thickness()
}
