//! Verlet's method with implicit damping: its order, its limit, and Verlet's method where nothing
//! is damped.

use a3_core::stability::{Growth, Mode};
use a3_core::{Control, Simulation};

use crate::common::{damped_spring, ellipse, integrate, method, scene};

const METHOD: &str = "implicit-damping";

/// The displacement after t of an oscillator that is released at 1.
fn released(omega: f64, zeta: f64, t: f64) -> f64 {
    let root = omega * (1.0 - zeta * zeta).abs().sqrt();
    let decay = zeta * omega;
    if zeta < 1.0 {
        (-decay * t).exp() * ((root * t).cos() + decay / root * (root * t).sin())
    } else {
        // Without the overflow of the hyperbolic functions.
        let (slow, fast) = (((root - decay) * t).exp(), ((-root - decay) * t).exp());
        0.5 * (slow + fast) + 0.5 * decay / root * (slow - fast)
    }
}

fn error(omega: f64, zeta: f64, end: f64, steps: u64) -> f64 {
    let mut y = vec![0.0; 12];
    y[1] = 1.0;
    let network = damped_spring(omega, 2.0 * zeta * omega);
    let y = integrate(&network, method(METHOD), &y, end / steps as f64, steps);
    (y[1] - released(omega, zeta, end)).abs()
}

#[test]
fn the_order_is_2_with_any_damping() {
    for zeta in [0.05, 0.5, 2.0, 5.0] {
        let error = |steps| error(1.0, zeta, 2.0, steps);
        for steps in [100, 200] {
            let slope = (error(steps) / error(2 * steps)).log2();
            assert!((slope - 2.0).abs() < 0.1, "{zeta}: {slope}");
        }
    }
}

/// A dashpot whose rate is 1e5 times that of the steps, by which the motion is slow.
#[test]
fn a_stiff_dashpot_does_not_limit_the_step() {
    for (zeta, steps) in [(50.0, 50), (5e5, 5)] {
        let error = error(1.0, zeta, 5.0, steps);
        assert!(error < 1e-3, "{zeta}: {error:e}");
    }
}

/// The step's matrix on a mode has the determinant R and the trace 1 + R - h^2 w^2 (1 - R) / z,
/// with z = 2 zeta h w: so the limit is h w (1 - R) = 4 zeta (1 + R). R is the stability function
/// of the Rosenbrock method.
#[test]
fn the_limit_is_that_of_its_stability_function() {
    let root = std::f64::consts::FRAC_1_SQRT_2;
    let g = 1.0 - root;
    for zeta in [0.01, 0.1, 0.5, 1.0, 3.0, 30.0] {
        let excess = |s: f64| {
            let z = 2.0 * zeta * s;
            let r = (1.0 - (1.0 - 2.0 * g) * z) / (1.0 + g * z).powi(2);
            s * (1.0 - r) - 4.0 * zeta * (1.0 + r)
        };
        let (mut low, mut high) = (0.1, 1e3);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            *(if excess(middle) > 0.0 { &mut high } else { &mut low }) = middle;
        }
        assert!(low > 1.99, "{low}");
        let mode = Mode { stiffness: 1.0, damping: 2.0 * zeta, ..Mode::default() };
        let mut growth = Growth::new(method(METHOD), mode).unwrap();
        assert!(growth.of_step(0.999 * low) < 1.0 + 1e-9, "{zeta}: {low}");
        assert!(growth.of_step(1.001 * low) > 1.0, "{zeta}: {low}");
    }
}

/// Without forces that depend on velocities, the bits are those of Verlet's method.
#[test]
fn without_damping_it_is_verlet() {
    for scene in [scene("mit"), scene("pendulum"), ellipse()] {
        let [own, other] = [METHOD, "verlet"].map(|name| {
            let method = method(name);
            let mut run = Simulation::new(scene.clone(), method, Control::Step(2e-3)).unwrap();
            run.take_steps(20).unwrap();
            (run.state().to_vec(), run.work())
        });
        assert!(own == other, "{}", scene.name);
    }
}
