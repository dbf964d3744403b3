//! Known facts of the course's cloth: which runs survive, when the others blow up, and the state of
//! rest.

use crate::common::simulation;
use a3_core::{Error, Mechanics};
use approx::assert_abs_diff_eq;

#[test]
fn runs_that_survive() {
    for (method, step, until) in
        [("rk4", 0.02, 8.0), ("rk4", 0.03, 8.0), ("trapezoid", 0.005, 8.0), ("euler", 0.0003, 6.0)]
    {
        let mut run = simulation("mit", method, step);
        run.advance_to(until).unwrap_or_else(|e| panic!("{method} {step}: {e}"));
        let stretch = run.largest_stretch().unwrap();
        assert!(stretch < 6.0, "{method} {step}: stretched {stretch} times");
    }
}

#[test]
fn runs_that_blow_up() {
    for (method, step, earliest, latest) in
        [("rk4", 0.04, 0.68, 0.76), ("trapezoid", 0.01, 2.7, 3.0), ("euler", 0.001, 4.0, 6.9)]
    {
        let Err(Error::BlowUp(blow_up)) = simulation("mit", method, step).advance_to(10.0) else {
            panic!("{method} {step} survived")
        };
        println!("{method} {step}: {blow_up}");
        assert!((earliest..=latest).contains(&blow_up.time), "{method} {step}: {blow_up}");
        assert_eq!(blow_up.step, (blow_up.time / step).round() as u64);
    }
}

#[test]
fn rest_shape_and_load() {
    let mut run = simulation("mit", "rk4", 0.02);
    run.advance_to(120.0).unwrap();
    assert_abs_diff_eq!(run.lowest(), -3.7382, epsilon = 1e-3);
    assert_abs_diff_eq!(run.largest_stretch().unwrap(), 2.756, epsilon = 1e-3);
    let network = run.model().network().unwrap();
    let (x, v) = run.state().split_at(run.state().len() / 2);
    let mut forces = vec![0.0; x.len()];
    network.spring_forces(x, v, &mut forces);
    let n = run.particles();
    let load: f64 = network.pins().map(|(i, _)| -forces[n + i]).sum();
    assert_abs_diff_eq!(load, 87.416, epsilon = 1e-2);
    // At rest, every force on a free particle cancels.
    network.forces(run.time(), x, v, &mut forces);
    let free = |k: &usize| !network.is_pinned(k % n);
    assert!((0..3 * n).filter(free).all(|k| forces[k].abs() < 1e-3));
}
