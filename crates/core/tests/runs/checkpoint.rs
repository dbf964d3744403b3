//! Checkpoints: a restored run continues with the same bits.

use a3_core::integrators::METHODS;
use a3_core::{Checkpoint, Control, Method, Network, Path, Pin, Scene, Simulation, Vector3};

use super::common::{described, method, on_all_cores, scene, simulation, takes_minutes};

/// Action on a run, after which it takes steps.
type Act = fn(&mut Simulation);

/// Everything that can be observed of a run, to the bit.
fn seen(run: &Simulation) -> (String, Vec<u64>) {
    let network = run.model().network();
    let pins: Vec<_> = network.into_iter().flat_map(Network::pins).collect();
    let bits: Vec<_> = run.state().iter().map(|y| y.to_bits()).collect();
    let rest = format!(
        "{:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {:?} {pins:?}",
        run.time().to_bits(),
        run.steps(),
        run.work(),
        run.step_size(),
        (run.method().name, run.control()),
        (run.windy(), run.swinging(), run.pinned()),
        run.grabbed(),
        run.blow_up(),
        (run.gained(), run.energy_change()),
        network.map(Network::torn),
    );
    (rest, bits)
}

/// Checkpoint after writing it as JSON and reading it again.
fn through_text(checkpoint: &Checkpoint) -> Checkpoint {
    let text = serde_json::to_string(checkpoint).unwrap();
    let again = serde_json::from_str(&text).unwrap();
    assert_eq!(checkpoint, &again);
    again
}

/// New run, restored from a checkpoint.
fn taken_up(scene: &Scene, checkpoint: &Checkpoint) -> Simulation {
    let mut fresh = Simulation::new(scene.clone(), method("euler"), Control::Step(0.01)).unwrap();
    fresh.restore(checkpoint).unwrap();
    fresh
}

/// Performs the actions on a run one after another. After each, runs restored from its checkpoints
/// continue beside it until the next, and all stay equal. Every third one has been a text.
fn check(scene: &Scene, method: &'static Method, control: Control, acts: &[Act]) {
    let mut run = Simulation::new(scene.clone(), method, control).unwrap();
    let mut others: Vec<Simulation> = vec![];
    let alike = |run: &Simulation, others: &[Simulation], k: usize| {
        for other in others {
            assert!(seen(run) == seen(other), "{} by {} after {k}", scene.name, method.name);
        }
    };
    for (k, act) in acts.iter().enumerate() {
        for run in std::iter::once(&mut run).chain(&mut others) {
            act(run);
            // First to a time within a step of an adaptive method, then to the end of a step.
            let _ = run.advance_to(run.time() + 0.013);
            let _ = run.take_steps(2);
        }
        alike(&run, &others, k);
        others = vec![taken_up(scene, &run.checkpoint())];
        assert_eq!(run.checkpoint(), others[0].checkpoint());
        // Still within the step in which the checkpoint was made.
        for run in std::iter::once(&mut run).chain(&mut others) {
            let _ = run.advance_to(run.time() + 0.0017);
        }
        alike(&run, &others, k);
        let kept = run.checkpoint();
        let kept = if k % 3 == 0 { through_text(&kept) } else { kept };
        others.push(taken_up(scene, &kept));
    }
}

const HANDS: &[Act] = &[
    |_| (),
    |run| run.set_wind(true),
    |run| run.set_swinging(true),
    |run| {
        run.grab(run.particles() - 1).unwrap();
        run.pull(run.position(run.particles() - 1) + Vector3::new(0.1, 0.05, 0.2));
    },
    |run| {
        let _ = run.toggle_pin(run.particles() / 2);
        let _ = run.grab_obstacle(0);
        run.pull_obstacle(Vector3::new(0.5, -3.0, 0.0));
    },
    |run| run.set_pinned(false),
    |run| run.release(),
    |run| {
        run.release_obstacle();
        run.set_swinging(false);
        run.set_pinned(true);
    },
    |run| run.set_wind(false),
];

#[test]
fn every_scene_goes_on_by_every_method() {
    on_all_cores(a3_scenes::SCENES, |entry| {
        let setup = entry.build(None).unwrap();
        for method in METHODS {
            if method.check(setup.scene.model.system()).is_ok()
                && !takes_minutes(method, &setup.scene)
            {
                let control = match setup.defaults.control_of(method) {
                    // Shorter steps, as for Euler's method with bodies, would test nothing more.
                    Control::Step(step) => Control::Step(step.max(5e-4)),
                    tolerance @ Control::Tolerance(_) => tolerance,
                };
                check(&setup.scene, method, control, HANDS);
            }
        }
    });
}

#[test]
fn fixed_steps_of_an_adaptive_method_stay_fixed() {
    check(&scene("mit"), method("dopri5"), Control::Step(0.01), HANDS);
}

