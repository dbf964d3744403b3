//! Runs on many threads have the bits of those on one thread.

use a3_core::{
    Constraint, Control, Grid, Model, Network, Path, Scene, Simulation, Vector3, integrators,
};

/// The state at 0.02 s, on a number of threads.
fn after(scene: &Scene, (method, control): (&str, Control), threads: usize) -> Vec<f64> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
    pool.build().unwrap().install(|| {
        let method = integrators::find(method).unwrap();
        let mut run = Simulation::new(scene.clone(), method, control).unwrap();
        run.advance_to(0.02).unwrap();
        assert_ne!(run.state(), scene.state);
        run.state().to_vec()
    })
}

fn built_in(name: &str) -> Scene {
    let entry = a3_scenes::find(name).unwrap();
    let mut scene = entry.build(Some(Grid::new(97, 101).unwrap())).unwrap().scene;
    // No two particles move alike.
    for (k, y) in scene.state.iter_mut().enumerate() {
        *y += 1e-4 * (k as f64).sin();
    }
    scene
}

/// A chain of rods that hangs by its first particle, initially out of line.
fn chain() -> Scene {
    let n = 6000;
    let mut network = Network::new(vec![0.1; n]).unwrap();
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let mut state = vec![0.0; 6 * n];
    for i in 1..n {
        let angle = (0.1 * i as f64).sin();
        state[i] = state[i - 1] + 0.1 * angle.sin();
        state[n + i] = state[n + i - 1] - 0.1 * angle.cos();
        let rod = Constraint::Rod { i: i - 1, j: i, length: 0.1 };
        network.add_constraint(rod).unwrap();
    }
    Scene::new("chain", Model::Network(Box::new(network)), state)
}

#[test]
fn eight_threads_leave_the_bits_of_one() {
    let pairs = ["dopri5", "dop853", "verner65"].map(|name| (name, Control::Tolerance(1e-5)));
    let nystrom = ["dprkn86", "dprkn1210"].map(|name| (name, Control::Tolerance(1e-7)));
    let implicit = ["implicit", "tr-bdf2"].map(|name| (name, Control::Step(0.01)));
    for (scene, methods) in [
        (built_in("cloth"), [&pairs[..], &implicit[..]].concat()),
        (built_in("mit"), nystrom.to_vec()),
        (chain(), vec![("rk4", Control::Step(0.002))]),
    ] {
        for method in methods {
            let expected = after(&scene, method, 1);
            let found = after(&scene, method, 8);
            assert!(found == expected, "{} by {}", scene.name, method.0);
        }
    }
}
