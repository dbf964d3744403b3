//! Constraints hold to rounding, their forces do no work, and methods keep their orders with them.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::common::{distance, integrate, method, size};
use a3_core::stability::{LargestMode, largest_step, rest, spectrum};
use a3_core::{
    Constraint, Control, Grid, Linearized, Mechanics, Model, Network, ParticleSystem, Path, Scene,
    Sheet, Simulation, Spring, SpringKind, SpringLaw, Vector3, integrators,
};

const G: f64 = 9.81;
const ZERO: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

fn vector(x: f64, y: f64, z: f64) -> Vector3<f64> {
    Vector3::new(x, y, z)
}

/// Network of particles of these masses (kg) under gravity with these constraints.
fn network(masses: &[f64], constraints: &[Constraint]) -> Network {
    let mut network = weightless(masses, constraints);
    network.set_gravity(vector(0.0, -G, 0.0));
    network
}

fn weightless(masses: &[f64], constraints: &[Constraint]) -> Network {
    let mut network = Network::new(masses.to_vec()).unwrap();
    for &constraint in constraints {
        network.add_constraint(constraint).unwrap();
    }
    network
}

fn rod(i: usize, j: usize, length: f64) -> Constraint {
    Constraint::Rod { i, j, length }
}

fn wire() -> Constraint {
    Constraint::Circle {
        particle: 0,
        center: ZERO,
        normal: vector(0.0, 0.0, 2.0),
        radius: 1.0,
    }
}

/// State y of particles at positions x (m) with velocities v (m/s).
fn state(x: &[Vector3<f64>], v: &[Vector3<f64>]) -> Vec<f64> {
    [x, v]
        .into_iter()
        .flat_map(|part| (0..3).flat_map(|axis| part.iter().map(move |a| a[axis])))
        .collect()
}

/// Position (m) and velocity (m/s) of particle i in the state y.
fn of(y: &[f64], i: usize) -> [Vector3<f64>; 2] {
    let n = y.len() / 6;
    [0, 3].map(|c| vector(y[c * n + i], y[(c + 1) * n + i], y[(c + 2) * n + i]))
}

fn total_energy(network: &Network, y: &[f64]) -> f64 {
    let (x, v) = y.split_at(y.len() / 2);
    network.energy(x, v).total()
}

fn error(network: &Network, y: &[f64]) -> f64 {
    network.constraint_error(&y[..y.len() / 2]).unwrap()
}

/// Largest error of the constraints (m) and largest change of the energy (J) during `steps` steps
/// of h (s), and the state after them.
fn watch(network: &Network, y: &[f64], name: &str, h: f64, steps: u64) -> (f64, f64, Vec<f64>) {
    let mut integrator = method(name).integrator(network).unwrap();
    let mut y = y.to_vec();
    let start = total_energy(network, &y);
    let (mut off, mut change) = (0.0f64, 0.0f64);
    for k in 0..steps {
        integrator.step(network, k as f64 * h, h, &mut y).unwrap();
        off = off.max(error(network, &y));
        change = change.max((total_energy(network, &y) - start).abs());
    }
    (off, change, y)
}

/// Period (s) of a pendulum that is released at this angle (rad), by Gauss's arithmetic-geometric
/// mean; `frequency` is its angular frequency at small angles (rad/s).
fn period(frequency: f64, angle: f64) -> f64 {
    let (mut a, mut b) = (1.0, (0.5 * angle).cos());
    while f64::abs(a - b) > 1e-15 {
        (a, b) = (0.5 * (a + b), f64::sqrt(a * b));
    }
    2.0 * PI / frequency / a
}

#[test]
fn a_bead_stays_on_its_wire_for_a_minute() {
    let network = network(&[0.5], &[wire()]);
    let y = state(&[vector(1.0, 0.0, 0.0)], &[ZERO]);
    let (off, change, _) = watch(&network, &y, "rk4", 1e-3, 60_000);
    assert!(off <= 1e-8 && change <= 1e-6, "{off:e} m, {change:e} J");
}

