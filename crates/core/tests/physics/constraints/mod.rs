//! Constraints hold to rounding, forces that hold them do no work, and methods keep their orders
//! with them.

mod bodies;
mod curved;
mod implicit;
mod joint_ends;
mod jointed;
mod limits;
mod motion;
mod pushed;
mod struck;

use std::f64::consts::PI;

use crate::common::method;
use a3_core::{
    Constraint, Network, Path, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3,
};

pub const G: f64 = 9.81;

pub const ZERO: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

pub fn vector(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// Network of particles of these masses (kg) under gravity with these constraints.
pub fn network(masses: &[f64], constraints: &[Constraint]) -> Network {
    let mut network = weightless(masses, constraints);
    network.set_gravity(vector(0.0, -G, 0.0));
    network
}

pub fn weightless(masses: &[f64], constraints: &[Constraint]) -> Network {
    let mut network = Network::new(masses.to_vec()).unwrap();
    for &constraint in constraints {
        network.add_constraint(constraint).unwrap();
    }
    network
}

pub fn rod(i: usize, j: usize, length: f64) -> Constraint {
    Constraint::Rod { i, j, length }
}

/// C'' = -ks C - kd C' for every rod of a network in a state [x | v] with these accelerations.
pub fn rods_are_held(network: &Network, [x, v, a]: [&[f64]; 3], most: f64) {
    let n = network.particles();
    let at = |values: &[f64], i: usize| vector(values[i], values[n + i], values[2 * n + i]);
    for constraint in network.constraints() {
        let Constraint::Rod { i, j, length } = *constraint else { panic!("a rod") };
        let [x, v, a] = [x, v, a].map(|values| at(values, i) - at(values, j));
        let r = x.norm();
        let (c, speed) = (r - length, x.dot(&v) / r);
        let second = (v.dot(&v) + x.dot(&a) - speed * speed) / r;
        let off = second + 100.0 * c + 20.0 * speed;
        assert!(off.abs() < most, "rod {i} to {j}: {off:e} m/s2");
    }
}

pub fn wire() -> Constraint {
    Constraint::Circle { particle: 0, center: ZERO, normal: vector(0.0, 0.0, 2.0), radius: 1.0 }
}

/// State y of particles at positions x (m) with velocities v (m/s).
pub fn state(x: &[Vector3<f64>], v: &[Vector3<f64>]) -> Vec<f64> {
    [x, v]
        .into_iter()
        .flat_map(|part| (0..3).flat_map(|axis| part.iter().map(move |a| a[axis])))
        .collect()
}

/// Position (m) and velocity (m/s) of particle i in the state y.
pub fn of(y: &[f64], i: usize) -> [Vector3<f64>; 2] {
    let n = y.len() / 6;
    [0, 3].map(|c| vector(y[c * n + i], y[(c + 1) * n + i], y[(c + 2) * n + i]))
}

pub fn total_energy(network: &Network, y: &[f64]) -> f64 {
    let (x, v) = y.split_at(y.len() / 2);
    network.energy(x, v).total()
}

pub fn error(network: &Network, y: &[f64]) -> f64 {
    network.constraint_error(&y[..y.len() / 2]).unwrap()
}

/// Largest error of the constraints (m) and largest change of the energy (J) during `steps` steps
/// of h (s), and the state after them.
pub fn watch(network: &Network, y: &[f64], name: &str, h: f64, steps: u64) -> (f64, f64, Vec<f64>) {
    let mut integrator = method(name).integrator(network).unwrap();
    let mut y = y.to_vec();
    let start = total_energy(network, &y);
    let (mut off, mut change) = (0.0f64, 0.0f64);
    for k in 0..steps {
        integrator.step(network, k as f64 * h, h, &mut y).unwrap();
        off = off.max(error(network, &y));
        change = change.max((total_energy(network, &y) - start).abs());
    }
    (off, change, y)
}

/// Period (s) of a pendulum that is released at this angle (rad), by Gauss's arithmetic-geometric
/// mean; `frequency` is its angular frequency at small angles (rad/s).
pub fn period(frequency: f64, angle: f64) -> f64 {
    let (mut a, mut b) = (1.0, (0.5 * angle).cos());
    while f64::abs(a - b) > 1e-15 {
        (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
    }
    2.0 * PI / frequency / a
}

/// Level chain of rods at rest; particle 0, at its end, is pinned.
pub fn chain(rods: usize) -> (Network, Vec<f64>) {
    let rod = |i| rod(i, i + 1, 0.5);
    let constraints: Vec<_> = (0..rods).map(rod).collect();
    let mut network = network(&vec![0.2; rods + 1], &constraints);
    network.pin(0, Path::Still(ZERO)).unwrap();
    let x: Vec<_> = (0..=rods).map(|i| vector(0.5 * i as f64, 0.0, 0.0)).collect();
    let v = vec![ZERO; rods + 1];
    (network, state(&x, &v))
}

/// Rods that hang from a swinging pin, with drag and a spring of this damping (N s/m).
pub fn driven(damping: f64) -> (Network, Vec<f64>) {
    let mut network = network(&[1.0, 0.7, 1.3], &[rod(0, 1, 0.8), rod(2, 1, 1.0)]);
    let path = Path::Sine { center: ZERO, amplitude: vector(0.3, 0.0, 0.2), rate: 2.0, phase: 0.4 };
    network.pin(0, path).unwrap();
    network.set_drag(0.8).unwrap();
    let law = SpringLaw::new(20.0, 0.8, damping).unwrap();
    let (kind, i, j) = (SpringKind::Structural, 0, 2);
    network.add_spring(Spring { kind, i, j, law }).unwrap();
    let place = path.at(0.0);
    let (p, v) = (place.position, place.velocity);
    let x = [p, p + vector(0.8, 0.0, 0.0), p + vector(0.8, -0.6, 0.8)];
    (network, state(&x, &[v; 3]))
}

/// Run of a scene by a method with its step or tolerance, until a time (s).
pub fn simulated(scene: &Scene, name: &str, value: f64, until: f64) -> Simulation {
    let method = method(name);
    let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run
}

pub fn velocity_of(run: &Simulation, i: usize) -> Vector3<f64> {
    of(&run.state()[..6 * run.model().particles()], i)[1]
}

pub fn joint_error(run: &Simulation) -> f64 {
    let network = run.model().network().unwrap();
    network.constraint_error(run.state()).unwrap()
}

pub fn energy(run: &Simulation) -> f64 {
    run.energy().unwrap().total()
}

/// Momentum and angular momentum about the origin.
pub fn momenta(run: &Simulation) -> (Vector3<f64>, Vector3<f64>) {
    let network = run.model().network().unwrap();
    let (mut p, mut l) = (ZERO, ZERO);
    for (k, body) in network.bodies().iter().enumerate() {
        let i = body.center();
        let moved = velocity_of(run, i) * network.masses()[i];
        p += moved;
        l += run.position(i).cross(&moved) + network.rotation(k, run.state()).momentum;
    }
    (p, l)
}
