//! Own methods and own systems from functions, against the built-in ones and exact answers.

use std::f64::consts::FRAC_1_SQRT_2;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use approx::assert_relative_eq;

use crate::common::{method, reference};
use a3_core::accuracy::{Demand, Frames, Metric, Reference, choose_among, measure};
use a3_core::integrators::{METHODS, View, find};
use a3_core::stability::{largest_step, spectrum};
use a3_core::{
    Control, Error, Integrator, Method, Model, Ode, ParticleSystem, Scene, SecondOrder, Simulation,
    Work,
};

/// y + a k.
pub fn plus(y: &[f64], a: f64, k: &[f64]) -> Vec<f64> {
    y.iter().zip(k).map(|(y, k)| y + a * k).collect()
}

/// Own classical Runge-Kutta method.
fn rk4(name: &str) -> Method {
    Method::from_step(name, 4, |f, t, y, h| {
        let k1 = f.at(t, y)?;
        let k2 = f.at(t + 0.5 * h, &plus(y, 0.5 * h, &k1))?;
        let k3 = f.at(t + 0.5 * h, &plus(y, 0.5 * h, &k2))?;
        let k4 = f.at(t + h, &plus(y, h, &k3))?;
        let mut end = y.to_vec();
        for (weight, k) in [(1.0, k1), (2.0, k2), (2.0, k3), (1.0, k4)] {
            end = plus(&end, weight * h / 6.0, &k);
        }
        Ok(end)
    })
    .unwrap()
}

/// Own explicit Euler method.
fn euler(name: &str) -> Method {
    Method::from_step(name, 1, |f, t, y, h| Ok(plus(y, h, &f.at(t, y)?))).unwrap()
}

/// A rotation y' = (-w y2, w y1) from (1, 0).
pub fn rotation(w: f64) -> Scene {
    let f = move |_t: f64, y: &[f64], dydt: &mut [f64]| {
        dydt.copy_from_slice(&[-w * y[1], w * y[0]]);
    };
    Scene::new("rotation", Ode::new(2, f).unwrap(), vec![1.0, 0.0])
}

#[test]
fn an_own_rk4_takes_the_steps_of_the_built_in_one() {
    let own = rk4("own-rk4").register();
    let built_in = method("rk4");
    for name in ["cloth", "pendulum", "chain"] {
        let scene = a3_scenes::find(name).unwrap().build(None).unwrap().scene;
        let run = |method| {
            let mut run =
                Simulation::new(scene.clone(), method, Control::Step(1.0 / 512.0)).unwrap();
            run.take_steps(100).unwrap();
            (run.state().to_vec(), run.work().evaluations)
        };
        let ((a, evaluations), (b, same)) = (run(own), run(built_in));
        assert_eq!(evaluations, same);
        let size = b.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
        let apart = a.iter().zip(&b).map(|(a, b)| (a - b).abs());
        let apart = apart.fold(0.0, f64::max);
        assert!(apart <= 1e-12 * size, "{name}: {apart:e} of {size}");
    }
}

/// The pair of Bogacki and Shampine as a function takes the steps that it takes as a tableau.
#[test]
fn an_own_step_with_an_estimate_takes_the_steps_of_its_tableau() {
    let other = [7.0 / 24.0, 0.25, 1.0 / 3.0, 0.125];
    let b = [2.0 / 9.0, 1.0 / 3.0, 4.0 / 9.0];
    let a = [vec![], vec![0.5], vec![0.0, 0.75]];
    let tableau = Method::from_tableau("own-bs23", &a, &b, Some(&other), &[]).unwrap();
    let own = Method::from_estimated_step("own-estimated", 3, move |f, t, y, h| {
        let k1 = f.at(t, y)?;
        let k2 = f.at(t + 0.5 * h, &plus(y, 0.5 * h, &k1))?;
        let k3 = f.at(t + 0.75 * h, &plus(y, 0.75 * h, &k2))?;
        let combined = |y: &[f64], weights: &[f64]| {
            let pairs = weights.iter().zip([&k1, &k2, &k3]);
            pairs.fold(y.to_vec(), |y, (b, k)| plus(&y, b * h, k))
        };
        let end = combined(y, &b);
        let k4 = f.at(t + h, &end)?;
        let apart: Vec<_> = b.iter().zip(other).map(|(b, other)| b - other).collect();
        let estimate = combined(&vec![0.0; y.len()], &apart);
        Ok([end, plus(&estimate, -other[3] * h, &k4)])
    });
    let [own, tableau] = [own.unwrap(), tableau].map(Method::register);
    assert!(own.is_own() && own.is_adaptive());
    let run = |method, tolerance| {
        let control = Control::Tolerance(tolerance);
        let mut run = Simulation::new(rotation(3.0), method, control).unwrap();
        // A time within a step.
        run.advance_to(1.0).unwrap();
        (run.steps(), run.state().to_vec())
    };
    for tolerance in [1e-4, 1e-7] {
        let ((steps, ours), (same, theirs)) = (run(own, tolerance), run(tableau, tolerance));
        assert_eq!(steps, same);
        for (ours, theirs) in ours.iter().zip(&theirs) {
            assert!((ours - theirs).abs() < 1e-12, "{ours} {theirs}");
        }
        let error = (ours[0] - 3.0_f64.cos()).hypot(ours[1] - 3.0_f64.sin());
        assert!(error < 30.0 * tolerance, "{error:e}");
    }
}

