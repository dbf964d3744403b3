//! Friction of surfaces on a slope.

use a3_core::{Control, Simulation, integrators};
use a3_scenes::Description;

/// Run of a scene from its TOML text.
fn run(toml: &str, method: &str, control: Control) -> Simulation {
    let setup = Description::parse(toml)
        .and_then(|description| description.build(None, &mut |_| Err("no files".into())));
    let method = integrators::find(method).unwrap();
    Simulation::new(setup.unwrap().scene, method, control).unwrap()
}

/// Sheet that lies on a ramp of that length (m), with a coefficient of friction and the tangent of
/// the ramp.
fn sheet_on_ramp(friction: f64, tangent: f64, length: f64) -> String {
    let angle = tangent.atan();
    let (c, s) = (angle.cos(), angle.sin());
    // About the gap at which the contact force supports the sheet.
    let up = 0.05 + 0.008_46;
    format!(
        "gravity = [0, -9.81, 0]
self_collision = true
[[box]]
center = [0, 0, 0]
size = [{length}, 0.1, 4]
rotation = [0, 0, {}]
friction = {friction}
[[cloth]]
grid = [5, 4]
spacing = 0.1
density = 0.3
stiffness = [60, 30, 2]
damping_ratio = 0.3
right = [0, 0, -1]
down = [{c}, {}, 0]
at = [{}, {}, 0]
",
        -angle,
        -s,
        s * up,
        c * up,
    )
}

/// Distance that the sheet slides down the slope between two times (s), and its final speed (m/s).
fn slides(friction: f64, tangent: f64, method: &str, step: f64, times: [f64; 2]) -> [f64; 2] {
    let length = if friction < tangent { 300.0 } else { 40.0 };
    let toml = sheet_on_ramp(friction, tangent, length);
    let mut run = run(&toml, method, Control::Step(step));
    let angle = tangent.atan();
    let down = a3_core::Vector3::new(angle.cos(), -angle.sin(), 0.0);
    run.advance_to(times[0]).unwrap();
    let before: Vec<_> = (0..run.particles()).map(|i| run.position(i)).collect();
    let speed = |run: &a3_core::Simulation| {
        let (n, v) = (run.particles(), run.velocities());
        a3_core::Vector3::new(v[0], v[n], v[2 * n]).dot(&down)
    };
    let first = speed(&run);
    run.advance_to(times[1]).unwrap();
    let moved = before
        .iter()
        .enumerate()
        .map(|(i, before)| (run.position(i) - before).dot(&down).abs())
        .fold(0.0, f64::max);
    [moved, (speed(&run) - first) / (times[1] - times[0])]
}

#[test]
fn a_sheet_sticks_or_slides_by_its_friction() {
    for (method, step) in [("v", 0.0005), ("r", 0.004), ("i", 0.004)] {
        let tangent = 30_f64.to_radians().tan();
        let [moved, _] = slides(0.6, tangent, method, step, [20.0, 30.0]);
        assert!(moved < 1e-12, "{method} moved {moved:.1e} m");
        let [_, rate] = slides(0.3, tangent, method, step, [6.0, 8.0]);
        assert!((rate / 2.356_287 - 1.0).abs() < 1e-3, "{method} slides at {rate} m/s2");
    }
}

#[test]
fn the_tangent_of_the_slope_decides() {
    let [held, _] = slides(0.51, 0.5, "v", 0.002, [20.0, 21.0]);
    let [slid, _] = slides(0.49, 0.5, "v", 0.002, [20.0, 21.0]);
    assert!(held < 1e-12 && slid > 0.01, "held {held:.1e} m, slid {slid:.1e} m");
}
