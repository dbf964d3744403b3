//! Functions of own systems and own methods that fail: runs end with their words.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::own::{plus, rotation};
use a3_core::accuracy::{Frames, Reference, horizon};
use a3_core::integrators::METHODS;
use a3_core::stability::{Budget, Motion};
use a3_core::{Cause, Control, Error, Method, Ode, Scene, Simulation};

/// A decay whose f fails from a time on.
fn failing(calls: &Arc<AtomicUsize>) -> Scene {
    let calls = calls.clone();
    let f = move |t: f64, y: &[f64], dydt: &mut [f64]| {
        calls.fetch_add(1, Ordering::Relaxed);
        dydt[0] = -y[0];
        if t > 0.5 { Err("no data after half a second") } else { Ok(()) }
    };
    Scene::new("failing", Ode::new(1, f).unwrap(), vec![1.0])
}

#[test]
fn a_failure_of_f_ends_a_run_with_its_own_words() {
    let told = Error::Callback("no data after half a second".into());
    for method in METHODS {
        let calls = Arc::new(AtomicUsize::new(0));
        let scene = failing(&calls);
        if method.check(scene.model.system()).is_err() {
            continue;
        }
        for control in [Control::Step(0.01), Control::Tolerance(1e-6)] {
            let Ok(mut run) = Simulation::new(scene.clone(), method, control) else {
                continue;
            };
            assert_eq!(run.advance_to(1.0), Err(told.clone()), "{}", method.name);
            let before = calls.load(Ordering::Relaxed);
            assert!(run.time() <= 0.51 && run.state()[0].is_finite());
            // The failure is over: the run may go on from there, and fails in the same way.
            assert_eq!(run.advance_to(1.0), Err(told.clone()), "{}", method.name);
            let again = calls.load(Ordering::Relaxed) - before;
            assert!(again < 1000, "{}: {again}", method.name);
        }
    }
    let calls = Arc::default();
    let scene = failing(&calls);
    let go_on = || true;
    let found = horizon(&scene, 2.0, &go_on).map(drop);
    assert_eq!(found, Err(told.clone()));
    let found = Reference::finest(&scene, Frames::new(2.0), &go_on).map(drop);
    assert_eq!(found, Err(told.clone()));
    let found = Motion::of(&scene, go_on).map(drop);
    assert_eq!(found, Err(told));
}

#[test]
fn a_failure_of_a_step_ends_a_run_with_its_own_words() {
    let scene = rotation(1.0);
    let failing = Method::from_step("own-failing", 1, |f, t, y, h| {
        if t > 0.3 {
            return Err(Error::Callback("the step gave up".into()));
        }
        Ok(plus(y, h, &f.at(t, y)?))
    });
    let failing = failing.unwrap().register();
    let mut run = Simulation::new(scene.clone(), failing, Control::Step(0.1)).unwrap();
    let told = Error::Callback("the step gave up".into());
    assert_eq!(run.advance_to(1.0), Err(told.clone()));
    let motion = Motion::of(&scene, || true).unwrap().unwrap();
    let budget = Budget::new(1e9);
    let bounded = motion.bounded(failing, &budget, || true);
    assert_eq!(bounded.map(drop), Err(told));

    let short = Method::from_step("own-short", 1, |_, _, y, _| Ok(y[1..].to_vec()));
    let mut run =
        Simulation::new(scene.clone(), short.unwrap().register(), Control::Step(0.1)).unwrap();
    let why = run.advance_to(1.0).unwrap_err().to_string();
    assert_eq!(why, "the method own-short returned 1 numbers, but the state has 2");

    let wrong = Method::from_step("own-wrong", 1, |f, t, _, _| f.at(t, &[0.0]));
    let mut run =
        Simulation::new(scene.clone(), wrong.unwrap().register(), Control::Step(0.1)).unwrap();
    let (expected, found) = (2, 1);
    assert_eq!(run.advance_to(1.0), Err(Error::Dimension { expected, found }));

    let nan = Method::from_step("own-nan", 1, |_, _, y, _| Ok(vec![f64::NAN; y.len()]));
    let mut run =
        Simulation::new(scene.clone(), nan.unwrap().register(), Control::Step(0.1)).unwrap();
    let Err(Error::BlowUp(blow_up)) = run.advance_to(1.0) else {
        panic!("NaN went unnoticed");
    };
    assert_eq!(blow_up.cause, Cause::NumberNotFinite { index: 0 });
}
