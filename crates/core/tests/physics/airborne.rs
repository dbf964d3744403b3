//! Closed bodies in the wind: rigid ones and soft ones have the drag of their area as seen along
//! the wind, and move as the closed forms say.

use crate::common::{described, method};
use a3_core::{Control, Mechanics, Model, Simulation, Vector3};
use approx::assert_relative_eq;

/// Density of the air (kg/m3), and its coefficient of drag.
const AIR: [f64; 2] = [1.2, 0.9];

/// Text of a steady wind of that velocity (m/s).
fn wind(velocity: [f64; 3]) -> String {
    let [density, drag] = AIR;
    format!(
        "[wind]\non = true\nsteady = true\nvelocity = {velocity:?}\ndensity = {density}\ndrag = {drag}\nlift = 0.7\n"
    )
}

/// Text of a body with a part, of a mass (kg).
fn body(part: &str, mass: f64) -> String {
    format!("[[body]]\nparts = [{{ {part} }}]\nmass = {mass}\n")
}

fn run(text: &str, step: f64) -> Simulation {
    Simulation::new(described(text), method("rk4"), Control::Step(step)).unwrap()
}

/// Bodies that fall through air: v = u tanh(g t / u), with the terminal speed u.
#[test]
fn bodies_reach_their_terminal_speeds() {
    let [density, drag] = AIR;
    let g = 9.81;
    for size in [1e-3, 1.0, 100.0_f64] {
        let shapes = [
            (format!("box = [{}, {}, {}]", 0.4 * size, 0.2 * size, 0.3 * size), 0.12, 1e-9),
            (format!("ball = {}", 0.2 * size), 0.04 * std::f64::consts::PI, 0.01),
            (
                format!("capsule = [{}, {}]", 0.6 * size, 0.1 * size),
                0.01 * std::f64::consts::PI,
                0.01,
            ),
        ];
        for (part, area, error) in shapes {
            let mass = 0.02 * size.powi(3);
            let scene =
                format!("gravity = [0, {}, 0]\n", -g) + &wind([0.0; 3]) + &body(&part, mass);
            let terminal = (2.0 * mass * g / (density * drag * area * size * size)).sqrt();
            let end = 2.0 * terminal / g;
            let mut run = run(&scene, end / 400.0);
            run.advance_to(end).unwrap();
            let (n, v) = (run.particles(), run.velocities());
            let velocity = -v[n];
            assert_relative_eq!(velocity, terminal * 2f64.tanh(), max_relative = error);
            // Nothing turns it, and nothing lifts it.
            assert!(v[0].abs() < 1e-9 * terminal, "{part}");
        }
    }
}

/// A box in a wind u: v = u - u / (1 + k u t), with k = rho C A / 2 m.
#[test]
fn a_wind_carries_a_body_along() {
    let [density, drag] = AIR;
    let (mass, u, t) = (0.1, 6.0_f64, 3.0);
    let scene = wind([0.0, 0.0, u]) + &body("box = [0.5, 0.2, 0.1]", mass);
    let mut run = run(&scene, 0.005);
    run.advance_to(t).unwrap();
    let k = density * drag * 0.1 / (2.0 * mass);
    let exact = u * t - (1.0 + k * u * t).ln() / k;
    assert_relative_eq!(run.position(0), Vector3::z() * exact, max_relative = 1e-9);
}

/// Two boxes side by side are one body; the faces between them are not in the air.
#[test]
fn the_air_passes_around_a_body_of_several_parts() {
    let whole = body("box = [0.5, 0.2, 0.2]", 0.3);
    let parts = whole.replace(
        "{ box = [0.5, 0.2, 0.2] }",
        "{ box = [0.25, 0.2, 0.2], at = [-0.125, 0, 0] }, { box = [0.25, 0.2, 0.2], at = [0.125, 0, 0] }",
    );
    let [whole, parts] = [whole, parts].map(|body| {
        let mut run = run(&(wind([4.0, 2.0, 1.0]) + &body), 0.005);
        run.advance_to(0.05).unwrap();
        run.position(0)
    });
    assert!(whole.x > 1e-3);
    assert_relative_eq!(whole, parts, max_relative = 1e-3);
}

/// A vane turns into the wind about its hinge, swings to and fro, and stays there.
#[test]
fn a_vane_turns_into_the_wind() {
    let vane = body("box = [0.6, 0.3, 0.01]", 0.2);
    let scene = wind([0.0, 0.0, 5.0])
        + &vane
        + "at = [0.3, 0, 0]\n[[joint]]\nbody = 0\nhinge = { at = [0, 0, 0], axis = [0, 1, 0] }\n";
    let mut run = run(&scene, 0.002);
    run.advance_to(0.3).unwrap();
    assert!(run.position(0).z > 0.05, "{}", run.position(0));
    run.advance_to(30.0).unwrap();
    let place = run.position(0);
    assert!((place - Vector3::z() * 0.3).norm() < 0.01, "{place}");
}

