//! Systems of any number of plain numbers as scenes: runs, references, choices, limits.

use std::f64::consts::TAU;
use std::sync::Arc;

use approx::assert_relative_eq;

use crate::common::{errors, method, reference};
use a3_core::accuracy::{Frames, Metric, Precision, Reference, Scope, choose, horizon};
use a3_core::stability::{Budget, Motion, largest_step, spectrum};
use a3_core::{
    Cause, Control, Error, Mechanics, Model, Ode, ParticleSystem, Refusal, Scene, Simulation,
    integrators,
};

/// System y' = f(t, y) of a given length.
struct Plain<F>(usize, F);

impl<F: Fn(f64, &[f64], &mut [f64])> ParticleSystem for Plain<F> {
    fn dim(&self) -> usize {
        self.0
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.1(t, y, dydt);
    }
}

fn scene<F>(f: F, state: Vec<f64>) -> Scene
where
    F: Fn(f64, &[f64], &mut [f64]) + Send + Sync + 'static,
{
    let model = Model::FirstOrder(Arc::new(Plain(state.len(), f)));
    Scene::new("plain", model, state)
}

/// y' = -rate y from 1.
fn decay(rate: f64) -> Scene {
    scene(move |_, y, dydt| dydt[0] = -rate * y[0], vec![1.0])
}

/// Planar motion round a centre that attracts by 1 / r^2, in x, y and their velocities, on an
/// ellipse of eccentricity 1/2 and semi-major axis 1, whose period is 2 pi.
fn kepler() -> Scene {
    let f = |_, y: &[f64], dydt: &mut [f64]| {
        let cubed = y[0].hypot(y[1]).powi(3);
        dydt.copy_from_slice(&[y[2], y[3], -y[0] / cubed, -y[1] / cubed]);
    };
    scene(f, vec![0.5, 0.0, 0.0, 3f64.sqrt()])
}

/// Root mean square of the differences of two states.
fn rms(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    (squares.sum::<f64>() / a.len() as f64).sqrt()
}

#[test]
fn the_error_of_a_decay_is_that_of_powers() {
    let (rate, h) = (3.0, 1.0 / 240.0);
    let scene = decay(rate);
    let reference = reference(&scene, 1.0);
    assert!(reference.floor.state < 1e-12, "{:?}", reference.floor);
    let errors = errors(&scene, "euler", Control::Step(h), &reference);
    let error = |k: i32| (-rate * f64::from(k) / 60.0).exp() - (1.0 - rate * h).powi(4 * k);
    let largest = (1..=60).map(error).fold(0.0, f64::max);
    assert_relative_eq!(errors.state, largest, max_relative = 1e-9);
    assert_eq!((errors.position, errors.energy), (0.0, 0.0));
    // No run that stays where it is can be wrong by more.
    assert_relative_eq!(reference.still.state, 1.0 - (-rate).exp(), epsilon = 1e-12);
}

#[test]
fn a_decay_limits_explicit_methods_by_two_over_its_rate() {
    let scene = decay(50.0);
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let motion = Motion::of(&scene, || true).unwrap().unwrap();
    for (name, limit) in [("euler", 2.0), ("trapezoid", 2.0), ("rk4", 2.785_293_563)] {
        let found = largest_step(method(name), &modes).unwrap().unwrap();
        assert_relative_eq!(found.bounded, limit / 50.0, max_relative = 1e-6);
        let seen = motion.bounded(method(name), &Budget::unlimited(), || true);
        let seen = seen.unwrap().unwrap();
        assert_relative_eq!(seen.held, limit / 50.0, max_relative = 0.03);
    }
    let implicit = largest_step(method("implicit"), &modes).unwrap().unwrap();
    assert!(implicit.step.is_infinite());
}

#[test]
fn a_planar_orbit_closes() {
    let start = kepler().state;
    let mut run = Simulation::new(kepler(), method("dop853"), Control::Tolerance(1e-12)).unwrap();
    run.advance_to(TAU).unwrap();
    assert!(rms(run.state(), &start) < 1e-10, "{:?}", run.state());

    // After a period the exact state is the one at the start.
    let frames = Frames { until: TAU, count: 64 };
    let scope = Scope { at_end: true, ..Scope::default() };
    let precision = Precision { metric: Metric::State, ..Precision::FINEST };
    let reference = Reference::new(&kepler(), frames, scope, precision, &|| true);
    let reference = reference.unwrap().unwrap();
    let mut sizes = start.clone();
    let mut run = Simulation::new(kepler(), method("dop853"), Control::Tolerance(1e-12)).unwrap();
    for k in 0..=64 {
        run.advance_to(TAU * f64::from(k) / 64.0).unwrap();
        for (size, y) in sizes.iter_mut().zip(run.state()) {
            *size = size.max(y.abs());
        }
    }
    for steps in [256.0, 1024.0] {
        let control = Control::Step(TAU / steps);
        let mut run = Simulation::new(kepler(), method("rk4"), control).unwrap();
        run.take_steps(steps as u64).unwrap();
        // Errors are over the largest size of each number, here at the frames.
        let over = |y: &[f64]| y.iter().zip(&sizes).map(|(y, size)| y / size).collect::<Vec<_>>();
        let own = rms(&over(run.state()), &over(&start));
        let found = errors(&kepler(), "rk4", control, &reference).state;
        // The sizes are as exact as the run that they are seen in.
        let close = 2.0 * reference.floor.state;
        assert_relative_eq!(found, own, epsilon = close, max_relative = 1e-3);
        assert!(own > 100.0 * reference.floor.state);
    }
}

