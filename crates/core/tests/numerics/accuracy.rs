//! Accuracy: the uncertainty of references, the errors of methods, and the choice of the cheapest
//! one.

use crate::common::{method, scene};
use a3_core::accuracy::{
    Frames, Metric, Precision, Reference, Scope, choose, horizon, ladder, measure,
};
use a3_core::stability::{Mode, spectrum};
use a3_core::{Control, Scene, integrators};

const GO_ON: &dyn Fn() -> bool = &|| true;

fn reference(scene: &Scene, until: f64) -> Reference {
    Reference::finest(scene, Frames::new(until), GO_ON)
        .unwrap()
        .unwrap()
}

fn within(scene: &Scene, until: f64, scope: Scope) -> Reference {
    let precision = Precision::FINEST;
    Reference::new(scene, Frames::new(until), scope, precision, GO_ON)
        .unwrap()
        .unwrap()
}

fn modes(scene: &Scene) -> Vec<Mode> {
    spectrum(scene.model.system(), 0.0, &scene.state)
}

#[test]
fn on_the_circle_the_error_is_the_known_one() {
    let circle = scene("simple");
    let reference = reference(&circle, 10.0);
    assert!(reference.floor.position < 1e-11, "{:?}", reference.floor);
    for (name, h) in [
        ("rk4", 0.1),
        ("euler", 1.0 / 120.0),
        ("trapezoid", 0.05),
        ("rk4", 0.5),
    ] {
        let outcome = measure(&circle, method(name), Control::Step(h), &reference, GO_ON)
            .unwrap()
            .unwrap();
        // The same error, computed step by step against the sine and the cosine.
        let mut y = circle.state.clone();
        let mut integrator = method(name).integrator(circle.model.system()).unwrap();
        let mut worst: f64 = 0.0;
        let steps = (10.0 / h).round() as u64;
        for k in 0..steps {
            let t = k as f64 * h;
            integrator
                .step(circle.model.system(), t, h, &mut y)
                .unwrap();
            let t = t + h;
            worst = worst.max((y[0] - t.cos()).hypot(y[1] - t.sin()));
        }
        let found = outcome.errors.position;
        assert!(
            (found / worst - 1.0).abs() < 0.02,
            "{name}: {found:e}, {worst:e}"
        );
        assert!(outcome.lost.is_none());
        assert!(outcome.work.evaluations >= steps);
    }
}

/// Scenes with collisions: their motion has kinks, at which no method keeps its order.
const KINKED: [&str; 2] = ["mit-sphere", "jelly"];

/// The uncertainty of the reference is small on every scene without collisions.
#[test]
fn references_agree_with_themselves() {
    // The flag is left out, because its finest reference takes three million evaluations.
    for entry in a3_scenes::SCENES
        .iter()
        .filter(|entry| entry.name != "flag")
    {
        let scene = entry.build(None).unwrap().scene;
        let horizon = horizon(&scene, GO_ON).unwrap().unwrap();
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
            let bound = if entry.name == "double-pendulum" {
                1e-3
            } else {
                1e-7
            };
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
            let outcome = measure(&mit, m, Control::Step(h), &reference, GO_ON)
                .unwrap()
                .unwrap();
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
        assert!(
            rungs.windows(2).all(|w| w[0].value() > w[1].value()),
            "{}: {rungs:?}",
            m.name
        );
        if !m.is_adaptive() {
            for rung in &rungs {
                let steps = 1.0 / rung.value();
                assert!((steps - steps.round()).abs() < 1e-6 && steps < 20_001.0);
            }
        }
    }
}

#[test]
fn a_run_can_be_stopped() {
    let mit = scene("mit");
    let stop: &dyn Fn() -> bool = &|| false;
    assert!(
        Reference::finest(&mit, Frames::new(1.0), stop)
            .unwrap()
            .is_none()
    );
    assert!(horizon(&mit, stop).unwrap().is_none());
    let reference = reference(&mit, 0.1);
    assert!(
        measure(&mit, method("rk4"), Control::Step(0.01), &reference, stop)
            .unwrap()
            .is_none()
    );
    assert!(
        choose(&mit, &reference, Metric::Position, 1e-3, stop, |_| ())
            .unwrap()
            .is_none()
    );
}

/// The chosen method costs at most 1.3 times the cheapest run that a search of every method at many
/// steps and tolerances finds.
#[test]
fn the_choice_is_the_best() {
    // The jelly and the flag are left out, because a search of all methods on them takes minutes.
    let entries = a3_scenes::SCENES.iter();
    for entry in entries.filter(|entry| !["flag", "jelly"].contains(&entry.name)) {
        let scene = entry.build(None).unwrap().scene;
        let horizon = horizon(&scene, GO_ON).unwrap().unwrap();
        let reference = reference(&scene, horizon.until.min(1.0));
        let mut runs: Vec<(f64, f64)> = vec![];
        let modes = modes(&scene);
        let all = integrators::METHODS.iter();
        for m in all.filter(|m| m.check(scene.model.system()).is_ok()) {
            for control in ladder(&modes, m, &reference.frames, 4000).unwrap() {
                let outcome = measure(&scene, m, control, &reference, GO_ON)
                    .unwrap()
                    .unwrap();
                if outcome.lost.is_none() {
                    runs.push((outcome.errors.position, outcome.work.total()));
                }
            }
        }
        for error in [1e-2, 1e-4, 1e-6] {
            let best = runs
                .iter()
                .filter(|(e, _)| *e <= error)
                .map(|(_, work)| *work)
                .fold(f64::INFINITY, f64::min);
            let found = choose(&scene, &reference, Metric::Position, error, GO_ON, |_| ())
                .unwrap()
                .unwrap();
            let Some(pick) = found.first() else {
                assert!(
                    best.is_infinite(),
                    "{} at {error:e}: nothing, but {best}",
                    entry.name
                );
                continue;
            };
            println!(
                "{:<11} {error:e}: {} {:.3e}, {:.0} (best {best:.0}), then {:?}",
                entry.name,
                pick.method.name,
                pick.control.value(),
                pick.outcome.work.total(),
                found.get(1).map(|c| (c.method.name, c.control)),
            );
            assert!(pick.outcome.errors.position <= error);
            assert!(
                pick.outcome.work.total() <= 1.3 * best,
                "{} at {error:e}",
                entry.name
            );
        }
    }
}
