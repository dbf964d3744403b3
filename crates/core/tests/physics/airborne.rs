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
            (
                format!("box = [{}, {}, {}]", 0.4 * size, 0.2 * size, 0.3 * size),
                0.12,
                1e-9,
            ),
            (
                format!("ball = {}", 0.2 * size),
                0.04 * std::f64::consts::PI,
                0.01,
            ),
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
    let Model::Network(network) = &scene.model else {
        panic!("masses and springs")
    };
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
    for (velocity, area) in [
        ([u, 0.0, 0.0], 0.36),
        ([0.0, -u, 0.0], 0.54),
        ([0.0, 0.0, u], 0.24),
    ] {
        let force = force_of_wind(&(wind(velocity) + jelly));
        let expected = Vector3::from(velocity) * (0.5 * density * drag * area * u);
        assert_relative_eq!(force, expected, max_relative = 1e-9);
    }
    let cloth = "[[cloth]]\ngrid = [4, 5]\nwidth = 1\ndensity = 0.2\nstiffness = [50, 30, 20]\nat = [0, 1, 0]\n";
    let force = force_of_wind(&(wind([0.0, 0.0, u]) + cloth));
    let expected = Vector3::z() * (0.5 * density * drag * 0.75 * u * u);
    assert_relative_eq!(force, expected, max_relative = 1e-9);
}