#[test]
fn the_cheapest_method_for_a_planar_orbit_meets_its_error() {
    let (scene, error) = (kepler(), 1e-4);
    let reference = reference(&scene, TAU);
    let found = choose(&scene, &reference, Metric::State, error, &|| true, |_| {});
    let found = found.unwrap().unwrap();
    assert!(found.len() > 3, "{found:?}");
    for candidate in &found {
        assert!(!candidate.method.needs_mechanics());
        assert!(candidate.outcome.errors.state <= error);
    }
    // Half of the error takes the cheapest one more work.
    let half = choose(&scene, &reference, Metric::State, 0.5 * error, &|| true, |_| {});
    let [all, half] = [&found, &half.unwrap().unwrap()].map(|found| found[0].outcome.work.total());
    assert!(half >= all, "{half} {all}");
}

/// y' = i y in the complex plane, by steps that turn and stretch it.
#[test]
fn the_phase_of_a_rotation_is_its_angle() {
    let turn = |_, y: &[f64], dydt: &mut [f64]| dydt.copy_from_slice(&[-y[1], y[0]]);
    let scene = scene(turn, vec![1.0, 0.0]);
    let reference = reference(&scene, 1.0);
    let h = 1.0 / 60.0;
    let errors = errors(&scene, "euler", Control::Step(h), &reference);
    // A step of Euler's method multiplies by 1 + i h.
    let (stretched, turned) = (1.0f64.hypot(h).powi(60), 60.0 * h.atan());
    let phase = stretched * (1.0 - turned).sin();
    assert_relative_eq!(errors.phase, phase, max_relative = 1e-9);
}

#[test]
fn every_method_steps_any_number_of_numbers_or_says_why_not() {
    for n in [1, 2, 4, 5, 7] {
        let f = |_, y: &[f64], dydt: &mut [f64]| {
            for (k, (dydt, y)) in dydt.iter_mut().zip(y).enumerate() {
                *dydt = -(1.0 + k as f64) * y;
            }
        };
        let scene = scene(f, vec![1.0; n]);
        for method in integrators::METHODS {
            let control =
                if method.is_adaptive() { Control::Tolerance(1e-8) } else { Control::Step(1e-3) };
            let run = Simulation::new(scene.clone(), method, control);
            if method.needs_mechanics() {
                let why = Refusal::LacksMasses;
                let method = method.title;
                assert_eq!(run.err(), Some(Error::Unsupported { method, why }));
                continue;
            }
            let mut run = run.unwrap();
            run.advance_to(0.5).unwrap();
            let exact: Vec<_> = (0..n).map(|k| (-0.5 * (1.0 + k as f64)).exp()).collect();
            let error = rms(run.state(), &exact);
            assert!(error < 2e-3, "{} {n}: {error:e}", method.name);
            let then = run.checkpoint();
            run.advance_to(0.7).unwrap();
            let later = run.state().to_vec();
            run.restore(&then).unwrap();
            run.advance_to(0.7).unwrap();
            assert_eq!(run.state(), later, "{}", method.name);
        }
    }
}

#[test]
fn a_state_within_a_step_is_on_its_polynomial() {
    // RK4 is exact for it, and so is the polynomial between its steps.
    let cubic = scene(|t, _, dydt| dydt[0] = 3.0 * t * t, vec![0.0]);
    let mut run = Simulation::new(cubic, method("rk4"), Control::Step(0.5)).unwrap();
    for t in [0.1f64, 0.4, 0.77, 1.3] {
        run.advance_to(t).unwrap();
        assert_relative_eq!(run.state()[0], t.powi(3), max_relative = 1e-13);
    }
}

