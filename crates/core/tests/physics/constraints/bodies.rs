//! Rods and points hold rigid bodies at any of their points.

use super::*;
use a3_core::contact::Shape;
use a3_core::integrators::METHODS;
use a3_core::rigid::{Body, Part, Rotation};
use a3_core::{Energy, ParticleSystem};

/// A bar with these principal moments, whose two ends are its points: particle 1 at `-arm`, and 2
/// at `arm` from its centre, particle 0. It hangs from its point 1 at the origin, turned by
/// `about`, with an angular velocity (rad/s).
fn hung(
    mass: f64,
    inertia: Vector3<f64>,
    arm: Vector3<f64>,
    [about, spin]: [Vector3<f64>; 2],
) -> (Network, Vec<f64>) {
    let mut network = Network::new(vec![mass; 3]).unwrap();
    add_bar(&mut network, 0, inertia, arm);
    network.add_constraint(Constraint::Point { particle: 1, position: ZERO }).unwrap();
    network.set_gravity(vector(0.0, -G, 0.0));
    let mut rotation = Rotation::about(about);
    let center = rotation.matrix() * arm;
    rotation.momentum = network.bodies()[0].momentum(rotation.q, spin);
    let mut y = vec![0.0; network.dim()];
    for axis in 0..3 {
        y[3 * axis] = center[axis];
        y[9 + 3 * axis] = spin.cross(&center)[axis];
    }
    network.set_rotation(0, &rotation, &mut y);
    network.hold(0.0, &mut y);
    (network, y)
}

/// A bar whose centre is the particle `center`, and whose ends are the two particles after it.
fn add_bar(network: &mut Network, center: usize, inertia: Vector3<f64>, arm: Vector3<f64>) {
    let (ends, radius) = ([-arm, arm], 0.05);
    let part = Part { shape: Shape::Capsule { ends, radius }, at: ZERO };
    let body = Body::new(center, center + 1, inertia, vec![part]).unwrap();
    network.add_body(body).unwrap();
}

const INERTIA: Vector3<f64> = Vector3::new(0.3, 0.02, 0.29);
const ARM: Vector3<f64> = Vector3::new(0.0, -0.7, 0.0);

fn run(network: &Network, name: &str, y: &[f64], h: f64, steps: u64) -> Vec<f64> {
    let mut integrator = method(name).integrator(network).unwrap();
    let mut y = y.to_vec();
    for k in 0..steps {
        integrator.step(network, k as f64 * h, h, &mut y).unwrap();
    }
    y
}

/// A physical pendulum swings as a mathematical one whose length is (I + m d2) / m d.
#[test]
fn a_bar_swings_about_its_end() {
    let (mass, angle) = (2.0, 1.2);
    let d = ARM.norm();
    let about = [vector(0.0, 0.0, angle), ZERO];
    let (network, y) = hung(mass, INERTIA, ARM, about);
    let frequency = (mass * G * d / (INERTIA.z + mass * d * d)).sqrt();
    let period = period(frequency, angle);
    for name in ["dop853", "rk4", "verlet"] {
        let after = |steps: u64| {
            let y = run(&network, name, &y, period / steps as f64, steps);
            let [x, v] = [0, 9].map(|k| vector(y[k], y[k + 3], y[k + 6]));
            let start = Rotation::about(vector(0.0, 0.0, angle)).matrix() * ARM;
            (x - start).norm() + v.norm()
        };
        let (coarse, fine) = (after(100), after(200));
        let slope = (coarse / fine).log2();
        let order = f64::from(method(name).order);
        assert!(
            fine < 1e-10 || (slope - order).abs() < 0.3,
            "{name}: {coarse:.1e} and {fine:.1e}, slope {slope:.2}"
        );
        assert!(fine < 0.02, "{name}: {fine:.1e}");
    }
}

/// A spinning top on its tip keeps its energy and its angular momentum about the vertical and, as
/// it is round, about its own axis.
#[test]
fn a_top_keeps_what_it_turns_with() {
    let inertia = vector(0.05, 0.03, 0.05);
    let arm = vector(0.0, 0.3, 0.0);
    let about = vector(0.5, 0.0, 0.2);
    let axis = Rotation::about(about).matrix() * Vector3::y();
    let (network, y) = hung(1.5, inertia, arm, [about, axis * 40.0]);
    let seen = |y: &[f64]| {
        let rotation = network.rotation(0, y);
        let [x, v] = [0, 9].map(|k| vector(y[k], y[k + 3], y[k + 6]));
        let about_tip = rotation.momentum + x.cross(&v) * 1.5;
        let own = rotation.matrix().tr_mul(&rotation.momentum).y;
        [network.energy_of(0.0, y).total(), about_tip.y, own]
    };
    let before = seen(&y);
    let y = run(&network, "dop853", &y, 2e-3, 1_500);
    for (after, before) in seen(&y).iter().zip(before) {
        assert!((after / before - 1.0).abs() < 1e-10, "{after} from {before}");
    }
    // It has turned about the vertical, and nodded.
    let tip = vector(y[1], y[4], y[7]);
    assert!(tip.norm() < 1e-9, "{tip}");
    let x = vector(y[0], y[3], y[6]);
    assert!((x - axis * 0.3).norm() > 0.05, "{x}");
}

