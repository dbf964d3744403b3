//! Differentials of the forces, and their stiffness blocks for implicit methods.

use a3_core::elements::{Hyperelastic, Material};
use a3_core::{Coupling, GeneralCoupling, Linearized, Mechanics};
use nalgebra::DMatrix;

use crate::box_of::{Bar, MODELS, noise, rubber, shaken};

fn bar(material: Material) -> Bar {
    Bar::new([2, 1, 1], [1.0, 0.6, 0.8], material)
}

/// Stiffness and damping as full matrices, from the couplings.
fn matrices(bar: &Bar, x: &[f64], clamped: bool) -> [DMatrix<f64>; 2] {
    let n = bar.rest.len();
    let mut whole = [DMatrix::zeros(3 * n, 3 * n), DMatrix::zeros(3 * n, 3 * n)];
    bar.network.couplings(0.0, x, clamped, &mut |coupling| {
        let Coupling::General(GeneralCoupling { i, j, stiffness, damping }) = coupling else {
            panic!("a coupling of another kind");
        };
        for (whole, block) in whole.iter_mut().zip([stiffness, damping]) {
            for (part, k) in block.into_iter().enumerate() {
                let (a, b) = (part / 3 * n, part % 3 * n);
                whole[(a + i, b + i)] += k;
                whole[(a + i, b + j)] -= k;
                whole[(b + j, a + j)] += k;
                whole[(b + j, a + i)] -= k;
            }
        }
    });
    whole
}

fn states(bar: &Bar) -> Vec<Vec<f64>> {
    let rest = bar.moved(|p| p);
    let flat = bar.moved(|p| nalgebra::Vector3::new(p.x, 0.0, 0.0));
    let squeezed = bar.moved(|p| 0.6 * p);
    let shaken = [0.05, 0.6].map(|by| shaken(&rest, by, 7));
    [vec![rest, flat, squeezed], shaken.to_vec()].concat()
}

#[test]
fn the_differential_is_that_of_the_forces() {
    for model in MODELS {
        let bar = bar(Material { damping: 0.02, ..rubber(model) });
        let x = shaken(&bar.moved(|p| p), 0.2, 1);
        let v = noise(x.len(), 2);
        let [dx, dv] = [3, 4].map(|seed| noise(x.len(), seed));
        let mut df = vec![0.0; x.len()];
        bar.network.force_differential(0.0, &x, &v, &dx, &dv, &mut df);
        let at = |h: f64| {
            let moved = |a: &[f64], d: &[f64]| -> Vec<f64> {
                a.iter().zip(d).map(|(a, d)| a + h * d).collect()
            };
            let mut f = vec![0.0; x.len()];
            bar.network.forces(0.0, &moved(&x, &dx), &moved(&v, &dv), &mut f);
            f
        };
        let h = 1e-4;
        let (near, far) = ([at(h), at(-h)], [at(2.0 * h), at(-2.0 * h)]);
        let most = df.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
        for k in 0..df.len() {
            let slope = (8.0 * (near[0][k] - near[1][k]) - (far[0][k] - far[1][k])) / (12.0 * h);
            assert!((df[k] - slope).abs() < 1e-9 * most, "{model:?} {k}: {} {slope}", df[k]);
        }
    }
}

/// At zero velocity the couplings are the full differential, in all states; flat tetrahedra have no
/// third principal axis, and are as accurate.
#[test]
fn couplings_are_the_differential() {
    for model in MODELS {
        let bar = bar(Material { damping: 0.02, ..rubber(model) });
        for (k, x) in states(&bar).iter().enumerate() {
            let [stiffness, damping] = matrices(&bar, x, false);
            let still = vec![0.0; x.len()];
            for (matrix, of_velocity) in [(stiffness, false), (damping, true)] {
                let d = noise(x.len(), 9);
                let (dx, dv) = if of_velocity { (&still, &d) } else { (&d, &still) };
                let mut df = still.clone();
                bar.network.force_differential(0.0, x, &still, dx, dv, &mut df);
                let product = &matrix * nalgebra::DVector::from_vec(d.clone());
                for (df, product) in df.iter().zip(product.iter()) {
                    let error = (df + product).abs();
                    assert!(error < 1e-11 * matrix.norm(), "{model:?} {k} {of_velocity}: {error}");
                }
                assert!((&matrix - matrix.transpose()).norm() < 1e-12 * matrix.norm());
            }
        }
    }
}

