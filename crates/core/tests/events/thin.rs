//! Obstacles that are thinner than the displacement in a step.

use crate::common::{described, method};
use a3_core::Simulation;
use a3_core::integrators::METHODS;

/// Text of a scene: a cloth falls 1 m onto a table top of that thickness (m) at y = 0.5.
fn table(thick: f64) -> String {
    format!(
        "gravity = [0, -9.81, 0]
        drag_per_mass = 0.1
        [[cloth]]
        grid = [8, 8]
        width = 0.8
        density = 0.2
        stiffness = [10, 5, 1]
        damping_ratio = 0.2
        at = [0, 1.5, -0.4]
        down = [0, 0, 1]
        [[box]]
        center = [0, {}, 0]
        size = [2, {thick}, 2]
        friction = 0.5",
        0.5 - 0.5 * thick
    )
}

#[test]
fn a_cloth_rests_on_a_thin_table_by_every_solver() {
    for thick in [0.02, 0.002] {
        let scene = described(&table(thick));
        for method in METHODS {
            if method.check(scene.model.system()).is_err() {
                continue;
            }
            // Steps that are stable, but too long for the table.
            let value = if method.is_adaptive() { 1e-3 } else { 1.0 / 240.0 };
            let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
            run.advance_to(0.7).unwrap();
            assert!(run.lowest() > 0.5 - 1e-3, "{} {thick}", method.name);
        }
    }
}

/// A particle at 50 m/s does not pass through a sphere, a capsule or a box, still or moving, even
/// if a step leads right through it.
#[test]
fn no_particle_passes_through_a_small_obstacle_in_a_step() {
    for shape in [
        "[[sphere]]\ncenter = [0, 0, 0]\nradius = 0.05",
        "[[capsule]]\nfrom = [0, -1, 0]\nto = [0, 1, 0]\nradius = 0.02",
        "[[box]]\ncenter = [0, 0, 0]\nsize = [0.01, 1, 1]\nrotation = [0, 0.02, 0]",
    ] {
        for moves in ["", "shift = { by = [-20, 0, 0], end = 1 }"] {
            let toml = format!(
                "[particles]
                positions = [[-0.9, 0.001, 0.002]]
                mass = 1
                [state]
                positions = [[-0.9, 0.001, 0.002]]
                velocities = [[50, 0, 0]]
                {shape}
                {moves}"
            );
            let method = method("rk4");
            let mut run = Simulation::new(described(&toml), method, method.control(0.1)).unwrap();
            run.take_steps(1).unwrap();
            let path = &run.model().network().unwrap().obstacles()[0].path;
            let ahead = run.position(0).x - path.at(run.time()).position.x;
            assert!(ahead < 0.06, "{ahead}: {toml}");
        }
    }
}

/// A particle that flies freely for long, in ever longer steps, and goes back, still meets what is
/// in its way.
#[test]
fn nothing_is_missed_after_a_free_flight() {
    let scene = described(
        "[particles]
        positions = [[0, 0, 0], [-1, 0, 0]]
        velocities = [[0, 1, 0], [1, 0, 0]]
        mass = 1
        [[box]]
        center = [1, 0, 0]
        size = [0.01, 1, 1]
        restitution = 1",
    );
    for name in ["dopri5", "dop853", "dprkn86"] {
        let method = method(name);
        let mut run = Simulation::new(scene.clone(), method, method.control(1e-6)).unwrap();
        let moment = run.moment();
        run.take_steps(20).unwrap();
        run.rewind(&moment).unwrap();
        run.advance_to(3.0).unwrap();
        let x = run.position(1).x;
        assert!((x + 0.01).abs() < 1e-6, "{name}: {x}");
    }
}
