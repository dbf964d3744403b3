//! Forces: they depend on their arguments alone, their differentials agree with central
//! differences, and they conserve momentum and energy.

use crate::common::{distance, integrate, method, scene, scene_with_grid, size};
use a3_core::elements::{Air, Buckling, Wind};
use a3_core::{
    Control, Grid, Linearized, Mechanics, Model, Network, ParticleSystem, Sheet, Simulation,
    Spring, SpringKind, SpringLaw, Vector3,
};
use approx::assert_relative_eq;

/// Pseudorandom number between -1 and 1 that k determines.
fn noise(k: usize) -> f64 {
    let x = (k as f64 * 12.9898 + 4.1).sin() * 43758.5453;
    2.0 * (x - x.floor()) - 1.0
}

fn shaken(state: &[f64], by: f64) -> Vec<f64> {
    state.iter().enumerate().map(|(k, y)| y + by * noise(k)).collect()
}

fn networks() -> impl Iterator<Item = (&'static str, Box<Network>, Vec<f64>)> {
    let of_scenes = a3_scenes::SCENES.iter().filter_map(|entry| {
        let scene = entry.build(None).unwrap().scene;
        let Model::Network(mut network) = scene.model else {
            return None;
        };
        // The forces of constraints and on rigid bodies have no differential; only implicit methods
        // would need it.
        if !network.constraints().is_empty() || !network.bodies().is_empty() {
            return None;
        }
        network.set_wind(scene.wind);
        Some((entry.name, network, shaken(&scene.state, 0.05)))
    });
    let buckling = (0..2).map(|k| {
        let scene = scene_with_grid("cloth", 6, 7);
        let grid = scene.grid().unwrap();
        let mut network = Network::new(vec![0.02; grid.particles()]).unwrap();
        for row in 0..6 {
            for col in 0..5 {
                let (i, j) = (grid.index_of(row, col), grid.index_of(row, col + 2));
                network
                    .add_buckling(Buckling {
                        i,
                        j,
                        rest_length: 1.4 - 0.1 * col as f64,
                        bending: 0.3,
                        compression: 20.0,
                        tension: 7.0,
                        damping: 0.2 * f64::from(k),
                    })
                    .unwrap();
            }
        }
        ("buckling", Box::new(network), shaken(&scene.state, 0.05))
    });
    let of_scenes = of_scenes.chain(buckling);
    let in_the_air = [("cloth in the air", "cloth"), ("mit in the air", "mit")];
    of_scenes.chain(in_the_air.map(|(title, name)| {
        let scene = scene_with_grid(name, 6, 7);
        let mut network = scene.model.network().unwrap().clone();
        network.set_triangles(scene.grid().unwrap().triangles()).unwrap();
        let air = Air::new(1.2, 1.1, 0.7).unwrap();
        let wind = Wind::on_triangles(3, Vector3::new(1.0, 0.5, 4.0), air);
        network.set_wind(Some(wind));
        (title, Box::new(network), shaken(&scene.state, 0.05))
    }))
}

#[test]
fn evaluating_twice_gives_the_same_bits() {
    for entry in a3_scenes::SCENES {
        let scene = entry.build(None).unwrap().scene;
        let system = scene.model.system();
        let y = shaken(&scene.state, 0.1);
        let mut a = vec![f64::NAN; y.len()];
        let mut b = vec![7.0; y.len()];
        system.eval_f(0.3, &y, &mut a);
        system.eval_f(5.0, &scene.state, &mut b);
        system.eval_f(0.3, &y, &mut b);
        assert!(a.iter().zip(&b).all(|(a, b)| a.to_bits() == b.to_bits()), "{}", entry.name);
    }
}

#[test]
fn differentials_match_central_differences() {
    let moving = networks().map(|of| (of, 1.0));
    let at_rest = networks().map(|of| (of, 0.0));
    for ((name, network, mut y), speed) in moving.chain(at_rest) {
        let half = y.len() / 2;
        y[half..].iter_mut().for_each(|v| *v *= speed);
        let (x, v) = y.split_at(half);
        let d: Vec<f64> = (0..y.len()).map(|k| noise(k + 1000)).collect();
        let (dx, dv) = d.split_at(x.len());
        let mut df = vec![0.0; x.len()];
        network.force_differential(0.7, x, v, dx, dv, &mut df);
        let e = 1e-6;
        let at = |sign: f64| {
            let moved: Vec<f64> = y.iter().zip(&d).map(|(y, d)| y + sign * e * d).collect();
            let mut f = vec![0.0; x.len()];
            network.forces(0.7, &moved[..x.len()], &moved[x.len()..], &mut f);
            f
        };
        let difference: Vec<f64> =
            at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / (2.0 * e)).collect();
        let error = distance(&df, &difference) / size(&difference);
        assert!(error < 1e-6, "{name}: {error:e}");
    }
}

