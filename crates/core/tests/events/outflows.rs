//! Liquid that flows out: when its particles leave, and what they do from then on.

use crate::common::{described, method};
use a3_core::{Control, Network, Scene, Simulation, Vector3, integrators};
use a3_scenes::{Description, snapshot};

/// A liquid whose particles burst apart, because they begin too dense, on both sides of an outflow.
const BURST: &str = "
    [[fluid]]
    dimensions = 2
    size = [0.3, 0.3, 0]
    spacing = 0.1
    at = [0, 0, 0]
    density = 1000
    sound = 10
    outflow = [{ size = [0.4, 2, 0], at = [0.4017, 0, 0] }, { size = [0.3, 0.2, 0], at = [0, 0.51, 0] }]
    [[fluid]]
    dimensions = 2
    size = [0.2, 0.2, 0]
    spacing = 0.1
    at = [0, 0, 0]
    density = 1000
    sound = 10
";

fn network(run: &Simulation) -> &Network {
    run.model().network().unwrap()
}

fn drained(run: &Simulation) -> Vec<u32> {
    network(run).fluid().unwrap().members().drained().to_vec()
}

fn run_of(scene: &Scene, name: &str, value: f64) -> Simulation {
    let method = method(name);
    Simulation::new(scene.clone(), method, method.control(value)).unwrap()
}

/// A drop that falls into an outflow, in metres, millimetres and hundreds of metres: an adaptive
/// method ends a step when it arrives, and a fixed step lets it leave at its end. The energy that
/// it takes along is no loss of the method.
#[test]
fn a_drop_leaves_where_it_arrives() {
    for scale in [1.0, 1e-3, 100.0_f64] {
        let pace = scale.sqrt();
        let scene = described(&format!(
            "gravity = [0, -10, 0]
            [[fluid]]
            size = [{0:e}, {0:e}, {0:e}]
            spacing = {0:e}
            at = [0, {1:e}, 0]
            density = 1000
            sound = {2:e}
            outflow = [{{ size = [{scale:e}, {scale:e}, {scale:e}], at = [0, {3:e}, 0] }}]
            [particles]
            positions = [[{scale:e}, 0, 0]]
            mass = 1",
            0.1 * scale,
            0.8 * scale,
            10.0 * pace,
            -0.5 * scale,
        ));
        let due = 0.4 * pace;
        for (name, value) in [("dopri5", 1e-6), ("dop853", 1e-9), ("dprkn86", 1e-9)] {
            let mut run = run_of(&scene, name, value);
            let mut ends = vec![];
            while run.time() < 0.5 * pace {
                assert_eq!(drained(&run).is_empty(), run.time() < due * (1.0 - 1e-9));
                run.take_steps(1).unwrap();
                ends.push(run.time());
            }
            let is_due = |end: &f64| (end - due).abs() < 1e-8 * pace;
            assert!(ends.iter().any(is_due), "{name}: {ends:?}");
            assert_eq!(drained(&run), [1], "{name}");
            assert!(run.position(1).y.abs() < 1e-8 * scale, "{name}");
            assert!(run.gained().is_none(), "{name}");
        }
        for name in ["verlet", "rk4", "implicit-damping"] {
            let step = 0.03 * pace;
            let mut run = run_of(&scene, name, step);
            run.take_steps(13).unwrap();
            assert!(drained(&run).is_empty(), "{name}");
            run.take_steps(1).unwrap();
            let left = run.position(1);
            let exact = -5.0 * (14.0 * step).powi(2) + 0.8 * scale;
            assert!((left.y - exact).abs() < 1e-9 * scale, "{name}");
            run.take_steps(20).unwrap();
            assert_eq!((drained(&run), run.position(1)), (vec![1], left), "{name}");
            assert!(run.gained().is_none(), "{name}");
        }
    }
}

/// The forces on what stays end when a particle leaves: where that is located, the error falls with
/// the tolerance, and all methods agree.
#[test]
fn adaptive_methods_locate_what_leaves() {
    let scene = described(BURST);
    let end = |name: &str, tolerance: f64| {
        let mut run = run_of(&scene, name, tolerance);
        run.advance_to(0.1).unwrap();
        let gone = drained(&run);
        assert!((4..13).contains(&gone.len()), "{gone:?}");
        run.state().to_vec()
    };
    let exact = end("dprkn1210", 1e-13);
    for (name, tolerances) in [
        ("dopri5", [1e-6, 1e-9]),
        ("dop853", [1e-7, 1e-11]),
        ("verner65", [1e-6, 1e-10]),
        ("dprkn86", [1e-7, 1e-11]),
    ] {
        let errors = tolerances.map(|tolerance| {
            let state = end(name, tolerance);
            let n = state.len() / 2;
            let apart = (0..n).map(|k| (state[k] - exact[k]).abs());
            apart.fold(0.0, f64::max)
        });
        assert!(errors[0] < 1e-4 && errors[1] < 0.02 * errors[0], "{name}: {errors:?}");
    }
}