#[test]
fn beads_and_rods_swing_as_pendulums_do() {
    let mut hung = network(&[1.0, 0.5], &[rod(0, 1, 1.0)]);
    hung.pin(0, Path::Still(ZERO)).unwrap();
    for (network, mut x) in [(network(&[0.5], &[wire()]), vec![]), (hung, vec![ZERO])] {
        x.push(vector(1.0, 0.0, 0.0));
        let i = x.len() - 1;
        let start = state(&x, &vec![ZERO; x.len()]);
        let quarter = 0.25 * period(G.sqrt(), FRAC_PI_2);
        let after = |quarters: u64| {
            let h = quarter / 1000.0;
            of(
                &integrate(&network, method("rk4"), &start, h, 1000 * quarters),
                i,
            )
        };
        let lowest = [vector(0.0, -1.0, 0.0), vector(-(2.0 * G).sqrt(), 0.0, 0.0)];
        for (quarters, [x, v]) in [
            (1, lowest),
            (2, [vector(-1.0, 0.0, 0.0), ZERO]),
            (4, [vector(1.0, 0.0, 0.0), ZERO]),
        ] {
            let [found, speed] = after(quarters);
            assert!((found - x).norm() < 1e-9, "{quarters}: {found}");
            assert!((speed - v).norm() < 1e-9, "{quarters}: {speed}");
        }
    }
}

#[test]
fn a_bead_slides_down_a_straight_wire() {
    let direction = vector(3.0, -4.0, 12.0);
    let line = Constraint::Line {
        particle: 0,
        point: vector(1.0, 2.0, 3.0),
        direction,
    };
    let (network, x) = (network(&[2.0], &[line]), vector(1.0, 2.0, 3.0));
    let (off, change, y) = watch(&network, &state(&[x], &[ZERO]), "rk4", 1e-3, 10_000);
    let u = direction / 13.0;
    let exact = x + u * (0.5 * 100.0 * -G * u.y);
    let [x, v] = of(&y, 0);
    assert!(off < 1e-12 && change < 1e-8, "{off:e} m, {change:e} J");
    assert!((x - exact).norm() < 1e-9 && (v - u * (10.0 * -G * u.y)).norm() < 1e-10);
}

#[test]
fn a_spherical_pendulum_keeps_what_it_turns_with() {
    let sphere = Constraint::Sphere {
        particle: 0,
        center: ZERO,
        radius: 2.0,
    };
    let network = network(&[1.5], &[sphere]);
    let y = state(&[vector(2.0, 0.0, 0.0)], &[vector(0.0, -1.0, 3.0)]);
    let (off, change, end) = watch(&network, &y, "rk4", 1e-3, 60_000);
    let turn = |y: &[f64]| {
        let [x, v] = of(y, 0);
        x.cross(&v).y
    };
    assert!(off <= 1e-8 && change <= 1e-6, "{off:e} m, {change:e} J");
    assert!((turn(&end) - turn(&y)).abs() < 1e-8);
}

/// Level chain of rods at rest; particle 0, at its end, is pinned.
fn chain(rods: usize) -> (Network, Vec<f64>) {
    let rod = |i| rod(i, i + 1, 0.5);
    let constraints: Vec<_> = (0..rods).map(rod).collect();
    let mut network = network(&vec![0.2; rods + 1], &constraints);
    network.pin(0, Path::Still(ZERO)).unwrap();
    let x: Vec<_> = (0..=rods)
        .map(|i| vector(0.5 * i as f64, 0.0, 0.0))
        .collect();
    let v = vec![ZERO; rods + 1];
    (network, state(&x, &v))
}

#[test]
fn a_double_pendulum_keeps_its_energy() {
    let (network, y) = chain(2);
    let (off, change, _) = watch(&network, &y, "rk4", 1e-3, 20_000);
    assert!(off < 1e-7 && change < 1e-6, "{off:e} m, {change:e} J");
}

#[test]
fn a_chain_of_rods_falls_and_holds() {
    let (network, y) = chain(10);
    let (off, change, end) = watch(&network, &y, "rk4", 1e-3, 5_000);
    assert!(of(&end, 10)[0].norm() <= 5.0 + 1e-5);
    assert!(off < 1e-5 && change < 1e-4, "{off:e} m, {change:e} J");
}

