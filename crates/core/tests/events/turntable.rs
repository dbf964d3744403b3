//! Friction on obstacles that turn, which acts after each step.

use crate::common::{described, method};
use a3_core::{Control, Simulation, Vector3};

/// A ball that a turntable sets in motion slides for 0.057 s, and then rolls on a circle, at 2/7 of
/// the table's rate (Earnshaw): at 0.5001 m/s, by the equations of sliding and rolling.
#[test]
fn a_ball_on_a_turntable_rolls_on_its_circle() {
    let scene = "gravity = [0, -9.81, 0]
        [[box]]
        center = [0, -0.1, 0]
        size = [6, 0.2, 6]
        friction = 0.9
        thickness = 0.004
        turn = { axis = [0, 1, 0], rate = 3.5 }
        [[body]]
        parts = [{ ball = 0.1 }]
        mass = 1
        at = [0.5, 0.1, 0]";
    let truth = Vector3::new(-0.195_142, 0.0, -0.460_420);
    let check = |name: &str, control: Control| {
        let mut run = Simulation::new(described(scene), method(name), control).unwrap();
        run.advance_to(2.0).unwrap();
        let mut off = run.position(0) - truth;
        off.y = 0.0;
        let (n, v) = (run.particles(), run.velocities());
        let speed = Vector3::new(v[0], v[n], v[2 * n]).norm();
        assert!(off.norm() < 5e-4, "{name}: {off}");
        assert!((speed - 0.500_067).abs() < 2e-4, "{name}: {speed}");
    };
    for name in ["dopri5", "dop853", "verner65"] {
        check(name, Control::Tolerance(1e-6));
    }
    check("rk4", Control::Step(1e-3));
}

/// A particle that slides on a turntable, and one that friction then holds and takes round, by the
/// equations of sliding.
#[test]
fn a_particle_slides_on_a_turntable_until_it_is_held() {
    for (rate, friction, until, truth) in [
        (3.5, 0.05, 1.5, [0.391_757, -0.524_557]),
        (1.0, 0.3, 2.0, [-0.168_890, -0.471_263]),
        (3.5, 0.9, 2.0, [0.482_750, -0.180_848]),
    ] {
        let scene = format!(
            "gravity = [0, -9.81, 0]
            [[box]]
            center = [0, -0.1, 0]
            size = [6, 0.2, 6]
            friction = {friction}
            turn = {{ axis = [0, 1, 0], rate = {rate} }}
            [particles]
            positions = [[0.5, 0, 0]]
            mass = 1"
        );
        let check = |name: &str, control: Control| {
            let mut run = Simulation::new(described(&scene), method(name), control).unwrap();
            run.advance_to(until).unwrap();
            let off = run.position(0) - Vector3::new(truth[0], 0.0, truth[1]);
            assert!(off.norm() < 2e-4, "{rate}, {name}: {off}");
        };
        for name in ["dopri5", "dop853", "verner65"] {
            check(name, Control::Tolerance(1e-6));
        }
        check("rk4", Control::Step(1e-3));
    }
}
