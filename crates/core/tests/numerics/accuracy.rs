//! Accuracy: the uncertainty of references, the errors of methods, and the choice of the cheapest
//! one.

use std::cell::Cell;
use std::time::Duration;

use crate::common::{errors, method, reference, scene};
use a3_core::accuracy::{
    Frames, Metric, Precision, Reference, Scope, choose, horizon, ladder, measure, measure_by,
};
use a3_core::stability::{Mode, spectrum};
use a3_core::{Control, Scene, integrators};

const GO_ON: &dyn Fn() -> bool = &|| true;

fn within(scene: &Scene, until: f64, scope: Scope) -> Reference {
    let precision = Precision::FINEST;
    Reference::new(scene, Frames::new(until), scope, precision, GO_ON).unwrap().unwrap()
}

fn modes(scene: &Scene) -> Vec<Mode> {
    spectrum(scene.model.system(), 0.0, &scene.state)
}

#[test]
fn on_the_circle_the_error_is_the_known_one() {
    let circle = scene("simple");
    let reference = reference(&circle, 10.0);
    assert!(reference.floor.position < 1e-11, "{:?}", reference.floor);
    for (name, h) in [("rk4", 0.1), ("euler", 1.0 / 120.0), ("trapezoid", 0.05), ("rk4", 0.5)] {
        let outcome =
            measure(&circle, method(name), Control::Step(h), &reference, GO_ON).unwrap().unwrap();
        // The same error, computed step by step against the sine and the cosine.
        let mut y = circle.state.clone();
        let mut integrator = method(name).integrator(circle.model.system()).unwrap();
        let mut worst: f64 = 0.0;
        let steps = (10.0 / h).round() as u64;
        for k in 0..steps {
            let t = k as f64 * h;
            integrator.step(circle.model.system(), t, h, &mut y).unwrap();
            let t = t + h;
            worst = worst.max((y[0] - t.cos()).hypot(y[1] - t.sin()));
        }
        let found = outcome.errors.position;
        assert!((found / worst - 1.0).abs() < 0.02, "{name}: {found:e}, {worst:e}");
        assert!(outcome.lost.is_none());
        assert!(outcome.work.evaluations >= steps);
    }
}

/// Frames within steps are interpolated so accurately that the error of a method of order 4 is the
/// same as if a step ended at each frame.
#[test]
fn frames_between_steps_show_no_error_of_their_own() {
    for name in ["chain", "mit", "simple"] {
        let scene = scene(name);
        let reference = reference(&scene, 2.0);
        let error = |steps: f64| {
            let control = Control::Step(2.0 / steps);
            let outcome = measure(&scene, method("rk4"), control, &reference, GO_ON);
            outcome.unwrap().unwrap()
        };
        for steps in [120.0, 360.0] {
            let (fits, odd) = (error(steps), error(steps + 1.0));
            let ratio = fits.errors.position / odd.errors.position;
            let expected = ((steps + 1.0) / steps).powi(4);
            println!("{name} {steps}: {ratio} {expected}");
            assert!((ratio / expected - 1.0).abs() < 0.01, "{name} {steps}: {ratio}");
            assert_eq!(odd.work.evaluations, 4 * (steps as u64 + 1));
        }
    }
}

/// The phase on a circle lags, one particle has its own error, and the end is not the worst moment.
#[test]
fn errors_are_of_what_was_asked_for() {
    let circle = scene("simple");
    let reference = reference(&circle, 5.0);
    let run = |reference: &Reference, scene: &Scene, name: &str, h: f64| {
        errors(scene, name, Control::Step(h), reference)
    };
    // The phase of Runge-Kutta on the circle lags by h^4 / 120 of the time.
    let errors = run(&reference, &circle, "rk4", 0.1);
    let lag = 5.0 * 0.1f64.powi(4) / 120.0;
    assert!((errors.phase / lag - 1.0).abs() < 0.01, "{} {lag}", errors.phase);
    assert!((reference.still.position - 2.0).abs() < 1e-3);

    // Gravity is exact in any step: only the pinned end changes the momentum of a chain.
    let chain = scene("chain");
    let scope = |particle, at_end| within(&chain, 2.0, Scope { particle, at_end });
    let error = |scope: &Reference| run(scope, &chain, "rk4", 1.0 / 30.0);
    let all = error(&scope(None, false));
    let each: Vec<_> = (0..4).map(|i| error(&scope(Some(i), true)).position).collect();
    let at_end = error(&scope(None, true)).position;
    let mean = (each.iter().map(|e| e * e).sum::<f64>() / 4.0).sqrt();
    assert!((mean / at_end - 1.0).abs() < 1e-6, "{mean} {at_end}");
    assert_eq!(each[0], 0.0);
    assert!(at_end < all.position && all.momentum > 0.0 && all.energy > 0.0);
    let none = Scope { particle: Some(4), at_end: false };
    let refused = Reference::new(&chain, Frames::new(1.0), none, Precision::FINEST, GO_ON);
    assert!(refused.is_err());
}

