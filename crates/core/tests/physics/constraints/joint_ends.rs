//! Ends of joints, particles that are attached to bodies, and the methods that hold joints.

use super::*;
use crate::common::described;
use a3_core::Control;
use a3_core::integrators::METHODS;

/// A door that turns freely stops at its limit, and not behind it.
#[test]
fn a_door_stops_at_its_limit_at_the_right_time() {
    let door = described(
        "[[body]]
        parts = [{ box = [0.8, 2, 0.04] }]
        mass = 20
        at = [0.4, 1, 0]
        velocity = [0, 0, -0.8]
        spin = [0, 2, 0]
        [[joint]]
        body = 0
        hinge = { at = [0, 0, 0], axis = [0, 1, 0], limits = [0, 1.5] }",
    );
    for (name, value) in [("dop853", 1e-10), ("rk4", 0.01), ("tr-bdf2", 0.01), ("euler", 1e-3)] {
        let angle = |run: &Simulation| {
            let at = run.position(0);
            (-at.z).atan2(at.x)
        };
        let before = simulated(&door, name, value, 0.74);
        assert!((angle(&before) - 1.48).abs() < 2e-3, "{name}: {}", angle(&before));
        for time in [0.76, 2.0] {
            let after = simulated(&door, name, value, time);
            let off = angle(&after) - 1.5;
            let (most, speed) = (
                match name {
                    "dop853" => 1e-8,
                    "euler" => 1e-3,
                    _ => 1e-6,
                },
                velocity_of(&after, 0).norm(),
            );
            assert!(off.abs() < most && speed < most, "{name}: {off:e}, {speed:e}");
        }
    }
}

/// A box slides down an inclined axis with g sin(angle), and stops where its slider ends.
#[test]
fn a_box_slides_along_its_axis_to_its_end() {
    let slope = described(&format!(
        "gravity = [0, -{G}, 0]
        [[body]]
        parts = [{{ box = [0.2, 0.3, 0.4] }}]
        mass = 5
        [[joint]]
        body = 0
        slider = {{ axis = [0.8, -0.6, 0], limits = [-1, 1.2] }}"
    ));
    let way = vector(0.8, -0.6, 0.0);
    for (name, value) in [("dop853", 1e-10), ("rk4", 0.01), ("verlet", 0.01), ("bdf", 1e-8)] {
        let run_to = |time| simulated(&slope, name, value, time);
        let slid = run_to(0.5).position(0) - way * (0.5 * 0.6 * G * 0.25);
        assert!(slid.norm() < 1e-7, "{name}: {slid}");
        let stopped = run_to(1.5).position(0) - way * 1.2;
        assert!(stopped.norm() < 1e-7, "{name}: {stopped}");
    }
}

/// A bar on a hinge falls from an angle A, rebounds at the lowest point with the share e of its
/// speed, and rises to 1 - cos A' = e2 (1 - cos A): between two rebounds, half of a period passes.
#[test]
fn a_pendulum_rebounds_at_its_limit() {
    let (angle, restitution): (f64, f64) = (1.2, 0.7);
    let (sin, cos) = angle.sin_cos();
    let scene = described(&format!(
        "gravity = [0, -{G}, 0]
        [[body]]
        parts = [{{ box = [0.1, 1.2, 0.2] }}]
        mass = 2
        at = [{}, {}, 0]
        rotation = [0, 0, {angle}]
        [[joint]]
        body = 0
        hinge = {{ at = [0, 0, 0], axis = [0, 0, 1], limits = [-{angle}, 2], restitution = {restitution} }}",
        0.6 * sin,
        -0.6 * cos,
    ));
    let frequency = (2.0 * G * 0.6 / (2.0 * (1.45 / 12.0 + 0.36))).sqrt();
    let rises = |count: i32| (1.0 - restitution.powi(2 * count) * (1.0 - cos)).acos();
    let quarter = |count: i32| 0.25 * period(frequency, rises(count));
    let mut time = quarter(0);
    for count in 1..=3 {
        time += quarter(count);
        for (name, value, most) in [("dop853", 1e-10, 1e-7), ("rk4", 0.01, 1e-5)] {
            let run = simulated(&scene, name, value, time);
            let off = run.position(0).x.atan2(-run.position(0).y) - rises(count);
            let speed = velocity_of(&run, 0).norm();
            assert!(
                off.abs() < most && speed < 10.0 * most,
                "{name}, {count} rebounds: {off:e}, {speed:e}"
            );
        }
        time += quarter(count);
    }
}

/// A box falls along a slider on its end, rebounds to e2 times the height again and again, and lies
/// there after the sum of all these times: t (1 + e) / (1 - e).
#[test]
fn a_box_on_a_slider_rebounds_and_comes_to_rest() {
    let scene = described(&format!(
        "gravity = [0, -{G}, 0]
        [[body]]
        parts = [{{ box = [0.2, 0.3, 0.4] }}]
        mass = 5
        [[joint]]
        body = 0
        slider = {{ axis = [0, 1, 0], limits = [-1, 1], restitution = 0.5 }}"
    ));
    let falls = (2.0 / G).sqrt();
    for (name, value) in [("dop853", 1e-9), ("rk4", 0.01), ("verlet", 0.01)] {
        let height = |time: f64| simulated(&scene, name, value, time * falls).position(0).y + 1.0;
        for (time, exact) in [(1.5, 0.25), (2.25, 0.0625), (3.1, 0.0), (6.0, 0.0)] {
            let off = height(time) - exact;
            assert!(off.abs() < 1e-6, "{name}, {time}: {off:e}");
        }
    }
}

