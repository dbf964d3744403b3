//! The force of contact: it is the gradient of its energy and conserves momentum; its differential
//! and the couplings for implicit methods.

use a3_core::{Coupling, Linearized, Mechanics, Network, Vector3};

use crate::pairs::{Kind, Random, STIFFNESS, THICKNESS};

/// Number of pairs of each kind.
const TRIES: usize = 100;
/// Force that counts as large (N).
const LARGE: f64 = STIFFNESS * THICKNESS;

fn forces(network: &Network, x: &[f64], v: &[f64]) -> Vec<f64> {
    let mut f = vec![0.0; x.len()];
    network.forces(0.0, x, v, &mut f);
    f
}

fn moved(x: &[f64], k: usize, by: f64) -> Vec<f64> {
    let mut x = x.to_vec();
    x[k] += by;
    x
}

fn row(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

/// Calls `check` with each kind of pair at random places where there is a force.
fn each_pair(damping: f64, mut check: impl FnMut(Kind, &Network, &[f64], &mut Random)) {
    for kind in Kind::ALL {
        let (network, mut random) = (kind.network(damping), Random(7));
        let mut pressed = 0;
        for _ in 0..TRIES {
            let x = kind.positions(&mut random);
            let f = forces(&network, &x, &vec![0.0; x.len()]);
            if f.iter().any(|f| *f != 0.0) {
                pressed += 1;
                check(kind, &network, &x, &mut random);
            }
        }
        assert!(pressed > TRIES / 3, "{kind:?}: {pressed} of {TRIES} pairs touch");
    }
}

#[test]
fn it_is_minus_the_gradient_of_its_energy() {
    each_pair(0.0, |kind, network, x, _| {
        let still = vec![0.0; x.len()];
        let f = forces(network, x, &still);
        let step = 1e-5 * THICKNESS;
        for (k, f) in f.iter().enumerate() {
            let energy = |by: f64| network.energy(&moved(x, k, by), &still).total();
            let slope = (energy(step) - energy(-step)) / (2.0 * step);
            let error = (f + slope).abs() / LARGE;
            assert!(error < 1e-6, "{kind:?}, number {k}: {f} and {slope}");
        }
    });
}

#[test]
fn it_sums_to_no_force_and_no_torque() {
    each_pair(3.0, |kind, network, x, random| {
        if !kind.is_free() {
            return;
        }
        let f = forces(network, x, &random.numbers(x.len()));
        let (mut sum, mut torque) = (Vector3::zeros(), Vector3::zeros());
        for i in 0..network.particles() {
            sum += row(&f, i);
            torque += row(x, i).cross(&row(&f, i));
        }
        let most = f.iter().fold(0.0_f64, |most, f| most.max(f.abs()));
        assert!(sum.norm() < 1e-14 * most.max(LARGE), "{kind:?}: {sum}");
        assert!(torque.norm() < 1e-13 * most.max(LARGE), "{kind:?}: {torque}");
    });
}

#[test]
fn its_differential_is_that_of_the_forces() {
    each_pair(3.0, |kind, network, x, random| {
        let v = random.numbers(x.len());
        let (dx, dv) = (random.numbers(x.len()), random.numbers(x.len()));
        let mut df = vec![0.0; x.len()];
        network.force_differential(0.0, x, &v, &dx, &dv, &mut df);
        let at = |step: f64| {
            let of = |a: &[f64], d: &[f64]| -> Vec<f64> {
                a.iter().zip(d).map(|(a, d)| a + step * d).collect()
            };
            forces(network, &of(x, &dx), &of(&v, &dv))
        };
        let step = 3e-6 * THICKNESS;
        let (after, before) = (at(step), at(-step));
        let most = df.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        for k in 0..x.len() {
            let found = (after[k] - before[k]) / (2.0 * step);
            let error = (df[k] - found).abs() / most.max(STIFFNESS);
            assert!(error < 1e-3, "{kind:?}, number {k}: {} and {found}", df[k]);
        }
    });
}

/// Adds the change of the forces by a coupling where particles move by dx (m) and change their
/// velocities by dv (m/s).
fn add(coupling: &Coupling, dx: &[f64], dv: &[f64], df: &mut [f64]) {
    let n = df.len() / 3;
    let Coupling::RankOne(c) = coupling else {
        panic!("contact has couplings of rank one");
    };
    let u = Vector3::from(c.direction);
    let along = |a: &[f64]| -> f64 {
        let terms = c.ends.iter().zip(c.weights);
        terms.map(|(i, weight)| weight * row(a, *i).dot(&u)).sum()
    };
    let change = c.stiffness * along(dx) + c.damping * along(dv);
    for (i, weight) in c.ends.iter().zip(c.weights) {
        for axis in 0..3 {
            df[axis * n + i] -= weight * change * u[axis];
        }
    }
}

/// If the first of two primitives moves along the normal, neither the normal nor the closest points
/// change, and the terms that couplings omit are zero.
#[test]
fn couplings_are_exact_along_the_normal() {
    each_pair(3.0, |kind, network, x, _| {
        let n = network.particles();
        let still = vec![0.0; x.len()];
        let f = forces(network, x, &still);
        let first = match kind {
            Kind::VertexTriangle | Kind::VertexFloor => 1,
            // The angle between the edges does not change, but its factor turns the force away from
            // the normal.
            Kind::NearlyParallel => return,
            Kind::EdgeEdge => 2,
            Kind::TriangleSphere | Kind::EdgeCapsule => n,
        };
        let force: Vector3<f64> = (0..first).map(|i| row(&f, i)).sum();
        let normal = force.normalize();
        let mut dx = still.clone();
        for i in 0..first {
            for axis in 0..3 {
                dx[axis * n + i] = normal[axis];
            }
        }
        for (dx, dv) in [(&dx, &still), (&still, &dx)] {
            let (mut exact, mut coupled) = (still.clone(), still.clone());
            network.force_differential(0.0, x, &still, dx, dv, &mut exact);
            network.couplings(0.0, x, false, &mut |coupling| {
                add(&coupling, dx, dv, &mut coupled);
            });
            for k in 0..x.len() {
                let error = (exact[k] - coupled[k]).abs() / STIFFNESS;
                assert!(error < 1e-6, "{kind:?}: {} and {}", exact[k], coupled[k]);
            }
        }
    });
}
