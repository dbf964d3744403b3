//! Radau IIA: published end values of stiff systems (Mazzia, Magherini, *Test set for initial value
//! problem solvers*, 2008), orders, dense output, and stiff motion that dies out.

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::common::{method, scene};
use crate::problems::{Problem, arenstorf, hires, oregonator, pleiades, robertson, van_der_pol};
use a3_core::accuracy::{Frames, Metric, Reference, choose, shown};
use a3_core::integrators::{Tolerance, Work};
use a3_core::{Control, Ode, ParticleSystem, Scene, Simulation};

/// Runs an adaptive method to the end. Returns the state there, the number of steps and the number
/// of evaluations.
fn run(name: &str, problem: &Problem, relative: f64) -> (Vec<f64>, u32, u64) {
    let tolerance = Tolerance::new(relative).unwrap();
    let system = &problem.system;
    let mut adaptive = method(name).adaptive(system, tolerance).unwrap();
    let (mut t, mut y, mut steps, mut work) = (0.0, problem.start.clone(), 0, 0);
    while t < problem.until {
        let taken = adaptive.advance(system, t, problem.until - t, &mut y).unwrap();
        (t, steps, work) = (t + taken.h, steps + 1, work + taken.work.evaluations);
    }
    (y, steps, work)
}

/// Largest error of a number over the largest number.
fn relative_error(found: &[f64], exact: &[f64]) -> f64 {
    let size = exact.iter().fold(0.0, |most: f64, y| most.max(y.abs()));
    let apart = found.iter().zip(exact).map(|(a, b)| (a - b).abs() / size);
    apart.fold(0.0, f64::max)
}

/// Radau to 1e-9 meets the published values to 2e-8 of the largest number: some numbers have been a
/// thousand times as large as they are in the end.
#[test]
fn published_values_are_met() {
    let problems = [
        ("van der Pol", van_der_pol(), 50_000),
        ("HIRES", hires(), 10_000),
        ("Oregonator", oregonator(), 50_000),
        ("Robertson", robertson(), 10_000),
    ];
    for (what, problem, most) in problems {
        let (y, steps, work) = run("radau", &problem, 1e-9);
        let error = relative_error(&y, &problem.end);
        println!("{what}: {error:.1e}, {steps} steps, {work} evaluations");
        assert!(error < 2e-8, "{what}: {error:e}");
        assert!(work < most, "{what}: {work}");
    }
}

/// A thousandth of the tolerance makes errors at least twenty times as small, and a tenth takes at
/// most 10^(1/4) = 1.8 times the steps, the estimate being of order 3.
#[test]
fn errors_follow_the_tolerance() {
    let problem = oregonator();
    let runs = [1e-6, 1e-7, 1e-8, 1e-9].map(|tolerance| {
        let (y, steps, _) = run("radau", &problem, tolerance);
        (relative_error(&y, &problem.end), f64::from(steps))
    });
    println!("{runs:?}");
    assert!(runs.windows(2).all(|pair| pair[1].1 < 2.0 * pair[0].1));
    assert!(runs[3].0 < 0.05 * runs[0].0);
}

/// The growth of a step on y' = -y is the Pade approximation of exp(-h) with degrees 2 and 3.
#[test]
fn a_step_on_a_decay_is_a_pade_approximation() {
    let decay = Ode::new(1, |_: f64, y: &[f64], dydt: &mut [f64]| dydt[0] = -y[0]).unwrap();
    for h in [0.01, 0.1, 1.0, 10.0, 1e6] {
        let mut radau = method("radau").integrator(&decay).unwrap();
        let mut y = [1.0];
        radau.step(&decay, 0.0, h, &mut y).unwrap();
        let above = 1.0 - 0.4 * h + h * h / 20.0;
        let below = 1.0 + 0.6 * h + 0.15 * h * h + h * h * h / 60.0;
        assert!((y[0] - above / below).abs() < 1e-12, "{h}: {}", y[0]);
    }
}

/// The polynomial of a step is exact for a cubic, which is in the space of collocation.
#[test]
fn states_within_a_step_are_on_the_polynomial() {
    let cubic = Ode::new(1, |t: f64, _: &[f64], dydt: &mut [f64]| {
        dydt[0] = 3.0 * t * t;
    })
    .unwrap();
    let tolerance = Tolerance::new(1e-3).unwrap();
    let mut radau = method("radau").adaptive(&cubic, tolerance).unwrap();
    let (mut t, mut y) = (0.0, [0.0]);
    while t < 2.0 {
        t += radau.advance(&cubic, t, 2.0 - t, &mut y).unwrap().h;
        let time = t - 0.3 * radau.last().h;
        let mut within = [0.0];
        let _ = radau.interpolate(&cubic, time, &mut within);
        assert!((within[0] - time.powi(3)).abs() < 1e-13 * t.powi(3).max(1.0));
    }
}

