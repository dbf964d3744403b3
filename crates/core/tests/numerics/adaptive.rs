//! Adaptive methods: errors and costs, dense output, the first step, and the failure if no step
//! meets the tolerance.

use std::f64::consts::TAU;

use crate::common::{distance, integrate, method, scene, simulation, size};
use a3_core::integrators::{Taken, Tolerance};
use a3_core::{Cause, Control, Error, Method, Ode, ParticleSystem, Scene, Simulation, integrators};

/// Largest error at the ends of the steps, and number of steps, for ten revolutions on the circle.
fn circle(name: &str, relative: f64) -> (f64, usize) {
    let circle = scene("simple");
    let system = circle.model.system();
    let mut adaptive = method(name).adaptive(system, Tolerance::new(relative).unwrap()).unwrap();
    let (mut t, mut y, mut worst, mut steps) = (0.0, circle.state.clone(), 0.0f64, 0);
    while t < 10.0 * TAU {
        t += adaptive.advance(system, t, f64::INFINITY, &mut y).unwrap().h;
        steps += 1;
        worst = worst.max((y[0] - t.cos()).hypot(y[1] - t.sin()));
    }
    (worst, steps)
}

#[test]
fn errors_and_steps_on_the_circle() {
    // Errors and accepted steps of SciPy and other libraries at relative tolerances of 1e-3, 1e-6,
    // 1e-9.
    for (name, listed) in [
        ("dopri5", [(1.4e-2, 72), (6.1e-6, 329), (6.0e-9, 1337)]),
        ("rkf45", [(4.8e-2, 82), (9.7e-5, 362), (3.6e-7, 1469)]),
    ] {
        for (relative, (error, steps)) in [1e-3, 1e-6, 1e-9].into_iter().zip(listed) {
            let (e, n) = circle(name, relative);
            println!("{name} at {relative:e}: error {e:.2e} ({error:.1e}), {n} steps ({steps})");
            assert!(e < 2.0 * error && n < 2 * steps, "{name} {relative:e}");
        }
    }
    let (error, steps) = circle("dop853", 1e-9);
    assert!(error < 1e-7 && steps < 200, "{error:e}, {steps}");
}

/// Dense output has its order: the largest error within a step falls as h to the power order + 1.
#[test]
fn dense_output_has_its_order() {
    for (name, order) in [("dopri5", 4), ("rkf45", 4), ("dop853", 7)] {
        let circle = scene("simple");
        let system = circle.model.system();
        // One step of length h, which a loose tolerance accepts.
        let error = |h: f64| {
            let mut adaptive = method(name).adaptive(system, Tolerance::new(1e3).unwrap()).unwrap();
            adaptive.try_first(h);
            let mut y = circle.state.clone();
            let Taken { h: taken, .. } =
                adaptive.advance(system, 0.0, f64::INFINITY, &mut y).unwrap();
            assert_eq!(taken, h);
            let mut worst: f64 = 0.0;
            for k in 0..=20 {
                let t = h * f64::from(k) / 20.0;
                let mut out = vec![0.0; 3];
                adaptive.interpolate(system, t, &mut out);
                worst = worst.max((out[0] - t.cos()).hypot(out[1] - t.sin()));
                if k == 20 {
                    assert!(distance(&out, &y) < 1e-15);
                }
            }
            worst
        };
        let (coarse, fine) = (error(0.4), error(0.2));
        let measured = (coarse / fine).log2() - 1.0;
        println!("{name}: {coarse:.2e} {fine:.2e}: order {measured:.2}");
        assert!((measured - f64::from(order)).abs() < 0.25, "{name}: {measured}");
    }
}

/// The state at a time does not depend on the frames before it, and frames cost no steps.
#[test]
fn frames_cost_no_steps() {
    for name in ["dopri5", "rkf45", "dop853", "verner65", "dprkn86", "dprkn1210"] {
        for scene_name in ["mit", "chain"] {
            let mut often = simulation(scene_name, name, 1e-5);
            let mut once = simulation(scene_name, name, 1e-5);
            for k in 1..=300 {
                often.advance_to(f64::from(k) / 300.0).unwrap();
            }
            once.advance_to(1.0).unwrap();
            assert_eq!(often.state(), once.state(), "{name} {scene_name}");
            assert_eq!(often.steps(), once.steps());
            assert_eq!(often.time(), 1.0);
        }
    }
}

