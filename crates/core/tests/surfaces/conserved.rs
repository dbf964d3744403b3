//! Quantities that a collision of free bodies conserves.

use a3_core::{Control, Simulation, Vector3};

use crate::common::{described, method};

/// Two cloths in free space, one of which flies at the other and rotates over it.
const CLOTHS: &str = "self_collision = true
    [[cloth]]
    grid = [5, 5]
    width = 1
    density = 0.5
    stiffness = [40, 20, 2]
    at = [0, 0, 0]
    down = [0, 0, 1]
    [[cloth]]
    grid = [4, 6]
    width = 1
    density = 0.5
    stiffness = [40, 20, 2]
    at = [0.13, 0.15, 0.17]
    down = [0, -0.1, 1]
    velocity = [0.1, -0.8, 0.2]";

/// Momentum (kg m/s) and angular momentum (kg m2/s) about the origin.
fn momenta(run: &Simulation) -> [Vector3<f64>; 2] {
    let masses = run.model().network().unwrap().masses();
    let n = masses.len();
    let row = |a: &[f64], i: usize| Vector3::new(a[i], a[n + i], a[2 * n + i]);
    let (x, v) = run.state().split_at(3 * n);
    let mut sums = [Vector3::zeros(); 2];
    for (i, m) in masses.iter().enumerate() {
        sums[0] += *m * row(v, i);
        sums[1] += *m * row(x, i).cross(&row(v, i));
    }
    sums
}

#[test]
fn collisions_of_free_cloths_conserve_momenta_and_energy() {
    let scene = described(CLOTHS);
    for (name, of_energy, of_turn) in [("verlet", 1e-4, 1e-12), ("rk4", 1e-6, 1e-10)] {
        let mut run = Simulation::new(scene.clone(), method(name), Control::Step(5e-4)).unwrap();
        let ([p, l], energy) = (momenta(&run), run.energy().unwrap().total());
        let (mut most, mut worst) = (0.0_f64, 0.0_f64);
        while run.time() < 0.8 {
            run.take_steps(10).unwrap();
            let found = run.energy().unwrap();
            most = most.max(found.contact);
            worst = worst.max((found.total() / energy - 1.0).abs());
        }
        assert_eq!(run.guarded().impulses, 0, "the force turns them");
        assert!(most > 0.1 * energy, "{name}: they hardly touch: {most} J of {energy} J");
        let after = momenta(&run);
        assert!((after[0] - p).norm() < 1e-12 * p.norm(), "{name}: {p} became {}", after[0]);
        assert!((after[1] - l).norm() < of_turn * l.norm(), "{name}: {l} became {}", after[1]);
        assert!(worst < of_energy, "{name}: the energy changes by a share of {worst}");
    }
}