/// Rods that hang from a swinging pin, with drag and a spring of this damping (N s/m).
fn driven(damping: f64) -> (Network, Vec<f64>) {
    let mut network = network(&[1.0, 0.7, 1.3], &[rod(0, 1, 0.8), rod(2, 1, 1.0)]);
    let path = Path::Sine {
        center: ZERO,
        amplitude: vector(0.3, 0.0, 0.2),
        rate: 2.0,
        phase: 0.4,
    };
    network.pin(0, path).unwrap();
    network.set_drag(0.8).unwrap();
    let law = SpringLaw::new(20.0, 0.8, damping).unwrap();
    let (kind, i, j) = (SpringKind::Structural, 0, 2);
    network.add_spring(Spring { kind, i, j, law }).unwrap();
    let place = path.at(0.0);
    let (p, v) = (place.position, place.velocity);
    let x = [p, p + vector(0.8, 0.0, 0.0), p + vector(0.8, -0.6, 0.8)];
    (network, state(&x, &[v; 3]))
}

/// Explicit methods keep their order with constraints, also where only the constraints depend on
/// velocities.
#[test]
fn every_explicit_method_keeps_its_order() {
    for damping in [0.5, 0.0] {
        let (network, y0) = driven(damping);
        let exact = integrate(&network, method("dop853"), &y0, 1.0 / 512.0, 512);
        for m in integrators::METHODS.iter().filter(|m| !m.implicit) {
            let (steps, slack) = match m.order {
                8.. => (20, 0.6),
                5.. => (512, 0.3),
                4 => (256, 0.05),
                _ => (2048, 0.05),
            };
            let error = |steps: u64| {
                let end = integrate(&network, m, &y0, 1.0 / steps as f64, steps);
                distance(&end, &exact)
            };
            let order = (error(steps) / error(2 * steps)).log2();
            assert!(
                (order - f64::from(m.order)).abs() < slack,
                "{}, damping {damping}: order {order:.3}, not {}",
                m.name,
                m.order
            );
        }
    }
}

/// C'' = -ks C - kd C' to rounding for every rod of a long moving chain that violates its
/// constraints.
#[test]
fn accelerations_are_what_the_constraints_ask_for() {
    let rods = 40;
    let (network, mut y) = chain(rods);
    let n = rods + 1;
    for (k, y) in y.iter_mut().enumerate().filter(|(k, _)| k % n > 0) {
        *y += 0.1 * (17.0 * k as f64).sin();
    }
    let (x, v) = y.split_at(3 * n);
    let mut a = vec![f64::NAN; 3 * n];
    network.accelerations(0.0, x, v, &mut a);
    let at = |values: &[f64], i: usize| vector(values[i], values[n + i], values[2 * n + i]);
    for constraint in network.constraints() {
        let Constraint::Rod { i, j, length } = *constraint else {
            panic!("a rod")
        };
        let [x, v, a] = [x, v, &a].map(|values| at(values, i) - at(values, j));
        let r = x.norm();
        let (c, speed) = (r - length, x.dot(&v) / r);
        let second = (v.dot(&v) + x.dot(&a) - speed * speed) / r;
        let off = second + 100.0 * c + 20.0 * speed;
        assert!(off.abs() < 1e-10, "rod {i} to {j}: {off:e} m/s2");
    }
}

#[test]
fn a_rod_to_a_pin_that_swings_keeps_its_length() {
    let (network, y) = driven(0.5);
    let (off, _, _) = watch(&network, &y, "rk4", 1e-3, 20_000);
    assert!(off < 1e-9, "{off:e} m");
}

/// Rods pull at pins: the sum of all forces, those on pins included, moves the centre of mass.
#[test]
fn rods_pull_at_pins_as_pins_pull_at_them() {
    let mut network = network(&[1.0, 0.5], &[rod(0, 1, 1.0)]);
    network.pin(0, Path::Still(ZERO)).unwrap();
    let y = state(&[ZERO, vector(0.0, -1.0, 0.0)], &[ZERO; 2]);
    let mut f = [f64::NAN; 6];
    network.forces(0.0, &y[..6], &y[6..], &mut f);
    for (f, expected) in f.iter().zip([0.0, 0.0, -1.5 * G, 0.0, 0.0, 0.0]) {
        assert!((f - expected).abs() < 1e-12, "{f}");
    }
}