#[test]
fn plain_numbers_grow_far_and_are_lost_where_they_are_none() {
    let growth = scene(|_, y, dydt| dydt[0] = y[0], vec![1.0]);
    let mut run = Simulation::new(growth, method("dop853"), Control::Tolerance(1e-10)).unwrap();
    run.advance_to(20.0).unwrap();
    assert_relative_eq!(run.state()[0], 20f64.exp(), max_relative = 1e-8);

    for name in ["euler", "rk4", "dopri5", "implicit"] {
        let f = |t, _: &[f64], dydt: &mut [f64]| {
            dydt.copy_from_slice(&[0.0, if t > 0.5 { f64::NAN } else { 1.0 }]);
        };
        let control =
            if method(name).is_adaptive() { Control::Tolerance(1e-6) } else { Control::Step(0.1) };
        let mut run = Simulation::new(scene(f, vec![0.0; 2]), method(name), control).unwrap();
        let Err(Error::BlowUp(lost)) = run.advance_to(1.0) else { panic!("{name} went on") };
        let named = match lost.cause {
            Cause::NumberNotFinite { index } => index == 1,
            Cause::StepTooSmall { .. } => method(name).is_adaptive(),
            Cause::NoConvergence { .. } => method(name).is_implicit(),
            _ => false,
        };
        assert!(named, "{name}: {lost}");
        assert!(run.state().iter().all(|y| y.is_finite()));
    }
}

#[test]
fn what_needs_particles_is_refused() {
    let (scene, go_on) = (kepler(), || true);
    let frames = Frames::new(1.0);
    let of = |scope, metric| {
        let precision = Precision { metric, uncertainty: 1e-6, max_work: f64::INFINITY };
        Reference::new(&scene, frames, scope, precision, &go_on).err()
    };
    let says = |error: Option<Error>, words: &str| {
        let error = error.map_or(String::new(), |error| error.to_string());
        assert!(error.contains(words), "{error}");
    };
    let all = Scope::default();
    for metric in [Metric::Position, Metric::Energy, Metric::Strain] {
        says(of(all, metric), "ask for the error of the state");
    }
    let beyond = Scope { particle: Some(9), ..all };
    says(of(beyond, Metric::State), "the scene has no number 9");
    let reference = reference(&scene, 1.0);
    let chosen = choose(&scene, &reference, Metric::Energy, 1e-3, &go_on, |_| {});
    says(chosen.err(), "ask for the error of the state");
    // They have none of these, and say so.
    let run = Simulation::new(scene.clone(), method("rk4"), Control::Step(0.1)).unwrap();
    assert_eq!((run.particles(), run.positions().nrows()), (0, 0));
    assert!(run.energy().is_none());
    assert_eq!(run.velocities(), [0.0, 3f64.sqrt(), -4.0, 0.0]);
    assert_eq!(scene.extent().1, 3f64.sqrt());
    let none = Scene::new(
        "none",
        Model::FirstOrder(Arc::new(Plain(0, |_, _: &[f64], _: &mut [f64]| {}))),
        vec![],
    );
    says(Simulation::new(none, method("rk4"), Control::Step(0.1)).err(), "one number");
}

#[test]
#[should_panic(expected = "out of bounds")]
fn plain_numbers_have_no_position() {
    let run = Simulation::new(kepler(), method("rk4"), Control::Step(0.1)).unwrap();
    let _ = run.position(0);
}

#[test]
fn chaos_of_plain_numbers_has_a_horizon() {
    let lorenz = |_, y: &[f64], dydt: &mut [f64]| {
        dydt[0] = 10.0 * (y[1] - y[0]);
        dydt[1] = y[0] * (28.0 - y[2]) - y[1];
        dydt[2] = y[0] * y[1] - 8.0 / 3.0 * y[2];
    };
    let found = horizon(&scene(lorenz, vec![-8.0, 8.0, 27.0]), 20.0, &|| true).unwrap().unwrap();
    // Its largest exponent is 0.906.
    assert!((0.5..2.5).contains(&found.lyapunov), "{found:?}");
    assert!(!found.buckles);
    let found = horizon(&decay(1.0), 5.0, &|| true).unwrap().unwrap();
    assert!(found.lyapunov.is_infinite());
    assert_relative_eq!(found.motion, 1.0 - (-5f64).exp(), max_relative = 1e-6);
}

/// A particle of 1 kg on a spring of 4 N/m to the origin.
struct Oscillator;

impl Mechanics for Oscillator {
    fn inverse_masses(&self) -> &[f64] {
        &[1.0]
    }

    fn forces(&self, _t: f64, x: &[f64], _v: &[f64], f: &mut [f64]) {
        for (f, x) in f.iter_mut().zip(x) {
            *f = -4.0 * x;
        }
    }
}

