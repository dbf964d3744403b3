//! The pull of a hand.

use a3_core::{Simulation, Vector3};
use a3_render::{Ball, Line};

use super::colours::{ALARM, AMBER};
use super::vectors::to_f32;

/// Length of a pull that is drawn as the strongest, as a share of the scene's radius.
const STRONG: f64 = 0.5;

/// A line from particle i to the hand (m), thicker and redder the farther it is, and a ball at its
/// end, in a picture with that unit of length (m); none while the hand is at the particle.
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
    let share = (strength / STRONG).min(1.0) as f32;
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