#[test]
fn an_adaptive_run_takes_part_in_everything() {
    let mut run = simulation("cloth", "dopri5", 1e-4);
    assert_eq!((run.control(), run.step_size()), (Control::Tolerance(1e-4), None));
    run.take_steps(5).unwrap();
    assert_eq!(run.steps(), 5);
    assert!(run.step_size().unwrap() > 1e-4 && run.time() > 0.0);
    // A hand grabs in the middle of a step: the rest of the step is discarded.
    run.advance_to(run.time() + 0.001).unwrap();
    run.grab(399).unwrap();
    let from = run.position(399);
    run.pull(from + a3_core::Vector3::new(0.3, 0.2, 0.5));
    run.advance_to(run.time() + 0.2).unwrap();
    assert!((run.position(399) - from).norm() > 0.5);
    run.release();
    run.set_wind(true);
    run.set_swinging(true);
    run.advance_to(1.0).unwrap();
    assert!(run.largest_stretch().unwrap() < 3.0);
    run.reset();
    let fresh = {
        let mut fresh = simulation("cloth", "dopri5", 1e-4);
        fresh.set_wind(true);
        fresh.set_swinging(true);
        fresh.advance_to(0.3).unwrap();
        fresh.state().to_vec()
    };
    run.advance_to(0.3).unwrap();
    assert_eq!(run.state(), fresh);
    run.set_method(method("rk4"), Control::Step(0.002)).unwrap();
    run.take_steps(10).unwrap();
    assert!((run.time() - 0.32).abs() < 1e-12);
    run.set_method(method("dop853"), Control::Tolerance(1e-7)).unwrap();
    run.advance_to(0.5).unwrap();
    assert_eq!(run.time(), 0.5);
    assert!(run.set_control(Control::Tolerance(0.0)).is_err());
}

#[test]
fn a_fixed_step_of_an_adaptive_method_stays_a_step() {
    let mut run =
        Simulation::new(crate::common::scene("mit"), method("dopri5"), Control::Step(0.01))
            .unwrap();
    run.take_steps(30).unwrap();
    let state = run.state().to_vec();
    assert_eq!((run.time(), run.step_size()), (0.3, Some(0.01)));
    run.reset();
    assert_eq!(run.control(), Control::Step(0.01));
    run.take_steps(30).unwrap();
    assert_eq!((run.state(), run.time()), (&state[..], 0.3));
    run.set_control(Control::Step(0.005)).unwrap();
    run.take_steps(20).unwrap();
    assert_eq!((run.time(), run.steps()), (0.4, 50));
    // An explicit change of control goes from a step to a tolerance and back.
    run.set_control(Control::Tolerance(1e-6)).unwrap();
    run.advance_to(0.5).unwrap();
    assert!(run.work().total() > 0.0 && run.step_size() != Some(0.005));
    run.set_control(Control::Step(0.01)).unwrap();
    run.take_steps(10).unwrap();
    assert_eq!(run.time(), 0.6);
}

#[test]
fn a_tolerance_is_for_methods_that_estimate_their_error() {
    let start = |control| Simulation::new(crate::common::scene("mit"), method("rk4"), control);
    let error = start(Control::Tolerance(1e-3)).err().unwrap().to_string();
    assert!(error.contains("estimates no error"), "{error}");
    let mut run = start(Control::Step(0.01)).unwrap();
    assert!(run.set_control(Control::Tolerance(1e-3)).is_err());
    assert!(run.set_method(method("rk4"), Control::Tolerance(1e-3)).is_err());
    assert_eq!(run.control(), Control::Step(0.01));
}

/// The error on stiff cloth falls with the tolerance.
#[test]
fn a_tighter_tolerance_is_more_accurate_on_cloth() {
    let reference = {
        let mut run = simulation("mit", "dop853", 1e-11);
        run.advance_to(1.0).unwrap();
        run.state().to_vec()
    };
    for name in ["dopri5", "rkf45", "dop853", "verner65"] {
        let mut last = f64::INFINITY;
        for relative in [1e-3, 1e-5, 1e-7] {
            let mut run = simulation("mit", name, relative);
            run.advance_to(1.0).unwrap();
            let error = distance(&run.state()[..675], &reference[..675]);
            println!("{name} {relative:e}: {error:.2e} {:?}", run.work());
            assert!(error < 0.1 * last && error < 1e4 * relative);
            last = error;
        }
    }
}

