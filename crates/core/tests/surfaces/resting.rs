//! Stability of what rests on the force of contact.

use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::stability::{largest_step, spectrum};
use a3_core::{Control, Model, Network, Path, Scene, Simulation, Touch, Vector3};

use crate::common::method;

/// Mass (kg), thickness (m), stiffness (N/m) and gravity (m/s2).
const MASS: f64 = 0.5;
const THICKNESS: f64 = 0.1;
const STIFFNESS: f64 = 900.0;
const GRAVITY: f64 = 9.81;

/// A particle that rests on a floor, or is `lifted` so far (m), and its angular frequency (1/s).
fn resting(lifted: f64) -> (Scene, f64) {
    let mut network = Network::new(vec![MASS]).unwrap();
    network.set_gravity(Vector3::new(0.0, -GRAVITY, 0.0));
    let floor = Obstacle {
        thickness: THICKNESS,
        ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros()))
    };
    network.add_obstacle(floor).unwrap();
    let skin = Skin {
        thickness: THICKNESS,
        stiffness: STIFFNESS,
        ..Skin::default()
    };
    let touch = Touch {
        skins: vec![skin],
        edges: vec![[0, 0]],
        bodies: false,
    };
    network.set_touch(Some(touch)).unwrap();
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
        assert!(
            (limit / exact - 1.0).abs() < 1e-3,
            "{name}: {limit}, not {exact}"
        );
    }
}

#[test]
fn runs_beyond_that_limit_grow_and_others_do_not() {
    let (scene, frequency) = resting(1e-7);
    // Of both methods, the state of rest is a state of rest in long steps too.
    for (name, product) in [("symplectic", 2.0), ("rk4", 8.0_f64.sqrt())] {
        for (share, grows) in [(0.96, false), (1.04, true)] {
            let step = Control::Step(share * product / frequency);
            let mut run = Simulation::new(scene.clone(), method(name), step).unwrap();
            let rest = scene.state[1] - 1e-7;
            let mut most = 0.0_f64;
            for _ in 0..60 {
                run.take_steps(1).unwrap();
                most = most.max((run.state()[1] - rest).abs());
            }
            assert_eq!(most > 1e-6, grows, "{name}, {share} of the limit: {most} m");
        }
    }
}
