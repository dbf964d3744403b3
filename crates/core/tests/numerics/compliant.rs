//! Methods that solve spring by spring: exact steps, conserved quantities, supported systems, and
//! the cost of an iteration.

use std::hint::black_box;
use std::time::Instant;

use crate::common::{distance, integrate, method, scene, scene_with_grid, size, spring};
use a3_core::elements::{Buckling, Springs};
use a3_core::{
    Compliant, Error, Grid, Mechanics, Method, Network, Path, Place, Refusal, Sheet, SpringLaw,
    Vector3, integrators,
};

fn methods() -> impl Iterator<Item = &'static Method> {
    integrators::METHODS.iter().filter(|m| m.needs_springs())
}

/// Numbers between -1 and 1 that a seed determines.
fn numbers(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }
}

/// Network of eight free particles with random masses and springs, and a random state.
fn random(seed: u64) -> (Network, Vec<f64>) {
    let mut next = numbers(seed);
    let mut network = Network::new((0..8).map(|_| 0.6 + 0.4 * next()).collect()).unwrap();
    for i in 0..8 {
        for j in [(i + 1) % 8, (i + 3) % 8] {
            let law = [50.0 + 40.0 * next(), 0.6 + 0.5 * next(), 0.2 + 0.2 * next()];
            network.add_spring(spring(i, j, law)).unwrap();
        }
    }
    (network, (0..48).map(|_| next()).collect())
}

/// Particle on a damped spring below a pin that moves, with gravity and drag.
fn led() -> (Network, Vec<f64>) {
    let mut network = Network::new(vec![1.0, 0.7]).unwrap();
    network.add_spring(spring(0, 1, [300.0, 0.8, 2.0])).unwrap();
    let path = Path::Sine {
        center: Vector3::zeros(),
        amplitude: Vector3::new(0.3, 0.0, 0.2),
        rate: 2.0,
        phase: 0.4,
    };
    network.pin(0, path).unwrap();
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    network.set_drag(0.8).unwrap();
    let place = path.at(0.0);
    let mut y = vec![0.0; 12];
    for axis in 0..3 {
        y[2 * axis] = place.position[axis];
        y[6 + 2 * axis] = place.velocity[axis];
    }
    (y[1], y[3], y[5], y[7]) = (0.9, -0.3, 0.1, 1.5);
    (network, y)
}

/// A single spring is solved as in implicit Euler, even by a single iteration, in steps of any
/// length; the pin is exactly at its place.
#[test]
fn one_spring_takes_the_step_of_implicit_euler() {
    let (network, y) = led();
    for m in methods() {
        for h in [1e-3, 0.05, 0.5] {
            let end = integrate(&network, m, &y, h, 1);
            let (x, v) = end.split_at(6);
            let mut f = [0.0; 6];
            network.forces(h, x, v, &mut f);
            let (_, path) = network.pins().next().unwrap();
            let place = path.at(h);
            for axis in 0..3 {
                let [pin, free] = [2 * axis, 2 * axis + 1];
                assert_eq!([x[pin], v[pin]], [place.position[axis], place.velocity[axis]]);
                let momentum = 0.7 * (v[free] - y[6 + free]) - h * f[free];
                let gap = x[free] - y[free] - h * v[free];
                assert!(
                    momentum.abs() < 1e-12 * (1.0 + h * 300.0) && gap.abs() < 1e-13,
                    "{} {h}: {momentum:e} {gap:e}",
                    m.name
                );
            }
        }
    }
}

#[test]
fn what_is_at_rest_stays_at_rest() {
    let grid = Grid::new(3, 3).unwrap();
    let mut network = Network::new(vec![0.3; 9]).unwrap();
    network.add(Sheet::new(grid, 0.5, [60.0, 0.0, 30.0], 0.1).unwrap()).unwrap();
    let mut y = vec![0.0; 54];
    for k in 0..9 {
        (y[k], y[9 + k]) = (0.5 * (k % 3) as f64, -0.5 * (k / 3) as f64);
    }
    for m in methods() {
        assert_eq!(integrate(&network, m, &y, 0.1, 10), y, "{}", m.name);
    }
}

