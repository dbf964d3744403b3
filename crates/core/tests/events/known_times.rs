//! Times at which a prescribed motion begins or ends.

use crate::common::{described, method};
use a3_core::Simulation;

/// Height of particle 1 at a time (s).
fn height(toml: &str, name: &str, value: f64, until: f64) -> f64 {
    let method = method(name);
    let mut run = Simulation::new(described(toml), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run.position(1).y
}

/// After 20 s at rest, a pin moves by 0.1 m within 50 ms: the mass that hangs from it swings by (a
/// / w T) (sin w (t - 20.05) - sin w (t - 20)) about the new place, from the response to two ramps.
#[test]
fn a_rest_lets_no_pulse_pass() {
    let toml = "
        gravity = [0, -10, 0]
        [particles]
        positions = [[0, 0, 0], [0, -1.4, 0]]
        mass = 1
        springs = [[0, 1, 25, 1, 0]]
        [[pin]]
        particles = [0]
        shift = { by = [0, 0.1, 0], start = 20, end = 20.05 }
    ";
    let response = |t: f64| {
        let (w, ramp) = (5.0, 2.0);
        let of = |t: f64| {
            if t > 0.0 { ramp * (t - f64::sin(w * t) / w) } else { 0.0 }
        };
        -1.4 + of(t - 20.0) - of(t - 20.05)
    };
    for (name, tolerance, bound) in [
        ("dop853", 1e-8, 1e-6),
        ("dopri5", 1e-7, 1e-4),
        ("verner65", 1e-7, 1e-4),
        ("dprkn86", 1e-8, 1e-5),
        ("bdf", 1e-7, 1e-2),
    ] {
        for until in [20.02, 20.3, 25.0] {
            let found = height(toml, name, tolerance, until);
            let error = (found - response(until)).abs();
            assert!(error < bound, "{name} at {until}: {error}");
        }
    }
}

/// A pin starts and stops moving abruptly: the tightest tolerance is met in few steps.
#[test]
fn tight_tolerances_are_met_where_a_pin_starts() {
    let toml = "
        gravity = [0, -9.81, 0]
        springs = [[0, 1, 40.0, 0.5, 0.3]]
        [particles]
        positions = [[0, 0, 0], [0.5, 0, 0]]
        mass = 0.1
        [[pin]]
        particles = [0]
        shift = { by = [0.3, 0, 0], start = 0.31, end = 0.67 }
    ";
    let mut run =
        Simulation::new(described(toml), method("dop853"), method("dop853").control(1e-13))
            .unwrap();
    run.advance_to(1.0).unwrap();
    assert!(run.work().rejections < run.steps(), "{:?}", run.work());
    let loose = height(toml, "dop853", 1e-10, 1.0);
    assert!((run.position(1).y - loose).abs() < 1e-8);
    assert!((loose - height(toml, "rk4", 1e-4, 1.0)).abs() < 1e-5);
}

/// The longest step is respected.
#[test]
fn no_step_is_longer_than_the_longest() {
    let mut scene = described("[particles]\npositions = [[0, 0, 0]]\nmass = 1");
    scene.limits.max_step = Some(0.125);
    let method = method("dop853");
    let mut run = Simulation::new(scene, method, method.control(1e-3)).unwrap();
    run.advance_to(4.0).unwrap();
    assert!(run.steps() >= 32 && run.step_size().unwrap() <= 0.125);
}

/// A step of the longest allowed length ends there, and not where a motion begins.
#[test]
fn longest_steps_stay_what_they_are() {
    let toml = "
        max_step = 1e-3
        [particles]
        positions = [[0, 0, 0], [0.5, 0, 0]]
        velocities = [[0, 0, 0], [0, 1, 0]]
        mass = 0.1
        springs = [[0, 1, 40.0, 0.5, 0.3]]
        [[pin]]
        particles = [0]
        shift = { by = [0.3, 0, 0], start = 0.3105, end = 0.67 }
    ";
    for name in ["dop853", "rkf45", "bdf"] {
        let solver = method(name);
        let mut run = Simulation::new(described(toml), solver, solver.control(1e-3)).unwrap();
        for k in 0..315 {
            let begin = run.time();
            run.take_steps(1).unwrap();
            let h = run.time() - begin;
            assert!(h < 1e-3 + 1e-12, "{name}: step {k} from {begin} takes {h}");
        }
        assert!(run.time() < 0.315, "{name}: {}", run.time());
        // A step ends where the motion begins.
        let far = run.position(0).x;
        assert!((far - 0.3 * (run.time() - 0.3105).max(0.0) / 0.3595).abs() < 1e-12);
    }
}

/// A motion may be much shorter than a step: its short steps are measured more finely than the
/// time.
#[test]
fn motions_may_be_as_short_as_digits_tell() {
    for end in ["1.000000000001", "1.0000000000000002", "1.00000001"] {
        let toml = format!(
            "
            [particles]
            positions = [[0, 0, 0], [0.5, 0, 0]]
            mass = 0.1
            springs = [[0, 1, 40.0, 0.5, 0.3]]
            [[pin]]
            particles = [0]
            shift = {{ by = [1e-3, 0, 0], start = 1, end = {end} }}
            "
        );
        for (name, value) in [("dop853", 1e-6), ("bdf", 1e-4)] {
            let solver = method(name);
            let control = solver.control(value);
            let mut run = Simulation::new(described(&toml), solver, control).unwrap();
            run.advance_to(1.5).unwrap();
            assert!((run.position(0).x - 1e-3).abs() < 1e-12, "{name} {end}");
        }
    }
}