#[test]
fn a_free_rod_turns_about_its_middle() {
    let network = weightless(&[1.0, 3.0], &[rod(0, 1, 2.0)]);
    let at = |angle: f64| {
        let out = vector(angle.cos(), 0.0, angle.sin());
        let across = vector(-angle.sin(), 0.0, angle.cos());
        state(&[out * 1.5, out * -0.5], &[across * 6.0, across * -2.0])
    };
    let y = integrate(&network, method("rk4"), &at(0.0), 1e-3, 5_000);
    assert!(distance(&y, &at(20.0)) < 1e-8);
    let ([_, v], [_, w]) = (of(&y, 0), of(&y, 1));
    assert!((v + w * 3.0).norm() < 1e-12);
}

#[test]
fn what_holds_does_no_work() {
    let speed = vector(1.4, 2.2, 0.8);
    let circle = Constraint::Circle {
        particle: 0,
        center: ZERO,
        normal: vector(1.0, 1.0, 1.0),
        radius: 3.0f64.sqrt() * 2f64.sqrt(),
    };
    let sphere = Constraint::Sphere {
        particle: 0,
        center: ZERO,
        radius: 6f64.sqrt(),
    };
    let line = Constraint::Line {
        particle: 0,
        point: ZERO,
        direction: vector(1.0, 1.0, -2.0),
    };
    let x = vector(1.0, 1.0, -2.0);
    let around = vector(1.0, 1.0, 1.0).cross(&x);
    for (constraint, v) in [(circle, around), (sphere, x.cross(&speed)), (line, x)] {
        let network = network(&[0.3], &[constraint]);
        let y = state(&[x], &[v]);
        let mut f = [0.0; 3];
        network.forces(0.0, &y[..3], &y[3..], &mut f);
        let held = Vector3::from(f) + vector(0.0, 0.3 * G, 0.0);
        assert!(held.norm() > 0.1, "{constraint:?}: {held}");
        let power = held.dot(&v);
        assert!(power.abs() < 1e-12, "{constraint:?}: {power:e} W");
    }
}

#[test]
fn a_rod_too_many_changes_nothing() {
    let start = state(
        &[ZERO, vector(0.6, -0.8, 0.0), vector(0.6, -0.8, 2.0)],
        &[ZERO; 3],
    );
    let plain = [rod(0, 1, 1.0), rod(1, 2, 2.0)];
    let run = |more: &[Constraint], pins: usize| {
        let mut network = network(&[1.0, 0.5, 2.0], &[&plain, more].concat());
        for i in 0..pins {
            let [x, _] = of(&start, i);
            network.pin(i, Path::Still(x)).unwrap();
        }
        integrate(&network, method("rk4"), &start, 1e-3, 2_000)
    };
    let expected = run(&[], 1);
    for more in [&plain[..], &[rod(2, 1, 2.0), rod(1, 2, 2.0)]] {
        assert!(distance(&run(more, 1), &expected) < 1e-10);
    }
    // A constraint between pins adds no force.
    let of_one = {
        let mut network = network(&[1.0, 0.5, 2.0], &plain[1..]);
        for i in 0..2 {
            network.pin(i, Path::Still(of(&start, i)[0])).unwrap();
        }
        integrate(&network, method("rk4"), &start, 1e-3, 2_000)
    };
    assert!(distance(&run(&[], 2), &of_one) < 1e-12);
    let far = run(&[rod(0, 1, 7.0)], 2);
    assert!(distance(&far, &of_one) < 1e-12);
}

