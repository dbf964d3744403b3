//! Methods for forces without velocities: strong drag, states within a step, and refusals.

use crate::common::{described, distance, method, oscillator, scene, simulation, size};
use a3_core::integrators::Tolerance;
use a3_core::{Cause, Error, Scene, Simulation};

/// A polynomial through the stages is accurate: errors of states within steps are of the size of
/// those at their ends.
#[test]
fn frames_are_as_accurate_as_steps() {
    for name in ["verner65", "dprkn86", "dprkn1210"] {
        for (scene_name, tolerance) in [("mit", 1e-4), ("chain", 1e-4), ("chain", 1e-7)] {
            let n = 3 * scene(scene_name).model.network().unwrap().particles();
            let mut exact = simulation(scene_name, "dop853", 1e-12);
            let mut run = simulation(scene_name, name, tolerance);
            let (mut ends, mut frames): (f64, f64) = (0.0, 0.0);
            while run.time() < 1.0 {
                let from = run.time();
                let mut ahead = simulation(scene_name, name, tolerance);
                ahead.restore(&run.checkpoint()).unwrap();
                ahead.take_steps(1).unwrap();
                for share in [0.25, 0.5, 0.75, 1.0] {
                    let time = from + share * (ahead.time() - from);
                    run.advance_to(time).unwrap();
                    exact.advance_to(time).unwrap();
                    let error = distance(&run.state()[..n], &exact.state()[..n]);
                    let worst = if share < 1.0 { &mut frames } else { &mut ends };
                    *worst = worst.max(error);
                }
            }
            println!("{name} {scene_name} {tolerance:e}: {ends:.1e} at ends, {frames:.1e} within");
            assert!(frames < 10.0 * ends, "{name}: {ends:e}, {frames:e}");
        }
    }
}

/// Drag that ends all motion within a ten-thousandth of a second shortens the steps, whatever the
/// first trial step is.
#[test]
fn strong_drag_is_followed() {
    let (omega, zeta) = (100.0, 50.0);
    let system = oscillator(omega, zeta);
    for name in ["dprkn86", "dprkn1210"] {
        let tolerance = Tolerance::new(1e-6).unwrap();
        let mut adaptive = method(name).adaptive(&system, tolerance).unwrap();
        for first in [0.01, 1.0] {
            let (mut t, mut y) = (0.0, vec![0.0; 12]);
            y[1] = 0.7;
            adaptive.restart();
            adaptive.try_first(first);
            while t < 0.02 {
                t += adaptive.advance(&system, t, f64::INFINITY, &mut y).unwrap().h;
            }
            let root = omega * (zeta * zeta - 1.0f64).sqrt();
            let (slow, fast) = (root - zeta * omega, -root - zeta * omega);
            let [a, b] = [slow, fast].map(|rate| (rate * t).exp());
            let x = 0.7 * (slow * b - fast * a) / (slow - fast);
            let v = 0.7 * slow * fast * (b - a) / (slow - fast);
            let error = (y[1] - x).abs().max((y[7] - v).abs());
            assert!(error < 1e-5 && size(&y) < 1.0, "{name}, {first} s: {error:e}");
        }
    }
}

/// A cloth of undamped springs, with a wind that does not blow yet.
fn calm() -> Scene {
    described(
        "gravity = [0, -9.81, 0]
        [wind]
        velocity = [3, 0, 1]
        [[cloth]]
        grid = [3, 4]
        width = 1
        mass = 0.1
        stiffness = [40, 20, 5]
        pin = [{ at = ['top'] }]",
    )
}

/// Wind that begins to blow in a run whose method does not support it ends the run with one
/// message, and a reset without wind starts it again.
#[test]
fn wind_in_the_midst_of_a_run_is_refused() {
    for name in ["dprkn86", "dprkn1210", "srkn11"] {
        let method = method(name);
        let control = method.control(if method.is_adaptive() { 1e-6 } else { 0.01 });
        let mut run = Simulation::new(calm(), method, control).unwrap();
        run.take_steps(3).unwrap();
        let before = run.state().to_vec();
        run.set_wind(true);
        let Err(Error::BlowUp(lost)) = run.take_steps(1) else {
            panic!("{name} served the wind");
        };
        assert_eq!((lost.cause, run.state()), (Cause::ReadsVelocity, &before[..]));
        assert!(lost.to_string().contains("must not depend on the velocity"));
        assert!(run.set_method(method, control).is_err());
        run.set_wind(false);
        run.reset();
        run.take_steps(3).unwrap();
        assert_eq!(run.state(), before);
    }
}