/// In this scene methods of order 4 have their order only at a hundredth of the largest stable
/// step; and a chart's precision costs less than the finest.
#[test]
fn references_are_refined_as_long_as_that_helps() {
    let random = crate::reference::scene_of("random");
    let finest = reference(&random, 3.0);
    assert!(finest.floor.position < 1e-8, "{:?}", finest.floor);
    let precision =
        Precision { metric: Metric::Position, uncertainty: 1e-3, max_work: f64::INFINITY };
    let frames = Frames::new(3.0);
    let coarse = Reference::new(&random, frames, Scope::default(), precision, GO_ON);
    let coarse = coarse.unwrap().unwrap();
    assert!(coarse.floor.position < 1e-3, "{:?}", coarse.floor);
    assert!(3.0 * coarse.work.total() < finest.work.total());
}

/// Scenes with collisions: their motion has kinks, at which no method keeps its order.
const KINKED: [&str; 2] = ["mit-sphere", "jelly"];

/// Scenes that are left out, because their finest references take minutes.
const LONG: [&str; 7] =
    ["flag", "drop", "dam-break", "cantilever", "boxes", "dominoes", "ball-on-cloth"];

/// The uncertainty of the reference is small on every scene without collisions.
#[test]
fn references_agree_with_themselves() {
    for entry in a3_scenes::SCENES.iter().filter(|entry| !LONG.contains(&entry.name)) {
        let scene = entry.build(None).unwrap().scene;
        let horizon = horizon(&scene, f64::INFINITY, GO_ON).unwrap().unwrap();
        let reference = reference(&scene, horizon.until);
        println!(
            "{:<11} until {} s, lyapunov {:.2} s, floor {:.1e} m {:.1e} J {:.1e}, {:?}",
            entry.name,
            horizon.until,
            horizon.lyapunov,
            reference.floor.position,
            reference.floor.energy,
            reference.floor.strain,
            reference.work.evaluations,
        );
        if !KINKED.contains(&entry.name) {
            // The double pendulum on rods is chaotic: runs separate within a second.
            let bound = if entry.name == "double-pendulum" { 1e-3 } else { 1e-7 };
            assert!(reference.floor.position < bound, "{}", entry.name);
        }
    }
}

#[test]
fn errors_fall_with_the_step_as_the_order_says() {
    let mit = scene("mit");
    let reference = reference(&mit, 0.5);
    for m in integrators::METHODS.iter().filter(|m| !m.is_adaptive()) {
        let h = reference.frames.spacing() / 32.0;
        let error = |h: f64| {
            let outcome = measure(&mit, m, Control::Step(h), &reference, GO_ON).unwrap().unwrap();
            outcome.errors.position
        };
        let (coarse, fine) = (error(h), error(0.5 * h));
        let order = (coarse / fine).log2();
        println!("{}: {coarse:.1e} {fine:.1e} {order:.2}", m.name);
        assert!(
            fine < 3.0 * reference.floor.position || (order - f64::from(m.order)).abs() < 0.3,
            "{}: {order}",
            m.name
        );
    }
}

#[test]
fn ladders_go_down_from_just_past_the_limit() {
    let mit = scene("mit");
    let (frames, modes) = (Frames::new(1.0), modes(&mit));
    for m in integrators::METHODS {
        let rungs = ladder(&modes, m, &frames, 20_000).unwrap();
        assert!(rungs.len() > 5, "{}", m.name);
        assert!(rungs.windows(2).all(|w| w[0].value() > w[1].value()), "{}: {rungs:?}", m.name);
        if !m.is_adaptive() {
            for rung in &rungs {
                let steps = 1.0 / rung.value();
                assert!((steps - steps.round()).abs() < 1e-6 && steps < 20_001.0);
            }
        }
    }
}

