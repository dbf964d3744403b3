//! Motion of solids: frequencies, orders, and conserved quantities.

use a3_core::elements::{Hyperelastic, Material};
use a3_core::integrators::METHODS;
use a3_core::{Control, Model, Path, Scene, Simulation, Vector3};

use crate::box_of::{Bar, DENSITY, MODELS, rubber, shaken};
use crate::common::{distance, integrate, method};

/// First frequency of a bar that is fixed at one end, along its length: sqrt(E / rho) / 4 L, of a
/// bar that does not contract across.
#[test]
fn a_bar_swings_as_slowly_as_it_is_long() {
    for model in MODELS {
        let length = 2.0;
        let mut bar =
            Bar::new([40, 1, 1], [length, 0.05, 0.05], Material { poisson: 0.0, ..rubber(model) });
        let n = bar.rest.len();
        for i in (0..n).filter(|i| bar.rest[*i].x == 0.0).collect::<Vec<_>>() {
            bar.network.pin(i, Path::Still(bar.rest[i])).unwrap();
        }
        // The shape of that mode, and a small amplitude.
        let quarter = std::f64::consts::FRAC_PI_2 / length;
        let x = bar.moved(|p| p + Vector3::x() * 1e-5 * (quarter * p.x).sin());
        let tip = (0..n).filter(|i| bar.rest[*i].x == length).collect::<Vec<_>>();
        let expected = (1e5 / DENSITY).sqrt() / (4.0 * length);
        let state = [x, vec![0.0; 3 * n]].concat();
        let scene = Scene::new("bar", Model::Network(Box::new(bar.network)), state);
        let mut run = Simulation::new(scene, method("verlet"), Control::Step(1e-3)).unwrap();
        // The tip reaches the rest length after a quarter of a period, and again after each half.
        let mut crossings = vec![];
        let mut before = 1.0;
        while crossings.len() < 5 {
            let t = run.time() + 1e-3;
            run.advance_to(t).unwrap();
            let mean = tip.iter().map(|i| run.position(*i).x).sum::<f64>() / tip.len() as f64;
            let now = mean - length;
            if before * now < 0.0 {
                crossings.push(t - 1e-3 * now / (now - before));
            }
            before = now;
        }
        let frequency = 2.0 / (crossings[4] - crossings[0]);
        assert!((frequency / expected - 1.0).abs() < 0.01, "{model:?}: {frequency} {expected}");
    }
}

fn swinging(damping: f64) -> (Bar, Vec<f64>) {
    let mut bar = Bar::new(
        [3, 1, 1],
        [0.6, 0.2, 0.2],
        Material { damping, ..rubber(Hyperelastic::NeoHookean) },
    );
    for i in (0..bar.rest.len()).filter(|i| bar.rest[*i].x == 0.0).collect::<Vec<_>>() {
        bar.network.pin(i, Path::Still(bar.rest[i])).unwrap();
    }
    bar.network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let x = bar.moved(|p| p + Vector3::new(0.0, 0.2 * p.x * p.x, 0.1 * p.x * p.x));
    let state = [x.clone(), vec![0.0; x.len()]].concat();
    (bar, state)
}

/// Every method that supports a solid keeps its order, with and without viscosity.
#[test]
fn methods_keep_their_orders() {
    for damping in [0.0, 0.005] {
        let (bar, y) = swinging(damping);
        let end = 0.04;
        let exact = integrate(&bar.network, method("rk4"), &y, end / 4096.0, 4096);
        let serving = |m: &&a3_core::Method| {
            !m.is_adaptive() && m.order <= 4 && m.check(&bar.network).is_ok()
        };
        let mut count = 0;
        for m in METHODS.iter().filter(serving) {
            let steps = if m.order == 1 { 512 } else { 64 };
            let error = |steps: u64| {
                distance(&integrate(&bar.network, m, &y, end / steps as f64, steps), &exact)
            };
            let order = (error(steps) / error(2 * steps)).log2();
            let expected = f64::from(m.order);
            assert!((order - expected).abs() < 0.25, "{} {damping}: {order}", m.name);
            count += 1;
        }
        assert!(count >= 10, "{count}");
    }
}

#[test]
fn methods_that_solve_spring_by_spring_refuse() {
    let (bar, _) = swinging(0.0);
    for name in ["xpbd", "vbd"] {
        let why = method(name).check(&bar.network).unwrap_err().to_string();
        assert!(why.contains("not those of linear springs"), "{why}");
    }
}

/// A free solid in flight conserves its momenta to rounding, and Verlet's method its energy.
#[test]
fn momenta_are_kept() {
    for (name, step) in [("verlet", 1e-3), ("implicit-midpoint", 0.004)] {
        let bar = Bar::new([2, 2, 2], [0.4; 3], rubber(Hyperelastic::NeoHookean));
        let n = bar.rest.len();
        let x = shaken(&bar.moved(|p| p), 0.02, 3);
        let v = bar.moved(|p| Vector3::new(1.0, 0.5, 0.0) + Vector3::new(2.0, 0.0, 3.0).cross(&p));
        let momenta = |y: &[f64]| {
            let at = |k: usize, i: usize| Vector3::new(y[k + i], y[k + n + i], y[k + 2 * n + i]);
            let of = |i: usize| (bar.network.masses()[i], at(0, i), at(3 * n, i));
            let linear: Vector3<f64> = (0..n).map(of).map(|(m, _, v)| m * v).sum();
            let angular: Vector3<f64> = (0..n).map(of).map(|(m, x, v)| m * x.cross(&v)).sum();
            (linear, angular)
        };
        let y = [x, v].concat();
        let energy = |y: &[f64]| bar.network.energy(&y[..3 * n], &y[3 * n..]).total();
        let end = integrate(&bar.network, method(name), &y, step, (0.5 / step) as u64);
        let ((p, l), (q, m)) = (momenta(&y), momenta(&end));
        assert!((p - q).norm() < 1e-11 * p.norm(), "{name}: {p} {q}");
        // The equations of an implicit step are solved to a tolerance.
        let close = if name == "verlet" { 1e-11 } else { 1e-8 };
        assert!((l - m).norm() < close * l.norm(), "{name}: {l} {m}");
        let change = energy(&end) / energy(&y) - 1.0;
        assert!(change.abs() < 0.01, "{name}: {change}");
    }
}