/// Where stiffness makes ends exact, states within steps obey the tolerance too.
#[test]
fn states_within_stiff_steps_obey_the_tolerance() {
    for k in [1.0, 1e2, 1e4, 1e6, 1e8] {
        let follower = Ode::new(1, move |t: f64, y: &[f64], dydt: &mut [f64]| {
            dydt[0] = -k * (y[0] - t.cos());
        })
        .unwrap();
        // The transient is k^2 / (1 + k^2) smaller than the start.
        let slow = |t: f64| (k * k * t.cos() + k * t.sin()) / (1.0 + k * k);
        let exact = |t: f64| slow(t) + (1.0 - slow(0.0)) * (-k * t).exp();
        for relative in [1e-4, 1e-6, 1e-8] {
            let tolerance = Tolerance::new(relative).unwrap();
            let mut radau = method("radau").adaptive(&follower, tolerance).unwrap();
            let (mut t, mut y, mut steps, mut off) = (0.0, [1.0], 0, [0.0f64; 2]);
            while t < 10.0 {
                let taken = radau.advance(&follower, t, 10.0 - t, &mut y).unwrap();
                for part in 1..20 {
                    let time = t + f64::from(part) / 20.0 * taken.h;
                    let mut within = [0.0];
                    let _ = radau.interpolate(&follower, time, &mut within);
                    off[0] = off[0].max((within[0] - exact(time)).abs());
                }
                (t, steps) = (t + taken.h, steps + 1);
                off[1] = off[1].max((y[0] - exact(t)).abs());
            }
            println!("k {k:e}, tolerance {relative:e}: {steps} steps, {off:?}");
            assert!(off[0] < 10.0 * relative, "{k:e} {relative:e} {off:?}");
        }
    }
}

#[test]
fn networks_are_refused_in_one_line() {
    let refused = method("radau").check(scene("chain").model.system());
    let words = refused.unwrap_err().to_string();
    assert!(words.contains("bdf") && !words.contains('\n'), "{words}");
}

/// The reference of a system, checked by another family of methods, costs few calls, and its
/// distance from the published state is at most ten times its floor, which is small.
#[test]
fn references_of_published_problems_are_true_and_cheap() {
    for (what, problem, is_stiff) in [
        ("van der Pol", van_der_pol(), true),
        ("HIRES", hires(), true),
        ("Oregonator", oregonator(), true),
        ("Arenstorf", arenstorf(), false),
        ("Pleiades", pleiades(), false),
    ] {
        let (until, end) = (problem.until, problem.end.clone());
        let calls = problem.calls.clone();
        let scene = problem.scene();
        let frames = Frames { until, count: 60 };
        let reference = Reference::finest(&scene, frames, &|| true).unwrap().unwrap();
        let [y, _] = reference.motion(&scene.model, until);
        let squares = y.iter().zip(&end).map(|(a, b)| (a - b).powi(2));
        let error = (squares.sum::<f64>() / end.len() as f64).sqrt();
        let (floor, calls) = (reference.floor.state, calls.load(Ordering::Relaxed));
        println!("{what}: error {error:.1e}, floor {floor:.1e}, {calls} calls");
        assert_eq!(reference.is_stiff, is_stiff, "{what}");
        assert!(error <= 10.0 * floor, "{what}: {error:e} {floor:e}");
        assert!(floor < 1e-6 && calls < 500_000, "{what}: {floor:e} {calls}");
    }
}

/// The cheapest method for a solution that stiffness k does not change is an implicit one, and the
/// search costs no more at larger k, nor where explicit methods would do, too.
#[test]
fn a_choice_on_a_stiff_system_costs_no_more_the_stiffer_it_is() {
    for k in [10.0, 30.0, 100.0, 1e3, 1e5, 1e8] {
        let calls = Arc::new(AtomicU64::new(0));
        let counter = calls.clone();
        let system = Ode::new(1, move |t: f64, y: &[f64], dydt: &mut [f64]| {
            counter.fetch_add(1, Ordering::Relaxed);
            dydt[0] = -k * (y[0] - t.cos());
        });
        let scene = Scene::new("follower", system.unwrap(), vec![1.0]);
        let frames = Frames { until: 2.0, count: 60 };
        let reference = Reference::finest(&scene, frames, &|| true).unwrap();
        let reference = reference.unwrap();
        let found = choose(&scene, &reference, Metric::State, 1e-4, &|| true, |_| {});
        let best = found.unwrap().unwrap()[0];
        let seen = shown(&scene, best.method, best.control, &reference, &|| true);
        assert!(seen.unwrap().unwrap().at_ends.state < 1e-4);
        // y = (k^2 cos t + k sin t) / (1 + k^2), after a transient that decays at once.
        let exact = (k * k * 2f64.cos() + k * 2f64.sin()) / (1.0 + k * k);
        let mut run = Simulation::new(scene, best.method, best.control).unwrap();
        run.advance_to(2.0).unwrap();
        let (off, count) = (run.state()[0] - exact, calls.load(Ordering::Relaxed));
        println!("{k:e}: {} {}, {off:.1e}, {count} calls", best.method.name, best.control);
        assert!(best.method.is_implicit() && off.abs() < 1e-4 && count < 50_000);
    }
}

