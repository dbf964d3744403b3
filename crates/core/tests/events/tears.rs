//! Springs that break within a step.

use crate::common::{described, method};
use a3_core::Simulation;

/// A mass is thrown down on a spring, which breaks on the way; then it falls freely.
#[test]
fn a_spring_breaks_at_one_time_whatever_the_frames() {
    let toml = "
        gravity = [0, -9.81, 0]
        tear = 1.5
        [particles]
        positions = [[0, 0, 0], [0, -0.5, 0]]
        masses = [1, 0.3]
        springs = [[0, 1, 40.0, 0.5, 0]]
        pin = [{ particles = [0] }]
        [state]
        positions = [[0, 0, 0], [0, -0.5, 0]]
        velocities = [[0, 0, 0], [0, -4.0, 0]]
    ";
    // x'' = g - w2 x from x = 0 with 4 m/s, until x = 0.25; then a free fall.
    let (w2, g) = (40.0_f64 / 0.3, 9.81);
    let w = w2.sqrt();
    let x = |t: f64| 4.0 / w * f64::sin(w * t) + g / w2 * (1.0 - f64::cos(w * t));
    let v = |t: f64| 4.0 * f64::cos(w * t) + g / w * f64::sin(w * t);
    let mut torn = 0.05;
    for _ in 0..50 {
        torn -= (x(torn) - 0.25) / v(torn);
    }
    let rest = 1.0 - torn;
    let end = -0.75 - v(torn) * rest - 0.5 * g * rest * rest;
    for (name, tolerance, bound) in [
        ("dop853", 1e-8, 1e-6),
        ("dopri5", 1e-8, 1e-6),
        ("verner65", 1e-8, 1e-6),
        ("bdf", 1e-8, 1e-3),
    ] {
        let ends = [1, 7, 100, 1000].map(|frames| {
            let method = method(name);
            let mut run =
                Simulation::new(described(toml), method, method.control(tolerance)).unwrap();
            for k in 1..=frames {
                run.advance_to(f64::from(k) / f64::from(frames)).unwrap();
            }
            assert_eq!(run.tears(), 1);
            run.position(1).y
        });
        assert!(ends.iter().all(|y| *y == ends[0]), "{name}: {ends:?}");
        assert!((ends[0] - end).abs() < bound, "{name}: {} {end}", ends[0]);
    }
}

/// A spring that is too long only within a step breaks too: a mass swings past the limit once and
/// back between the ends of a long step.
#[test]
fn a_spring_that_is_too_long_for_a_moment_breaks() {
    // x = 0.3 sin(w t) with w = 2 pi: the length is at most 1.3.
    let toml = |tear: f64| {
        format!(
            "tear = {tear}
            [particles]
            positions = [[0, 0, 0], [1, 0, 0]]
            mass = 1
            springs = [[0, 1, 39.478417604357434, 1, 0]]
            pin = [{{ particles = [0] }}]
            [state]
            positions = [[0, 0, 0], [1, 0, 0]]
            velocities = [[0, 0, 0], [1.8849555921538759, 0, 0]]"
        )
    };
    for tolerance in [1e-1, 1e-3, 1e-6] {
        for (tear, tears) in [(1.2999, 1), (1.31, 0)] {
            let method = method("dop853");
            let scene = described(&toml(tear));
            let mut run = Simulation::new(scene, method, method.control(tolerance)).unwrap();
            run.advance_to(0.5).unwrap();
            assert_eq!(run.tears(), tears, "{tolerance} {tear}");
        }
    }
}