/// State at the end of a step and the estimate of its error, from t (s) and the state before it.
type Estimated = fn(f64, &[f64]) -> Result<[Vec<f64>; 2], Error>;

#[test]
fn an_own_step_with_an_estimate_says_why_it_fails() {
    let fails = |name: &str, step: Estimated| {
        let method = Method::from_estimated_step(name, 2, move |_, t, y, _| step(t, y));
        let method = method.unwrap().register();
        let run = Simulation::new(rotation(1.0), method, Control::Tolerance(1e-3));
        run.unwrap().advance_to(1.0).unwrap_err().to_string()
    };
    let why = fails("own-late", |t, y| match t {
        0.0 => Ok([y.to_vec(), vec![0.0; y.len()]]),
        _ => Err(Error::Callback("no more".into())),
    });
    assert!(why.contains("no more"), "{why}");
    let why = fails("own-short", |_, y| Ok([y.to_vec(), vec![0.0]]));
    assert!(why.contains("own-short returned 1 numbers"), "{why}");
}

#[test]
fn names_are_checked_and_found() {
    let refused = |name: &str| match euler_named(name) {
        Err(Error::Invalid(why)) => why,
        other => panic!("{name}: {other:?}"),
    };
    for name in ["", "two words", "a\nb", &"x".repeat(41)] {
        assert!(refused(name).contains("word"), "{name}");
    }
    for taken in METHODS {
        let letter = taken.letter.unwrap().to_string();
        let names = taken.aliases.iter().copied().chain([taken.name, &*letter]);
        for name in names {
            assert!(refused(name).contains(taken.title), "{name}");
        }
    }
    let order = Method::from_step("own", 0, |_, _, y, _| Ok(y.to_vec()));
    assert!(matches!(order, Err(Error::Invalid(why)) if why.contains("order")));

    assert!(find("own-named").is_none());
    let first = euler("own-named").register();
    assert!(std::ptr::eq(find("own-named").unwrap(), first));
    let second = euler("own-named").with_title("the second").register();
    assert!(std::ptr::eq(find("own-named").unwrap(), second));
    assert!(first.is_own() && first.letter.is_none() && !METHODS[0].is_own());
    assert!(first.shares_integrator(second));
    assert!(!first.shares_integrator(method("euler")));
    assert!(!method("euler").shares_integrator(rk4("own-other").register()));
}

/// Solver of another library: classical Runge-Kutta steps of tol^(1/4) s, to each time in turn.
fn another(name: &str) -> Result<Method, Error> {
    Method::foreign(name, |f, times, y0, tolerance| {
        let (mut t, mut y, mut states) = (0.0, y0.to_vec(), vec![]);
        for &time in times {
            let count = ((time - t) / tolerance.powf(0.25)).ceil();
            let h = (time - t) / count;
            for k in 0..count as u32 {
                let t = t + f64::from(k) * h;
                let k1 = f.at(t, &y)?;
                let k2 = f.at(t + 0.5 * h, &plus(&y, 0.5 * h, &k1))?;
                let k3 = f.at(t + 0.5 * h, &plus(&y, 0.5 * h, &k2))?;
                let k4 = f.at(t + h, &plus(&y, h, &k3))?;
                for (weight, k) in [(1.0, k1), (2.0, k2), (2.0, k3), (1.0, k4)] {
                    y = plus(&y, weight * h / 6.0, &k);
                }
            }
            t = time;
            states.extend_from_slice(&y);
        }
        Ok(states)
    })
}

