//! Orders of methods of fixed steps through rebounds, where forces depend on velocities.

use crate::common::{described, method};
use a3_core::{Control, Simulation};

/// Two masses on a spring that rebound eight times in a second.
fn scene(damping: f64, drag: f64) -> String {
    format!(
        "gravity = [0, -9.81, 0]
        drag = {drag}
        floor = {{ height = 0, restitution = 0.8 }}
        [particles]
        positions = [[0, 0.2, 0], [0.25, 0.35, 0]]
        velocities = [[0.3, 0, 0], [0, 0, 0]]
        masses = [0.2, 0.3]
        springs = [[0, 1, 60, 0.28, {damping}]]"
    )
}

/// Positions after a second (m).
fn end(text: &str, name: &str, control: Control) -> Vec<f64> {
    let mut run = Simulation::new(described(text), method(name), control).unwrap();
    run.advance_to(1.0).unwrap();
    run.state()[..6].to_vec()
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    let distances = a.iter().zip(b).map(|(a, b)| (a - b).abs());
    distances.fold(0.0, f64::max)
}

#[test]
fn methods_keep_order_2_through_rebounds() {
    for (damping, drag) in [(0.0, 0.0), (0.6, 0.0), (0.3, 0.2)] {
        let text = scene(damping, drag);
        let truth = end(&text, "dop853", Control::Tolerance(1e-12));
        for name in [
            "rk4",
            "verlet",
            "tr-bdf2",
            "trapezoid",
            "midpoint",
            "implicit-midpoint",
            "implicit-damping",
        ] {
            let errors = [200, 400, 800, 1600].map(|count| {
                let control = Control::Step(1.0 / f64::from(count));
                apart(&end(&text, name, control), &truth)
            });
            let found = (errors[0] / errors[3]).log2() / 3.0;
            assert!(found > 1.8, "{name}: {errors:?}");
            assert!(name != "rk4" || errors[3] < 1e-9, "{errors:?}");
        }
    }
}

/// Exact positions, by an event-driven model of order 8 in Python.
#[test]
fn fixed_steps_converge_to_the_motion_of_a_model() {
    let truth =
        [0.103_185_228_409, 0.381_209_847_727, 0.005_851_999_910, 0.066_042_278_710, 0.0, 0.0];
    let error = apart(&end(&scene(0.6, 0.0), "rk4", Control::Step(1.0 / 1600.0)), &truth);
    assert!(error < 1e-8, "{error:e}");
}
