//! Wind in a region, as from a fan: its work against the closed form, at rest, moving and turning.

use crate::common::{described, method};
use a3_core::elements::{Region, Wind};
use a3_core::{Path, Simulation, Turn, Vector3};

/// Force of the wind at its centre (N), mass of the particle (kg), and radius along the wind (m).
const FORCE: f64 = 3.0;
const MASS: f64 = 0.5;
const LENGTH: f64 = 2.0;

/// A particle that starts at `x` (m) with a speed (m/s), in a region that moves with the motion
/// that the text gives.
fn blown(x: f64, speed: f64, motion: &str) -> String {
    format!(
        "
        [particles]
        positions = [[{x}, 0, 0]]
        mass = {MASS}
        [state]
        velocities = [[{speed}, 0, 0]]
        [wind]
        on = true
        steady = true
        force = [{FORCE}, 0, 0]
        region = {{ at = [0, 0, 0], radius = 0.7, length = {LENGTH}{motion} }}
        "
    )
}

/// Velocity along x (m/s) and z (m/s) after a time (s).
fn end(toml: &str, name: &str, value: f64, until: f64) -> [f64; 2] {
    let method = method(name);
    let mut run = Simulation::new(described(toml), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    let v = run.velocities();
    [v[0], v[2]]
}

/// Speed (m/s) at the surface of a particle that starts at rest at the centre: the work of the
/// force F (1 - s2 / L2)3 from 0 to L is 16/35 F L.
fn speed_at_surface() -> f64 {
    (2.0 * FORCE * LENGTH * 16.0 / 35.0 / MASS).sqrt()
}

#[test]
fn a_particle_leaves_with_the_work_of_the_wind() {
    let still = blown(0.0, 0.0, "");
    for (name, value, bound) in [
        ("rk4", 1e-3, 1e-9),
        ("verlet", 1e-3, 1e-6),
        ("trapezoidal", 1e-3, 1e-5),
        ("dopri5", 1e-9, 1e-6),
        ("implicit-midpoint", 1e-3, 1e-5),
        ("bdf", 1e-8, 1e-4),
    ] {
        let [speed, _] = end(&still, name, value, 4.0);
        let error = (speed - speed_at_surface()).abs();
        assert!(error < bound, "{name}: {error}");
    }
    // No wind above the region.
    let beside = blown(0.0, 0.0, "").replace("[[0, 0, 0]]", "[[0, 0.71, 0]]");
    assert_eq!(end(&beside, "rk4", 1e-2, 1.0), [0.0; 2]);
}

#[test]
fn the_edge_of_a_region_keeps_the_order_of_a_method() {
    let error = |step: f64| {
        let [speed, _] = end(&blown(0.0, 0.0, ""), "rk4", step, 4.0);
        (speed - speed_at_surface()).abs()
    };
    let order = (error(0.05) / error(0.025)).log2();
    assert!((3.7..5.0).contains(&order), "{order}");
}

#[test]
fn a_region_that_moves_does_the_same_work() {
    let motion = ", shift = { by = [10, 0, 30], end = 10 }";
    let toml = blown(0.0, 1.0, motion).replace("[[1, 0, 0]]", "[[1, 0, 3]]");
    let [speed, across] = end(&toml, "rk4", 1e-3, 4.0);
    assert!((speed - 1.0 - speed_at_surface()).abs() < 1e-9, "{speed}");
    assert!((across - 3.0).abs() < 1e-12, "{across}");
}

#[test]
fn a_region_turns_its_wind_and_ends_its_turn_between_steps() {
    let turn =
        Turn { axis: Vector3::y(), rate: 0.5 * std::f64::consts::PI, start: 1.0, end: Some(2.0) };
    let region = Region {
        path: Path::Still(Vector3::new(1.0, 0.0, 0.0)),
        turn: Some(turn),
        radius: 0.5,
        length: 2.0,
    };
    let wind = Wind::new(1, Vector3::x() * FORCE).steady();
    let wind = wind.within(region).unwrap();
    // A quarter turn about y takes x to -z, and the long axis of the region with it.
    let left = |q: f64| (1.0 - q).powi(3);
    for (t, x, expected) in [
        (0.5, [1.0, 0.0, 0.0], Vector3::x()),
        (0.5, [2.0, 0.0, 0.0], Vector3::x() * left(0.25)),
        (0.5, [1.0, 0.0, 1.0], Vector3::zeros()),
        (3.0, [1.0, 0.0, 1.0], -Vector3::z() * left(0.25)),
        (3.0, [1.0, 0.4, 0.0], -Vector3::z() * left(0.64)),
        (3.0, [2.0, 0.0, 0.0], Vector3::zeros()),
    ] {
        let error = (wind.at(t, x) - expected * FORCE).norm();
        assert!(error < 1e-14, "{t} {x:?}: {error}");
        let later = wind.ahead(t).at(0.0, x);
        assert!((later - wind.at(t, x)).norm() < 1e-14);
    }
    assert!(wind.within(Region { radius: 0.0, ..region }).is_err());
    // The kinks at 1 s and 2 s are met: a tight tolerance agrees with steps that end there.
    let motion = ", turn = { axis = [0, 1, 0], angle = 1.5707963267948966, start = 1, end = 2 }";
    let slow = blown(0.0, 0.0, motion).replace("force = [3, 0, 0]", "force = [0.1, 0, 0]");
    let fine = end(&slow, "rk4", 1e-3, 4.0);
    let adaptive = end(&slow, "dop853", 1e-10, 4.0);
    for (a, b) in fine.iter().zip(&adaptive) {
        assert!((a - b).abs() < 1e-9, "{fine:?} {adaptive:?}");
    }
    assert!(fine[1] < -0.1, "{fine:?}");
}
