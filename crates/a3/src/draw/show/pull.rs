//! The pull of the mouse.

use a3_core::{Simulation, Vector3};
use a3_render::{Ball, Line};

use super::colours::{ALARM, AMBER};
use super::vectors::to_f32;

/// Length of a pull from which on it is drawn with the strongest line, as a share of the scene's
/// radius.
const MAX_PULL: f64 = 0.5;

/// Returns a line from particle i to the pointer (m), thicker and redder the longer it is, and a
/// ball at its end; `None` while the pointer is at the particle. `unit` is the unit of length of
/// the scene (m).
pub fn pull(
    simulation: &Simulation,
    i: usize,
    hand: Vector3<f64>,
    unit: f32,
) -> Option<(Line, Ball)> {
    let place = simulation.position(i);
    let strength = (hand - place).norm() / simulation.extent().1;
    if strength < 0.01 {
        return None;
    }
    let share = (strength / MAX_PULL).min(1.0) as f32;
    let color = [0, 1, 2, 3].map(|k| AMBER[k] + share * (ALARM[k] - AMBER[k]));
    let to = to_f32(hand);
    let ball = Ball {
        center: to,
        radius: 0.035 * unit,
        color,
    };
    let line = Line::new(to_f32(place), to, 2.0 + 6.0 * share, color);
    Some((line, ball))
}