/// A solver of another library has the errors and the evaluations of the same steps by a3's own.
#[test]
fn a_solver_of_another_library_is_measured_beside_others() {
    let foreign = another("Another RK4").unwrap().register();
    assert!(foreign.is_foreign() && foreign.is_adaptive() && !method("rk4").is_foreign());
    assert_eq!(find("Another RK4"), Some(foreign));
    let scene = rotation(3.0);
    let frames = Frames { until: 2.0, count: 20 };
    let reference = Reference::finest(&scene, frames, &|| true).unwrap().unwrap();
    let of = |method, control| measure(&scene, method, control, &reference, &|| true);
    // Two steps of 0.05 s to each frame.
    let own = of(method("rk4"), Control::Step(0.05)).unwrap().unwrap();
    let found = of(foreign, Control::Tolerance(0.05f64.powi(4) * 1.000_001));
    let found = found.unwrap().unwrap();
    assert_relative_eq!(found.errors.state, own.errors.state, max_relative = 1e-6);
    assert_eq!(found.work.evaluations, 4 * 40);

    let refused = Simulation::new(scene.clone(), foreign, Control::Tolerance(1e-6));
    let why = refused.err().unwrap().to_string();
    assert!(why.contains("takes no steps"), "{why}");
    assert!(foreign.check(crate::common::scene("chain").model.system()).is_err());
    assert!(of(foreign, Control::Step(0.1)).is_err());
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    assert_eq!(largest_step(foreign, &modes).unwrap(), None);
    assert!(another("\n").is_err() && another("rk4").is_err());

    let with = |states: Vec<f64>| {
        let method = Method::foreign("short", move |_, _, _, _| Ok(states.clone()));
        of(method.unwrap().register(), Control::Tolerance(1e-6))
    };
    let short = with(vec![0.0; 3]).unwrap_err().to_string();
    assert!(short.contains("returned 3 numbers"), "{short}");
    let mut states = vec![0.0; 2 * 20];
    states[5] = f64::NAN;
    let lost = with(states).unwrap().unwrap().lost.unwrap();
    assert_relative_eq!(lost.time, 0.3);
}

fn euler_named(name: &str) -> Result<Method, Error> {
    Method::from_step(name, 1, |f, t, y, h| Ok(plus(y, h, &f.at(t, y)?)))
}

/// Explicit Euler multiplies a decay of rate r by 1 - h r: it is stable up to h = 2 / r. It lets
/// any oscillation grow.
#[test]
fn the_limits_of_an_own_euler_are_exact() {
    let own = euler("own-limits").register();
    let decay = Ode::new(1, |_t, y, dydt| dydt[0] = -50.0 * y[0]).unwrap();
    let modes = spectrum(&decay, 0.0, &[1.0]);
    let limit = largest_step(own, &modes).unwrap().unwrap();
    assert_relative_eq!(limit.bounded, 0.04, max_relative = 1e-8);

    let scene = rotation(3.0);
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let limit = largest_step(own, &modes).unwrap().unwrap();
    assert_eq!(limit.bounded, 0.0);
    // In ten seconds, or a thousand steps if these are longer, it grows tenfold.
    let steps = (10.0 / limit.step).max(1000.0);
    let growth = (0.5 * steps * (3.0 * limit.step).powi(2).ln_1p()).exp();
    assert_relative_eq!(growth, 10.0, max_relative = 1e-6);
}

/// Damped spring x'' = -k x - d x', on one coordinate.
fn spring(k: f64, d: f64) -> SecondOrder {
    SecondOrder::of_coordinates(&[1.0], move |_t, x, v, f| f[0] = -k * x[0] - d * v[0]).unwrap()
}

