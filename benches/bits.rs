//! Hashes of states in a release build: they equal those of any other build. `cargo bench --bench
//! bits`.
//!
//! The expected hashes are those of the program's own test, of the built-in scenes with every
//! method in fixed steps.

use std::collections::BTreeMap;

use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Scene, Simulation};

const HASHES: &str = include_str!("../crates/a3/tests/golden/states.txt");

/// Step (s) and number of steps of all runs, and of runs with rigid bodies in contact.
const STEPS: (f64, f64) = (2e-3, 300.0);
const RIGID: (f64, f64) = (1e-3, 20.0);

/// FNV-1a of all bits of the state after a run, or the reason why there is none.
fn hash(scene: &Scene, method: &'static Method) -> String {
    let network = scene.model.network();
    let rigid = network.is_some_and(|n| !n.bodies().is_empty() && n.gravity().is_some());
    let (step, steps) = if rigid { RIGID } else { STEPS };
    let Ok(mut run) = Simulation::new(scene.clone(), method, Control::Step(step)) else {
        return "refused".into();
    };
    if run.advance_to(step * steps).is_err() {
        return "lost".into();
    }
    let (n, velocities) = (run.particles(), run.velocities());
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for part in [&run.state()[..3 * n], &velocities] {
        for (i, axis) in (0..n).flat_map(|i| (0..3).map(move |axis| (i, axis))) {
            for byte in part[axis * n + i].to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    format!("{hash:016x}")
}

fn main() {
    let expected: BTreeMap<_, _> =
        HASHES.lines().filter_map(|line| line.rsplit_once(' ')).collect();
    let mut compared = 0;
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).expect("a built-in scene").scene;
        for method in METHODS.iter().filter(|method| !method.is_adaptive()) {
            let name = format!("{} - {}", entry.name, method.letter.unwrap());
            let found = hash(&scene, method);
            assert_eq!(expected.get(name.as_str()), Some(&found.as_str()), "{name}");
            compared += 1;
        }
    }
    assert!(compared > 100, "{compared} runs");
    println!("{compared} runs have the bits of any other build");
}