/// Impulses along springs are equal and opposite; in vertex block descent, the ends of a spring are
/// moved one after the other.
#[test]
fn xpbd_conserves_momentum_and_vertex_block_descent_does_not() {
    for seed in 0..5 {
        let (network, y) = random(seed);
        for m in methods() {
            let end = integrate(&network, m, &y, 0.05, 40);
            for axis in 3..6 {
                let of = |y: &[f64]| -> f64 {
                    let column = y[8 * axis..].iter().zip(network.masses());
                    column.map(|(v, m)| m * v).sum()
                };
                let drift = (of(&end) - of(&y)).abs();
                let conserved = m.name != "vbd";
                assert_eq!(drift < 1e-12, conserved, "{} {seed}: {drift:e}", m.name);
            }
        }
    }
}

/// On any network, halving the step halves the error against the true motion.
#[test]
fn random_networks_are_integrated_with_order_one() {
    for seed in 5..10 {
        let (mut network, y) = random(seed);
        network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
        let exact = integrate(&network, method("dop853"), &y, 1.0 / 512.0, 256);
        for m in methods() {
            let [coarse, fine] = [2000, 4000].map(|steps| {
                distance(&integrate(&network, m, &y, 0.5 / steps as f64, steps), &exact)
            });
            let order = (coarse / fine).log2();
            assert!((order - 1.0).abs() < 0.1, "{} {seed}: {order}", m.name);
        }
    }
}

/// A sheet and a list of its springs have the same bits.
#[test]
fn a_sheet_is_its_springs_listed() {
    let cloth = scene_with_grid("cloth", 5, 6);
    let sheet = cloth.model.network().unwrap();
    let mut listed = Network::new(sheet.masses().to_vec()).unwrap();
    for (i, path) in sheet.pins() {
        listed.pin(i, path).unwrap();
    }
    listed.add(Springs::new(sheet.springs().collect())).unwrap();
    listed.set_gravity(sheet.gravity().unwrap());
    listed.set_drag(sheet.drag().unwrap()).unwrap();
    for m in methods() {
        let [a, b] = [sheet, &listed].map(|n| integrate(n, m, &cloth.state, 0.01, 30));
        assert!(a == b && a != cloth.state, "{}", m.name);
    }
}

/// Springs of length zero, between pins, without stiffness, and much too stiff for their masses.
#[test]
fn no_number_is_lost_where_springs_have_no_direction() {
    let mut network = Network::new(vec![1e-3, 1.0, 1e3, 1.0, 1.0]).unwrap();
    for (i, j, law) in [
        (0, 1, [1e9, 0.0, 0.0]),
        (1, 2, [10.0, 0.0, 1.0]),
        (2, 3, [0.0, 0.5, 3.0]),
        (3, 4, [10.0, 0.5, 3.0]),
        (0, 2, [1e4, 0.5, 0.0]),
    ] {
        network.add_spring(spring(i, j, law)).unwrap();
    }
    for i in [3, 4] {
        network.pin(i, Path::Still(Vector3::zeros())).unwrap();
    }
    let mut y = vec![0.0; 30];
    for m in methods() {
        assert_eq!(integrate(&network, m, &y, 0.1, 5), y, "{}", m.name);
    }
    (y[0], y[1], y[2], y[16]) = (1.0, 1.0, 1.0, 2.0);
    for m in methods() {
        let end = integrate(&network, m, &y, 0.1, 100);
        assert!(size(&end) < 100.0, "{}: {end:?}", m.name);
    }
}

/// System of two particles, the first one pinned, that lists its spring outside the core.
struct Pair {
    law: SpringLaw,
    lists: bool,
}

impl Mechanics for Pair {
    fn inverse_masses(&self) -> &[f64] {
        &[0.0, 2.0]
    }