/// The kernel over the rows of a sheet agrees with the plain formula, spring by spring.
#[test]
fn sheets_agree_with_the_plain_formula() {
    for (rows, cols) in [
        (2, 2),
        (2, 9),
        (9, 2),
        (3, 70),
        (7, 5),
        (20, 20),
        (31, 29),
        (30, 30),
        (15, 131),
        (4, 129),
        (3, 128),
        (5, 700),
    ] {
        for name in ["cloth", "mit"] {
            let scene = scene_with_grid(name, rows, cols);
            let network = scene.model.network().unwrap();
            let y = shaken(&scene.state, 0.05);
            let (x, v) = y.split_at(y.len() / 2);
            let n = rows * cols;
            let mut expected = vec![0.0; 3 * n];
            for Spring { i, j, law, .. } in network.springs() {
                let get = |a: &[f64], i: usize| Vector3::new(a[i], a[n + i], a[2 * n + i]);
                let d = get(x, i) - get(x, j);
                let u = d.normalize();
                let rate = (get(v, i) - get(v, j)).dot(&u);
                let force = u * (law.stiffness * (d.norm() - law.rest_length) + law.damping * rate);
                for axis in 0..3 {
                    expected[axis * n + i] -= force[axis];
                    expected[axis * n + j] += force[axis];
                }
            }
            let mut f = vec![0.0; 3 * n];
            network.spring_forces(x, v, &mut f);
            let error = distance(&f, &expected) / size(&expected);
            assert!(error < 1e-13, "{name} {rows}x{cols}: {error:e}");
        }
    }
}

#[test]
fn springs_in_no_order_are_put_in_one_and_pull_alike() {
    let scene = scene_with_grid("cloth", 9, 14);
    let sheet = scene.model.network().unwrap();
    let mut springs: Vec<Spring> = sheet.springs().collect();
    let count = springs.len();
    for k in 0..count {
        springs.swap(k, (7919 * k + 13) % count);
    }
    let mut list = Network::new(vec![1.0; sheet.particles()]).unwrap();
    list.add_springs(springs.iter().copied()).unwrap();
    let ends: Vec<_> = list.springs().map(|s| s.i.min(s.j)).collect();
    assert!(ends.is_sorted() && ends.len() == count);
    let y = shaken(&scene.state, 0.05);
    let (x, v) = y.split_at(y.len() / 2);
    let (mut f, mut expected) = (vec![0.0; x.len()], vec![0.0; x.len()]);
    list.spring_forces(x, v, &mut f);
    sheet.spring_forces(x, v, &mut expected);
    assert!(distance(&f, &expected) < 1e-13 * size(&expected));
    let wrong = Spring { j: 9 * 14, ..springs[0] };
    assert!(list.add_springs([wrong]).is_err());
}

#[test]
fn a_spring_of_length_zero_has_no_force() {
    for damping in [0.0, 1.0] {
        let mut network = Network::new(vec![1.0; 2]).unwrap();
        let law = SpringLaw::new(100.0, 0.5, damping).unwrap();
        network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law }).unwrap();
        let (x, v) = ([0.3; 6], [0.0, 1.0, 0.0, 2.0, 0.0, 3.0]);
        let mut f = [f64::NAN; 6];
        network.forces(0.0, &x, &v, &mut f);
        assert_eq!(f, [0.0; 6]);
        network.force_differential(0.0, &x, &v, &[0.1; 6], &[0.2; 6], &mut f);
        assert!(f.iter().all(|f| f.is_finite()));

        let grid = Grid::new(5, 7).unwrap();
        let mut network = Network::new(vec![1.0; grid.particles()]).unwrap();
        network.add(Sheet::new(grid, 0.1, [100.0, 80.0, 30.0], damping).unwrap()).unwrap();
        let n = 3 * grid.particles();
        let (x, v) = (vec![0.3; n], (0..n).map(|k| k as f64).collect::<Vec<_>>());
        let mut f = vec![f64::NAN; n];
        network.forces(0.0, &x, &v, &mut f);
        assert_eq!(f, vec![0.0; n]);
    }
}

