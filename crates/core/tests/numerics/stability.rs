//! Exact growth factors and stability limits; each limit is tested from both sides.

use crate::common::{damped_spring, integrate, method, oscillator, scene, size};
use a3_core::Network;
use approx::assert_relative_eq;

/// Damping ratios of `DAMPED_LIMITS`.
pub const ZETAS: [f64; 5] = [0.01, 0.1, 0.5, 1.0, 2.0];

/// Largest stable h w of methods on an oscillator with drag, for each of these damping ratios.
#[rustfmt::skip]
pub const DAMPED_LIMITS: [(&str, [f64; 5]); 8] = [
    ("euler", [0.020_000, 0.200_000, 1.000_000, 2.000_000, 0.535_898]),
    ("trapezoid", [0.444_003, 1.049_755, 2.000_000, 2.000_000, 0.535_898]),
    ("midpoint", [0.444_003, 1.049_755, 2.000_000, 2.000_000, 0.535_898]),
    ("rk4", [2.848_570, 2.950_853, 2.622_542, 2.785_294, 0.746_317]),
    ("dopri5", [1.872_130, 2.681_407, 3.398_992, 3.306_568, 0.885_992]),
    ("dop853", [6.031_695, 6.281_012, 6.765_937, 6.393_652, 1.713_174]),
    ("symplectic", [1.980_100, 1.809_975, 1.236_068, 0.828_427, 0.472_136]),
    ("verlet", [2.000_133, 2.013_432, 2.399_357, 4.002_670, 8.000_000]),
];

/// Growth of the radius in one step of h on the circle f = (-y, x, 0).
fn growth(name: &str, h: f64) -> f64 {
    match name {
        "euler" => (1.0 + h * h).sqrt(),
        "trapezoid" | "midpoint" => (1.0 + h.powi(4) / 4.0).sqrt(),
        "rk4" => (1.0 - h.powi(6) / 72.0 + h.powi(8) / 576.0).sqrt(),
        _ => unreachable!(),
    }
}

#[test]
fn the_circle_grows_as_it_must() {
    let circle = scene("simple");
    for name in ["euler", "trapezoid", "midpoint", "rk4"] {
        for h in [0.01, 0.04, 0.3, 1.0, 2.8, 2.9] {
            let y = integrate(circle.model.system(), method(name), &circle.state, h, 1);
            let radius = y.iter().map(|y| y * y).sum::<f64>().sqrt();
            assert_relative_eq!(radius, growth(name, h), max_relative = 1e-12);
        }
    }
}

#[test]
fn the_circle_after_1571_steps() {
    let circle = scene("simple");
    for (name, expected) in [
        ("euler", 3.510_630_430_52),
        ("trapezoid", 1.000_502_846_22),
        ("midpoint", 1.000_502_846_22),
        ("rk4", 0.999_999_955_323),
    ] {
        let y = integrate(circle.model.system(), method(name), &circle.state, 0.04, 1571);
        let radius = y.iter().map(|y| y * y).sum::<f64>().sqrt();
        assert_relative_eq!(radius, growth(name, 0.04).powi(1571), max_relative = 1e-12);
        assert_relative_eq!(radius, expected, max_relative = 1e-11);
    }
}

/// Largest magnitude in the final states of two runs of a damped oscillator of 1 rad/s, in steps of
/// `h_omega` (s).
fn largest(name: &str, network: &Network, h_omega: f64) -> f64 {
    let mut largest: f64 = 0.0;
    for axis in 0..2 {
        // One run starts from a displacement, the other from a velocity: one of them excites the
        // growing mode.
        let mut y = vec![0.0; 12];
        y[1 + 6 * axis] = 1.0;
        largest = largest.max(size(&integrate(network, method(name), &y, h_omega, 60_000)));
    }
    largest
}

fn holds_below_and_fails_above(name: &str, zeta: f64, limit: f64) {
    check(name, &oscillator(1.0, zeta), zeta, limit);
}