#[test]
fn looks_are_not_a_part_of_the_time_of_a_run() {
    let mit = scene("mit");
    let reference = reference(&mit, 0.5);
    // Steps that end at frames, steps that do not, and those of an adaptive method.
    let runs = [
        ("rk4", Control::Step(1.0 / 240.0)),
        ("rk4", Control::Step(0.5 / 77.0)),
        ("dopri5", Control::Tolerance(1e-4)),
    ];
    for (name, control) in runs {
        // This clock advances by a second whenever it is read, and also before and after each
        // frame.
        let reads = Cell::new(0);
        let clock = || {
            reads.set(reads.get() + 1);
            Duration::from_secs(reads.get())
        };
        let outcome = measure_by(&clock, &mit, method(name), control, &reference, &mut [], GO_ON);
        let looks = (reads.get() - 2) / 2;
        assert!(looks >= reference.frames.count, "{name}: {looks}");
        assert_eq!(outcome.unwrap().unwrap().time.as_secs(), looks + 1);
    }
}

#[test]
fn a_run_can_be_stopped() {
    let mit = scene("mit");
    let stop: &dyn Fn() -> bool = &|| false;
    assert!(Reference::finest(&mit, Frames::new(1.0), stop).unwrap().is_none());
    assert!(horizon(&mit, f64::INFINITY, stop).unwrap().is_none());
    let reference = reference(&mit, 0.1);
    assert!(measure(&mit, method("rk4"), Control::Step(0.01), &reference, stop).unwrap().is_none());
    assert!(choose(&mit, &reference, Metric::Position, 1e-3, stop, |_| ()).unwrap().is_none());
}

/// The least work of all runs that meet the error and cost less than `most`: of adaptive methods at
/// twenty tolerances, of others at numbers of steps a twentieth apart.
fn search(scene: &Scene, reference: &Reference, error: f64, most: f64) -> f64 {
    let mut best = most;
    let run = |m, control, best: &mut f64| {
        let outcome = measure(scene, m, control, reference, GO_ON).unwrap().unwrap();
        if outcome.lost.is_none() && outcome.errors.position <= error {
            *best = best.min(outcome.work.total());
        }
        outcome.work.total()
    };
    let all = integrators::METHODS.iter();
    for m in all.filter(|m| m.check(scene.model.system()).is_ok()) {
        if m.is_adaptive() {
            for k in 0..20 {
                let tolerance = 10f64.powf(-1.0 - 10.0 * f64::from(k) / 19.0);
                if run(m, Control::Tolerance(tolerance), &mut best) > best {
                    break;
                }
            }
        } else {
            let mut count = 4u64;
            while (count * u64::from(m.evaluations)) as f64 <= best {
                let control = Control::Step(reference.frames.until / count as f64);
                // Linear algebra adds to the evaluations.
                if run(m, control, &mut best) > 2.0 * best {
                    break;
                }
                count += 1 + count / 20;
            }
        }
    }
    best
}

/// The chosen method costs at most 1.3 times the cheapest run that a search of every method at many
/// steps and tolerances finds.
#[test]
fn the_choice_is_the_best() {
    // A search of all methods on jelly takes minutes, too.
    let entries = a3_scenes::SCENES.iter();
    let entries =
        entries.filter(|entry| ![LONG.as_slice(), &KINKED].concat().contains(&entry.name));
    let mut scenes: Vec<_> = entries.map(|entry| entry.build(None).unwrap().scene).collect();
    scenes.extend(["random", "jellyhang"].map(crate::reference::scene_of));
    for scene in scenes {
        let horizon = horizon(&scene, f64::INFINITY, GO_ON).unwrap().unwrap();
        let reference = reference(&scene, horizon.until.min(1.0));
        for error in [1e-2, 1e-4, 1e-6] {
            let found = choose(&scene, &reference, Metric::Position, error, GO_ON, |_| ())
                .unwrap()
                .unwrap();
            let pick = &found[0];
            let work = pick.outcome.work.total();
            let best = search(&scene, &reference, error, work);
            println!(
                "{:<11} {error:e}: {} {:.3e}, {work:.0} (best {best:.0}), then {:?}",
                scene.name,
                pick.method.name,
                pick.control.value(),
                found.get(1).map(|c| (c.method.name, c.control)),
            );
            assert!(pick.outcome.errors.position <= error);
            assert!(work <= 1.3 * best, "{} at {error:e}", scene.name);
        }
    }
}
