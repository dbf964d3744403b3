//! Implicit methods with constraints: their orders, exact lengths, energy, momentum, and the price
//! of long chains.

use crate::common::{integrate, method};
use a3_core::{Control, Model, Path, Scene, Simulation, Vector3};

use super::*;

const METHODS: [(&str, f64); 3] = [("implicit", 1.0), ("tr-bdf2", 2.0), ("implicit-midpoint", 2.0)];

/// Two rods of 1 m with particles of 1 kg, which are released in the direction (0.6, 0.8, 0).
fn double_pendulum() -> (Network, Vec<f64>) {
    let mut network = network(&[1.0; 3], &[rod(0, 1, 1.0), rod(1, 2, 1.0)]);
    network.pin(0, Path::Still(ZERO)).unwrap();
    let x = [ZERO, vector(0.6, 0.8, 0.0), vector(1.2, 1.6, 0.0)];
    (network, state(&x, &[ZERO; 3]))
}

/// Where its particles are after a second, by the equations for the two angles, solved by the
/// pair DOP853 of `scipy` at a tolerance of 1e-13.
const AFTER_A_SECOND: [Vector3<f64>; 2] = [
    vector_of(0.371_795_553_050_316_3, -0.928_314_637_788_292_9),
    vector_of(-0.004_249_225_825_422_1, -1.854_916_129_412_549_4),
];

const fn vector_of(x: f64, y: f64) -> Vector3<f64> {
    Vector3::new(x, y, 0.0)
}

/// Slope of errors at steps of h and h / 2, in powers of h.
fn slope(error: impl Fn(f64) -> f64, h: f64) -> f64 {
    (error(h) / error(0.5 * h)).log2()
}

#[test]
fn implicit_methods_keep_their_orders_on_a_double_pendulum() {
    let (network, y) = double_pendulum();
    for (name, order) in METHODS {
        let error = |h: f64| {
            let y = integrate(&network, method(name), &y, h, (1.0 / h).round() as u64);
            let off = (1..3).map(|i| (of(&y, i)[0] - AFTER_A_SECOND[i - 1]).norm());
            assert!(super::error(&network, &y) < 1e-14, "{name}");
            off.fold(0.0, f64::max)
        };
        let h = if order > 1.0 { 0.01 } else { 0.001 };
        let found = slope(error, h);
        assert!((found - order).abs() < 0.2, "{name}: order {found}");
    }
}

#[test]
fn implicit_methods_keep_their_orders_on_a_wire() {
    let (network, quarter) = (network(&[0.5], &[wire()]), 0.25 * period(G.sqrt(), 0.5 * PI));
    let y = state(&[vector(1.0, 0.0, 0.0)], &[ZERO]);
    for (name, order) in METHODS {
        let error = |h: f64| {
            let steps = (1.0 / h).round();
            let y = integrate(&network, method(name), &y, quarter / steps, steps as u64);
            let [x, v] = of(&y, 0);
            assert!((x.norm() - 1.0).abs() < 1e-14 && x.dot(&v).abs() < 1e-13);
            (x - vector(0.0, -1.0, 0.0)).norm()
        };
        let found = slope(error, if order > 1.0 { 0.02 } else { 0.005 });
        assert!((found - order).abs() < 0.2, "{name}: order {found}");
    }
}

#[test]
fn bdf_meets_its_tolerance_with_rods() {
    for (tolerance, allowed) in [(1e-4, 2e-3), (1e-6, 2e-5), (1e-8, 2e-7)] {
        let (network, y) = double_pendulum();
        let scene = Scene::new("rods", Model::Network(Box::new(network.clone())), y);
        let control = Control::Tolerance(tolerance);
        let mut run = Simulation::new(scene, method("bdf"), control).unwrap();
        // Half a step is a state within one.
        for time in [0.123, 1.0] {
            run.advance_to(time).unwrap();
            assert!(error(&network, run.state()) < 1e-14, "{tolerance:e}");
        }
        let off = (run.position(2) - AFTER_A_SECOND[1]).norm();
        assert!(off < allowed, "{tolerance:e}: {off:e} m");
    }
}

