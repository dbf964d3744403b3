//! Rolling friction of balls against closed forms: on a floor, on a slope and on a turntable.

use crate::common::{described, method};
use a3_core::{Simulation, Vector3};

/// Gravity (m/s2), radius of the ball (m), and its coefficient of rolling friction (m).
const G: f64 = 9.81;
const RADIUS: f64 = 0.1;
const ROLLING: f64 = 0.005;
const MASS: f64 = 2.0;

const METHODS: [(&str, f64); 4] =
    [("verlet", 1e-3), ("rk4", 2e-3), ("symplectic-euler", 1e-3), ("dopri5", 1e-6)];

/// A ball that rolls along x at a speed (m/s) on what the text describes, with gravity that is
/// inclined by an angle (rad).
fn ball(speed: f64, slope: f64, below: &str) -> String {
    format!(
        "
        gravity = [{}, {}, 0]
        {below}
        [[body]]
        at = [0, 0.100156, 0]
        velocity = [{speed}, 0, 0]
        spin = [0, 0, {}]
        mass = {MASS}
        friction = 0.8
        rolling_friction = {ROLLING}
        parts = [{{ ball = {RADIUS} }}]
        ",
        G * slope.sin(),
        -G * slope.cos(),
        -speed / RADIUS,
    )
}

fn run(toml: &str, (name, value): (&str, f64), until: f64) -> Simulation {
    let method = method(name);
    let mut run = Simulation::new(described(toml), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run
}

/// Deceleration (m/s2) of a ball by rolling friction: the torque b m g acts on 7/5 m R2 about the
/// point of contact.
const DECELERATION: f64 = 5.0 / 7.0 * ROLLING * G / RADIUS;

#[test]
fn a_ball_slows_down_evenly_and_stops() {
    let toml = ball(1.0, 0.0, "floor = 0");
    for pair in METHODS {
        let speed = run(&toml, pair, 1.0).velocities()[0];
        let error = (speed - (1.0 - DECELERATION)).abs();
        assert!(error < 2e-3, "{pair:?}: {error}");
        let stopped = run(&toml, pair, 4.0);
        let place = stopped.position(0).x;
        let error = (place - 0.5 / DECELERATION).abs();
        assert!(error < 5e-3, "{pair:?}: {error}");
        let later = run(&toml, pair, 8.0);
        let crept = (later.position(0) - stopped.position(0)).norm();
        assert!(crept < 1e-6, "{pair:?}: {crept}");
    }
}

#[test]
fn the_tangent_of_the_slope_decides_whether_a_ball_rolls() {
    // It rests up to the tangent 0.05.
    for pair in METHODS {
        let rests = run(&ball(0.0, 0.045, "floor = 0"), pair, 4.0);
        assert!(rests.position(0).x < 1e-4, "{pair:?}: {}", rests.position(0));
        let slope = 0.15_f64;
        let rolls = run(&ball(0.0, slope, "floor = 0"), pair, 2.0);
        let along = 5.0 / 7.0 * G * (slope.sin() - slope.cos() * ROLLING / RADIUS);
        let error = (rolls.velocities()[0] / (2.0 * along) - 1.0).abs();
        assert!(error < 5e-3, "{pair:?}: {error}");
    }
}

/// A ball on the axis of a turntable is spun up by the torque b m g.
#[test]
fn a_turntable_takes_a_ball_along() {
    let table = "
        [[box]]
        size = [1, 0.2, 1]
        center = [0, -0.1, 0]
        thickness = 0.002
        turn = { axis = [0, 1, 0], rate = 6 }
    ";
    let toml = ball(0.0, 0.0, "").replace("[[body]]", &format!("{table}\n[[body]]"));
    for pair in METHODS {
        let spin = |until: f64| {
            let run = run(&toml, pair, until);
            let network = run.model().network().unwrap();
            network.rotation(0, run.state()).momentum / (0.4 * MASS * RADIUS * RADIUS)
        };
        let early = 0.2;
        let expected = ROLLING * G / (0.4 * RADIUS * RADIUS) * early;
        let error = (spin(early) - Vector3::y() * expected).norm();
        assert!(error < 0.02 * expected, "{pair:?}: {error} of {expected}");
        let error = (spin(2.0) - Vector3::y() * 6.0).norm();
        assert!(error < 1e-2, "{pair:?}: {error}");
    }
}

/// The repulsion k d s3 of a stiffness k and a thickness d bears the weight at the gap d (1 - s).
#[test]
fn a_ball_rests_where_its_stiffness_bears_it() {
    let thickness = 0.002;
    for stiffness in [3e4, 5e5] {
        let toml = format!(
            "
            gravity = [0, {}, 0]
            floor = {{ height = 0, thickness = {thickness} }}
            [[body]]
            at = [0, 0.1012, 0]
            mass = {MASS}
            thickness = {thickness}
            contact_stiffness = {stiffness}
            parts = [{{ ball = {RADIUS} }}]
            ",
            -G
        );
        let height = run(&toml, ("verlet", 2e-4), 3.0).position(0).y;
        let share = (MASS * G / (stiffness * thickness)).cbrt();
        let expected = RADIUS + thickness * (1.0 - share);
        assert!((height - expected).abs() < 1e-6, "{height} {expected}");
    }
}
