//! The collision safeguard in free space: random collisions of two bodies that are too fast for the
//! force.

use a3_core::{Control, Simulation, Vector3};

use crate::common::{described, method};
use crate::pairs::Random;

/// Collisions of each pair of bodies, and steps of each.
const TRIES: usize = 6;
const STEPS: usize = 20;

/// Step (s).
const STEP: f64 = 0.005;

/// Bodies about a metre wide; their places and velocities are added.
const BODIES: [&str; 3] = [
    "[[cloth]]\ngrid = [4, 5]\nwidth = 1\ndensity = 0.5\nstiffness = [40, 20, 2]\ndown = [0, 0, 1]\n",
    "[[jelly]]\ngrid = [3, 3, 3]\nsize = [0.8, 0.5, 0.7]\nmass = 0.1\nstiffness = [40, 20, 2]\n",
    "[[chain]]\nparticles = 6\nmass = 0.03\nstiffness = 40\n",
];

fn vector(random: &mut Random, size: f64) -> Vector3<f64> {
    random.vector() * size
}

/// Text of a body at a height (m) above the origin, with a speed (m/s).
fn body(kind: usize, height: f64, speed: f64, friction: f64, random: &mut Random) -> String {
    let [x, y, z]: [f64; 3] = (Vector3::y() * height + vector(random, 0.1)).into();
    let [u, v, w]: [f64; 3] = (Vector3::y() * speed + vector(random, 0.3 * speed.abs())).into();
    let place = match kind {
        0 => format!("at = [{x}, {y}, {}]\n", z - 0.4),
        1 => format!("at = [{x}, {y}, {z}]\n"),
        _ => format!("from = [{}, {y}, {z}]\nto = [{}, {y}, {z}]\n", x - 0.5, x + 0.5),
    };
    format!("{}{place}velocity = [{u}, {v}, {w}]\nfriction = {friction}\n", BODIES[kind])
}

/// Twice the kinetic energy (J), the sum of m (v, x), and that of m |v| and m |x| (SI units).
fn sums(masses: &[f64], y: &[f64]) -> (f64, [Vector3<f64>; 2], [f64; 2]) {
    let n = masses.len();
    let row = |a: &[f64], i: usize| Vector3::new(a[i], a[n + i], a[2 * n + i]);
    let (x, v) = y.split_at(3 * n);
    let (mut energy, mut vectors, mut sizes) = (0.0, [Vector3::zeros(); 2], [0.0; 2]);
    for (i, m) in masses.iter().enumerate() {
        energy += m * row(v, i).norm_squared();
        for (k, all) in [v, x].into_iter().enumerate() {
            vectors[k] += row(all, i) * *m;
            sizes[k] += row(all, i).norm() * m;
        }
    }
    (energy, vectors, sizes)
}

#[test]
fn the_guard_adds_no_energy_and_keeps_momentum() {
    let mut random = Random(11);
    let (mut impulses, mut cuts) = ([0; 2], 0);
    for [first, second] in [[0, 0], [0, 1], [0, 2], [1, 1], [1, 2], [2, 2]] {
        for k in 0..TRIES {
            let friction = [0.0, 2.0][k % 2];
            let height = if first == 1 || second == 1 { 0.75 } else { 0.3 };
            let speed = 2.0 + 20.0 * random.unit();
            let text = format!(
                "self_collision = true\n{}{}",
                body(first, 0.0, speed, friction, &mut random),
                body(second, height, -speed, friction, &mut random)
            );
            let verlet = method("verlet");
            let mut run = Simulation::new(described(&text), verlet, Control::Step(STEP)).unwrap();
            let masses = run.model().network().unwrap().masses().to_vec();
            let before = sums(&masses, run.state()).1[0];
            for step in 0..STEPS {
                // The same step without the phases after it.
                let mut loose = run.state().to_vec();
                let system = run.model().system();
                let mut integrator = verlet.integrator(system).unwrap();
                integrator.step(system, run.time(), STEP, &mut loose).unwrap();
                let guarded = run.guarded();
                run.take_steps(1).unwrap();
                let (energy, vectors, sizes) = sums(&masses, &loose);
                let (after, kept, _) = sums(&masses, run.state());
                let what = format!("step {step} of {text}");
                assert!(after <= energy * (1.0 + 1e-14), "{energy} to {after}: {what}");
                if run.guarded().cuts == guarded.cuts {
                    for (vector, kept, size) in [0, 1].map(|k| (vectors[k], kept[k], sizes[k])) {
                        let error = (kept - vector).norm() / size;
                        assert!(error < 1e-14, "{error}: {what}");
                    }
                }
            }
            let after = sums(&masses, run.state());
            if run.guarded().cuts == 0 {
                let error = (after.1[0] - before).norm() / after.2[0];
                assert!(error < 1e-12, "{error}: {text}");
            }
            impulses[k % 2] += run.guarded().impulses;
            cuts += run.guarded().cuts;
        }
    }
    assert!(cuts > 0, "nothing was cut");
    assert!(impulses.iter().all(|count| *count > 400), "{impulses:?}");
}
