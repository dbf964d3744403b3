//! Scenes whose states were computed independently, by extrapolation in extended precision: methods
//! agree with them to 1e-9.

use crate::common::{distance, method, on_all_cores, simulation, spring};
use a3_core::{Method, Model, Network, Path, Scene, Simulation, Vector3};
use serde::Deserialize;

#[derive(Deserialize)]
struct ReferenceFile {
    gravity: [f64; 3],
    drag: f64,
    mass: Vec<f64>,
    pinned: Vec<usize>,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
    springs: Vec<(usize, usize, f64, f64, f64)>,
    #[serde(default)]
    states: Vec<State>,
}

#[derive(Deserialize)]
struct State {
    time: f64,
    positions: Vec<[f64; 3]>,
    velocities: Vec<[f64; 3]>,
}

fn load(name: &str) -> ReferenceFile {
    let path = format!("{}/reference/{name}.json", env!("CARGO_MANIFEST_DIR"));
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn column_major(positions: &[[f64; 3]], velocities: &[[f64; 3]]) -> Vec<f64> {
    [positions, velocities]
        .iter()
        .flat_map(|a| (0..3).flat_map(move |axis| a.iter().map(move |x| x[axis])))
        .collect()
}

/// Scene of a file.
pub fn scene_of(name: &str) -> Scene {
    scene(&load(name))
}

fn scene(reference: &ReferenceFile) -> Scene {
    let mut network = Network::new(reference.mass.clone()).unwrap();
    for &(i, j, k, rest, damping) in &reference.springs {
        network.add_spring(spring(i, j, [k, rest, damping])).unwrap();
    }
    for &i in &reference.pinned {
        network.pin(i, Path::Still(Vector3::from(reference.positions[i]))).unwrap();
    }
    network.set_gravity(Vector3::from(reference.gravity));
    network.set_drag(reference.drag).unwrap();
    Scene::new(
        "reference",
        Model::Network(Box::new(network)),
        column_major(&reference.positions, &reference.velocities),
    )
}

fn simulate(reference: &ReferenceFile, name: &str, h: f64) -> Simulation {
    let method = method(name);
    Simulation::new(scene(reference), method, method.control(h)).unwrap()
}

/// Largest error over all states of the reference, velocities included.
fn error(name: &str, method: &str, h: f64) -> f64 {
    let reference = load(name);
    let mut simulation = simulate(&reference, method, h);
    let mut worst: f64 = 0.0;
    for state in &reference.states {
        simulation.advance_to(state.time).unwrap();
        assert_eq!(simulation.time(), state.time);
        worst = worst
            .max(distance(simulation.state(), &column_major(&state.positions, &state.velocities)));
    }
    worst
}

#[test]
fn rk4_meets_every_reference() {
    for (name, h) in [
        ("pendulum", 2e-4),
        ("pendulum_drag", 2e-4),
        ("chain", 1e-3),
        ("mit", 1e-4),
        ("cloth_damped", 1e-4),
    ] {
        let error = error(name, "rk4", h);
        println!("{name}: {error:.2e}");
        assert!(error < 1e-9, "{name}: {error:e}");
    }
}

/// Every method agrees with the references: an adaptive one at a tight tolerance, any other after
/// extrapolation to step zero by Neville's scheme, as its error has the powers p, p + 1, ... of h.
#[test]
fn every_method_meets_the_references_in_the_limit() {
    let bases = [
        ("pendulum", 400),
        ("pendulum_drag", 400),
        ("chain", 200),
        ("cloth_damped", 250),
        ("mit", 100),
    ];
    on_all_cores(bases, |(name, base)| {
        let reference = load(name);
        let state = &reference.states[0];
        let expected = column_major(&state.positions, &state.velocities);
        let damped = reference.springs.iter().any(|spring| spring.4 > 0.0);
        let serving = |m: &&Method| !(damped && m.positions_only() || m.plain_only());
        for method in a3_core::integrators::METHODS.iter().filter(serving) {
            if method.is_adaptive() {
                // Formulas of order 5 at most would take too long to be as accurate as pairs of
                // order 5 or 8.
                let (tolerance, most) =
                    if method.is_implicit() { (1e-8, 1e-5) } else { (1e-12, 1e-9) };
                let mut simulation = simulate(&reference, method.name, tolerance);
                simulation.advance_to(state.time).unwrap();
                let error = distance(simulation.state(), &expected);
                println!("{name}, {}: {error:.1e}", method.name);
                assert!(error < most, "{name}, {}: {error:e}", method.name);
                continue;
            }
            let run = |level: u32| {
                let step = state.time / f64::from(base << level);
                let mut simulation = simulate(&reference, method.name, step);
                simulation.advance_to(state.time).unwrap();
                simulation.state().to_vec()
            };
            let order = method.order as i32;
            // Methods of high order reach rounding after a few levels.
            let levels = if order >= 4 { 3 } else { 8 };
            let (mut best, mut coarser) = (f64::INFINITY, vec![]);
            for level in 0..levels {
                let mut row = vec![run(level)];
                for (k, coarse) in coarser.iter().enumerate() {
                    let factor = 2f64.powi(order + k as i32) - 1.0;
                    let pairs = row[k].iter().zip(coarse);
                    row.push(pairs.map(|(a, b)| a + (a - b) / factor).collect());
                }
                let errors = row.iter().map(|y| distance(y, &expected));
                best = errors.fold(best, f64::min);
                coarser = row;
                if best < 1e-9 {
                    break;
                }
            }
            println!("{name}, {}: {best:.1e}", method.name);
            assert!(best < 1e-9, "{name}, {}: {best:e}", method.name);
        }
    });
}

/// The scenes `mit` and `chain` are those of the course: their states agree with the references.
#[test]
fn built_in_scenes_are_the_references() {
    for (name, h) in [("mit", 2e-4), ("chain", 1e-3)] {
        let reference = load(name);
        let mut simulation = simulation(name, "rk4", h);
        for state in &reference.states {
            simulation.advance_to(state.time).unwrap();
            let expected = column_major(&state.positions, &state.velocities);
            let error = distance(simulation.state(), &expected);
            assert!(error < 1e-8, "{name} at {}: {error:e}", state.time);
        }
    }
}