/// Symplectic Euler on a spring of frequency w is stable up to h w = 2.
#[test]
fn an_own_integrator_kicks_an_own_spring() {
    struct Kick;
    impl Integrator for Kick {
        fn step(
            &mut self,
            system: &dyn ParticleSystem,
            t: f64,
            h: f64,
            y: &mut [f64],
        ) -> Result<Work, Error> {
            let mechanics = system.mechanics().unwrap();
            let (x, v) = y.split_at_mut(y.len() / 2);
            let mut a = vec![0.0; v.len()];
            mechanics.accelerations(t, x, v, &mut a);
            for ((x, v), a) in x.iter_mut().zip(v).zip(a) {
                *v += h * a;
                *x += h * *v;
            }
            Ok(Work::of(1))
        }
    }
    let own = Method::new("own-kick", 1, |_| Box::new(Kick))
        .unwrap()
        .with_view(View::Kicks)
        .with_evaluations(1)
        .register();
    let spring = spring(25.0, 0.0).positional();
    let y = spring.state(&[1.0], &[0.0]).unwrap();
    let modes = spectrum(&spring, 0.0, &y);
    assert_eq!(modes.len(), 1);
    let limit = largest_step(own, &modes).unwrap().unwrap();
    assert_relative_eq!(limit.step, 2.0 / 5.0, max_relative = 1e-6);

    let scene = Scene::new("spring", spring, y);
    let run = |method| {
        let mut run = Simulation::new(scene.clone(), method, Control::Step(0.01)).unwrap();
        run.take_steps(100).unwrap();
        run.state().to_vec()
    };
    let (a, b) = (run(own), run(method("symplectic")));
    assert!((a[0] - b[0]).abs() < 1e-14 && a[0] != 1.0);
    assert!(own.check(rotation(1.0).model.system()).is_err());
}

/// All methods solve an own system of three coordinates, x'' = -k x - d x' + g(t), each with its
/// own mass; with and without its Jacobian implicit methods find the same states.
#[test]
fn every_method_runs_own_systems_of_any_dimension() {
    let masses = [1.0, 2.0, 0.5];
    let forces = |t: f64, x: &[f64], v: &[f64], f: &mut [f64]| {
        for (k, f) in f.iter_mut().enumerate() {
            *f = -9.0 * x[k] - 0.3 * v[k] + (2.0 * t).cos();
        }
        f[0] += x[1] * x[2];
    };
    let plain = || SecondOrder::of_coordinates(&masses, forces).unwrap();
    let exact = || {
        plain().with_jacobian(|_t, x, _v, of_x, of_v| {
            for k in 0..3 {
                of_x[4 * k] = -9.0;
                of_v[4 * k] = -0.3;
            }
            of_x[1] = x[2];
            of_x[2] = x[1];
        })
    };
    let state = plain().state(&[1.0, -1.0, 0.5], &[0.0, 1.0, 0.0]).unwrap();
    assert_eq!(state.len(), 18);
    assert!(plain().state(&[1.0], &[0.0]).is_err());
    let scene = |system: SecondOrder| Scene::new("three", system, state.clone());
    let end = |scene: &Scene, method, control| {
        let mut run = Simulation::new(scene.clone(), method, control).unwrap();
        run.advance_to(1.0).unwrap();
        (run.state().to_vec(), run.work())
    };
    let (truth, _) = end(&scene(plain()), method("dop853"), Control::Tolerance(1e-12));
    // The other axes stay 0.
    assert!(truth[3..9].iter().chain(&truth[12..]).all(|y| *y == 0.0));
    let apart = |a: &[f64]| {
        let pairs = a.iter().zip(&truth);
        pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    };
    let mut count = 0;
    for method in METHODS {
        if method.check(scene(plain()).model.system()).is_err() {
            continue;
        }
        count += 1;
        let (y, work) = end(&scene(plain()), method, Control::Step(1e-3));
        assert!(apart(&y) < 0.01, "{}: {}", method.name, apart(&y));
        let (z, less) = end(&scene(exact()), method, Control::Step(1e-3));
        assert!(apart(&z) < 0.01, "{}", method.name);
        if method.is_implicit() {
            assert!(less.total() < work.total(), "{}", method.name);
            let differ = y.iter().zip(&z).map(|(y, z)| (y - z).abs());
            assert!(differ.fold(0.0, f64::max) < 1e-7, "{}", method.name);
        } else {
            assert_eq!(y, z);
        }
    }
    assert!(count > 12, "{count}");
    let positional = spring(9.0, 0.0).positional();
    let many = METHODS.iter().filter(|m| m.check(&positional).is_ok());
    assert!(many.count() > count);
}