/// Heat in a rod of n parts whose mean warms all of them: the linear algebra of a step grows faster
/// with n than the work of an evaluation, by which it is counted.
#[test]
fn work_counts_linear_algebra() {
    let rod = |parts: usize, cost: Option<f64>| {
        let squared = (parts as f64 + 1.0).powi(2);
        let system = Ode::new(parts, move |_: f64, y: &[f64], dydt: &mut [f64]| {
            let mean = y.iter().sum::<f64>() / parts as f64;
            for i in 0..parts {
                let left = if i == 0 { 0.0 } else { y[i - 1] };
                let right = y.get(i + 1).copied().unwrap_or_default();
                dydt[i] = squared * (left - 2.0 * y[i] + right) + mean;
            }
        });
        let system = system.unwrap();
        match cost {
            Some(cost) => system.with_evaluation_cost(cost).unwrap(),
            None => system,
        }
    };
    let work = |name: &str, system: Ode| {
        let start = vec![1.0; system.dim()];
        let scene = Scene::new("rod", system, start);
        let control = Control::Tolerance(1e-4);
        let mut run = Simulation::new(scene, method(name), control).unwrap();
        run.advance_to(0.1).unwrap();
        run.work()
    };
    for name in ["radau", "bdf"] {
        let [few, many] = [20, 200].map(|parts| work(name, rod(parts, None)));
        let share = |work: Work| work.algebra / work.evaluations as f64;
        assert!(share(many) > 1.5 * share(few), "{name}: {few:?} {many:?}");
        let own = rod(200, None).evaluation_cost();
        let dear = work(name, rod(200, Some(10.0 * own)));
        assert_eq!(dear.evaluations, many.evaluations);
        assert!((10.0 * dear.algebra / many.algebra - 1.0).abs() < 1e-9);
        assert!((many.total() - many.algebra - many.evaluations as f64).abs() < 1e-6);
    }
    assert!(Ode::new(1, |_: f64, _: &[f64], _: &mut [f64]| ()).is_ok_and(|system| {
        let none = system.with_evaluation_cost(0.0);
        none.is_err_and(|why| why.to_string().contains("cost of an evaluation"))
    }));
}

/// Steps that Newton's method cannot solve as a whole, or for which an old Jacobian leads to
/// another solution, are divided, and errors are those of the methods' orders.
#[test]
fn implicit_methods_with_fixed_steps_solve_stiff_systems() {
    let mut kinetics = robertson();
    kinetics.until = 40.0;
    // By Radau at a tolerance of 1e-10.
    kinetics.end = vec![0.715_827_068_720_645, 9.185_534_764_481_7e-6, 0.284_163_745_744_591];
    let oregonator = oregonator();
    for (problem, name, step, most) in [
        (&kinetics, "tr-bdf2", 0.1, 1e-7),
        (&kinetics, "tr-bdf2", 4.0, 1e-4),
        (&kinetics, "implicit-midpoint", 0.1, 1e-5),
        (&kinetics, "implicit", 0.1, 1e-3),
        (&kinetics, "implicit", 1.0, 1e-2),
        (&oregonator, "tr-bdf2", 0.1, 0.02),
        (&oregonator, "tr-bdf2", 0.5, 0.05),
        (&oregonator, "implicit", 0.01, 0.05),
    ] {
        let mut integrator = method(name).integrator(&problem.system).unwrap();
        let mut y = problem.start.clone();
        let count = (problem.until / step).round() as u32;
        let mut work = Work::default();
        let before = problem.calls.load(Ordering::Relaxed);
        for k in 0..count {
            let taken = integrator.step(&problem.system, f64::from(k) * step, step, &mut y);
            work += taken.unwrap();
        }
        let (error, calls) =
            (relative_error(&y, &problem.end), problem.calls.load(Ordering::Relaxed) - before);
        println!("{name} {step}: {error:.1e}, {} evaluations", work.evaluations);
        assert!(error < most, "{name} in steps of {step} s: {error:.1e}");
        // Steps that were given up count, too.
        assert_eq!(work.evaluations, calls, "{name} in steps of {step} s");
    }
}