/// Returns the force (N) of the wind on the particles of a scene at the start.
fn force_of_wind(text: &str) -> Vector3<f64> {
    let scene = described(text);
    let Model::Network(network) = &scene.model else { panic!("masses and springs") };
    let n = network.particles();
    let (x, v) = scene.state.split_at(3 * n);
    let mut f = vec![0.0; 3 * n];
    network.forces(0.0, x, &v[..3 * n], &mut f);
    Vector3::from_fn(|axis, _| f[axis * n..(axis + 1) * n].iter().sum())
}

/// Soft bodies have a closed surface, too, and half the air on each of its sides. A sheet has one
/// side to the air.
#[test]
fn a_jelly_has_the_drag_of_its_area_and_so_has_a_cloth() {
    let [density, drag] = AIR;
    let u = 5.0;
    let jelly = "[[jelly]]\ngrid = [4, 3, 5]\nsize = [0.6, 0.4, 0.9]\nmass = 0.01\nstiffness = [50, 30, 20]\nat = [0, 1, 0]\n";
    for (velocity, area) in [([u, 0.0, 0.0], 0.36), ([0.0, -u, 0.0], 0.54), ([0.0, 0.0, u], 0.24)] {
        let force = force_of_wind(&(wind(velocity) + jelly));
        let expected = Vector3::from(velocity) * (0.5 * density * drag * area * u);
        assert_relative_eq!(force, expected, max_relative = 1e-9);
    }
    let cloth = "[[cloth]]\ngrid = [4, 5]\nwidth = 1\ndensity = 0.2\nstiffness = [50, 30, 20]\nat = [0, 1, 0]\n";
    let force = force_of_wind(&(wind([0.0, 0.0, u]) + cloth));
    let expected = Vector3::z() * (0.5 * density * drag * 0.75 * u * u);
    assert_relative_eq!(force, expected, max_relative = 1e-9);
}

/// Returns the rates of the momentum (N) and the angular momentum (N m) of the only body at the
/// start.
fn wrench(text: &str) -> [Vector3<f64>; 2] {
    let mut run = run(text, 1e-6);
    let momenta = |run: &Simulation| {
        let network = run.model().network().unwrap();
        let (n, v) = (run.particles(), run.velocities());
        let speed = Vector3::from_fn(|axis, _| v[axis * n]);
        let turning = network.rotation(0, run.state()).momentum;
        [speed * network.masses()[0], turning]
    };
    let before = momenta(&run);
    run.take_steps(1).unwrap();
    let after = momenta(&run);
    [0, 1].map(|k| (after[k] - before[k]) / run.time())
}

/// Checks that a vector is the exact one, to an error.
#[track_caller]
fn check(found: Vector3<f64>, exact: Vector3<f64>, error: f64) {
    assert!((found - exact).norm() <= error, "{found} and not {exact}");
}

/// Text of a fan that blows along z at 5 m/s, at a place (m), with its radii across and along (m).
fn fan(at: [f64; 3], [radius, length]: [f64; 2]) -> String {
    let still = wind([0.0, 0.0, 5.0]).replace("lift = 0.7", "lift = 0");
    still + &format!("region = {{ at = {at:?}, radius = {radius}, length = {length} }}\n")
}

/// Squared speed of the air of such a fan in a place (m2/s2).
fn squared_speed(at: [f64; 3], [radius, length]: [f64; 2], place: [f64; 3]) -> f64 {
    let [x, y, z] = [0, 1, 2].map(|axis| place[axis] - at[axis]);
    let left = 1.0 - (x * x + y * y) / (radius * radius) - z * z / (length * length);
    25.0 * left.max(0.0).powi(6)
}

/// A plate of 2 m x 1 m, whole and in two or three parts of different sizes.
const PLATES: [&str; 3] = [
    "{ box = [2, 1, 0.02] }",
    "{ box = [0.7, 1, 0.02], at = [-0.65, 0, 0] }, { box = [1.3, 1, 0.02], at = [0.35, 0, 0] }",
    "{ box = [0.2, 1, 0.02], at = [-0.9, 0, 0] }, { box = [1.8, 0.4, 0.02], at = [0.1, 0.3, 0] }, \
     { box = [1.8, 0.6, 0.02], at = [0.1, -0.2, 0] }",
];

fn plate(parts: &str) -> String {
    format!("[[body]]\nparts = [{parts}]\nmass = 4\n")
}