/// The eigenvalues of Van der Pol's oscillator at (2, 0), with and without its Jacobian.
#[test]
fn modes_come_from_an_own_jacobian() {
    let f = |_t: f64, y: &[f64], dydt: &mut [f64]| {
        dydt.copy_from_slice(&[y[1], 5.0 * (1.0 - y[0] * y[0]) * y[1] - y[0]]);
    };
    let calls = Arc::new(AtomicUsize::new(0));
    let counted = calls.clone();
    let exact = Ode::new(2, f).unwrap().with_jacobian(move |_t, y, out| {
        counted.fetch_add(1, Ordering::Relaxed);
        out.copy_from_slice(&[0.0, 1.0, -10.0 * y[0] * y[1] - 1.0, 5.0 * (1.0 - y[0] * y[0])]);
    });
    // l^2 + 15 l + 1 = 0.
    let fastest = f64::midpoint(15.0, (15.0f64 * 15.0 - 4.0).sqrt());
    for system in [&exact, &Ode::new(2, f).unwrap()] {
        let modes = spectrum(system, 0.0, &[2.0, 0.0]);
        let euler = largest_step(method("euler"), &modes).unwrap().unwrap();
        assert_relative_eq!(euler.bounded, 2.0 / fastest, max_relative = 1e-6);
    }
    assert_eq!(calls.load(Ordering::Relaxed), 1);
}

/// An own Heun's method has order 2 on an own system, and is chosen among methods where it is the
/// cheapest.
#[test]
fn own_methods_are_measured_and_chosen() {
    let heun = Method::from_step("own-heun", 2, |f, t, y, h| {
        let a = f.at(t, y)?;
        let b = f.at(t + h, &plus(y, h, &a))?;
        Ok(plus(&plus(y, 0.5 * h, &a), 0.5 * h, &b))
    });
    let heun = heun.unwrap().register();
    let scene = rotation(2.0);
    let go_on = || true;
    let reference = reference(&scene, 1.0);
    let error = |step: f64| {
        let outcome = measure(&scene, heun, Control::Step(step), &reference, &go_on);
        outcome.unwrap().unwrap().errors.state
    };
    let order = (error(0.01) / error(0.005)).log2();
    assert!((order - 2.0).abs() < 0.02, "{order}");
    // The error of a step in the phase is (h w)^3 / 6.
    let exact = FRAC_1_SQRT_2 * (2.0 * 0.005f64).powi(3) / 6.0 * 200.0;
    assert_relative_eq!(error(0.005), exact, max_relative = 0.01);

    let among = [heun, euler("own-cheap").register(), method("euler")];
    let demand = Demand { metric: Metric::State, error: 1e-3, timed: false };
    let found = choose_among(&among, &scene, &reference, demand, &go_on, |_| {});
    let found = found.unwrap().unwrap();
    assert_eq!(found[0].method.name, "own-heun");
    assert!(found[0].outcome.errors.state <= 1e-3);
}

#[test]
fn systems_that_make_no_sense_are_refused() {
    let no_forces = |_t: f64, _x: &[f64], _v: &[f64], _f: &mut [f64]| {};
    assert!(Ode::new(0, |_t, _y, _dydt| ()).is_err());
    for masses in [&[][..], &[0.0], &[-1.0], &[f64::NAN], &[1.0, f64::INFINITY]] {
        assert!(SecondOrder::of_particles(masses, no_forces).is_err());
        assert!(SecondOrder::of_coordinates(masses, no_forces).is_err());
    }
    let ball = SecondOrder::of_particles(&[2.0], |_t, _x, _v, f: &mut [f64]| f[1] = -19.62);
    let ball = ball.unwrap().positional();
    let y = ball.state(&[0.0; 3], &[3.0, 4.0, 0.0]).unwrap();
    let mut run = Simulation::new(
        Scene::new("ball", Model::from(ball), y),
        method("dprkn86"),
        Control::Step(2.0),
    )
    .unwrap();
    run.take_steps(1).unwrap();
    assert_relative_eq!(run.state()[0], 6.0, epsilon = 1e-12);
    assert_relative_eq!(run.state()[1], 8.0 - 0.5 * 9.81 * 4.0, epsilon = 1e-12);
}