    fn forces(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let d = Vector3::new(x[1] - x[0], x[3] - x[2], x[5] - x[4]);
        let w = Vector3::new(v[1] - v[0], v[3] - v[2], v[5] - v[4]);
        let u = d.normalize();
        let pull = self.law.stiffness * (d.norm() - self.law.rest_length);
        let force = -u * (pull + self.law.damping * w.dot(&u));
        for axis in 0..3 {
            f[2 * axis + 1] = force[axis] - 0.3 * v[2 * axis + 1];
            f[2 * axis] = 0.0;
        }
    }

    fn drag_coefficient(&self) -> f64 {
        0.3
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        visit(0, Place::still(Vector3::zeros()));
    }

    fn compliant(&self) -> Option<&dyn Compliant> {
        self.lists.then_some(self as &dyn Compliant)
    }
}

impl Compliant for Pair {
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        visit([0, 1], self.law);
    }

    fn other_forces(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
    }
}

#[test]
fn a_system_that_lists_its_springs_is_served_and_another_is_refused() {
    let law = SpringLaw::new(30.0, 0.5, 0.4).unwrap();
    let y = [0.0, 1.0, 0.0, 0.2, 0.0, 0.1, 0.0, 0.3, 0.0, 1.0, 0.0, -0.5];
    let [listed, other] = [true, false].map(|lists| Pair { law, lists });
    let exact = integrate(&other, method("rk4"), &y, 1e-3, 500);
    for m in methods() {
        let error = |steps| distance(&integrate(&listed, m, &y, 0.5 / steps as f64, steps), &exact);
        let order = (error(500) / error(1000)).log2();
        assert!((order - 1.0).abs() < 0.05, "{}: {order}", m.name);
        let refused = Error::Unsupported { method: m.title, why: Refusal::LacksSprings };
        assert_eq!(m.check(&other), Err(refused));
    }
}

/// Springs that buckle have no single stiffness.
#[test]
fn springs_that_buckle_are_refused() {
    let (mut network, _) = random(0);
    assert!(methods().all(|m| m.check(&network).is_ok()));
    let buckling = Buckling {
        i: 0,
        j: 2,
        rest_length: 1.0,
        bending: 0.1,
        compression: 100.0,
        tension: 0.0,
        damping: 0.0,
    };
    network.add_buckling(buckling).unwrap();
    assert!(methods().all(|m| m.check(&network).is_err()));
    assert!(method("implicit").check(&network).is_ok());
}

/// Costs of iterations, in evaluations of forces spring by spring.
/// `cargo test -p a3-core-tests --test numerics prices_measured -- --ignored --nocapture`
#[test]
#[ignore = "measures"]
fn prices_measured() {
    let time = |run: &mut dyn FnMut()| {
        let once = |_| {
            let begun = Instant::now();
            (0..20).for_each(|_| run());
            begun.elapsed().as_secs_f64() / 20.0
        };
        (0..60).map(once).fold(f64::INFINITY, f64::min)
    };
    for (name, scene) in [
        ("mit", scene("mit")),
        ("cloth", scene("cloth")),
        ("cloth 64x64", scene_with_grid("cloth", 64, 64)),
        ("jelly", scene("jelly")),
    ] {
        let network = scene.model.network().unwrap();
        let mut listed = Network::new(network.masses().to_vec()).unwrap();
        listed.add(Springs::new(network.springs().collect())).unwrap();
        let (x, v) = scene.state.split_at(scene.state.len() / 2);
        let mut f = vec![0.0; x.len()];
        let unit = time(&mut || listed.forces(0.0, black_box(x), v, &mut f));
        let own = time(&mut || network.forces(0.0, black_box(x), v, &mut f));
        print!("{name:<12} one by one {:7.1} us, own {:.2}", 1e6 * unit, own / unit);
        for m in methods() {
            let mut integrator = m.integrator(network).unwrap();
            let mut y = scene.state.clone();
            let step = time(&mut || {
                integrator.step(network, 0.0, 1e-4, &mut y).unwrap();
            });
            print!("  {} {:.2}", m.name, step / unit);
        }
        println!();
    }
}