#[test]
fn a_fixed_particle_has_no_derivative() {
    for (name, network, y) in networks() {
        let mut dydt = vec![f64::NAN; y.len()];
        network.eval_f(0.2, &y, &mut dydt);
        let n = network.particles();
        for (i, _) in network.pins() {
            assert!((0..6).all(|axis| dydt[axis * n + i] == 0.0), "{name}, particle {i}");
        }
    }
}

/// Linear and angular momentum of a free cloth under damped springs alone are conserved, as no
/// external force acts.
#[test]
fn momentum_is_conserved() {
    let scene = scene("cloth");
    let network = scene.model.network().unwrap();
    let n = network.particles();
    let mut free = Network::new(network.masses().to_vec()).unwrap();
    free.add(network.sheets().next().unwrap().clone()).unwrap();
    let start = shaken(&scene.state, 0.02);
    let momenta = |y: &[f64]| {
        let get = |k: usize, i: usize| Vector3::new(y[k + i], y[k + n + i], y[k + 2 * n + i]);
        (0..n).fold((Vector3::zeros(), Vector3::zeros()), |(p, l), i| {
            let mv = free.masses()[i] * get(3 * n, i);
            (p + mv, l + get(0, i).cross(&mv))
        })
    };
    let (p0, l0) = momenta(&start);
    for (name, angular_error) in [("rk4", 1e-7), ("verlet", 1e-12), ("symplectic", 1e-12)] {
        let end = integrate(&free, method(name), &start, 0.001, 500);
        assert!(distance(&end, &start) > 0.01);
        let (p, l) = momenta(&end);
        assert!((p - p0).norm() < 1e-13 * n as f64, "{name}: {:e}", (p - p0).norm());
        assert!((l - l0).norm() < angular_error, "{name}: {:e}", (l - l0).norm());
    }
}

/// Total energy without drag and damping is conserved to the order of the method, and by Verlet's
/// method for any time.
#[test]
fn energy_is_conserved() {
    let scene = scene("mit");
    let mut network = scene.model.network().unwrap().clone();
    network.set_drag(0.0).unwrap();
    let scene = a3_core::Scene { model: Model::Network(Box::new(network)), ..scene };
    let drift = |name: &str, h: f64, until: f64| {
        let mut run =
            Simulation::new(scene.clone(), method(name), method(name).control(h)).unwrap();
        let before = run.energy().unwrap().total();
        run.advance_to(until).unwrap();
        let after = run.energy().unwrap();
        assert!(after.kinetic > 1.0);
        (after.total() - before).abs()
    };
    assert!(drift("rk4", 0.001, 2.0) < 1e-5);
    // The error is of second order and has no trend: over ten times the time it grows only a few
    // times.
    let (short, finer, long) =
        (drift("verlet", 0.002, 2.0), drift("verlet", 0.001, 2.0), drift("verlet", 0.002, 20.0));
    assert!(short < 0.05 && finer < 0.5 * short, "{short:e} {finer:e}");
    assert!(long < 0.2, "{long:e}");
}

/// Energy computed by hand: a spring of 100 N/m stretched by 0.5 m, and 2 kg at 3 m/s at a height
/// of 4 m.
#[test]
fn energy_by_kind() {
    let mut network = Network::new(vec![2.0; 2]).unwrap();
    let law = SpringLaw::new(100.0, 0.5, 0.0).unwrap();
    network.add_spring(Spring { kind: SpringKind::Structural, i: 0, j: 1, law }).unwrap();
    network.set_gravity(Vector3::new(0.0, -10.0, 0.0));
    let energy = network.energy(&[0.0, 1.0, 4.0, 4.0, 0.0, 0.0], &[3.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
    assert_relative_eq!(energy.elastic, 12.5);
    assert_relative_eq!(energy.kinetic, 9.0);
    assert_relative_eq!(energy.gravitational, 160.0);
    assert_relative_eq!(energy.total(), 181.5);
}

#[test]
fn the_wind_pushes() {
    let scene = scene("cloth");
    let mut run = Simulation::new(scene, method("trapezoid"), Control::Step(0.005)).unwrap();
    run.advance_to(40.0).unwrap();
    let calm = run.positions().column(2).mean();
    run.set_wind(true);
    run.advance_to(41.5).unwrap();
    assert!(run.positions().column(2).mean() > calm + 0.05);
    assert_eq!(Wind::new(3, Vector3::zeros()).at(1.0, [0.0; 3]), Vector3::zeros());
}