#[test]
fn what_is_torn_stays_torn() {
    let scene = described(
        "tear = 1.2
        gravity = [0, -9.81, 0]
        springs = [[0, 12, 1, 0.6, 0.001], [1, 13, 1, 0.6, 0.001], [2, 14, 1, 0.6, 0.001]]
        [wind]
        on = true
        velocity = [3, 0, 1]
        [[sphere]]
        center = [0.5, -0.5, 0.4]
        radius = 0.1
        sine = { amplitude = [0, 0, 0.3], rate = 5 }
        [[cloth]]
        grid = [6, 5]
        width = 1
        mass = 0.01
        stiffness = [20, 10, 5]
        damping_ratio = 0.1
        pin = [{ at = ['left'] }, { at = ['right'], shift = { by = [0.9, 0, 0], start = 0, end = 0.1 } }]",
    );
    let acts: &[Act] = &[|_| (), |_| (), |run| run.set_wind(false), |_| (), |_| ()];
    for method in METHODS.iter().filter(|m| !m.positions_only() && !m.plain_only()) {
        let control = method.control(if method.is_adaptive() { 1e-5 } else { 0.005 });
        check(&scene, method, control, acts);
        let mut run = Simulation::new(scene.clone(), method, control).unwrap();
        run.advance_to(0.1).unwrap();
        assert!(run.tears() > 5, "{}: {}", method.name, run.tears());
    }
}

/// A restored run that blows up later goes back to the same state as the original run.
#[test]
fn a_run_that_is_lost_later_is_lost_alike() {
    let mut run = simulation("mit", "rk4", 0.05);
    run.take_steps(3).unwrap();
    let mut again = taken_up(run.scene(), &through_text(&run.checkpoint()));
    while run.take_steps(1).is_ok() {}
    while again.take_steps(1).is_ok() {}
    assert!(run.blow_up().is_some() && seen(&run) == seen(&again));
    // The checkpoint of a run that blew up has the last sound state, from which a run with shorter
    // steps can continue.
    let mut on = taken_up(run.scene(), &through_text(&run.checkpoint()));
    assert_eq!((on.state(), on.blow_up()), (run.state(), None));
    on.set_control(Control::Step(0.01)).unwrap();
    assert!(on.take_steps(100).is_ok());
}

/// A moment is a checkpoint without the stages of an adaptive method's last step: a run restored
/// from it begins a new step.
#[test]
fn a_moment_is_small_and_goes_on() {
    let mut run = simulation("cloth", "dop853", 1e-8);
    run.advance_to(0.1).unwrap();
    let mut moment = simulation("chain", "rk4", 0.01).moment();
    run.record(&mut moment);
    assert_eq!(moment, run.moment());
    // It contains the state, the pins, and little else.
    let pins = moment.pins.len() * size_of::<Pin>();
    assert!(moment.size() < 8 * run.state().len() + pins + 1600);
    assert!(serde_json::to_string(&run.checkpoint()).unwrap().len() > 10 * 8 * run.state().len());
    let mut again = simulation("cloth", "euler", 0.01);
    again.restore(&moment).unwrap();
    assert_eq!((again.state(), again.time()), (run.state(), run.time()));
    run.advance_to(0.2).unwrap();
    again.advance_to(0.2).unwrap();
    let apart = run.state().iter().zip(again.state()).map(|(a, b)| (a - b).abs());
    assert!(apart.fold(0.0, f64::max) < 1e-5);
}

#[test]
fn checkpoints_that_do_not_fit_are_refused_and_change_nothing() {
    let mut run = simulation("mit", "dopri5", 1e-4);
    run.advance_to(0.1).unwrap();
    let before = run.checkpoint();
    let mut refuse = |change: &dyn Fn(&mut Checkpoint)| {
        let mut broken = before.clone();
        change(&mut broken);
        assert!(run.restore(&broken).is_err());
        assert_eq!(run.checkpoint(), before);
    };
    refuse(&|c| c.run.y.push(0.0));
    refuse(&|c| c.run.y[0] = f64::NAN);
    refuse(&|c| c.run.y[40] = 1e200);
    refuse(&|c| {
        let pinned = c.pins[0].particle;
        c.pins[0].path = Path::Still(Vector3::new(9.0, 0.0, pinned as f64));
    });
    refuse(&|c| c.run.since = f64::INFINITY);
    refuse(&|c| c.run.since = -1e180);
    refuse(&|c| c.run.control = Control::Tolerance(-1.0));
    refuse(&|c| c.run.method = method("rk4"));
    let pin = |i: usize| Pin::new(i, Path::Still(Vector3::zeros()));
    refuse(&|c| c.pins.push(pin(1_000_000)));
    refuse(&|c| {
        let until = Some(-1.0);
        c.pins.push(Pin { until, ..pin(0) });
    });
    refuse(&|c| c.torn.push([0, 224]));
    refuse(&|c| c.obstacles.push((7, Path::Still(Vector3::zeros()))));
    refuse(&|c| c.run.grabbed_obstacle = Some(7));
    refuse(&|c| c.progress.within.as_mut().unwrap().ends[1].truncate(3));
    let other = simulation("mit", "dop853", 1e-6);
    refuse(&|c| {
        let mut run = simulation("mit", "dop853", 1e-6);
        run.advance_to(0.01).unwrap();
        c.progress = run.checkpoint().progress;
    });
    assert!(run.restore(&simulation("chain", "rk4", 0.01).checkpoint()).is_err());
    run.restore(&other.checkpoint()).unwrap();
    let text = serde_json::to_string(&before).unwrap();
    let error = serde_json::from_str::<Checkpoint>(&text.replace("dopri5", "magic"));
    assert!(error.unwrap_err().to_string().contains("no method magic"));
}

/// A body that spins faster than any can is refused.
#[test]
fn a_body_with_an_impossible_spin_is_refused() {
    let mut run = simulation("boxes", "verlet", 0.001);
    run.take_steps(2).unwrap();
    let mut forged = run.checkpoint();
    *forged.run.y.last_mut().unwrap() = 1e100;
    let why = run.restore(&forged).unwrap_err().to_string();
    assert!(why.contains("body"), "{why}");
}
