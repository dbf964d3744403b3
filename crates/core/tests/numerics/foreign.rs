//! A system defined outside the core runs with every method that supports it.

use crate::common::integrate;
use a3_core::{Error, ParticleSystem, Refusal, integrators};

/// Lotka-Volterra system of prey a and predators b: a' = a (2/3 - 4/3 b), b' = b (a - 1).
struct LotkaVolterra;

impl ParticleSystem for LotkaVolterra {
    fn dim(&self) -> usize {
        2
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt[0] = y[0] * (2.0 / 3.0 - 4.0 / 3.0 * y[1]);
        dydt[1] = y[1] * (y[0] - 1.0);
    }
}

/// Invariant, which is constant along every solution.
fn invariant(y: &[f64]) -> f64 {
    y[0] - y[0].ln() + 4.0 / 3.0 * y[1] - 2.0 / 3.0 * y[1].ln()
}

#[test]
fn predators_and_prey() {
    let start = [0.9, 0.9];
    for method in integrators::METHODS {
        if method.needs_mechanics() {
            let refused = method.integrator(&LotkaVolterra).err();
            assert_eq!(
                refused,
                Some(Error::Unsupported { method: method.title, why: Refusal::LacksMasses })
            );
            continue;
        }
        let drift = |steps: u64| {
            let y = integrate(&LotkaVolterra, method, &start, 10.0 / steps as f64, steps);
            (invariant(&y) - invariant(&start)).abs()
        };
        let (coarse, fine) = (drift(200), drift(2000));
        assert!(
            coarse < 0.5 && fine < (0.2 * coarse).max(1e-13),
            "{}: {coarse:e}, {fine:e}",
            method.name
        );
    }
}

#[test]
fn a_state_of_another_length_is_refused() {
    for method in integrators::METHODS.iter().filter(|m| !m.needs_mechanics()) {
        let mut integrator = method.integrator(&LotkaVolterra).unwrap();
        let refused = integrator.step(&LotkaVolterra, 0.0, 0.1, &mut [1.0; 3]);
        assert_eq!(refused, Err(Error::Dimension { expected: 2, found: 3 }));
    }
}
