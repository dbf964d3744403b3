//! Implicit methods: growth factors, energy, states of rest, and steps at which no explicit method
//! is stable.

use std::time::Instant;

use crate::common::{integrate, method, oscillator, scene, simulation};
use a3_core::{
    Control, Coupling, Grid, Linearized, Mechanics, Network, Path, Sheet, Simulation, Vector3,
};
use a3_core::{Model, Scene};
use approx::assert_relative_eq;

/// Growth factor |R(iy)| of a method.
fn growth(name: &str, y: f64) -> f64 {
    let g = 1.0 - std::f64::consts::FRAC_1_SQRT_2;
    match name {
        "implicit" => 1.0 / (1.0 + y * y).sqrt(),
        "implicit-midpoint" => 1.0,
        "tr-bdf2" => (1.0 + (1.0 - 2.0 * g).powi(2) * y * y).sqrt() / (1.0 + g * g * y * y),
        _ => unreachable!(),
    }
}

const METHODS: [&str; 3] = ["implicit", "implicit-midpoint", "tr-bdf2"];

#[test]
fn the_circle_shrinks_as_it_must() {
    assert_relative_eq!(growth("tr-bdf2", 1.0), 0.996_873_937, max_relative = 1e-9);
    assert_relative_eq!(growth("tr-bdf2", 10.0), 0.444_858_060, max_relative = 1e-9);
    let circle = scene("simple");
    for name in METHODS {
        for h in [0.01, 0.3, 1.0, 10.0, 1000.0] {
            let y = integrate(circle.model.system(), method(name), &circle.state, h, 1);
            let radius = y.iter().map(|y| y * y).sum::<f64>().sqrt();
            // The Jacobian comes from central differences, hence the tolerance.
            assert_relative_eq!(radius, growth(name, h), max_relative = 1e-9);
        }
    }
}

/// The growth of an oscillator, solved with forces, masses and couplings, is also |R(i h omega)|.
#[test]
fn the_oscillator_shrinks_as_it_must() {
    for (omega, h) in [(1.0, 0.1), (1.0, 1.0), (30.0, 0.5), (1e4, 0.01)] {
        let network = oscillator(omega, 0.0);
        let mut y = vec![0.0; 12];
        (y[1], y[7]) = (1.0, 0.3 * omega);
        let amplitude = |y: &[f64]| y[1].hypot(y[7] / omega);
        for name in METHODS {
            let after = integrate(&network, method(name), &y, h, 1);
            let radius = amplitude(&after) / amplitude(&y);
            assert_relative_eq!(radius, growth(name, h * omega), max_relative = 1e-9);
        }
    }
}

#[test]
fn couplings_are_the_symmetric_part_of_the_differential() {
    for name in ["cloth", "mit", "chain", "pendulum"] {
        let scene = scene(name);
        let network = scene.model.network().unwrap();
        let n = network.particles();
        let mut run = Simulation::new(scene.clone(), method("rk4"), Control::Step(0.005)).unwrap();
        run.advance_to(0.3).unwrap();
        let x = &run.state()[..3 * n];
        let zero = vec![0.0; 3 * n];
        let d: Vec<f64> = (0..3 * n).map(|k| (k as f64 * 0.7).sin()).collect();
        for damping in [false, true] {
            let mut df = vec![0.0; 3 * n];
            let (dx, dv) = if damping { (&zero, &d) } else { (&d, &zero) };
            network.force_differential(0.0, x, &zero, dx, dv, &mut df);
            let mut sum = vec![0.0; 3 * n];
            if damping {
                for (sum, d) in sum.iter_mut().zip(&d) {
                    *sum = -network.drag_coefficient() * d;
                }
            }
            network.couplings(0.0, x, false, &mut |coupling| {
                let Coupling::Axial(c) = coupling else { panic!("springs act along their length") };
                let e: [f64; 3] = std::array::from_fn(|a| d[a * n + c.i] - d[a * n + c.j]);
                let share = (0..3).map(|a| e[a] * c.direction[a]).sum::<f64>();
                for a in 0..3 {
                    let along = share * c.direction[a];
                    let force = if damping {
                        c.damping * along
                    } else {
                        c.along * along + c.across * (e[a] - along)
                    };
                    sum[a * n + c.i] -= force;
                    sum[a * n + c.j] += force;
                }
            });
            let largest = crate::common::size(&df);
            assert!(crate::common::distance(&df, &sum) <= 1e-12 * largest, "{name}, {damping}");
        }
    }
}

/// With a step of 0.2 s, the course's cloth comes to rest in the right state.
#[test]
fn the_course_cloth_settles_in_long_steps() {
    let mut run = simulation("mit", "i", 0.2);
    let (_, radius) = run.extent();
    for _ in 0..1000 {
        run.take_steps(1).unwrap();
        assert!(run.state()[..675].iter().all(|x| x.abs() < 10.0 * radius));
    }
    // RK4, DOP853, TR-BDF2 and the midpoint rule come to rest at the same height, to all of these
    // digits.
    assert_relative_eq!(run.lowest(), -3.738_373_760_058, epsilon = 1e-9);
    assert_relative_eq!(run.largest_stretch().unwrap(), 2.756, epsilon = 1e-3);
    assert!(run.work().residual < 1e-3);
}

