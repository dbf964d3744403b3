//! Particles that rest and slide on flat obstacles, in steps that locate events.

use crate::common::{described, method};
use a3_core::{Control, Simulation};

/// Final positions (m) of a scene.
fn end(text: &str, name: &str, control: Control, until: f64) -> Vec<f64> {
    let mut run = Simulation::new(described(text), method(name), control).unwrap();
    run.advance_to(until).unwrap();
    run.state()[..3 * run.particles()].to_vec()
}

/// Largest distance along an axis.
fn apart(a: &[f64], b: &[f64]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    distances.fold(0.0, f64::max)
}

/// A mass on a rough floor that a spring pulls back and forth: in each half period the amplitude
/// decreases by twice the stretch that friction can hold, until friction holds the spring and the
/// mass sticks.
#[test]
fn friction_stops_an_oscillator_where_its_closed_form_says() {
    let (stiffness, mass, friction, first): (f64, f64, f64, f64) = (40.0, 0.2, 0.3, 0.1);
    let scene = format!(
        "gravity = [0, -9.81, 0]
        floor = {{ height = 0, friction = {friction} }}
        [particles]
        positions = [[0, 0, 0], [{}, 0, 0]]
        masses = [1, {mass}]
        springs = [[0, 1, {stiffness}, 1, 0]]
        pin = [{{ particles = [0] }}]",
        1.0 + first
    );
    let held = friction * mass * 9.81 / stiffness;
    let half_period = std::f64::consts::PI * (mass / stiffness).sqrt();
    let (mut stretch, mut turns) = (first, 0.0);
    while stretch.abs() > held {
        stretch = -stretch + 2.0 * held * stretch.signum();
        turns += 1.0;
    }
    assert!(turns > 2.0);
    for name in ["dop853", "verner65", "dopri5"] {
        for (tolerance, most) in [(1e-6, 1e-5), (1e-10, 1e-8)] {
            let control = Control::Tolerance(tolerance);
            let x = end(&scene, name, control, (turns + 2.0) * half_period);
            let error = (x[1] - 1.0 - stretch).abs();
            assert!(error < most, "{name} {tolerance}: {error}");
            let x = end(&scene, name, control, half_period);
            let error = (x[1] - 1.0 + first - 2.0 * held).abs();
            assert!(error < most, "{name} {tolerance}, at the first turn: {error}");
        }
    }
}

/// Three masses on springs fall on a rough floor or a box, slide, lift off and come to rest.
/// Adaptive methods of any order agree. Fixed steps, with contact at their ends, converge to the
/// same motion.
#[test]
fn what_slides_and_sticks_converges_to_one_motion() {
    for obstacle in ["", "[[box]]\ncenter = [0, 0, 0]\nsize = [1.2, 0.2, 2]\nfriction = 0.2\n"] {
        let scene = format!(
            "gravity = [0, -9.81, 0]
            drag = 0.01
            floor = {{ height = 0, friction = 0.4 }}
            [particles]
            positions = [[0, 0.5, 0], [0.4, 0.6, 0.1], [0.1, 0.9, 0.3]]
            velocities = [[2, 0, 0], [2, 0, 0], [2, 0.5, 0]]
            masses = [0.2, 0.3, 0.1]
            springs = [[0, 1, 40, 0.4, 0.1], [1, 2, 40, 0.5, 0.1], [0, 2, 30, 0.5, 0.1]]
            {obstacle}"
        );
        let truth = end(&scene, "dop853", Control::Tolerance(1e-12), 1.5);
        for (name, tolerance, most) in [
            ("dop853", 1e-6, 1e-4),
            ("dop853", 1e-9, 1e-6),
            ("verner65", 1e-9, 1e-6),
            ("rkf45", 1e-9, 1e-6),
        ] {
            let error = apart(&truth, &end(&scene, name, Control::Tolerance(tolerance), 1.5));
            assert!(error < most, "{name} {tolerance}: {error}");
        }
        let steps = [5e-4, 1.25e-4];
        let errors = steps.map(|h| apart(&truth, &end(&scene, "rk4", Control::Step(h), 1.5)));
        assert!(errors[0] < 1e-3 && errors[1] < 0.7 * errors[0], "{errors:?}");
    }
}
