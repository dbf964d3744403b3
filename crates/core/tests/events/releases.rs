//! Pins that let go at a time.

use crate::common::{described, method};
use a3_core::{Control, Method, Scene, Simulation, Vector3, integrators};
use a3_scenes::{Description, snapshot};

/// Time at which the pin of [`SPRING`] lets go (s).
const UNTIL: f64 = 0.7031;

/// A mass of 2 kg on a spring of 50 N/m and 1 m, along which a pin moves it to and fro.
const SPRING: &str = "
    springs = [[0, 1, 50, 1, 0]]
    [particles]
    positions = [[0, 0, 0], [1, 0, 0]]
    mass = 2
    [[pin]]
    particles = [0]
    [[pin]]
    particles = [1]
    sine = { amplitude = [0.2, 0, 0], rate = 3 }
    until = 0.7031
";

/// Place of the mass of [`SPRING`] at a time (s): on the pin's path, and then in free oscillation
/// with 5 rad/s from the place and the velocity on that path.
fn exact(t: f64) -> f64 {
    let (sin, cos) = (3.0 * t.min(UNTIL)).sin_cos();
    let (x, v) = (0.2 * sin, 0.6 * cos);
    let (sin, cos) = (5.0 * (t - UNTIL).max(0.0)).sin_cos();
    1.0 + x * cos + v / 5.0 * sin
}

fn run_of(scene: &Scene, method: &'static Method, value: f64) -> Simulation {
    Simulation::new(scene.clone(), method, method.control(value)).unwrap()
}

fn pinned(run: &Simulation, i: usize) -> bool {
    run.model().network().unwrap().is_pinned(i)
}

#[test]
fn fixed_steps_keep_their_orders() {
    let scene = described(SPRING);
    let mut tried = 0;
    for m in integrators::METHODS {
        if m.check_control(Control::Step(0.1)).is_err() || m.check(scene.model.system()).is_err() {
            continue;
        }
        let steps = if m.order > 5 { [12_u32, 24] } else { [150, 300] };
        let [coarse, fine] = steps.map(|count| {
            let step = Control::Step(1.5 / f64::from(count));
            let mut run = Simulation::new(scene.clone(), m, step).unwrap();
            run.take_steps(count.into()).unwrap();
            assert!((run.time() - 1.5).abs() < 1e-12 && !pinned(&run, 1));
            (run.position(1).x - exact(1.5)).abs()
        });
        let order = (coarse / fine).log2();
        let name = m.name;
        let least = f64::from(m.order) - 0.6;
        let is_exact = fine < 1e-14;
        assert!(order > least || is_exact, "{name}: {order}, {coarse:e}, {fine:e}");
        assert!(fine < 0.02, "{name}: {fine:e}");
        tried += 1;
    }
    assert!(tried > 10, "{tried} methods");
}

#[test]
fn adaptive_steps_end_there() {
    let scene = described(SPRING);
    for (name, tolerance, bound) in [
        ("dop853", 1e-10, 1e-8),
        ("dopri5", 1e-8, 1e-6),
        ("verner65", 1e-8, 1e-6),
        ("dprkn86", 1e-9, 1e-7),
        ("bdf", 1e-7, 1e-3),
    ] {
        let mut run = run_of(&scene, method(name), tolerance);
        let mut ends = vec![];
        while run.time() < 1.5 {
            run.take_steps(1).unwrap();
            ends.push(run.time());
        }
        assert!(ends.contains(&UNTIL), "{name}: {ends:?}");
        assert!(run.work().rejections < 20, "{name}: {:?}", run.work());
        let error = (run.position(1).x - exact(run.time())).abs();
        assert!(error < bound, "{name}: {error:e}");
    }
}

/// A ball that is thrown: it is moved along a line, and let go where the line ends, with the speed
/// that it has there. Methods of order 2 are exact.
#[test]
fn what_is_thrown_flies_on_a_parabola() {
    let scene = described(
        "
        gravity = [0, -10, 0]
        [particles]
        positions = [[0, 0, 0]]
        mass = 0.3
        [[pin]]
        particles = [0]
        shift = { by = [0.8, 0.4, 0], start = 0.2, end = 0.6 }
        until = 0.6
        ",
    );
    let exact = |t: f64| {
        let s = t - 0.6;
        Vector3::new(0.8 + 2.0 * s, 0.4 + s - 5.0 * s * s, 0.0)
    };
    for (name, value) in [("verlet", 0.07), ("implicit-midpoint", 0.07), ("dopri5", 1e-6)] {
        let Some(found) = integrators::find(name) else {
            continue;
        };
        let mut run = run_of(&scene, found, value);
        // Reading it within the step in which it is let go changes nothing.
        for time in [0.59, 0.6, 0.61, 0.625, 1.4] {
            run.advance_to(time).unwrap();
            assert_eq!(pinned(&run, 0), time < 0.6, "{name} at {time}");
            if time >= 0.6 {
                let error = (run.position(0) - exact(time)).norm();
                assert!(error < 1e-9, "{name} at {time}: {error:e}");
            }
        }
        assert!(run.gained().is_none(), "{name}: {:?}", run.gained());
    }
}

