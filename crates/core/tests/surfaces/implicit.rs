//! Implicit methods on a pile of cloth, with steps as in a game.

use a3_core::Simulation;

use crate::common::{described, method};

/// A cloth that falls on its edge and folds, with springs of that stiffness (N/m) and damping
/// ratio.
fn pile(stiffness: f64, damping: f64) -> String {
    format!(
        "gravity = [0, -9.81, 0]
        drag_per_mass = 0.5
        floor = 0
        self_collision = true
        [[cloth]]
        grid = [10, 10]
        width = 1
        density = 0.2469
        stiffness = [{stiffness}, {}, {}]
        damping_ratio = {damping}
        at = [0, 1.05, 0]
        sway = [0, 0, 0.2]",
        0.5 * stiffness,
        0.0125 * stiffness
    )
}

#[test]
fn they_run_piles_soft_and_stiff_damped_and_not() {
    for (stiffness, damping) in [(40.0, 0.1), (4.0, 0.1), (4000.0, 0.1), (40.0, 0.0), (40.0, 1.0)] {
        let scene = described(&pile(stiffness, damping));
        for (name, value) in [("implicit", 1.0 / 60.0), ("tr-bdf2", 1.0 / 60.0), ("bdf", 1e-3)] {
            let method = method(name);
            let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
            let before = run.energy().unwrap().total();
            let ran = run.advance_to(0.6);
            assert!(ran.is_ok(), "{name}, {stiffness} N/m, damping ratio {damping}: {ran:?}");
            let after = run.energy().unwrap().total();
            assert!(after < before, "{name}, {stiffness} N/m: energy from {before} J to {after} J");
        }
    }
}
