//! Sweeps over the rows of sheets, also of several and of torn ones, have the same bits as whole
//! arrays.

use a3_core::elements::{Air, Wind};
use a3_core::{
    Control, Grid, Mechanics, Method, Model, Network, Place, Scene, Sheet, Simulation, Splitting,
    Spring, SpringKind, SpringLaw, Vector3, integrators,
};

use crate::common::{distance, integrate, method, size};
use crate::networks::{Kinds, SPACING, listed, network};

/// Network that offers no rows.
struct WholeArrays<'a>(&'a Network);

impl Mechanics for WholeArrays<'_> {
    fn inverse_masses(&self) -> &[f64] {
        self.0.inverse_masses()
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.0.forces(t, x, v, f);
    }

    fn accelerations(&self, t: f64, x: &[f64], v: &[f64], a: &mut [f64]) {
        self.0.accelerations(t, x, v, a);
    }

    fn pins(&self, t: f64, visit: &mut dyn FnMut(usize, Place)) {
        Mechanics::pins(self.0, t, visit);
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        self.0.splitting()
    }
}

#[test]
fn sheets_step_in_sweeps_to_the_bits_of_whole_arrays() {
    for seed in 0..24 {
        let kinds = Kinds { mixed: false, torn: seed % 2 == 0, damped: seed % 3 > 0 };
        let (network, y) = network(seed, kinds);
        assert!(Mechanics::rows(&network).is_some());
        for name in ["euler", "rk4", "symplectic-euler", "verlet", "pefrl"] {
            let found = integrate(&network, method(name), &y, 1e-3, 5);
            let expected = integrate(&WholeArrays(&network), method(name), &y, 1e-3, 5);
            assert!(found.iter().all(|y| y.is_finite()) && found != y);
            assert!(found == expected, "seed {seed}, {name}");
        }
    }
}

#[test]
fn threads_change_no_bit() {
    let (grids, mut masses, mut positions) = ([(70, 33), (40, 60), (3, 9)], vec![], vec![]);
    let mut network = None;
    for (k, (rows, cols)) in grids.into_iter().enumerate() {
        masses.extend((0..rows * cols).map(|i| 0.02 + 0.005 * (i % 3) as f64));
        for i in 0..rows * cols {
            let wave = 0.05 * (i as f64).sin();
            let [row, col] = [(i / cols) as f64, (i % cols) as f64];
            positions.push([SPACING * col + wave, wave - SPACING * row, k as f64]);
        }
    }
    let n = masses.len();
    let mut first = 0;
    for (rows, cols) in grids {
        let network = network.get_or_insert_with(|| Network::new(masses.clone()).unwrap());
        let sheet = Sheet::new(Grid::new(rows, cols).unwrap(), SPACING, [50.0, 20.0, 9.0], 0.003);
        network.add(sheet.unwrap().starting_at(first)).unwrap();
        let [i, j] = [first, first + 1];
        network.break_springs(&[[i, j], [j + 2 * cols, i + 2 * cols]]).unwrap();
        first += rows * cols;
    }
    let mut network = network.unwrap();
    network.set_wind(Some(Wind::new(5, Vector3::new(0.0, 0.01, 0.05))));
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let y: Vec<f64> =
        (0..6 * n).map(|k| positions[k % n].get(k / n).copied().unwrap_or(0.0)).collect();
    let mixed = {
        let mut mixed = network.clone();
        let law = SpringLaw::new(10.0, 0.1, 0.1).unwrap();
        let (i, j, kind) = (7, n - 3, SpringKind::Structural);
        mixed.add_spring(Spring { kind, i, j, law }).unwrap();
        mixed
    };
    for network in [&network, &mixed] {
        for name in ["rk4", "verlet", "implicit"] {
            let run = |threads| {
                let pool = rayon::ThreadPoolBuilder::new().num_threads(threads);
                let pool = pool.build().unwrap();
                pool.install(|| integrate(network, method(name), &y, 1e-3, 3))
            };
            let expected = run(1);
            if name != "implicit" {
                let whole = WholeArrays(network);
                assert!(integrate(&whole, method(name), &y, 1e-3, 3) == expected);
            }
            assert!([2, 3, 5].into_iter().all(|threads| run(threads) == expected));
        }
    }
}

/// Sweeps are offered unless the network has elements that they do not support; wind on particles
/// is supported.
#[test]
fn rows_are_offered_where_nothing_joins_them() {
    let kinds = Kinds { mixed: false, torn: true, damped: true };
    let (network, _) = network(2, kinds);
    let has_rows = |change: &dyn Fn(&mut Network)| {
        let mut changed = network.clone();
        change(&mut changed);
        Mechanics::rows(&changed).is_some()
    };
    assert_eq!(network.sheets().count(), 3);
    assert!(has_rows(&|_| ()));
    assert!(has_rows(&|n| n.set_wind(None)));
    assert!(has_rows(&|n| n.add_springs([]).unwrap()));
    let law = SpringLaw::new(1.0, 1.0, 0.0).unwrap();
    let (i, j, kind) = (0, 1, SpringKind::Bend);
    let spring = Spring { kind, i, j, law };
    assert!(!has_rows(&|n| n.add_spring(spring).unwrap()));
    let broken = |n: &mut Network| {
        n.add_spring(spring).unwrap();
        n.break_springs(&[[0, 1]]).unwrap();
    };
    assert!(has_rows(&broken));
    let air = Air::new(1.2, 1.0, 0.0).unwrap();
    let wind = Wind::on_triangles(1, Vector3::z(), air);
    assert!(!has_rows(&|n| n.set_wind(Some(wind))));
    let mut more = Network::new(vec![1.0; 5]).unwrap();
    let sheet = Sheet::new(Grid::new(2, 2).unwrap(), 1.0, [1.0; 3], 0.0).unwrap();
    more.add(sheet.clone().starting_at(1)).unwrap();
    assert!(Mechanics::rows(&more).is_none());
    for wrong in [0, 2, 4] {
        assert!(more.add(sheet.clone().starting_at(wrong)).is_err());
    }
    let error = more.add(sheet.starting_at(2)).unwrap_err().to_string();
    assert!(error.contains("no particle 5"), "{error}");
}

/// Cloth that tears during a run continues in sweeps, and moves like a network of the same single
/// springs.
#[test]
fn torn_cloth_goes_on_in_sweeps() {
    let kinds = Kinds { mixed: false, torn: false, damped: true };
    let (mut network, y) = network(5, kinds);
    network.set_tear(Some(1.45)).unwrap();
    let mut list = listed(&network);
    list.set_tear(Some(1.45)).unwrap();
    let run = |network: &Network| {
        let scene = Scene::new("torn", Model::Network(Box::new(network.clone())), y.clone());
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(1e-3)).unwrap();
        run.take_steps(60).unwrap();
        run
    };
    let (torn, expected) = (run(&network), run(&list));
    let of = |run: &Simulation| run.model().network().unwrap().clone();
    assert!(torn.tears() > 5, "{}", torn.tears());
    assert_eq!(of(&torn).torn(), of(&expected).torn());
    assert!(Mechanics::rows(&of(&torn)).is_some());
    let error = distance(torn.state(), expected.state()) / size(expected.state());
    assert!(error < 1e-9, "{error:e}");
    // Every method can continue with the torn cloth.
    let torn_network = of(&torn);
    let serving = |m: &&Method| m.check(&torn_network).is_ok();
    for m in integrators::METHODS.iter().filter(serving) {
        let after = integrate(&of(&torn), m, torn.state(), 1e-4, 2);
        assert!(after.iter().all(|y| y.is_finite()), "{}", m.name);
    }
}
