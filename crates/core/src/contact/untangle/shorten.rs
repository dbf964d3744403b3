//! Displacements that make the curves shorter along which surfaces cross.

use nalgebra::Vector3;

use super::hit::Hit;
use super::skeleton::Skeleton;

/// Least sine of the angle between an edge and a triangle that counts.
const LEAST_SINE: f64 = 1e-2;
/// Length of the gradient at which the displacement is 0.7 of the largest.
const SOFTNESS: f64 = 0.1;
/// Least sine of the angle between two triangles whose curve has a direction.
const PARALLEL_SINE: f64 = 1e-9;

/// Returns the displacement (m) of the edge relative to the triangle that makes the curve of their
/// surfaces shorter. An edge without triangles leaves by its shorter end.
pub(super) fn step(skeleton: &Skeleton, hit: &Hit, at: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    let ends = skeleton.edges[hit.edge];
    let triangles = skeleton.triangles_at(hit.edge);
    if triangles.is_empty() {
        return Some(hit.passage(usize::from(hit.share > 0.5)));
    }
    let [p, q] = ends.map(|i| at[i as usize]);
    let edge = (q - p).normalize();
    let sine = edge.dot(&hit.normal);
    let sine = sine.abs().max(LEAST_SINE).copysign(sine);
    let mut gradient = Vector3::zeros();
    for triangle in triangles {
        let corners = skeleton.triangles[*triangle as usize];
        let third = corners.into_iter().find(|i| !ends.contains(i))?;
        let to = at[third as usize] - p;
        let inward = to - edge * edge.dot(&to);
        let normal = edge.cross(&inward);
        let along = normal.cross(&hit.normal);
        if along.norm() < PARALLEL_SINE * normal.norm() {
            continue;
        }
        // The curve runs from the edge into the triangle.
        let along = along.normalize() * 1.0_f64.copysign(along.dot(&inward));
        gradient += along - hit.normal * (2.0 * edge.dot(&along) / sine);
    }
    let scale = hit.most / gradient.norm_squared().hypot(SOFTNESS).sqrt();
    gradient
        .iter()
        .all(|g| g.is_finite())
        .then_some(gradient * scale)
}
