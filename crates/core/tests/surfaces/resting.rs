//! Stability of bodies that rest on the force of contact.

use a3_core::stability::{Budget, RestState, largest_step, observe_at_rest, rest, spectrum};
use a3_core::{Control, Model, Scene, Simulation};

use crate::bead_above_floor;
use crate::common::{described, method};

/// Mass (kg), thickness (m), stiffness (N/m) and gravity (m/s2).
const MASS: f64 = 0.5;
const THICKNESS: f64 = 0.1;
const STIFFNESS: f64 = 900.0;
const GRAVITY: f64 = 9.81;

/// A particle that rests on a floor, or is lifted by `lifted` (m), and its angular frequency (1/s).
fn resting(lifted: f64) -> (Scene, f64) {
    let network = bead_above_floor(MASS, GRAVITY, [THICKNESS, STIFFNESS]);
    // m g = k d s3, and w2 = 3 k s2 / m.
    let share = (MASS * GRAVITY / (STIFFNESS * THICKNESS)).cbrt();
    let height = THICKNESS * (1.0 - share) + lifted;
    let state = vec![0.0, height, 0.0, 0.0, 0.0, 0.0];
    let scene = Scene::new("resting", Model::Network(Box::new(network)), state);
    (scene, (3.0 * STIFFNESS * share * share / MASS).sqrt())
}

#[test]
fn the_limit_of_a_step_is_that_of_contact_at_rest() {
    let (scene, frequency) = resting(0.0);
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    for (name, product) in [("verlet", 2.0), ("rk4", 8.0_f64.sqrt())] {
        let limit = largest_step(method(name), &modes).unwrap().unwrap().step;
        let exact = product / frequency;
        assert!((limit / exact - 1.0).abs() < 1e-3, "{name}: {limit}, not {exact}");
    }
}

#[test]
fn runs_beyond_that_limit_grow_and_others_do_not() {
    let (scene, frequency) = resting(1e-7);
    // For both methods, the state of rest is one in long steps too.
    for (name, product) in [("symplectic", 2.0), ("rk4", 8.0_f64.sqrt())] {
        for (share, grows) in [(0.96, false), (1.04, true)] {
            let step = Control::Step(share * product / frequency);
            let mut run = Simulation::new(scene.clone(), method(name), step).unwrap();
            let rest = scene.state[1] - 1e-7;
            let mut most = 0.0_f64;
            for _ in 0..60 {
                // A run that gains as much energy as it had blows up.
                if run.take_steps(1).is_err() {
                    assert!(grows, "{name}, {share} of the limit");
                    break;
                }
                most = most.max((run.state()[1] - rest).abs());
            }
            assert_eq!(most > 1e-6, grows, "{name}, {share} of the limit: {most} m");
        }
    }
}

/// The scene with the stiffness and the damping of its contact multiplied.
fn multiplied(mut scene: Scene, stiffness: f64, damping: f64) -> Scene {
    if let Model::Network(network) = &mut scene.model {
        let mut touch = network.touch().unwrap().clone();
        for skin in &mut touch.skins {
            skin.stiffness *= stiffness;
            skin.damping *= damping;
        }
        network.set_touch(Some(touch)).unwrap();
    }
    scene
}

/// State of rest, on the force of contact alone.
fn at_rest(scene: &Scene) -> RestState {
    let rest = rest(scene, || true).unwrap().expect("a state of rest");
    let y = &rest.scene.state;
    let mut f = y.clone();
    rest.scene.model.system().eval_f(0.0, y, &mut f);
    let largest = f.iter().fold(0.0, |m: f64, f| m.max(f.abs()));
    assert!(largest < 1e-6, "{largest} m/s2");
    rest
}

/// A sheet lies on a floor, or a second one on the first.
fn lying(sheets: usize) -> Scene {
    let sheet = |height: f64| {
        format!(
            "[[cloth]]
            grid = [4, 4]
            width = 0.4
            density = 0.2
            stiffness = [0.4, 0.2, 0.005]
            damping_ratio = 0.1
            thickness = 0.02
            right = [1, 0, 0]
            down = [0, 0, 1]
            at = [{height}, {height}, {height}]
            "
        )
    };
    let all: String = [0.02, 0.04][..sheets].iter().map(|h| sheet(*h)).collect();
    described(&format!(
        "gravity = [0, -9.81, 0]
        drag_per_mass = 0.5
        floor = {{ height = 0, thickness = 0.02 }}
        self_collision = true
        {all}"
    ))
}

/// Without springs across it, a flat sheet moves up and down as its particles do alone: each of
/// mass m by w2 = 3 k s2 / m with m g = k d s3, so that w6 = 27 k g2 / (m d2), and the lightest is
/// fastest. Contact that is 64 times as stiff halves the step.
#[test]
fn stiffer_contact_lowers_the_limit_of_a_sheet_as_it_should() {
    let limit = |stiffness: f64| {
        let scene = multiplied(lying(1), stiffness, 0.0);
        let rest = at_rest(&scene);
        let network = scene.model.network().unwrap();
        let skin = network.touch().unwrap().skins[0];
        let lightest = network.masses().iter().copied().fold(f64::INFINITY, f64::min);
        let exact =
            (27.0 * skin.stiffness * (GRAVITY / skin.thickness).powi(2) / lightest).powf(1.0 / 6.0);
        let found = rest.modes[0].frequency();
        assert!((found / exact - 1.0).abs() < 1e-3, "{found} 1/s, not {exact}");
        largest_step(method("symplectic"), &rest.modes).unwrap().unwrap().step
    };
    let ratio = limit(64.0) / limit(64.0 * 64.0);
    assert!((ratio - 2.0).abs() < 0.01, "{ratio}");
}

/// At rest the force is m g, and its damping is that times the damping of the skin.
#[test]
fn the_mode_of_contact_has_the_damping_of_the_skin() {
    let mut scene = resting(0.05).0;
    if let Model::Network(network) = &mut scene.model {
        let mut touch = network.touch().unwrap().clone();
        touch.skins[0].damping = 0.7;
        network.set_touch(Some(touch)).unwrap();
    }
    let damping = at_rest(&scene).modes[0].damping;
    assert!((damping / (0.7 * GRAVITY) - 1.0).abs() < 1e-6, "{damping} 1/s");
}

#[test]
fn limits_of_sheets_that_lie_on_one_another_are_seen() {
    for (sheets, stiffness) in [(1, 64.0), (2, 1.0), (2, 64.0)] {
        let rest = at_rest(&multiplied(lying(sheets), stiffness, 1.0));
        for name in ["symplectic", "rk4"] {
            let m = method(name);
            let limit = largest_step(m, &rest.modes).unwrap().unwrap();
            let seen = observe_at_rest(&rest, m, Some(&limit), &Budget::unlimited(), || true)
                .unwrap()
                .unwrap();
            assert!(
                (seen.held / limit.step - 1.0).abs() < 0.03 && !seen.is_open(),
                "{sheets} sheets, {name}: {seen:?}, not {limit:?}"
            );
        }
    }
}
