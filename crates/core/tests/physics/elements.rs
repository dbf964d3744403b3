//! Several elements together act like the same springs, listed one by one.

use a3_core::{Coupling, Grid, Linearized, Matrix, Mechanics, Network, Sheet, Splitting};

use crate::common::{distance, size};
use crate::networks::{Random, SPACING, listed, networks};

#[test]
fn networks_agree_with_a_list_of_their_springs() {
    for (name, network, y) in networks() {
        let list = listed(&network);
        assert_eq!(list.sheets().count(), 0);
        let (x, v) = y.split_at(y.len() / 2);
        let compare = |what: &str, evaluate: &dyn Fn(&Network, &mut [f64])| {
            let (mut f, mut expected) = (vec![f64::NAN; x.len()], vec![f64::NAN; x.len()]);
            evaluate(&network, &mut f);
            evaluate(&list, &mut expected);
            let error = distance(&f, &expected) / size(&expected);
            assert!(error < 1e-12, "{name}, {what}: {error:e}");
        };
        compare("springs", &|n, f| n.spring_forces(x, v, f));
        compare("forces", &|n, f| n.forces(0.3, x, v, f));
        compare("accelerations", &|n, f| n.accelerations(0.3, x, v, f));
        compare("kicks", &|n, f| n.kick_forces(0.3, x, v, f));
        let zero = vec![0.0; x.len()];
        compare("stiffness", &|n, f| {
            n.force_differential(0.3, x, &zero, v, &zero, f);
        });
        compare("damping", &|n, f| {
            n.force_differential(0.3, x, &zero, &zero, v, f);
        });
        let (a, b) = (network.energy(x, v), list.energy(x, v));
        assert!((a.total() - b.total()).abs() < 1e-12 * b.elastic.max(b.kinetic));
        assert_eq!(network.kick_reads_velocity(), list.kick_reads_velocity());
    }
}

#[test]
fn differentials_match_central_differences() {
    for (name, network, mut y) in networks() {
        for speed in [1.0, 0.0] {
            let half = y.len() / 2;
            y[half..].iter_mut().for_each(|v| *v *= speed);
            let (x, v) = y.split_at(half);
            let mut random = Random(7);
            let d: Vec<f64> = (0..y.len()).map(|_| random.between(-1.0, 1.0)).collect();
            let (dx, dv) = d.split_at(half);
            let mut df = vec![f64::NAN; half];
            network.force_differential(0.7, x, v, dx, dv, &mut df);
            let e = 1e-6;
            let at = |sign: f64| {
                let moved: Vec<f64> = y.iter().zip(&d).map(|(y, d)| y + sign * e * d).collect();
                let mut f = vec![0.0; half];
                network.forces(0.7, &moved[..half], &moved[half..], &mut f);
                f
            };
            let difference: Vec<f64> =
                at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / (2.0 * e)).collect();
            let error = distance(&df, &difference) / size(&difference);
            assert!(error < 1e-6, "{name}: {error:e}");
        }
    }
}

#[test]
fn the_product_with_the_matrix_is_that_of_its_couplings() {
    for (name, network, y) in networks() {
        let n = network.particles();
        let (x, v) = y.split_at(3 * n);
        let free: Vec<f64> = (0..n).map(|i| f64::from(u8::from(!network.is_pinned(i)))).collect();
        let p: Vec<f64> = v.iter().enumerate().map(|(k, v)| v * free[k % n]).collect();
        for clamped in [false, true] {
            let matrix = Matrix {
                x,
                stiffness: 0.02 * 0.02,
                damping: 0.02,
                clamped,
                masses: network.masses(),
                free: &free,
            };
            let mut out = vec![f64::NAN; 3 * n];
            let products = network.products();
            let count = products.map_or(0, |it| it.multiply(&matrix, &p, &mut out));
            let of_sheets: usize = network.sheets().map(Sheet::len).sum();
            assert_eq!(count, of_sheets);
            let mut expected: Vec<f64> =
                (0..3 * n).map(|k| network.masses()[k % n] * p[k]).collect();
            let mut visited = 0;
            network.couplings(0.0, x, clamped, &mut |coupling| {
                let Coupling::Axial(c) = coupling else { panic!("springs act along their length") };
                visited += 1;
                assert!(!clamped || c.across >= 0.0);
                if visited > count {
                    return;
                }
                let d = [0, n, 2 * n].map(|k| p[k + c.i] - p[k + c.j]);
                let share: f64 = d.iter().zip(c.direction).map(|(d, u)| d * u).sum();
                for axis in 0..3 {
                    let along = share * c.direction[axis];
                    let [a2, a] = [matrix.stiffness, matrix.damping];
                    let force = a2 * (c.along * along + c.across * (d[axis] - along))
                        + a * c.damping * along;
                    expected[axis * n + c.i] += force;
                    expected[axis * n + c.j] -= force;
                }
            });
            expected.iter_mut().enumerate().for_each(|(k, out)| *out *= free[k % n]);
            let error = distance(&out, &expected) / size(&expected);
            assert!(error < 1e-12, "{name}, {clamped}: {error:e}");
        }
    }
}

/// A broken spring has no force where its particles meet, and does not affect others.
#[test]
fn a_broken_spring_between_particles_at_one_place_has_no_force() {
    for damping in [0.0, 0.1] {
        let grid = Grid::new(4, 9).unwrap();
        let mut network = Network::new(vec![1.0; 36]).unwrap();
        let sheet = Sheet::new(grid, SPACING, [9.0, 5.0, 3.0], damping).unwrap();
        network.add(sheet).unwrap();
        network.break_springs(&[[10, 11], [11, 20]]).unwrap();
        let mut random = Random(3);
        let mut y: Vec<f64> = (0..216).map(|_| random.between(-1.0, 1.0)).collect();
        for axis in 0..3 {
            y[36 * axis + 11] = y[36 * axis + 10];
            y[36 * axis + 20] = y[36 * axis + 10];
        }
        let (x, v) = y.split_at(108);
        let (mut f, mut expected) = (vec![f64::NAN; 108], vec![f64::NAN; 108]);
        network.forces(0.0, x, v, &mut f);
        let mut list = Network::new(vec![1.0; 36]).unwrap();
        list.add_springs(network.springs()).unwrap();
        list.forces(0.0, x, v, &mut expected);
        assert!(distance(&f, &expected) < 1e-12 * size(&expected));
        let zero = vec![0.0; 108];
        network.force_differential(0.0, x, &zero, v, v, &mut f);
        list.force_differential(0.0, x, &zero, v, v, &mut expected);
        assert!(distance(&f, &expected) < 1e-12 * size(&expected));
    }
}
