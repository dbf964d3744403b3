//! Forces of deformations with a closed form.

use a3_core::Vector3;
use a3_core::elements::{Hyperelastic, Material, Solid};
use nalgebra::Matrix3;

use crate::box_of::{Bar, MODELS, noise, rubber, shaken};

/// Energy of a volume by the definitions, of any deformation gradient.
fn energy(material: &Material, f: Matrix3<f64>) -> f64 {
    let Material { young, poisson, .. } = *material;
    let mu = young / (2.0 * (1.0 + poisson));
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    match material.model {
        Hyperelastic::NeoHookean => {
            let (m, l) = (4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu);
            let a = 1.0 + m / l - m / (4.0 * l);
            let (size, volume) = (f.norm_squared(), f.determinant());
            let of = |size: f64, volume: f64| {
                0.5 * m * (size - 3.0) + 0.5 * l * (volume - a).powi(2)
                    - 0.5 * m * (size + 1.0).ln()
            };
            of(size, volume) - of(3.0, 1.0)
        }
        Hyperelastic::StVenantKirchhoff => {
            let strain = 0.5 * (f.transpose() * f - Matrix3::identity());
            mu * strain.norm_squared() + 0.5 * lambda * strain.trace().powi(2)
        }
    }
}

/// Energy of a bar, tetrahedron by tetrahedron.
fn whole_energy(bar: &Bar, x: &[f64]) -> f64 {
    let n = bar.rest.len();
    let edges = |places: &dyn Fn(u32) -> Vector3<f64>, t: &[u32; 4]| {
        let [a, b, c, d] = t.map(places);
        Matrix3::from_columns(&[b - a, c - a, d - a])
    };
    let of_one = |t: &[u32; 4]| {
        let rest = edges(&|i| bar.rest[i as usize], t);
        let i = |i: u32| i as usize;
        let now = edges(&|k| Vector3::new(x[i(k)], x[n + i(k)], x[2 * n + i(k)]), t);
        rest.determinant() / 6.0 * energy(&bar.material, now * rest.try_inverse().unwrap())
    };
    bar.tetrahedra.iter().map(of_one).sum()
}

/// Forces are minus the gradient of the energy, both computed by plain loops.
#[test]
fn forces_are_those_of_the_energy() {
    for model in MODELS {
        for poisson in [-0.4, 0.0, 0.3, 0.45] {
            let bar = Bar::new([2, 1, 2], [1.0, 0.6, 0.8], Material { poisson, ..rubber(model) });
            // Some of the tetrahedra are inside out.
            for by in [0.05, 0.6] {
                let x = shaken(&bar.moved(|p| p), by, 3);
                let still = vec![0.0; x.len()];
                let own = bar.network.energy(&x, &still).elastic;
                let expected = whole_energy(&bar, &x);
                assert!((own / expected - 1.0).abs() < 1e-11, "{own} {expected}");
                let forces = bar.forces(&x, &still);
                let most = forces.iter().fold(0.0, |most: f64, f| most.max(f.norm()));
                let n = forces.len();
                for k in 0..3 * n {
                    let at = |by: f64| {
                        let mut x = x.clone();
                        x[k] += by;
                        whole_energy(&bar, &x)
                    };
                    let h = 1e-4;
                    let slope =
                        (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * h);
                    let error = (forces[k % n][k / n] + slope).abs();
                    assert!(error < 1e-8 * most, "{model:?} {k}: {error} of {most}");
                }
            }
        }
    }
}

/// Patch test: a homogeneous deformation has no forces on particles inside, for any tetrahedra.
#[test]
fn an_even_deformation_is_in_equilibrium_inside() {
    for model in MODELS {
        let mut bar = Bar::new([4, 4, 4], [1.0; 3], rubber(model));
        let noise = noise(3 * bar.rest.len(), 5);
        let is_inside = |p: &Vector3<f64>| p.iter().all(|x| *x > 0.01 && *x < 0.99);
        for (i, p) in bar.rest.iter_mut().enumerate().filter(|(_, p)| is_inside(p)) {
            *p += 0.04 * Vector3::from_fn(|axis, _| noise[3 * i + axis]);
        }
        let solid = Solid::new(0, &bar.tetrahedra, &bar.rest, bar.material).unwrap();
        let mut network = a3_core::Network::new(bar.network.masses().to_vec()).unwrap();
        network.add(solid).unwrap();
        bar.network = network;
        let f = Matrix3::new(1.2, 0.1, -0.3, 0.2, 0.8, 0.15, 0.0, -0.1, 1.1);
        let x = bar.moved(|p| f * p + Vector3::new(1.0, 2.0, 3.0));
        let forces = bar.forces(&x, &vec![0.0; x.len()]);
        let most = forces.iter().fold(0.0, |most: f64, f| most.max(f.norm()));
        assert!(most > 1.0);
        let mut count = 0;
        for (p, force) in bar.rest.iter().zip(forces).filter(|(p, _)| is_inside(p)) {
            assert!(force.norm() < 1e-12 * most, "{model:?} {p}: {force}");
            count += 1;
        }
        assert_eq!(count, 27);
    }
}