/// The edge of a cloth moves with the body to which it is attached, and pulls at it: the two fall
/// together, and keep their momenta.
#[test]
fn a_cloth_is_attached_to_a_turning_body() {
    let scene = described(
        "[[cloth]]
        grid = [4, 5]
        width = 0.8
        density = 0.3
        stiffness = [60, 30, 5]
        pin = [{ at = [\"top\"], body = 0 }]
        [[body]]
        parts = [{ capsule = [0.9, 0.03] }]
        rotation = [0, 0, 1.5707963267948966]
        mass = 1
        spin = [0, 3, 1]",
    );
    let network = scene.model.network().unwrap();
    let attached = |run: &Simulation| {
        let pose = network.pose(0, run.state());
        (0..5).map(move |i| pose.inwards(run.position(i) - pose.place.position)).collect::<Vec<_>>()
    };
    let total = |run: &Simulation| {
        let moved = (0..20).map(|i| velocity_of(run, i) * network.masses()[i]);
        moved.sum::<Vector3<f64>>() + momenta(run).0
    };
    let begun = simulated(&scene, "dop853", 1e-9, 0.0);
    for (name, value, most) in
        [("dop853", 1e-9, 1e-9), ("rk4", 2e-3, 1e-6), ("implicit", 0.02, 1e-10)]
    {
        let run = simulated(&scene, name, value, 0.5);
        assert!(joint_error(&run) < most, "{name}: {:e}", joint_error(&run));
        for (a, b) in attached(&run).iter().zip(attached(&begun)) {
            assert!((a - b).norm() < 2.0 * most, "{name}: {a} {b}");
        }
        let change = total(&run) - total(&begun);
        assert!(change.norm() < 1e-9, "{name}: {change}");
        assert!((run.position(19) - begun.position(19)).norm() > 0.1, "{name}");
    }
}

/// A light box that is fixed below a heavy one hits the floor: both stop, and stay together.
#[test]
fn what_is_joined_stops_together() {
    let scene = described(
        "gravity = [0, -9.81, 0]
        floor = 0
        [[body]]
        parts = [{ box = [0.4, 0.2, 0.4] }]
        mass = 1
        at = [0, 0.6, 0]
        [[body]]
        parts = [{ box = [0.3, 0.2, 0.3] }]
        mass = 5
        at = [0, 0.8, 0]
        [[joint]]
        bodies = [0, 1]
        fixed = true",
    );
    for (name, value) in [("rk4", 0.005), ("verlet", 0.005), ("dopri5", 1e-4)] {
        let run = simulated(&scene, name, value, 0.6);
        let [low, high] = [0, 9].map(|i| run.position(i).y);
        assert!((low - 0.1).abs() < 0.01, "{name}: {low}");
        assert!((high - low - 0.2).abs() < 1e-3, "{name}: {high}");
        let worst = run.worst_constraint().unwrap();
        assert!(worst.share < 0.02, "{name}: {}", worst.share);
    }
}

/// Joints do not touch, and every method either holds them or says why not.
#[test]
fn every_method_holds_joints_or_refuses_them() {
    let scene = described(
        "gravity = [0, -9.81, 0]
        [[body]]
        parts = [{ box = [1.2, 0.1, 0.2] }]
        mass = 2
        at = [0.6, 0, 0]
        [[joint]]
        body = 0
        hinge = { at = [0, 0, 0], axis = [0, 0, 1] }",
    );
    let exact = simulated(&scene, "dop853", 1e-10, 0.5).position(0);
    for method in METHODS {
        match method.check(scene.model.system()) {
            Ok(()) => {
                let run = simulated(&scene, method.name, method.default_control.value(), 0.5);
                let off = (run.position(0) - exact).norm();
                let most = if method.order == 1 { 3e-2 } else { 2e-3 };
                assert!(off < most, "{}: {off:e}", method.name);
            }
            Err(refused) => assert!(refused.to_string().contains("rigid"), "{refused}"),
        }
    }
}

/// A doll whose knees end at limits is thrown at the floor: the impact turns no knee past its end,
/// and the energy never grows.
#[test]
fn impacts_end_where_joints_end() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../docs/scenes/doll.toml");
    let doll = std::fs::read_to_string(path).unwrap();
    let doll = doll.replace("axis = [1, 0, 0] }", "axis = [1, 0, 0], limits = [-0.1, 2.2] }");
    assert_eq!(doll.matches("limits").count(), 2);
    let doll = doll.replace("spin = [0.8, 0, 0.4]", "");
    for seed in [2_u64, 4, 7] {
        let mut bits = seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
        let mut random = |least: f64, most: f64| {
            bits ^= bits << 13;
            bits ^= bits >> 7;
            bits ^= bits << 17;
            least + (most - least) * (bits >> 11) as f64 / (1_u64 << 53) as f64
        };
        let speed = random(5.0, 30.0);
        let (around, down) = (random(0.0, std::f64::consts::TAU), random(0.3, 1.5));
        let level = speed * down.cos();
        let (x, y, z) = (level * around.cos(), -speed * down.sin(), level * around.sin());
        let spin = [random(-8.0, 8.0), random(-8.0, 8.0), random(-8.0, 8.0)];
        let thrown = format!("[[body]]\nvelocity = [{x}, {y}, {z}]\nspin = {spin:?}\n");
        let scene = described(&doll.replace("[[body]]", &thrown));
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.002)).unwrap();
        let begun = energy(&run);
        for _ in 0..20 {
            run.take_steps(5).unwrap();
            assert!(energy(&run) <= begun * (1.0 + 1e-6), "{seed}: {}", energy(&run));
            let worst = run.worst_constraint().unwrap();
            assert!(worst.share < 0.1, "{seed}: {}", worst.share);
        }
        assert!(energy(&run) < 0.9 * begun, "{seed}: it hits the floor");
    }
}