fn check(name: &str, network: &Network, zeta: f64, limit: f64) {
    let below = largest(name, network, 0.99 * limit);
    assert!(below < 100.0, "{name}, zeta {zeta}: {below:e} at 0.99 of the limit {limit}");
    let above = largest(name, network, 1.01 * limit);
    assert!(above > 1e3, "{name}, zeta {zeta}: only {above:e} at 1.01 of the limit {limit}");
}

#[test]
fn undamped_limits() {
    for (name, limit) in [
        ("rk4", 2.828_427_125),
        ("symplectic", 2.0),
        ("verlet", 2.0),
        ("pefrl", 2.989_450),
        ("dop853", 5.960_359_812),
    ] {
        holds_below_and_fails_above(name, 0.0, limit);
    }
}

#[test]
fn methods_without_an_undamped_limit_always_grow() {
    for (name, h, steps) in [
        ("euler", 0.01, 400_000),
        ("trapezoid", 0.1, 1_000_000),
        ("midpoint", 0.1, 1_000_000),
        ("rkf45", 0.9, 400_000),
    ] {
        let network = oscillator(1.0, 0.0);
        let mut y = vec![0.0; 12];
        y[1] = 1.0;
        let y = integrate(&network, method(name), &y, h, steps);
        assert!(size(&y) > 1e3, "{name}: {:e}", size(&y));
    }
}

#[test]
fn damped_limits() {
    for (name, limits) in DAMPED_LIMITS {
        for (zeta, limit) in ZETAS.into_iter().zip(limits) {
            // A step 1 % above the limit grows visibly within these steps, except for Euler at
            // light damping, where growth is too slow.
            if name == "euler" && zeta == 0.01 {
                continue;
            }
            holds_below_and_fails_above(name, zeta, limit);
        }
    }
}

/// The spring damps the oscillator, and there is no drag.
#[test]
fn limits_of_a_damped_spring() {
    for (zeta, limit) in [
        (0.01, 5.824_314),
        (0.1, 5.306_993),
        (0.3, 4.390_518),
        (0.5, 3.758_512),
        (1.0, 2.459_701),
        (2.0, 1.380_401),
    ] {
        check("verlet", &damped_spring(1.0, 2.0 * zeta), zeta, limit);
    }
}

/// Limit of Dormand and Prince's method without damping; past it the method grows by a factor of 1
/// + 5e-6 in each step.
#[test]
fn the_undamped_limit_of_dopri5() {
    let network = oscillator(1.0, 0.0);
    let mut y = vec![0.0; 12];
    y[1] = 1.0;
    for (fraction, grows) in [(0.99, false), (1.01, true)] {
        let h = 0.997_189_009 * fraction;
        let y = integrate(&network, method("dopri5"), &y, h, 2_000_000);
        assert_eq!(size(&y) > 1e3, grows, "{:e} at {fraction}", size(&y));
    }
}

/// Limit of Euler's method at zeta = 0.01: at 1.01 times its limit the amplitude grows by only 2e-6
/// in each step, so that amplitudes at two times are compared.
#[test]
fn euler_at_light_damping() {
    let network = oscillator(1.0, 0.01);
    let mut y = vec![0.0; 12];
    y[1] = 1.0;
    // Both times are whole periods, so that the phase is the same.
    let amplitude = |h: f64, steps| {
        let y = integrate(&network, method("euler"), &y, h, steps);
        (y[1] * y[1] + y[7] * y[7]).sqrt()
    };
    for (fraction, grows) in [(0.99, false), (1.01, true)] {
        let h: f64 = 0.02 * fraction;
        let steps = |t: f64| (t / h).round() as u64;
        let period = std::f64::consts::TAU;
        let (early, late) =
            (amplitude(h, steps(period * 1.0)), amplitude(h, steps(period * 1001.0)));
        assert_eq!(late > early, grows, "{early} {late} at {fraction} of the limit");
    }
}
