//! Orders of convergence: the global error falls as h to the method's order, with gravity, drag,
//! damped springs and a moving pin.

use crate::common::{described, distance, integrate, method, spring};
use a3_core::{Grid, Method, Network, Path, Sheet, Turn, Vector3, integrators};

/// An oscillation, and a rotation about a moving axis.
fn paths() -> [Path; 2] {
    let sine = Path::Sine {
        center: Vector3::zeros(),
        amplitude: Vector3::new(0.3, 0.0, 0.2),
        rate: 2.0,
        phase: 0.4,
    };
    let turn = Path::Turn {
        turn: Turn { axis: Vector3::new(0.6, 0.0, 0.8), rate: 2.0, start: -0.3, end: Some(1.5) },
        arm: Vector3::new(0.1, 0.2, 0.1),
        from: Vector3::new(-0.4, -0.2, 0.0),
        to: Vector3::new(0.3, 0.1, 0.0),
        start: -1.0,
        end: 2.0,
    };
    [sine, turn]
}

fn network(spring_damping: f64, path: Path) -> Network {
    let mut network = Network::new(vec![1.0, 0.7, 1.3]).unwrap();
    for (i, j, k) in [(0, 1, 20.0), (1, 2, 30.0)] {
        let spring = spring(i, j, [k, 0.8, spring_damping]);
        network.add_spring(spring).unwrap();
    }
    network.pin(0, path).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(0.8).unwrap();
    network
}

fn start(network: &Network) -> Vec<f64> {
    let mut y = vec![0.0; 18];
    let x = [[0.0; 3], [0.9, 0.1, 0.2], [1.5, -0.2, 0.3]];
    for (i, x) in x.iter().enumerate() {
        for axis in 0..3 {
            y[3 * axis + i] = x[axis];
        }
    }
    for (i, path) in network.pins() {
        for axis in 0..3 {
            y[3 * axis + i] = path.at(0.0).position[axis];
            y[9 + 3 * axis + i] = path.at(0.0).velocity[axis];
        }
    }
    y
}

#[test]
fn every_method_has_its_order() {
    for (spring_damping, path) in [0.0, 0.5].into_iter().zip(paths()) {
        let network = network(spring_damping, path);
        let y0 = start(&network);
        let exact = integrate(&network, method("dop853"), &y0, 1.0 / 512.0, 512);
        let serving = |m: &&Method| m.check(&network).is_ok();
        for m in integrators::METHODS.iter().filter(serving) {
            // Steps are short enough for the leading term and long enough to avoid rounding errors;
            // for order 6 and above, both are hardly possible.
            let (steps, slack) = match m.order {
                9.. => (4, 1.5),
                8 => (20, 0.6),
                6.. => (20, 0.9),
                5 => (256, 0.1),
                4 => (512, 0.05),
                _ => (4096, 0.05),
            };
            let error = |steps: u64| {
                distance(&integrate(&network, m, &y0, 1.0 / steps as f64, steps), &exact)
            };
            let order = (error(steps) / error(2 * steps)).log2();
            assert!(
                (order - f64::from(m.order)).abs() < slack,
                "{} with spring damping {spring_damping}: order {order:.3}, not {}",
                m.name,
                m.order
            );
        }
    }
}

/// The springs that hold a rigid body at its ends rotate it, and their forces depend on its spin.
#[test]
fn bodies_on_damped_springs_keep_the_order() {
    let scene = described(
        "gravity = [0, -9.81, 0]
        drag = 0.1
        springs = [[0, 3, 60, 0.3, 2], [1, 4, 90, 0.2, 1], [3, 4, 5, 1, 0.1]]
        [particles]
        positions = [[0.6, 0.4, 0], [-0.6, 0.5, 0.2]]
        mass = 1
        pin = [{ particles = [0, 1] }]
        [[body]]
        parts = [{ capsule = [1.2, 0.1] }]
        rotation = [0, 0, 1.5]
        mass = 1.5
        spin = [0.5, 2, 1]",
    );
    let (system, y) = (scene.model.system(), &scene.state);
    let exact = integrate(system, method("dop853"), y, 1.0 / 512.0, 512);
    for (name, steps) in [("verlet", 256), ("rk4", 64), ("pefrl", 64)] {
        let m = method(name);
        let error = |steps: u64| {
            let found = integrate(system, m, y, 1.0 / steps as f64, steps);
            distance(&found, &exact)
        };
        let order = (error(steps) / error(2 * steps)).log2();
        assert!((order - f64::from(m.order)).abs() < 0.2, "{name}: {order}");
    }
}

/// Sweeps over rows keep the order with moving pins, which they move to their places stage by
/// stage.
#[test]
fn sheets_led_by_their_pins_keep_the_order() {
    let grid = Grid::new(4, 5).unwrap();
    let n = grid.particles();
    let mut network = Network::new(vec![0.5; n]).unwrap();
    let sheet = Sheet::new(grid, 0.5, [40.0, 20.0, 10.0], 0.01).unwrap();
    network.add(sheet).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let mut y = vec![0.0; 6 * n];
    for k in 0..n {
        (y[k], y[2 * n + k]) = (0.5 * (k % 5) as f64, 0.5 * (k / 5) as f64);
    }
    for i in [0, 4] {
        let path = Path::Sine {
            center: Vector3::new(y[i], 0.0, 0.0),
            amplitude: Vector3::new(0.3, 0.0, 0.2),
            rate: 3.0,
            phase: 0.0,
        };
        network.pin(i, path).unwrap();
        for axis in 0..3 {
            y[3 * n + axis * n + i] = path.at(0.0).velocity[axis];
        }
    }
    let exact = integrate(&network, method("dop853"), &y, 1.0 / 512.0, 512);
    for name in ["euler", "heun", "midpoint", "rk4", "symplectic", "verlet", "pefrl"] {
        let m = method(name);
        let error = |steps: u64| {
            let found = integrate(&network, m, &y, 1.0 / steps as f64, steps);
            distance(&found, &exact)
        };
        let order = (error(100) / error(200)).log2();
        assert!(order > f64::from(m.order) - 0.2, "{name}: {order}");
    }
}