/// How often a run is shown changes no bit, also where a pin lets go within a step.
#[test]
fn showing_a_run_changes_nothing() {
    let scene = described(SPRING);
    for (name, value) in [("verlet", 0.05), ("rk4", 0.05), ("dopri5", 1e-6)] {
        let mut shown = run_of(&scene, method(name), value);
        for k in 1..=150 {
            shown.advance_to(0.01 * f64::from(k)).unwrap();
            let error = (shown.position(1).x - exact(shown.time())).abs();
            assert!(error < 5e-3, "{name} at {}: {error:e}", shown.time());
        }
        let mut straight = run_of(&scene, method(name), value);
        straight.advance_to(1.5).unwrap();
        assert_eq!(shown.state(), straight.state(), "{name}");
    }
}

/// Whether a particle is held is right at every time that a run goes back to, in a copy of the run
/// too, and the run goes on from there as it did.
#[test]
fn going_back_holds_again() {
    let scene = described(SPRING);
    for (name, value) in [("verlet", 0.05), ("implicit", 0.05), ("bdf", 1e-5)] {
        let mut run = run_of(&scene, method(name), value);
        let mut past = vec![];
        for k in 1..=120 {
            run.advance_to(0.0125 * f64::from(k)).unwrap();
            past.push((run.time(), run.moment(), run.checkpoint()));
        }
        let end = run.state().to_vec();
        for (time, moment, checkpoint) in past.iter().rev().step_by(7) {
            run.rewind(moment).unwrap();
            assert_eq!(pinned(&run, 1), *time < UNTIL, "{name} at {time}");
            run.advance_to(1.5).unwrap();
            assert!((run.position(1).x - end[1]).abs() < 0.03, "{name} from {time}");
            let mut other = run_of(&scene, method(name), value);
            other.restore(checkpoint).unwrap();
            assert_eq!(pinned(&other, 1), *time < UNTIL, "{name} at {time}");
            other.advance_to(1.5).unwrap();
            assert_eq!(other.state(), end, "{name} from {time}");
        }
        run.reset();
        assert!(pinned(&run, 1), "{name}");
    }
}

/// A pin that a person has moved, or taken away and set again, lets go when the scene says so. One
/// that a person sets later holds.
#[test]
fn hands_do_not_change_the_time() {
    let scene = described(SPRING);
    let mut run = run_of(&scene, method("verlet"), 0.01);
    run.advance_to(0.305).unwrap();
    run.grab(1).unwrap();
    run.pull(run.position(1) + Vector3::new(0.1, 0.1, 0.0));
    run.advance_to(0.405).unwrap();
    run.release();
    let left = run.position(1);
    run.advance_to(0.7).unwrap();
    assert!(pinned(&run, 1) && (run.position(1) - left).norm() < 1e-12);
    run.advance_to(0.71).unwrap();
    assert!(!pinned(&run, 1) && (run.position(1) - left).norm() > 0.0);

    run.reset();
    run.advance_to(0.305).unwrap();
    assert!(!run.toggle_pin(1).unwrap() && run.toggle_pin(1).unwrap());
    run.advance_to(0.8).unwrap();
    assert!(!pinned(&run, 1));
    assert!(run.toggle_pin(1).unwrap());
    run.advance_to(1.0).unwrap();
    assert!(pinned(&run, 1));

    run.reset();
    run.set_pinned(false);
    run.advance_to(0.5).unwrap();
    run.set_pinned(true);
    assert!(pinned(&run, 1) && pinned(&run, 0));
    run.advance_to(0.8).unwrap();
    assert!(!pinned(&run, 1) && pinned(&run, 0));
    run.set_pinned(false);
    run.set_pinned(true);
    assert!(!pinned(&run, 1) && pinned(&run, 0));
}

/// A description of a run at a time lets go as long after it as the run does.
#[test]
fn a_description_lets_go_when_the_run_does() {
    let mut description = Description::parse(SPRING).unwrap();
    let scene = described(SPRING);
    let mut run = run_of(&scene, method("dop853"), 1e-9);
    for (time, count) in [(0.3, 2), (0.8, 1)] {
        run.advance_to(time).unwrap();
        snapshot::begin_with(&mut description, run.model(), &run.moment());
        let text = description.to_toml().unwrap();
        let mut again = run_of(&described(&text), method("dop853"), 1e-9);
        assert_eq!(again.model().network().unwrap().pins().count(), count);
        again.advance_to(1.5 - time).unwrap();
        assert!((again.position(1).x - exact(1.5)).abs() < 1e-7, "{time}");
    }
}