/// Two bars, joined by a rod at their ends, and a particle on a rod at another end, fly and tumble.
fn flying() -> (Network, Vec<f64>) {
    let mut network = Network::new(vec![2.0, 1.0, 1.0, 1.3, 1.0, 1.0, 0.4]).unwrap();
    add_bar(&mut network, 0, vector(0.3, 0.02, 0.29), vector(0.0, 0.5, 0.0));
    add_bar(&mut network, 3, vector(0.03, 0.2, 0.21), vector(0.4, 0.0, 0.0));
    let mut y = vec![0.0; network.dim()];
    let n = 7;
    for (k, y) in y[..6 * n].iter_mut().enumerate() {
        *y = (3.7 * k as f64).sin();
    }
    for k in 0..2 {
        let mut rotation = Rotation::about(vector(0.3, -0.8, 0.5 + k as f64));
        rotation.momentum = vector(0.2, 0.5 - k as f64, -0.3);
        network.set_rotation(k, &rotation, &mut y);
    }
    network.hold(0.0, &mut y);
    for (i, j) in [(2, 4), (5, 6), (1, 3), (6, 0)] {
        let [a, b] = [i, j].map(|i| vector(y[i], y[n + i], y[2 * n + i]));
        network.add_constraint(rod(i, j, (a - b).norm())).unwrap();
    }
    (network, y)
}

/// C'' = -ks C - kd C' for every rod at any points of tumbling bodies.
#[test]
fn accelerations_of_points_are_what_rods_ask_for() {
    let (mut network, y) = flying();
    network.set_gravity(vector(0.4, -G, 0.1));
    network.set_drag(0.3).unwrap();
    let n = network.particles();
    let mut rates = vec![f64::NAN; y.len()];
    network.eval_f(0.0, &y, &mut rates);
    rods_are_held(&network, [&y[..], &y[3 * n..], &rates[3 * n..]], 1e-11);
}

/// Without other forces, what rods join keeps its momenta; once nothing is off any more, its energy
/// too.
#[test]
fn what_rods_join_keeps_momenta_and_energy() {
    let (network, start) = flying();
    let n = network.particles();
    let momenta = |y: &[f64]| {
        let (mut p, mut l) = (ZERO, ZERO);
        for i in 0..n {
            let m = network.masses()[i];
            let [x, v] = [0, 3 * n].map(|k| vector(y[k + i], y[k + n + i], y[k + 2 * n + i]));
            p += v * m;
            l += x.cross(&v) * m;
        }
        for k in 0..2 {
            l += network.rotation(k, y).momentum;
        }
        (p, l)
    };
    let energy = |y: &[f64]| Energy::total(&network.energy_of(0.0, y));
    let settled = run(&network, "dop853", &start, 2e-3, 2_500);
    let y = run(&network, "dop853", &settled, 2e-3, 500);
    let ((p, l), (p1, l1)) = (momenta(&start), momenta(&y));
    assert!((p - p1).norm() < 1e-12 * p.norm().max(1.0), "{p} {p1}");
    assert!((l - l1).norm() < 1e-9 * l.norm(), "{l} {l1}");
    let change = energy(&y) / energy(&settled) - 1.0;
    assert!(change.abs() < 1e-9, "{change:e}");
}

#[test]
fn every_method_swings_a_bar_or_refuses_it() {
    let (network, y) = hung(2.0, INERTIA, ARM, [vector(0.0, 0.0, 0.4), ZERO]);
    let exact = run(&network, "dop853", &y, 1e-3, 500);
    for method in METHODS {
        match method.integrator(&network) {
            Ok(_) => {
                let mut y = run(&network, method.name, &y, 1e-3, 500);
                network.hold(0.5, &mut y);
                let off = crate::common::distance(&y, &exact);
                let most = if method.order == 1 { 1e-2 } else { 1e-5 };
                assert!(off < most, "{}: {off:.1e}", method.name);
            }
            Err(refused) => {
                let refused = refused.to_string();
                let known = refused.contains("constraints") || refused.contains("rigid");
                assert!(known, "{refused}");
            }
        }
    }
}

/// A rod without a length is as long as its ends are apart, where the body has turned them to.
#[test]
fn rods_of_a_scene_end_where_bodies_begin() {
    let scene = crate::common::described(
        "gravity = [0, -9.81, 0]
        [particles]
        positions = [[0.6, 0.5, 0]]
        mass = 1
        pin = [{ particles = [0] }]
        [[body]]
        parts = [{ capsule = [1.2, 0.05] }]
        rotation = [0, 0, 1.5707963267948966]
        at = [0, -0.3, 0]
        mass = 0.2
        [[constraint]]
        rod = [0, 3]",
    );
    let network = scene.model.network().unwrap();
    let Constraint::Rod { length, .. } = network.constraints()[0] else { panic!("a rod") };
    let [left, right] = [(-0.6f64 - 0.6), 0.0].map(|x| x.hypot(0.8));
    assert!((length - left).abs().min((length - right).abs()) < 1e-12, "{length}");
}