/// System y' = y^2, whose solution from y = 1 has a pole at t = 1 s.
struct Pole;

impl ParticleSystem for Pole {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        for (dydt, y) in dydt.iter_mut().zip(y) {
            *dydt = y * y;
        }
    }
}

#[test]
fn where_no_step_will_do_it_says_so() {
    let serving = |m: &&Method| m.is_adaptive() && !m.needs_mechanics();
    for m in integrators::METHODS.iter().filter(serving) {
        let tolerance = Tolerance::new(1e-6).unwrap();
        let mut adaptive = m.adaptive(&Pole, tolerance).unwrap();
        let (mut t, mut y) = (0.0, vec![1.0; 3]);
        let error = loop {
            match adaptive.advance(&Pole, t, f64::INFINITY, &mut y) {
                Ok(taken) => t += taken.h,
                Err(error) => break error,
            }
        };
        // The pole is found with the method's error on the way to it.
        let off = if m.is_implicit() { 1e-4 } else { 1e-5 };
        assert!(
            matches!(error, Error::StepTooSmall { time, .. } if (time - 1.0).abs() < off),
            "{}: {error:?}",
            m.name
        );
        assert!(size(&y).is_finite());
        assert!(error.to_string().contains("no step meets the tolerance"));
    }
    // A run that fails like this reports a blow-up: it neither hangs nor panics.
    let mut bare = scene("simple");
    bare.model = a3_core::Model::Points(std::sync::Arc::new(Pole));
    bare.state = vec![1.0, 0.5, 0.25];
    let mut run = Simulation::new(bare, method("dopri5"), Control::Tolerance(1e-6)).unwrap();
    let Err(Error::BlowUp(lost)) = run.advance_to(2.0) else {
        panic!("past a pole");
    };
    assert!(matches!(lost.cause, Cause::StepTooSmall { .. } | Cause::Away { .. }));
}

/// System whose derivative is NaN from a time on (s).
struct Undefined(f64);

impl ParticleSystem for Undefined {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, t: f64, _y: &[f64], dydt: &mut [f64]) {
        dydt.fill(if t < self.0 { 1.0 } else { f64::NAN });
    }
}

#[test]
fn a_derivative_that_is_no_number_ends_a_run() {
    let serving = |m: &&Method| !m.needs_mechanics();
    for m in integrators::METHODS.iter().filter(serving) {
        for from in [0.0, 0.2] {
            let mut bare = scene("simple");
            bare.model = a3_core::Model::Points(std::sync::Arc::new(Undefined(from)));
            bare.state = vec![1.0; 3];
            let control =
                if m.is_adaptive() { Control::Tolerance(1e-6) } else { Control::Step(0.05) };
            let mut run = Simulation::new(bare, m, control).unwrap();
            let Err(Error::BlowUp(lost)) = run.advance_to(1.0) else {
                panic!("{}: it went on without a derivative", m.name);
            };
            let named = match lost.cause {
                Cause::NotFinite { particle: 0 } => true,
                Cause::StepTooSmall { .. } => m.is_adaptive() && from > 0.0,
                Cause::NoConvergence { .. } => m.is_implicit(),
                _ => false,
            };
            assert!(named, "{}: {:?}", m.name, lost.cause);
        }
    }
}

#[test]
fn tolerances_that_make_no_sense_are_refused() {
    for relative in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        let error = Tolerance::new(relative).unwrap_err().to_string();
        assert!(error.contains("the tolerance must be"), "{error}");
    }
}

/// Adaptive methods can also take fixed steps.
#[test]
fn pairs_take_fixed_steps_too() {
    let circle = scene("simple");
    for (name, error) in [("dopri5", 1e-8), ("rkf45", 1e-7), ("dop853", 1e-13)] {
        let y = integrate(circle.model.system(), method(name), &circle.state, 0.05, 100);
        let (sin, cos) = 5f64.sin_cos();
        let found = (y[0] - cos).hypot(y[1] - sin);
        assert!(found < error, "{name}: {found:e}");
    }
}

#[test]
fn fixed_steps_of_bdf_alone_are_those_of_another_method() {
    let all = integrators::METHODS;
    for (k, a) in all.iter().enumerate() {
        for b in &all[..k] {
            let same = a.shares_integrator(b);
            assert_eq!(same, [b.name, a.name] == ["tr-bdf2", "bdf"], "{}", a.name);
        }
    }
}

