//! Motion under constraints: beads on wires, rods, pendulums, chains.

use std::f64::consts::FRAC_PI_2;

use crate::common::{distance, integrate, method};
use a3_core::{Constraint, Mechanics, Path, Vector3, integrators};

use super::*;

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
            of(&integrate(&network, method("rk4"), &start, h, 1000 * quarters), i)
        };
        let lowest = [vector(0.0, -1.0, 0.0), vector(-(2.0 * G).sqrt(), 0.0, 0.0)];
        for (quarters, [x, v]) in
            [(1, lowest), (2, [vector(-1.0, 0.0, 0.0), ZERO]), (4, [vector(1.0, 0.0, 0.0), ZERO])]
        {
            let [found, speed] = after(quarters);
            assert!((found - x).norm() < 1e-9, "{quarters}: {found}");
            assert!((speed - v).norm() < 1e-9, "{quarters}: {speed}");
        }
    }
}

#[test]
fn a_bead_slides_down_a_straight_wire() {
    let direction = vector(3.0, -4.0, 12.0);
    let line = Constraint::Line { particle: 0, point: vector(1.0, 2.0, 3.0), direction };
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
    let sphere = Constraint::Sphere { particle: 0, center: ZERO, radius: 2.0 };
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

/// Methods keep their order with constraints, also where only the constraints depend on velocities.
#[test]
fn every_method_keeps_its_order() {
    for damping in [0.5, 0.0] {
        let (network, y0) = driven(damping);
        let exact = integrate(&network, method("dop853"), &y0, 1.0 / 512.0, 512);
        for m in integrators::METHODS.iter().filter(|m| m.check(&network).is_ok()) {
            let (steps, slack) = match m.order {
                8.. => (20, 0.6),
                6.. => (20, 0.9),
                5 => (512, 0.3),
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

/// C'' = -ks C - kd C' to rounding for every rod of chains that violate their constraints: of few
/// rods, of many, and of many of which some are given twice, so that no factorisation serves.
#[test]
fn accelerations_are_what_the_constraints_ask_for() {
    for (rods, doubled) in [(5, 0), (40, 0), (1000, 0), (40, 7)] {
        let (mut network, y) = chain(rods);
        for k in 0..doubled {
            network.add_constraint(rod(5 * k, 5 * k + 1, 0.5)).unwrap();
        }
        accelerations_fit(&network, y);
    }
}

fn accelerations_fit(network: &Network, mut y: Vec<f64>) {
    let n = network.particles();
    for (k, y) in y.iter_mut().enumerate().filter(|(k, _)| k % n > 0) {
        *y += 0.1 * (17.0 * k as f64).sin();
    }
    let (x, v) = y.split_at(3 * n);
    let mut a = vec![f64::NAN; 3 * n];
    network.accelerations(0.0, x, v, &mut a);
    rods_are_held(network, [x, v, &a], 1e-10);
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
    let sphere = Constraint::Sphere { particle: 0, center: ZERO, radius: 6f64.sqrt() };
    let line = Constraint::Line { particle: 0, point: ZERO, direction: vector(1.0, 1.0, -2.0) };
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