/// Energy of an undamped pendulum on a spring for 200 s: the midpoint rule and PEFRL conserve it,
/// and implicit Euler loses it.
#[test]
fn energy_over_a_long_time() {
    let mut pendulum = scene("pendulum");
    if let Model::Network(network) = &mut pendulum.model {
        network.set_drag(0.0).unwrap();
    }
    let drift = |name: &str, h: f64| {
        let mut run =
            Simulation::new(pendulum.clone(), method(name), method(name).control(h)).unwrap();
        let start = run.energy().unwrap().total();
        let (mut early, mut late): (f64, f64) = (0.0, 0.0);
        for k in 1..=2000 {
            run.advance_to(0.1 * f64::from(k)).unwrap();
            let error = (run.energy().unwrap().total() - start).abs();
            if k <= 200 {
                early = early.max(error);
            } else {
                late = late.max(error);
            }
        }
        println!("{name} at {h}: {early:.1e} J in 20 s, {late:.1e} J in 200 s");
        (early, late)
    };
    // All methods here take equal work, 40,000 evaluations.
    let (_, pefrl) = drift("pefrl", 0.02);
    assert!(pefrl < 1e-5);
    let (_, verlet) = drift("verlet", 0.005);
    assert!(verlet < 1e-2 && verlet > 10.0 * pefrl);
    let (_, rk4) = drift("rk4", 0.02);
    assert!(rk4 > 100.0 * pefrl);
    // The energy error oscillates and does not grow with time.
    for (name, h) in [("implicit-midpoint", 0.01), ("pefrl", 0.02), ("verlet", 0.005)] {
        let (early, late) = drift(name, h);
        assert!(late < 1.5 * early, "{name}: {early:e}, {late:e}");
    }
    assert!(drift("implicit", 0.005).1 > 1.0);
}

/// Square cloth of 1 m and 1 kg, flat and level, with two corners pinned; its fastest angular
/// frequency is about `omega` (rad/s). It falls with a jerk.
fn falling(side: usize, omega: f64) -> Scene {
    let grid = Grid::new(side, side).unwrap();
    let n = grid.particles();
    let spacing = 1.0 / (side - 1) as f64;
    let mass = 1.0 / n as f64;
    // The largest angular frequency of such a square is about sqrt(7.8 k/m).
    let k = mass * omega * omega / 7.8;
    let mut network = Network::new(vec![mass; n]).unwrap();
    network.add(Sheet::new(grid, spacing, [k, k, 0.25 * k], 0.0).unwrap()).unwrap();
    let mut state = vec![0.0; 6 * n];
    for i in 0..n {
        state[i] = (i % side) as f64 * spacing;
        state[2 * n + i] = (i / side) as f64 * spacing;
    }
    for corner in [0, side - 1] {
        let at = Vector3::new(state[corner], 0.0, state[2 * n + corner]);
        network.pin(corner, Path::Still(at)).unwrap();
    }
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    Scene::new("falling", Model::Network(Box::new(network)), state)
}

#[test]
fn stiff_cloth_falls_at_a_frame_a_step() {
    for name in ["implicit", "tr-bdf2"] {
        let begun = Instant::now();
        let mut run =
            Simulation::new(falling(20, 1000.0), method(name), Control::Step(1.0 / 60.0)).unwrap();
        run.advance_to(1.0).unwrap();
        println!(
            "{name}: stretch {:.3}, {:?}, {:.0?}",
            run.largest_stretch().unwrap(),
            run.work(),
            begun.elapsed()
        );
        assert!(run.largest_stretch().unwrap() < 1.3, "{name}");
    }
    // The classical Runge-Kutta method blows up at this step.
    let mut run =
        Simulation::new(falling(20, 1000.0), method("rk4"), Control::Step(1.0 / 60.0)).unwrap();
    assert!(run.advance_to(1.0).is_err());
}

/// Pins follow their paths also where a hand changes which particles are pinned.
#[test]
fn hands_pull_at_implicit_cloth() {
    for name in METHODS {
        let mut run = simulation("cloth", name, 0.01);
        run.set_swinging(true);
        run.take_steps(10).unwrap();
        run.grab(399).unwrap();
        let from = run.position(399);
        run.pull(from + Vector3::new(0.2, 0.1, 0.3));
        run.advance_to(run.time() + 0.3).unwrap();
        assert_relative_eq!(run.position(399), from + Vector3::new(0.2, 0.1, 0.3), epsilon = 1e-9);
        run.release();
        run.advance_to(1.0).unwrap();
        let network = run.model().network().unwrap();
        for (i, path) in network.pins() {
            assert_relative_eq!(run.position(i), path.at(run.time()).position, epsilon = 1e-12);
        }
        assert!(run.largest_stretch().unwrap() < 2.0);
    }
}
