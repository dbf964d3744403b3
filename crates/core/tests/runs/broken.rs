//! Constraints that a run does not meet are named, and the energy that it loses is reported.

use a3_core::{Cause, Error, Simulation, integrators};

use super::common::{described, method};

const WEIGHT: &str = "gravity = [0, -9.81, 0]\n";

/// A rigid chain, straight between two pins: there are no other positions, but no bounded force
/// holds it there.
const STRAIGHT: &str = "[particles]\npositions = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\nmass = 1\n\
    pin = [{ particles = [0, 2] }]\n[[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";

/// A rod whose ends are pinned, one of them to a pin that moves.
const PINNED: &str = "[particles]\npositions = [[0, 0, 0], [1, 0, 0]]\nmass = 1\n\
    pin = [{ particles = [0] }, { particles = [1], sine = { amplitude = [0.5, 0, 0], rate = 2 } }]\n\
    [[constraint]]\nrod = [0, 1]\n";

/// A chain of 2 m whose ends are taken 2.5 m apart.
const TAUT: &str = "[particles]\n\
    positions = [[0, 0, 0], [0.5, -0.8660254037844386, 0], [1, 0, 0]]\nmass = 1\n\
    pin = [{ particles = [0] }, { particles = [2], shift = { by = [1.5, 0, 0], end = 1 } }]\n\
    [[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";

/// A light bead on two rods, and a heavy bob: the bead moves fast.
const BEAD: &str = "[particles]\n\
    positions = [[0, 0, 0], [0.5, 0, 0], [0.977668245, 0.147760103, 0]]\nmasses = [1, 0.1, 1]\n\
    pin = [{ particles = [0] }]\n[[constraint]]\nrod = [0, 1]\n[[constraint]]\nrod = [1, 2]\n";

fn run(scene: &str, name: &str, value: f64) -> Simulation {
    let method = method(name);
    let scene = described(&format!("{WEIGHT}{scene}"));
    Simulation::new(scene, method, method.control(value)).unwrap()
}

#[test]
fn a_straight_chain_between_pins_stays() {
    for method in integrators::METHODS {
        if method.is_implicit() || method.positions_only() {
            continue;
        }
        let value = match method.name {
            _ if method.is_adaptive() => 1e-6,
            "euler" => 0.001,
            _ => 0.005,
        };
        let mut run = run(STRAIGHT, method.name, value);
        run.advance_to(2.0).unwrap();
        run.conclude().unwrap();
        let sag = run.position(1) - a3_core::Vector3::x();
        assert!(sag.norm() < 3e-3, "{}: {sag}", method.name);
        assert!(run.was_nearly_singular(), "{}", method.name);
        assert!(run.steps() < 20_000, "{}: {}", method.name, run.steps());
    }
}

#[test]
fn contradictions_are_named() {
    for (scene, from, until) in [(PINNED, 0.0, 0.8), (TAUT, 0.6, 1.0)] {
        for (name, value) in [
            ("rk4", 0.001),
            ("verlet", 0.005),
            ("trapezoid", 0.002),
            ("dopri5", 1e-6),
            ("dop853", 1e-3),
        ] {
            let mut run = run(scene, name, value);
            let Err(Error::BlowUp(lost)) = run.advance_to(3.0) else {
                panic!("{name} went on");
            };
            assert!(matches!(lost.cause, Cause::Contradiction(_)), "{name}: {lost}");
            assert!(lost.time > from && lost.time < until, "{name}: {lost}");
            let words = lost.to_string();
            assert!(words.contains("the rod between particles"), "{words}");
        }
    }
}

#[test]
fn rods_that_lose_their_length_are_told_with_the_energy() {
    let mut coarse = run(BEAD, "verlet", 0.01);
    coarse.advance_to(5.0).unwrap();
    let unmet = coarse.worst_constraint().unwrap();
    assert!(unmet.is_visible() && unmet.share < 0.1, "{unmet:?}");
    let change = coarse.energy_change().unwrap();
    assert!((0.1..0.5).contains(&change), "{change}");
    let mut fine = run(BEAD, "rk4", 0.0005);
    fine.advance_to(5.0).unwrap();
    let unmet = fine.worst_constraint().unwrap();
    assert!(unmet.share < 1e-4 && !unmet.is_visible(), "{unmet:?}");
    assert!(fine.energy_change().unwrap().abs() < 1e-3);
    // A step that is far too long breaks them; shorter steps do not.
    let mut lost = run(BEAD, "euler", 0.02);
    let Err(Error::BlowUp(lost)) = lost.advance_to(5.0) else {
        panic!("it went on");
    };
    let Cause::Unmet(unmet) = lost.cause else { panic!("{lost}") };
    assert!(unmet.share > 0.1);
    assert!(lost.to_string().contains("is off by"), "{lost}");
}

#[test]
fn only_energy_that_is_kept_has_a_change() {
    let change = |scene: &str| {
        let mut run = run(scene, "rk4", 0.01);
        run.advance_to(1.0).unwrap();
        run.energy_change()
    };
    let free = "[particles]\npositions = [[0, 0, 0], [1.2, 0, 0]]\nmass = 1\n\
        pin = [{ particles = [0] }]\nsprings = [[0, 1, 100, 1, DAMPING]]\n";
    let [kept, damped] = ["0", "2"].map(|c| free.replace("DAMPING", c));
    assert!(change(&kept).unwrap().abs() < 1e-3);
    assert_eq!(change(&damped), None);
    assert_eq!(change(&format!("drag = 0.1\n{kept}")), None);
    assert_eq!(change(PINNED.split("[[constraint]]").next().unwrap()), None);
    // Contact loses energy; until then it is conserved.
    let ball = "[particles]\npositions = [[0, 1, 0]]\nmass = 1\n";
    assert!(change(ball).unwrap().abs() < 1e-9);
    assert!(change(&format!("floor = -10\n{ball}")).unwrap().abs() < 1e-9);
    assert_eq!(change(&format!("floor = 0\n{ball}")), None);
    // Hands may change the energy.
    let mut held = run(&kept, "verlet", 0.001);
    held.advance_to(0.5).unwrap();
    assert!(held.energy_change().is_some());
    held.grab(1).unwrap();
    held.release();
    held.advance_to(0.6).unwrap();
    assert_eq!(held.energy_change(), None);
    // Euler's method gains energy.
    let mut euler = run(&kept, "euler", 0.002);
    euler.advance_to(1.0).unwrap();
    assert!(euler.energy_change().unwrap() > 0.01);
}