#[test]
fn bdf_begins_off_a_wire() {
    let network = network(&[0.5], &[wire()]);
    let y = state(&[vector(1.0 + 1e-5, 0.0, 0.0)], &[ZERO]);
    let scene = Scene::new("bead", Model::Network(Box::new(network.clone())), y);
    let mut run = Simulation::new(scene, method("bdf"), Control::Tolerance(1e-7)).unwrap();
    run.advance_to(0.1).unwrap();
    assert!(error(&network, run.state()) < 1e-14);
}

#[test]
fn the_midpoint_rule_keeps_the_energy_of_rods() {
    let (network, y) = double_pendulum();
    let (off, change, _) = watch(&network, &y, "implicit-midpoint", 0.01, 1000);
    assert!(off < 1e-14 && change < 2e-2, "{off:e} m, {change:e} J");
    // Without the symmetric projection, 0.065 J are lost.
    let end = integrate(&network, method("implicit-midpoint"), &y, 0.01, 1000);
    let lost = (total_energy(&network, &end) - total_energy(&network, &y)).abs();
    assert!(lost < 5e-3, "{lost:e} J");
}

#[test]
fn free_rods_keep_their_momentum() {
    let network = weightless(&[1.0, 0.5, 2.0], &[rod(0, 1, 1.0), rod(1, 2, 1.5)]);
    let x = [ZERO, vector(1.0, 0.0, 0.0), vector(1.0, 1.5, 0.0)];
    let v = [vector(0.0, -2.0, 1.0), vector(0.0, 1.0, 0.0), vector(0.3, 1.0, -1.0)];
    let y = state(&x, &v);
    let momentum = |y: &[f64]| -> [Vector3<f64>; 2] {
        let parts = (0..3).map(|i| {
            let ([x, v], m) = (of(y, i), network.masses()[i]);
            [v * m, x.cross(&v) * m]
        });
        parts.fold([ZERO; 2], |sum, part| [sum[0] + part[0], sum[1] + part[1]])
    };
    let before = momentum(&y);
    for (name, turning) in [("implicit", 1.0), ("tr-bdf2", 1e-2), ("implicit-midpoint", 1e-5)] {
        let after = momentum(&integrate(&network, method(name), &y, 0.01, 200));
        assert!((after[0] - before[0]).norm() < 1e-12, "{name}");
        let change = (after[1] - before[1]).norm();
        assert!(change < turning, "{name}: {change:e}");
    }
}

/// Rods on a swinging pin with a stiff spring, against steps of a tenth by an explicit method.
#[test]
fn rods_hang_from_a_swinging_pin() {
    let (network, y) = driven(0.3);
    let exact = integrate(&network, method("rk4"), &y, 1e-3, 1000);
    for (name, most) in [("tr-bdf2", 1e-3), ("implicit-midpoint", 1e-3)] {
        let found = integrate(&network, method(name), &y, 0.01, 100);
        let off = (0..3).map(|i| (of(&found, i)[0] - of(&exact, i)[0]).norm());
        let off = off.fold(0.0, f64::max);
        assert!(off < most, "{name}: {off:e} m");
    }
}

/// The work of a step is in units of an evaluation, whose time is proportional to the length.
#[test]
fn a_long_chain_costs_as_its_length() {
    let work = |rods: usize| {
        let (network, mut y) = chain(rods);
        let mut step = method("tr-bdf2").integrator(&network).unwrap();
        let work = step.step(&network, 0.0, 0.002, &mut y).unwrap();
        assert!(error(&network, &y) < 1e-10);
        work.total() / work.evaluations as f64
    };
    let (short, long) = (work(250), work(1000));
    assert!(long < 1.3 * short, "{short} {long}");
}