#[test]
fn own_forces_and_masses_have_particles() {
    let state = vec![1.0, 0.0, 0.0, 0.0, 2.0, 0.0];
    let model = Model::FirstOrder(Arc::new(Oscillator));
    let scene = Scene::new("oscillator", model, state);
    assert_eq!((scene.model.particles(), scene.extent().1), (1, 1.0));
    let reference = reference(&scene, 1.0);
    assert!(reference.floor.position < 1e-12);
    for (name, order) in [("verlet", 2.0), ("rk4", 4.0), ("implicit", 1.0)] {
        let error = |h: f64| errors(&scene, name, Control::Step(h), &reference).position;
        let (coarse, fine) = (error(1.0 / 120.0), error(1.0 / 240.0));
        assert!(((coarse / fine).log2() - order).abs() < 0.1, "{name}");
    }
    // The limit of RK4 is the root of 8 over w.
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let limit = largest_step(method("rk4"), &modes).unwrap().unwrap();
    assert_relative_eq!(limit.step, 2f64.sqrt(), max_relative = 0.01);
    let mut run = Simulation::new(scene, method("dop853"), Control::Tolerance(1e-10)).unwrap();
    run.advance_to(0.3).unwrap();
    assert_relative_eq!(run.position(0).x, 0.6f64.cos(), epsilon = 1e-8);
    assert_relative_eq!(run.velocities()[1], 2.0 * 0.6f64.cos(), epsilon = 1e-7);
}

/// A pulse of 1 ms in ten seconds, from rest: adaptive steps, which grow there, and fixed ones of
/// 0.3 s end at both of its edges, and the integral of the steps of f is exact by every method.
#[test]
fn known_jumps_end_steps() {
    let pulse = |jumps: &[f64]| {
        let f = |t: f64, _y: &[f64], dydt: &mut [f64]| {
            dydt[0] = if (5.0..5.001).contains(&t) { 1.0 } else { 0.0 };
        };
        let ode = Ode::new(1, f).unwrap().with_jumps(jumps.to_vec()).unwrap();
        Scene::new("pulse", ode, vec![0.0])
    };
    let mut tried = 0;
    for method in integrators::METHODS {
        let known = pulse(&[5.001, 5.0]);
        if method.check(known.model.system()).is_err() {
            continue;
        }
        let control =
            if method.is_adaptive() { Control::Tolerance(1e-6) } else { Control::Step(0.3) };
        let end = |scene: Scene| {
            let mut run = Simulation::new(scene, method, control).unwrap();
            run.advance_to(9.9).unwrap();
            run.state()[0]
        };
        let found = end(known);
        assert!((found - 1e-3).abs() < 1e-9, "{}: {found}", method.name);
        // Steps that end at the edges themselves, and a look within a step.
        if !method.is_adaptive() {
            for (h, at) in [(0.25, 5.2), (0.125, 6.0), (0.0005, 5.0007), (0.1, 5.0004), (0.7, 7.1)]
            {
                let scene = pulse(&[5.0, 5.001]);
                let mut run = Simulation::new(scene, method, Control::Step(h)).unwrap();
                run.advance_to(at).unwrap();
                let right = (at - 5.0).min(1e-3);
                let found = run.state()[0];
                assert!((found - right).abs() < 1e-9, "{} {h} {at}: {found}", method.name);
            }
        }
        let missed = end(pulse(&[]));
        assert!((missed - 1e-3).abs() > 1e-6, "{}: {missed}", method.name);
        tried += 1;
    }
    assert!(tried > 10, "{tried}");
    let wrong = Ode::new(1, |_, _: &[f64], _: &mut [f64]| {}).unwrap();
    assert!(wrong.with_jumps(vec![f64::NAN]).is_err());
}

/// y' = y cos t, plus a jump of f at -1, from the state at 0 back to that at -2.
#[test]
fn reversed_systems_go_back_in_time() {
    let f = |t: f64, y: &[f64], dydt: &mut [f64]| {
        dydt[0] = y[0] * t.cos();
        dydt[1] = if t >= -1.0 { 1.0 } else { 5.0 };
    };
    let jacobian = |t: f64, _: &[f64], out: &mut [f64]| {
        out.copy_from_slice(&[t.cos(), 0.0, 0.0, 0.0]);
    };
    for name in ["rk4", "dop853", "radau", "bdf"] {
        let system = Ode::new(2, f).unwrap().with_jacobian(jacobian);
        let system = system.with_jumps(vec![-1.0]).unwrap().reversed();
        let method = method(name);
        let control =
            if method.is_adaptive() { Control::Tolerance(1e-9) } else { Control::Step(0.003) };
        let scene = Scene::new("back", system, vec![1.0, 0.0]);
        let mut run = Simulation::new(scene, method, control).unwrap();
        run.advance_to(2.0).unwrap();
        let [grown, jumped] = [run.state()[0] - (-2f64).sin().exp(), run.state()[1] + 6.0];
        assert!(grown.abs() < 1e-6 && jumped.abs() < 1e-8, "{name}: {grown:e} {jumped:e}");
    }
}