/// Constraints may be redundant, as those of three rods between particles on a line are.
#[test]
fn a_flat_triangle_of_rods_turns_as_one() {
    let network = weightless(&[1.0; 3], &[rod(0, 1, 1.0), rod(1, 2, 1.0), rod(0, 2, 2.0)]);
    let at = |angle: f64| {
        let out = vector(angle.cos(), angle.sin(), 0.0);
        let across = vector(-angle.sin(), angle.cos(), 0.0);
        state(&[out, ZERO, -out], &[across * 2.0, ZERO, across * -2.0])
    };
    let y = integrate(&network, method("rk4"), &at(0.0), 1e-3, 3_000);
    assert!(distance(&y, &at(6.0)) < 1e-9);
}

#[test]
fn what_cannot_be_held_stays_finite() {
    let point = |x| Constraint::Point {
        particle: 0,
        position: vector(x, 0.0, 0.0),
    };
    let both = weightless(&[1.0], &[point(-1.0), point(2.0)]);
    let y = integrate(
        &both,
        method("rk4"),
        &state(&[vector(0.1, 0.3, 0.2)], &[ZERO]),
        1e-3,
        5_000,
    );
    // Contradictory constraints are met as nearly as possible.
    assert!(distance(&y, &state(&[vector(0.5, 0.0, 0.0)], &[ZERO])) < 1e-9);
    let rods = [
        rod(0, 1, 1.0),
        rod(0, 1, 3.0),
        rod(1, 2, 1.0),
        rod(2, 0, 7.0),
    ];
    let y = state(
        &[ZERO, vector(2.0, 0.0, 0.0), vector(3.0, 0.0, 0.0)],
        &[ZERO; 3],
    );
    let impossible = network(&[1.0, 2.0, 0.1], &rods);
    let y = integrate(&impossible, method("rk4"), &y, 1e-3, 1_000);
    assert!(size(&y) < 10.0, "{y:?}");
}

/// At the centre of a sphere no direction is defined: the constraint adds no force, and no NaN.
#[test]
fn in_a_centre_nothing_holds() {
    let sphere = Constraint::Sphere {
        particle: 0,
        center: ZERO,
        radius: 1.0,
    };
    let network = network(&[1.0, 1.0], &[sphere, rod(0, 1, 1.0)]);
    let mut f = [f64::NAN; 6];
    network.forces(0.0, &[0.0; 6], &[3.0; 6], &mut f);
    assert_eq!(f, [0.0, 0.0, -G, -G, 0.0, 0.0]);
    assert_eq!(network.constraint_error(&[0.0; 6]), Some(1.0));
}

/// Errors of every kind of constraint decay by C'' = -w^2 C - 2 w C': 0.1 m becomes 0.1 (1 + w t)
/// exp(-w t) m.
#[test]
fn what_is_off_comes_back() {
    let slope = vector(0.6, 0.8, 0.0);
    for (constraint, x) in [
        (
            Constraint::Point {
                particle: 0,
                position: slope,
            },
            slope + vector(0.1, 0.0, 0.0),
        ),
        (
            Constraint::Line {
                particle: 0,
                point: ZERO,
                direction: vector(-0.8, 0.6, 0.0),
            },
            slope * 0.1,
        ),
        (wire(), slope * 1.1),
        (wire(), slope + vector(0.0, 0.0, 0.1)),
        (
            Constraint::Sphere {
                particle: 0,
                center: ZERO,
                radius: 1.0,
            },
            slope * 0.9,
        ),
        (rod(0, 1, 1.0), slope * 0.9),
    ] {
        for w in [10.0, 20.0] {
            let mut network = network(&[1.0, 3.0], &[constraint]);
            network.set_baumgarte_frequency(w).unwrap();
            let y = state(&[x, ZERO], &[ZERO; 2]);
            for t in [0.1, 0.4, 4.0] {
                let end = integrate(&network, method("dop853"), &y, t / 400.0, 400);
                let exact = 0.1 * (1.0 + w * t) * (-w * t).exp();
                let found = error(&network, &end);
                assert!(
                    (found - exact).abs() < 1e-9,
                    "{constraint:?}, {t} s: {found}"
                );
            }
        }
    }
}

