//! Errors of contact: of the penetration and of the times of the first impact, against known
//! values.

use a3_core::accuracy::{Frames, Metric, Precision, Reference, Scope, measure};
use a3_core::{Control, Model, Scene};

use crate::bead_above_floor;
use crate::common::method;

/// Thickness (m), stiffness (N/m), and speed of a bead of 1 kg without gravity (m/s).
const THICKNESS: f64 = 0.2;
const STIFFNESS: f64 = 600.0;
const SPEED: f64 = 0.9;

/// Integral of 1 / sqrt(1 - u4) from 0 to 1, a quarter of the period of x'' = -2 x3 of amplitude 1:
/// half of the lemniscate constant.
const QUARTER: f64 = 1.311_028_777_146_059_9;

/// A bead above a floor, at that height (m) and velocity (m/s).
fn bead(height: f64, velocity: f64, gravity: f64) -> Scene {
    let network = bead_above_floor(1.0, gravity, [THICKNESS, STIFFNESS]);
    let state = vec![0.0, height, 0.0, 0.0, velocity, 0.0];
    Scene::new("bead", Model::Network(Box::new(network)), state)
}

/// Depth (m) at which the floor has stopped a bead of that speed: m v2 / 2 = k d2 (depth / d)4 / 4.
fn deepest() -> f64 {
    (2.0 * SPEED.powi(2) * THICKNESS.powi(2) / STIFFNESS).powf(0.25)
}

/// Reference of the state at `until` (s) alone, in frames of about 5 ms.
fn at(scene: &Scene, until: f64) -> Reference {
    let (frames, at_end) = (Frames { until, count: 200 }, true);
    let scope = Scope { at_end, ..Scope::default() };
    Reference::new(scene, frames, scope, Precision::FINEST, &|| true).unwrap().unwrap()
}

fn assert_close(found: f64, exact: f64, tolerance: f64) {
    assert!((found - exact).abs() < tolerance, "{found}, not {exact}");
}

/// For a run in which nothing moves, the error is the true value: the time since the impact.
#[test]
fn the_reference_knows_the_impact_of_a_bead() {
    let falling = bead(0.5, -SPEED, 0.0);
    let begins = (0.5 - THICKNESS) / SPEED;
    let turns = begins + QUARTER * deepest() / SPEED;
    let at_turn = at(&falling, turns);
    assert_close(at_turn.still.penetration, deepest() / THICKNESS, 1e-9);
    assert_close(at_turn.still.impact, turns - begins, 1e-9);
    assert!(at_turn.floor.penetration < 1e-9 && at_turn.floor.impact < 1e-9);
    // A bead that starts at its turning point: only the end of its impact follows.
    let leaving = at(&bead(THICKNESS - deepest(), 0.0, 0.0), 1.0);
    assert_close(leaving.still.impact, 1.0 - QUARTER * deepest() / SPEED, 1e-7);
    assert_eq!(at(&bead(5.0, -SPEED, 0.0), 1.0).still.impact, 0.0);
}

/// Explicit Euler falls with the right velocity, half a step late: x = x0 - g t2 / 2 + g t h / 2.
#[test]
fn the_error_of_the_impact_is_how_late_it_is() {
    let (drop, gravity, h) = (0.3, 9.81, 1e-3);
    let scene = bead(THICKNESS + drop, 0.0, gravity);
    let reference = at(&scene, 0.3);
    let euler = measure(&scene, method("euler"), Control::Step(h), &reference, &|| true);
    let late =
        0.5 * h + (0.25 * h * h + 2.0 * drop / gravity).sqrt() - (2.0 * drop / gravity).sqrt();
    assert_close(euler.unwrap().unwrap().errors.impact, late, 1e-3 * late);
}

/// Once the bead has left, its errors are those of the whole bounce, and fall with the order.
#[test]
fn errors_of_a_bounce_fall_with_the_order() {
    let scene = bead(0.5, -SPEED, 0.0);
    let reference = |metric| {
        let precision = Precision { metric, ..Precision::FINEST };
        let frames = Frames { until: 1.0, count: 60 };
        Reference::new(&scene, frames, Scope::default(), precision, &|| true).unwrap().unwrap()
    };
    for metric in [Metric::Impact, Metric::Penetration] {
        let reference = reference(metric);
        for (name, order) in [("verlet", 2.0), ("rk4", 4.0)] {
            let of = |steps: u32| {
                let control = Control::Step(1.0 / f64::from(steps));
                let run = measure(&scene, method(name), control, &reference, &|| true);
                metric.of(&run.unwrap().unwrap().errors)
            };
            // Single errors vary with the place in a step where the touch begins.
            let sum = |first: u32| (0..8).map(|k| of(first + k * first / 16).powi(2)).sum::<f64>();
            let found = 0.25 * (sum(120) / sum(480)).log2();
            assert!((found - order).abs() < 0.2, "{name}, {metric:?}: order {found}");
        }
    }
}