/// Every explicit method lets out what it should, and its own energy does not change by that.
#[test]
fn all_methods_let_liquid_out() {
    let scene = described(BURST);
    let mut tried = 0;
    for m in integrators::METHODS {
        if m.check(scene.model.system()).is_err() || m.is_implicit() {
            continue;
        }
        let control = match m.default_control {
            Control::Step(_) => Control::Step(1e-4),
            Control::Tolerance(_) => m.control(1e-7),
        };
        let mut run = Simulation::new(scene.clone(), m, control).unwrap();
        run.advance_to(0.1).unwrap();
        let count = drained(&run).len();
        assert!((4..13).contains(&count), "{}: {count}", m.name);
        for i in drained(&run) {
            assert!(network(&run).is_wall(i as usize), "{}", m.name);
        }
        let energy = run.energy().unwrap().total();
        let flowing = network(&run).fluid().unwrap().particles().len();
        assert_eq!(flowing + count, 13, "{}", m.name);
        assert!(run.gained().is_none() && energy > 0.0, "{}", m.name);
        tried += 1;
    }
    assert!(tried > 10, "{tried} methods");
}

/// What has left is right at every time that a run goes back to, and in a copy of the run, and the
/// run goes on from there as it did.
#[test]
fn going_back_brings_liquid_back() {
    let scene = described(BURST);
    for (name, value) in [("verlet", 1e-3), ("dopri5", 1e-7)] {
        let mut run = run_of(&scene, name, value);
        let mut past = vec![];
        for k in 1..=40 {
            run.advance_to(0.0025 * f64::from(k)).unwrap();
            past.push((run.moment(), run.checkpoint(), drained(&run)));
        }
        let (end, gone) = (run.state().to_vec(), drained(&run));
        for (moment, checkpoint, then) in past.iter().rev().step_by(5) {
            run.rewind(moment).unwrap();
            assert_eq!(drained(&run), *then, "{name}");
            let held = network(&run).pins().count();
            assert_eq!(held, then.len(), "{name}");
            run.advance_to(0.1).unwrap();
            assert_eq!(drained(&run), gone, "{name}");
            let mut other = run_of(&scene, name, value);
            other.restore(checkpoint).unwrap();
            assert_eq!(drained(&other), *then, "{name}");
            other.advance_to(0.1).unwrap();
            assert_eq!(other.state(), end, "{name}");
            run.rewind(&past[39].0).unwrap();
            assert_eq!((run.state(), drained(&run)), (&end[..], gone.clone()));
        }
        run.reset();
        assert!(drained(&run).is_empty() && network(&run).pins().count() == 0);
    }
}

/// Hands do not bring liquid back, and a description of the run leaves it outside.
#[test]
fn liquid_stays_outside() {
    let scene = described(BURST);
    let mut run = run_of(&scene, "dop853", 1e-9);
    run.advance_to(0.06).unwrap();
    let gone = drained(&run);
    assert!(!gone.is_empty());
    run.set_pinned(false);
    run.toggle_pin(gone[0] as usize).unwrap();
    assert_eq!(network(&run).pins().count(), gone.len());
    let mut description = Description::parse(BURST).unwrap();
    snapshot::begin_with(&mut description, run.model(), &run.moment());
    let text = description.to_toml().unwrap();
    let mut again = run_of(&described(&text), "dop853", 1e-9);
    assert_eq!(drained(&again), gone, "{text}");
    run.advance_to(0.1).unwrap();
    again.advance_to(0.04).unwrap();
    assert_eq!(drained(&run), drained(&again));
    let apart = run.state().iter().zip(again.state());
    assert!(apart.into_iter().all(|(a, b)| (a - b).abs() < 1e-6));
}

/// Where surfaces touch, a chain flies through the place where a drop left, and is not stopped.
#[test]
fn what_has_left_touches_nothing() {
    let scene = |outflow: &str| {
        described(&format!(
            "self_collision = true
            [[fluid]]
            dimensions = 2
            size = [0.1, 0.1, 0]
            spacing = 0.1
            at = [0, 0, 0]
            density = 1000
            sound = 10
            velocity = [0, -1, 0]
            {outflow}
            [[chain]]
            particles = 3
            from = [1, -0.3, -0.2]
            to = [1, -0.3, 0.2]
            stiffness = 1000
            mass = 0.1
            thickness = 0.02
            velocity = [-2, 0, 0]"
        ))
    };
    let chain = |outflow: &str| {
        let mut run = run_of(&scene(outflow), "verlet", 1e-3);
        run.advance_to(1.0).unwrap();
        run.position(1)
    };
    let free = chain("outflow = [{ size = [0.4, 0.4, 0], at = [0, -0.45, 0] }]");
    assert!((free - Vector3::new(-1.0, -0.3, 0.0)).norm() < 1e-9, "{free}");
}