#[test]
fn implicit_methods_refuse_in_one_line() {
    let (constrained, y) = chain(2);
    let free = network(&[1.0], &[]);
    for m in integrators::METHODS {
        assert!(m.check(&free).is_ok());
        assert_eq!(m.check(&constrained).is_err(), m.implicit, "{}", m.name);
        if let Err(refused) = m.integrator(&constrained) {
            let line = refused.to_string();
            assert!(
                line.starts_with(m.title) && line.contains("explicit"),
                "{line}"
            );
            assert!(!line.contains('\n'));
        } else {
            integrate(&constrained, m, &y, 1e-3, 3);
        }
    }
}

#[test]
fn constraints_that_make_no_sense_are_refused() {
    let mut network = network(&[1.0; 2], &[]);
    assert_eq!(network.constraint_error(&[0.0; 6]), None);
    assert!(!network.forces_in_use().contains(&"constraints"));
    let point = |particle, x| Constraint::Point {
        particle,
        position: vector(x, 0.0, 0.0),
    };
    let circle = |normal, radius| Constraint::Circle {
        particle: 0,
        center: ZERO,
        normal,
        radius,
    };
    let sphere = |x, radius| Constraint::Sphere {
        particle: 1,
        center: vector(0.0, x, 0.0),
        radius,
    };
    let line = |x, direction| Constraint::Line {
        particle: 1,
        point: vector(0.0, x, 0.0),
        direction,
    };
    let up = vector(0.0, 1.0, 0.0);
    for (constraint, says) in [
        (point(2, 0.0), "0 to 1"),
        (point(0, f64::NAN), "finite"),
        (line(f64::INFINITY, up), "finite"),
        (line(0.0, ZERO), "direction"),
        (line(0.0, up * f64::NAN), "direction"),
        (circle(ZERO, 1.0), "direction"),
        (circle(up, 0.0), "radius"),
        (sphere(0.0, -1.0), "radius"),
        (sphere(f64::NAN, 1.0), "finite"),
        (rod(0, 2, 1.0), "0 to 1"),
        (rod(1, 1, 1.0), "twice"),
        (rod(0, 1, 0.0), "length"),
    ] {
        let refused = network.add_constraint(constraint).unwrap_err().to_string();
        assert!(refused.contains(says), "{refused}");
    }
    assert!(network.set_baumgarte_frequency(0.0).is_err());
    assert!(network.constraints().is_empty() && network.baumgarte_frequency().is_none());
    network.add_constraint(line(0.0, up * 3.0)).unwrap();
    assert_eq!(network.constraints(), [line(0.0, up)]);
    assert!(network.forces_in_use().contains(&"constraints"));
    assert!(!network.forces_in_use().contains(&"spring damping"));
    assert_eq!(network.baumgarte_frequency(), Some(10.0));
}

/// Evaluations do not depend on earlier ones, with which they share scratch.
#[test]
fn evaluations_are_functions_of_their_arguments() {
    let ((network, y), (other, z)) = (driven(0.5), chain(10));
    let evaluate = |network: &Network, y: &[f64]| {
        let mut out = vec![f64::NAN; y.len()];
        network.eval_f(0.3, y, &mut out);
        out
    };
    let first = evaluate(&network, &y);
    evaluate(&other, &z);
    let lost = evaluate(&other, &vec![f64::NAN; z.len()]);
    assert!(lost.iter().any(|a| a.is_nan()));
    assert_eq!(first, evaluate(&network, &y));
}

fn scene((network, state): (Network, Vec<f64>)) -> Scene {
    Scene::new("rods", Model::Network(Box::new(network)), state)
}

