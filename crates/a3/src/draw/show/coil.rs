//! Springs as coils.

use a3_core::{Spring, Vector3};

use super::vectors::{perpendicular, to_f32};

/// Number of turns of a coil.
const TURNS: usize = 12;
/// Number of straight pieces of a turn.
const PIECES: usize = 14;

/// Returns the points of a coil from a to b (m) with straight ends. `unit` is the unit of length of
/// the scene (m). A stretched coil is thinner.
pub fn coil(a: Vector3<f64>, b: Vector3<f64>, spring: &Spring, unit: f64) -> Vec<[f32; 3]> {
    let along = b - a;
    let length = along.norm();
    if length < 1e-6 * unit {
        return vec![];
    }
    let side = perpendicular(along);
    let other = along.cross(&side) / length;
    let rest = spring.law.rest_length.max(1e-3 * unit);
    let radius = 0.07 * rest.min(unit) * (rest / length).clamp(0.4, 1.5).sqrt();
    let count = TURNS * PIECES;
    let mut points = vec![to_f32(a)];
    points.extend((0..=count).map(|k| {
        let share = k as f64 / count as f64;
        // The radius grows from the ends to the middle, so that the coil leaves its axis smoothly.
        let radius = radius * (12.0 * share.min(1.0 - share)).min(1.0);
        let (sin, cos) = (std::f64::consts::TAU * TURNS as f64 * share).sin_cos();
        to_f32(a + along * (0.1 + 0.8 * share) + (side * cos + other * sin) * radius)
    }));
    points.push(to_f32(b));
    points
}
