//! Shared functions of several tests.
#![allow(dead_code, missing_docs, reason = "each test file uses its part")]

use std::sync::Mutex;

use a3_core::accuracy::{Errors, Frames, Reference, measure};
use a3_core::integrators;
use a3_core::{
    Control, Grid, Method, Network, ParticleSystem, Path, Scene, Simulation, Spring, SpringKind,
    SpringLaw, Vector3,
};

pub fn method(name: &str) -> &'static Method {
    integrators::find(name).unwrap()
}

pub fn scene(name: &str) -> Scene {
    a3_scenes::find(name).unwrap().build(None).unwrap().scene
}

/// A drop that is drawn out, without viscosity and weight.
pub fn ellipse() -> Scene {
    described(include_str!("../../../../docs/scenes/ellipse.toml"))
}

/// Numbers from -1 to 1, by a linear congruential generator.
pub fn state_random(count: usize, seed: u64) -> Vec<f64> {
    let mut bits = seed;
    let mut next = || {
        bits = bits.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (bits >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

/// Does the work for each item, on as many threads as there are cores.
pub fn on_all_cores<T: Send>(items: impl IntoIterator<Item = T>, work: impl Fn(T) + Sync) {
    let items = Mutex::new(items.into_iter().collect::<Vec<_>>());
    let next = || items.lock().unwrap().pop();
    std::thread::scope(|scope| {
        for _ in 0..std::thread::available_parallelism().map_or(1, usize::from) {
            scope.spawn(|| {
                while let Some(item) = next() {
                    work(item);
                }
            });
        }
    });
}

/// Whether a second of the scene takes the method minutes: implicit methods find the slopes of f by
/// differences if there are many rigid bodies.
pub fn takes_minutes(method: &Method, scene: &Scene) -> bool {
    let bodies = scene.model.network().map_or(0, |n| n.bodies().len());
    (method.is_implicit() || method.solves_linear_systems()) && bodies > 1
}

/// Scene described by the text of a scene file.
pub fn described(text: &str) -> Scene {
    a3_scenes::Description::parse(text)
        .and_then(|d| d.build(None, &mut |_| Err("no mesh".into())))
        .unwrap()
        .scene
}

pub fn scene_with_grid(name: &str, rows: usize, cols: usize) -> Scene {
    a3_scenes::find(name).unwrap().build(Some(Grid::new(rows, cols).unwrap())).unwrap().scene
}

/// Run of a built-in scene: in steps of `value` (s), or to the tolerance `value` with an adaptive
/// method.
pub fn simulation(scene_name: &str, method_name: &str, value: f64) -> Simulation {
    let method = method(method_name);
    Simulation::new(scene(scene_name), method, method.control(value)).unwrap()
}

/// State y after `steps` steps of h (s), taken by the method's integrator alone, without a
/// simulation.
pub fn integrate(
    system: &dyn ParticleSystem,
    method: &Method,
    y: &[f64],
    h: f64,
    steps: u64,
) -> Vec<f64> {
    let mut integrator = method.integrator(system).unwrap();
    let mut y = y.to_vec();
    for k in 0..steps {
        integrator.step(system, k as f64 * h, h, &mut y).unwrap();
    }
    y
}

/// Structural spring of a stiffness (N/m), a rest length (m) and a damping (N s/m).
pub fn spring(i: usize, j: usize, [stiffness, rest_length, damping]: [f64; 3]) -> Spring {
    let law = SpringLaw::new(stiffness, rest_length, damping).unwrap();
    let kind = SpringKind::Structural;
    Spring { kind, i, j, law }
}

/// Particle of 1 kg, number 1, on a spring of rest length 0 that is pinned at the origin, with an
/// angular frequency `omega` (rad/s) and this damping (N s/m).
pub fn damped_spring(omega: f64, damping: f64) -> Network {
    let mut network = Network::new(vec![1.0; 2]).unwrap();
    let spring = spring(0, 1, [omega * omega, 0.0, damping]);
    network.add_spring(spring).unwrap();
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    network
}

/// Linear oscillator of angular frequency `omega` (rad/s), with viscous drag of damping ratio
/// `zeta`.
pub fn oscillator(omega: f64, zeta: f64) -> Network {
    let mut network = damped_spring(omega, 0.0);
    network.set_drag(2.0 * zeta * omega).unwrap();
    network
}

/// Finest reference of a scene until a time (s).
pub fn reference(scene: &Scene, until: f64) -> Reference {
    let found = Reference::finest(scene, Frames::new(until), &|| true);
    found.unwrap().unwrap()
}

/// Errors of a run against a reference.
pub fn errors(scene: &Scene, name: &str, control: Control, reference: &Reference) -> Errors {
    let outcome = measure(scene, method(name), control, reference, &|| true);
    outcome.unwrap().unwrap().errors
}

/// Largest magnitude of a number in y; infinite if one of them is NaN.
pub fn size(y: &[f64]) -> f64 {
    y.iter().fold(0.0, |m: f64, y| if y.is_nan() { f64::INFINITY } else { m.max(y.abs()) })
}

/// Largest difference between two states.
pub fn distance(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    size(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>())
}