#[test]
fn clamped_couplings_are_positive_semidefinite() {
    for model in MODELS {
        let bar = bar(Material { damping: 0.02, ..rubber(model) });
        let mut indefinite = 0;
        for (k, x) in states(&bar).iter().enumerate() {
            let least =
                |matrix: &DMatrix<f64>| matrix.symmetric_eigenvalues().min() / matrix.norm();
            let [stiffness, damping] = matrices(&bar, x, true);
            let (clamped, damped) = (least(&stiffness), least(&damping));
            assert!(clamped > -1e-12, "{model:?} {k}: {clamped}");
            assert!(damped > -1e-12, "{model:?} {k}: {damped}");
            let [whole, _] = matrices(&bar, x, false);
            indefinite += usize::from(least(&whole) < -1e-3);
            if k == 0 {
                assert!((whole - &stiffness).norm() < 1e-9 * stiffness.norm(), "{model:?}");
                let rigid = |k: &&f64| k.abs() < 1e-12 * stiffness.norm();
                let modes = stiffness.symmetric_eigenvalues();
                assert_eq!(modes.iter().filter(rigid).count(), 6, "{model:?}: {modes}");
            }
        }
        assert!((2..5).contains(&indefinite), "{model:?}: {indefinite}");
    }
}

/// Viscous forces are tau times the rate of the elastic ones at rest, vanish for rigid motion,
/// dissipate energy, and have no total force and torque.
#[test]
fn viscosity_damps_strain_alone() {
    for model in MODELS {
        let plain = bar(rubber(model));
        let bar = bar(Material { damping: 0.02, ..rubber(model) });
        let rest = bar.moved(|p| p);
        let x = shaken(&rest, 0.1, 1);
        let still = vec![0.0; x.len()];
        let n = bar.rest.len();
        let viscous = |x: &[f64], v: &[f64]| -> Vec<nalgebra::Vector3<f64>> {
            let all = bar.forces(x, v).into_iter().zip(plain.forces(x, v));
            all.map(|(all, elastic)| all - elastic).collect()
        };
        let at = |x: &[f64], i: usize| nalgebra::Vector3::new(x[i], x[n + i], x[2 * n + i]);
        let turn = nalgebra::Vector3::new(1.0, -2.0, 0.5);
        let rigid: Vec<_> = (0..n).map(|i| turn.cross(&at(&x, i)) + turn).collect();
        let rigid: Vec<f64> = (0..3).flat_map(|a| rigid.iter().map(move |v| v[a])).collect();
        let v = noise(x.len(), 2);
        let size =
            |f: &[nalgebra::Vector3<f64>]| f.iter().map(nalgebra::Vector3::norm).sum::<f64>();
        let forces = viscous(&x, &v);
        assert!(size(&viscous(&x, &rigid)) < 1e-10 * size(&forces));
        let sum: nalgebra::Vector3<f64> = forces.iter().sum();
        let moment: nalgebra::Vector3<f64> =
            forces.iter().enumerate().map(|(i, f)| at(&x, i).cross(f)).sum();
        assert!(sum.norm() < 1e-12 * size(&forces) && moment.norm() < 1e-12 * size(&forces));
        let power: f64 = forces.iter().enumerate().map(|(i, f)| f.dot(&at(&v, i))).sum();
        assert!(power < -0.1 * size(&forces), "{power}");
        let mut rate = still.clone();
        bar.network.force_differential(0.0, &rest, &still, &v, &still, &mut rate);
        for (i, f) in viscous(&rest, &v).iter().enumerate() {
            let expected = 0.02 * at(&rate, i);
            assert!((f - expected).norm() < 1e-9 * expected.norm(), "{f} {expected}");
        }
    }
}

/// Elastic forces, too, have no total force and torque, also with a number of tetrahedra that does
/// not fill whole vectors.
#[test]
fn elastic_forces_conserve_momentum() {
    for model in MODELS {
        let bar = Bar::new([3, 2, 3], [1.0; 3], rubber(model));
        assert_eq!(bar.tetrahedra.len() % 8, 4);
        let x = shaken(&bar.moved(|p| p), 0.1, 1);
        let forces = bar.forces(&x, &vec![0.0; x.len()]);
        let n = forces.len();
        let size: f64 = forces.iter().map(nalgebra::Vector3::norm).sum();
        let at = |i: usize| nalgebra::Vector3::new(x[i], x[n + i], x[2 * n + i]);
        let sum: nalgebra::Vector3<f64> = forces.iter().sum();
        let moments = forces.iter().enumerate().map(|(i, f)| at(i).cross(f));
        let moment: nalgebra::Vector3<f64> = moments.sum();
        assert!(sum.norm() < 1e-13 * size && moment.norm() < 1e-13 * size, "{sum} {moment}");
    }
}

#[test]
fn stiffness_and_damping_are_scaled_apart() {
    let mut scaled = bar(Material { damping: 0.02, ..rubber(Hyperelastic::NeoHookean) });
    scaled.network.scale_springs(4.0, 2.0).unwrap();
    let expected = bar(Material { young: 4e5, damping: 0.01, ..rubber(Hyperelastic::NeoHookean) });
    let x = shaken(&scaled.moved(|p| p), 0.1, 1);
    let v = noise(x.len(), 2);
    assert_eq!(scaled.forces(&x, &v), expected.forces(&x, &v));
    assert!(scaled.network.linearized().is_some());
}