/// Numbers of mixed size: an epidemic that one patient brings to ten million, and an oscillator of
/// a millionth beside one of 1, which it is not to disturb.
#[test]
fn each_number_of_a_plain_system_has_its_own_size() {
    let serving = |m: &&Method| m.is_adaptive() && !m.needs_mechanics();
    for m in integrators::METHODS.iter().filter(serving) {
        let epidemic = Ode::new(3, |_t, y, dydt| {
            let (infections, recoveries) = (0.5 * y[0] * y[1] / 1e7, 0.1 * y[1]);
            dydt.copy_from_slice(&[-infections, infections - recoveries, recoveries]);
        });
        let scene = Scene::new("epidemic", epidemic.unwrap(), vec![1e7 - 1.0, 1.0, 0.0]);
        let mut run = Simulation::new(scene, m, m.default_control).unwrap();
        // By RK4 with steps of 2 ms.
        for (time, ill) in [(20.0, 2_979.571_36), (40.0, 3_600_335.65)] {
            run.advance_to(time).unwrap();
            let off = run.state()[1] / ill - 1.0;
            assert!(off.abs() < 0.02, "{} at {time} s: {off:.1e}", m.name);
        }
        let pair = Ode::new(4, |_t, y, dydt| {
            dydt.copy_from_slice(&[y[1], -y[0], 4.0 * y[3], -4.0 * y[2]]);
        });
        let scene = Scene::new("pair", pair.unwrap(), vec![1.0, 0.0, 1e-6, 0.0]);
        let mut run = Simulation::new(scene, m, Control::Tolerance(1e-6)).unwrap();
        run.advance_to(20.0).unwrap();
        let y = run.state();
        let off = (y[2] - 1e-6 * 80f64.cos()).hypot(y[3] + 1e-6 * 80f64.sin());
        assert!(off < 1e-8, "{}: {off:.1e}", m.name);
    }
}

/// A number that others cancel in is rounding, and one below its scale does not count.
#[test]
fn numbers_that_do_not_count_cost_nothing() {
    let steps = |epsilon: f64, scales: Option<Vec<f64>>| {
        // The third number is a difference of two equal ones, the fourth a fast, tiny oscillation.
        let system = Ode::new(5, move |_t, y, dydt| {
            let cancelled = (y[0] + 0.1) - y[0] - 0.1;
            let fast = [100.0 * y[4], -100.0 * y[3]];
            dydt.copy_from_slice(&[y[1], -y[0], cancelled, fast[0], fast[1]]);
        });
        let system = system.unwrap();
        let system = match scales {
            Some(scales) => system.with_scales(scales).unwrap(),
            None => system,
        };
        let scene = Scene::new("mixed", system, vec![1.0, 0.0, 0.0, epsilon, 0.0]);
        let tolerance = Control::Tolerance(1e-8);
        let mut run = Simulation::new(scene, method("dopri5"), tolerance).unwrap();
        run.advance_to(10.0).unwrap();
        run.steps()
    };
    let (alone, counted) = (steps(0.0, None), steps(1e-6, None));
    // Stability limits the steps where the oscillation does not count.
    let ignored = steps(1e-6, Some(vec![1.0; 5]));
    println!("{alone}, {counted}, {ignored} steps");
    assert!(counted > 20 * alone && counted > 3 * ignored);
    assert!(Ode::new(1, |_t, _y, _dydt| ()).unwrap().with_scales(vec![0.0]).is_err());
}

/// Scales and an absolute tolerance say two things about the same error.
#[test]
fn an_absolute_tolerance_beside_scales_is_refused() {
    let decay = Ode::new(1, |_t, y, dydt| dydt[0] = -y[0]).unwrap();
    let scaled = decay.with_scales(vec![1e-3]).unwrap();
    let mut scene = Scene::new("decay", scaled, vec![1.0]);
    assert!(scene.tolerance(1e-3).is_ok());
    scene.limits.absolute = Some(1e-6);
    let refused = Simulation::new(scene, method("dopri5"), Control::Tolerance(1e-3));
    let refused = refused.err().unwrap().to_string();
    assert!(refused.contains("leave out the scales, or the absolute tolerance"), "{refused}");
}