/// Force and torque of fans on a plate, against sums over a grid of a million points.
#[test]
fn fans_of_all_sizes_push_a_plate_where_they_blow() {
    let [density, drag] = AIR;
    for (x, y, radius) in [
        (-0.5, 0.0, 0.05),
        (-0.5, 0.0, 0.1),
        (-0.53, 0.11, 0.2),
        (-0.5, 0.0, 0.4),
        (-0.45, 0.0, 0.4),
        (-0.9, 0.45, 0.4),
        (0.3, 0.2, 3.0),
    ] {
        let (at, radii) = ([x, y, 0.0], [radius, 3.0]);
        let [mut force, mut torque] = [Vector3::zeros(); 2];
        let (columns, rows) = (1414, 707);
        for k in 0..columns * rows {
            let share = |k: usize, count: usize| (k as f64 + 0.5) / count as f64 - 0.5;
            let place = [2.0 * share(k % columns, columns), share(k / columns, rows), 0.0];
            let pressure = 0.5 * density * drag * squared_speed(at, radii, place);
            let part = Vector3::z() * (pressure * 2.0 / (columns * rows) as f64);
            force += part;
            torque += Vector3::from(place).cross(&part);
        }
        for parts in PLATES {
            let [pushed, turned] = wrench(&(fan(at, radii) + &plate(parts)));
            check(pushed, force, 0.01 * force.norm());
            check(turned, torque, 0.01 * torque.norm() + 0.003 * force.norm());
        }
    }
}

/// A fan in front of a ball, against a sum over a fine grid of its surface. The force is along the
/// wind at each point, and half of it counts on each side.
#[test]
fn fans_push_a_ball_where_they_blow() {
    let [density, drag] = AIR;
    let ball = body("ball = 0.5", 2.0);
    for (x, radius) in [(0.0, 0.1), (0.2, 0.15), (0.3, 0.3), (0.45, 0.2), (0.1, 2.0)] {
        let (at, radii) = ([x, 0.1, 0.0], [radius, 4.0]);
        let [mut force, mut torque] = [Vector3::zeros(); 2];
        let (heights, angles) = (1000, 1000);
        for k in 0..heights * angles {
            let height = 2.0 * (f64::from(k / angles) + 0.5) / f64::from(heights) - 1.0;
            let angle = std::f64::consts::TAU * f64::from(k % angles) / f64::from(angles);
            let across = (1.0 - height * height).sqrt();
            let normal = Vector3::new(across * angle.cos(), across * angle.sin(), height);
            let place = 0.5 * normal;
            let pressure = 0.25 * density * drag * squared_speed(at, radii, place.into());
            let area = std::f64::consts::PI / f64::from(heights * angles);
            let part = Vector3::z() * (pressure * area * height.abs());
            force += part;
            torque += place.cross(&part);
        }
        let [pushed, turned] = wrench(&(fan(at, radii) + &ball));
        check(pushed, force, 0.015 * force.norm());
        check(turned, torque, 0.015 * torque.norm() + 0.002 * force.norm());
    }
}

/// A plate that turns in still air about a line in it has the torque rho C w^2 b a^4 / 64 about
/// its middle. The number of its parts and the direction of its long side make no difference.
#[test]
fn a_plate_that_spins_in_still_air_has_the_drag_of_each_of_its_points() {
    let [density, drag] = AIR;
    let still = wind([0.0; 3]).replace("lift = 0.7", "lift = 0");
    let rate = 3.0;
    for parts in PLATES {
        for (spin, [a, b]) in [([0.0, rate, 0.0], [2.0, 1.0_f64]), ([rate, 0.0, 0.0], [1.0, 2.0])] {
            let [force, torque] =
                wrench(&(still.clone() + &plate(parts) + &format!("spin = {spin:?}\n")));
            let exact = -density * drag * rate * b * a.powi(4) / 64.0;
            let exact = Vector3::from(spin) * exact;
            check(torque, exact, 0.01 * exact.norm());
            check(force, Vector3::zeros(), 0.01 * exact.norm());
        }
    }
}

/// Drag acts on all of a body's mass alike: it damps its motion and its rotation at the rate c / m
/// for every shape. The angular momentum of a free rotation keeps its direction, also where the
/// body turns about no principal axis.
#[test]
fn drag_damps_speed_and_spin_alike() {
    let text = "drag = 0.6\n".to_owned()
        + &body("box = [0.4, 0.3, 0.1]", 2.0)
        + "velocity = [1, 2, 3]\nspin = [3, -2, 1]\n";
    for (name, error) in [("rk4", 1e-9), ("verlet", 1e-9), ("tr-bdf2", 1e-6)] {
        let method = method(name);
        let mut run = Simulation::new(described(&text), method, method.control(1e-3)).unwrap();
        let momenta = |run: &Simulation| {
            let (n, v) = (run.particles(), run.velocities());
            let turning = run.model().network().unwrap().rotation(0, run.state()).momentum;
            [Vector3::from_fn(|axis, _| v[axis * n]), turning]
        };
        let before = momenta(&run);
        run.advance_to(1.0).unwrap();
        let left = (-0.3 * run.time()).exp();
        for (after, before) in momenta(&run).into_iter().zip(before) {
            check(after, before * left, error * before.norm());
        }
    }
}