/// The lateral stretch and the pull over the area at rest (Pa) of a bar stretched to `length`.
fn uniaxial(material: &Material, length: f64) -> (f64, f64) {
    let Material { young, poisson, .. } = *material;
    let strain = 0.5 * (length * length - 1.0);
    if material.model == Hyperelastic::StVenantKirchhoff {
        return ((1.0 - 2.0 * poisson * strain).sqrt(), young * strain * length);
    }
    let [lambda, mu] = material.lame();
    let (m, l) = (4.0 / 3.0 * mu, lambda + 5.0 / 6.0 * mu);
    let parts = |s: f64| {
        let along = m - m / (length * length + 2.0 * s * s + 1.0);
        (along, l * (length * s * s - 1.0 - 0.75 * m / l))
    };
    let (mut low, mut high) = (0.1, 2.0);
    for _ in 0..60 {
        let s = 0.5 * (low + high);
        let (along, pressure) = parts(s);
        if along + pressure * length > 0.0 {
            high = s;
        } else {
            low = s;
        }
    }
    let (along, pressure) = parts(low);
    (low, along * length + pressure * low * low)
}

#[test]
fn a_bar_is_stretched_as_its_law_says() {
    let size = [2.0, 0.5, 0.4];
    for model in MODELS {
        for length in [0.8, 1.001, 1.3] {
            let bar = Bar::new([4, 2, 2], size, rubber(model));
            let (across, stress) = uniaxial(&bar.material, length);
            let x = bar.moved(|p| Vector3::new(length * p.x, across * p.y, across * p.z));
            let forces = bar.forces(&x, &vec![0.0; x.len()]);
            let end = |at: f64| {
                let there = bar.rest.iter().zip(&forces).filter(|(p, _)| p.x == at);
                there.map(|(_, f)| f.x).sum::<f64>()
            };
            let pull = stress * size[1] * size[2];
            assert!((end(0.0) / pull - 1.0).abs() < 1e-9, "{model:?} {length}");
            assert!((end(2.0) / pull + 1.0).abs() < 1e-9, "{model:?} {length}");
            let most = forces.iter().fold(0.0, |most: f64, f| most.max(f.norm()));
            for (p, f) in bar.rest.iter().zip(&forces) {
                let free = p.x > 0.0 && p.x < 2.0;
                let inward = if free { f.norm() } else { f.yz().norm() };
                assert!(inward < 1e-9 * most, "{model:?} {length} {p}: {f}");
            }
            if model == Hyperelastic::NeoHookean && length == 1.001 {
                // Hooke's law for small strains.
                assert!((stress / (1e5 * 0.001) - 1.0).abs() < 3e-3, "{stress}");
                assert!(((1.0 - across) / 3e-4 - 1.0).abs() < 3e-3, "{across}");
            }
        }
    }
}

#[test]
fn what_is_no_solid_is_refused_by_name() {
    let rest =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.5, 0.5, 0.0]];
    let rest = rest.map(Vector3::from);
    let of = |tetrahedra: &[[u32; 4]], material| {
        Solid::new(0, tetrahedra, &rest, material).map(|_| ()).unwrap_err().to_string()
    };
    let good = rubber(Hyperelastic::NeoHookean);
    for (corners, expected) in [
        ([0, 2, 1, 3], "tetrahedron 1 is inside out"),
        ([0, 1, 2, 4], "tetrahedron 1 is flat"),
        ([0, 1, 1, 3], "tetrahedron 1 is flat"),
        ([0, 1, 2, 5], "tetrahedron 1 has corner 5, but the particles are numbered 0 to 4"),
    ] {
        let why = of(&[[0, 1, 2, 3], corners], good);
        assert!(why.contains(expected), "{why}");
    }
    for (bad, expected) in [
        (Material { poisson: 0.5, ..good }, "Poisson's ratio must be above -1"),
        (Material { poisson: -1.0, ..good }, "Poisson's ratio must be above -1"),
        (Material { poisson: f64::NAN, ..good }, "Poisson's ratio must be above -1"),
        (Material { young: 0.0, ..good }, "Young's modulus must be"),
        (Material { young: f64::INFINITY, ..good }, "Young's modulus must be"),
        (Material { damping: -1.0, ..good }, "the damping must be"),
        (Material { young: 1e308, poisson: 0.4999, ..good }, "beyond all numbers"),
    ] {
        let why = of(&[[0, 1, 2, 3]], bad);
        assert!(why.contains(expected), "{why}");
    }
    let solid = Solid::new(2, &[[0, 1, 2, 3]], &rest, good).unwrap();
    let mut network = a3_core::Network::new(vec![1.0; 5]).unwrap();
    assert!(network.add(solid).unwrap_err().to_string().contains("there is no particle 5"));
}
