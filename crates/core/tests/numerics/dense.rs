//! States within the steps of own adaptive methods, on their own polynomials.

use a3_core::integrators::{Adaptive, Tolerance};
use a3_core::{Error, Method, Ode};

/// Degree of the method.
const DEGREE: usize = 12;

/// Returns a method by Taylor's series for y' = y. With a `share`, it also returns that share of
/// its polynomial within a step.
fn taylor(name: &str, share: Option<f64>) -> Method {
    let method = Method::from_estimated_step(name, DEGREE as u32, move |f, t, y, h| {
        let rate = f.at(t, y)?[0];
        let mut term = 1.0;
        let terms = (1..=DEGREE).map(|j| {
            term *= h / j as f64;
            term * rate
        });
        let terms: Vec<_> = terms.collect();
        let mut found = vec![vec![y[0] + terms.iter().sum::<f64>()], vec![terms[DEGREE - 1]]];
        if let Some(share) = share {
            found.extend(terms.into_iter().map(|term| vec![share * term]));
        }
        Ok(found)
    });
    method.unwrap()
}

fn growth() -> Ode {
    Ode::new(1, |_, y, dydt: &mut [f64]| dydt[0] = y[0]).unwrap()
}

/// Returns a method that has advanced to 3 s, and the number of its steps.
fn advanced(method: &Method) -> Result<(Adaptive, u32), Error> {
    let tolerance = Tolerance::new(1e-10).unwrap();
    let mut adaptive = method.adaptive(&growth(), tolerance).unwrap();
    let (mut t, mut y, mut steps) = (0.0, [1.0], 0);
    while t < 3.0 {
        t += adaptive.advance(&growth(), t, 3.0 - t, &mut y)?.h;
        steps += 1;
    }
    Ok((adaptive, steps))
}

/// Returns the largest relative error of the states within the last step.
fn miss(adaptive: &mut Adaptive) -> f64 {
    let last = adaptive.last();
    let misses = (0..=10).map(|k| {
        let (t, mut y) = (last.t + 0.1 * f64::from(k) * last.h, [0.0]);
        let work = adaptive.interpolate(&growth(), t, &mut y);
        assert_eq!(work.evaluations, 0);
        (y[0] / t.exp() - 1.0).abs()
    });
    misses.fold(0.0, f64::max)
}

#[test]
fn states_within_a_step_are_on_the_polynomial_of_the_method() {
    let (mut dense, steps) = advanced(&taylor("taylor-dense", Some(1.0))).unwrap();
    let (mut cubic, same) = advanced(&taylor("taylor-cubic", None)).unwrap();
    assert_eq!(steps, same);
    let (own, other) = (miss(&mut dense), miss(&mut cubic));
    println!("{steps} steps: {own:.1e} on the polynomial, {other:.1e} on the cubic");
    assert!(own < 1e-10 && other > 1e-6, "{own} {other}");
    // A run that is resumed has the same polynomial.
    let (mut resumed, _) = advanced(&taylor("taylor-again", Some(1.0))).unwrap();
    resumed.resume(&cubic.state(true)).unwrap();
    assert_eq!(miss(&mut resumed), other);
    resumed.resume(&dense.state(true)).unwrap();
    assert_eq!(miss(&mut resumed), own);
}

#[test]
fn a_polynomial_that_ends_elsewhere_is_refused() {
    let told = advanced(&taylor("taylor-wrong", Some(0.9))).err().unwrap().to_string();
    assert!(told.contains("taylor-wrong returned do not sum to the change"), "{told}");
}