/// A hand that pulls at rods in any direction keeps their lengths and bounds their velocities.
#[test]
fn a_hand_gets_no_farther_than_rods_let_it() {
    for grabbed in [3, 10] {
        let run = Simulation::new(scene(chain(10)), method("rk4"), Control::Step(0.005));
        let mut run = run.unwrap();
        run.grab(grabbed).unwrap();
        // Within the chain's reach, the particle comes to the target.
        let target = vector(0.3, 0.5, 0.4) * (0.15 * grabbed as f64);
        for _ in 0..150 {
            run.pull(target);
            run.take_steps(4).unwrap();
        }
        let left = (run.position(grabbed) - target).norm();
        assert!(left < 0.2, "{left} m");
        let mut furthest = 0.0f64;
        for k in 0..600 {
            let turn = f64::from(k / 20) * 2.4;
            run.pull(vector(
                8.0 * turn.cos(),
                8.0 * (1.3 * turn).sin(),
                turn.sin(),
            ));
            run.take_steps(4).unwrap();
            furthest = furthest.max(error(run.model().network().unwrap(), run.state()));
        }
        assert!(furthest < 1e-2, "{furthest} m");
        run.release();
        run.take_steps(1000).unwrap();
        assert!(error(run.model().network().unwrap(), run.state()) < 1e-4);
    }
}

/// A hand moves the end of a rod between pins to at least 0.95 and at most 1.05 lengths from the
/// other end.
#[test]
fn a_hand_keeps_the_length_of_a_rod() {
    let mut network = weightless(&[1.0; 2], &[rod(0, 1, 2.0)]);
    let y = state(&[ZERO, vector(2.0, 0.0, 0.0)], &[ZERO; 2]);
    for i in 0..2 {
        network.pin(i, Path::Still(of(&y, i)[0])).unwrap();
    }
    for (target, end) in [
        (vector(9.0, 0.0, 0.0), vector(2.1, 0.0, 0.0)),
        (vector(-9.0, 0.0, 0.0), vector(1.9, 0.0, 0.0)),
        (vector(2.0, 0.4, 0.0), vector(2.0, 0.4, 0.0)),
    ] {
        let scene = scene((network.clone(), y.clone()));
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.01)).unwrap();
        run.grab(1).unwrap();
        run.pull(target);
        run.advance_to(3.0).unwrap();
        assert!(
            (run.position(1) - end).norm() < 1e-12,
            "{}",
            run.position(1)
        );
    }
}

/// Baumgarte stabilisation limits the step too, and a scene with constraints has no state of rest,
/// as implicit methods do not support it.
#[test]
fn stability_knows_of_the_feedback() {
    let scene = scene(chain(3));
    let system = scene.model.system();
    let modes = spectrum(system, 0.0, &scene.state);
    let euler = largest_step(method("euler"), &modes).unwrap().unwrap();
    assert!((euler.step - 0.2).abs() < 1e-3, "{}", euler.step);
    let mechanics = system.mechanics().unwrap().linearized().unwrap();
    let x = &scene.state[..scene.state.len() / 2];
    let fastest = LargestMode::default().estimate(mechanics, 0.0, x).unwrap();
    assert_eq!(fastest.frequency(), 10.0);
    assert!(rest(&scene).unwrap().is_none());
}

/// A sheet that hangs from point constraints moves like one that hangs from pins; it is stepped by
/// whole arrays, as sweeps do not support constraints.
#[test]
fn a_sheet_hangs_from_points_as_from_pins() {
    let grid = Grid::new(4, 5).unwrap();
    let n = grid.particles();
    let x: Vec<_> = (0..n)
        .map(|k| vector(0.5 * (k % 5) as f64, 0.0, 0.5 * (k / 5) as f64))
        .collect();
    let y = state(&x, &vec![ZERO; n]);
    let sheet = |constraints: &[Constraint]| {
        let mut network = network(&vec![0.5; n], constraints);
        let sheet = Sheet::new(grid, 0.5, [40.0, 20.0, 10.0], 0.01).unwrap();
        network.add(sheet).unwrap();
        network
    };
    let point = |particle: usize| Constraint::Point {
        particle,
        position: x[particle],
    };
    let pointed = sheet(&[point(0), point(4)]);
    let mut pinned = sheet(&[]);
    for i in [0, 4] {
        pinned.pin(i, Path::Still(x[i])).unwrap();
    }
    for name in ["rk4", "verlet", "symplectic"] {
        let [a, b] =
            [&pointed, &pinned].map(|network| integrate(network, method(name), &y, 1e-4, 10_000));
        assert!(distance(&a, &b) < 1e-4, "{name}: {}", distance(&a, &b));
        assert!(error(&pointed, &a) < 1e-12, "{name}");
    }
}
