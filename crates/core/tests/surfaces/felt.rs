//! Forces of contact that a run reports.

use a3_core::contact::{Obstacle, Shape};
use a3_core::{Control, Model, Network, Path, Scene, Simulation, Vector3};

use crate::bead_above_floor;
use crate::common::method;

const GRAVITY: f64 = 9.81;

fn run(scene: Scene, name: &str, step: f64) -> Simulation {
    Simulation::new(scene, method(name), Control::Step(step)).unwrap()
}

/// A body on an obstacle is pressed by its weight, whether its particles touch the obstacle or the
/// obstacle repels its surface; before it has arrived, there is no force.
#[test]
fn what_lies_on_the_floor_feels_its_weight() {
    let mut met = Network::new(vec![0.5]).unwrap();
    met.set_gravity(Vector3::new(0.0, -GRAVITY, 0.0));
    let floor = Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros()));
    met.add_obstacle(floor).unwrap();
    let repelled = bead_above_floor(0.5, GRAVITY, [0.1, 900.0]);
    let share = (0.5 * GRAVITY / (900.0 * 0.1)).cbrt();
    for (network, height) in [(met, 0.01), (repelled, 0.1 * (1.0 - share))] {
        let state = vec![0.0, height, 0.0, 0.0, 0.0, 0.0];
        let scene = Scene::new("lying", Model::Network(Box::new(network)), state);
        let mut run = run(scene, "symplectic", 1e-3);
        let begun = run.contact_forces().unwrap()[1];
        run.take_steps(200).unwrap();
        let force = run.contact_forces().unwrap()[1];
        assert!((force / (0.5 * GRAVITY) - 1.0).abs() < 1e-9, "{force}");
        run.reset();
        assert_eq!(run.contact_forces().unwrap()[1], begun);
    }
}

/// Each box of a stack at rest is supported against its own weight, by forces on its corners.
#[test]
fn each_box_of_a_stack_is_held_against_its_weight() {
    let scene = a3_scenes::find("boxes").unwrap().build(None).unwrap().scene;
    let mut run = run(scene, "rk4", 1e-3);
    run.take_steps(1500).unwrap();
    let (mut forces, n) = (vec![0.0; 3 * run.particles()], run.particles());
    // Friction and the safeguard's impulses differ from step to step.
    for _ in 0..100 {
        run.take_steps(1).unwrap();
        let felt = run.contact_forces().unwrap();
        forces.iter_mut().zip(felt).for_each(|(f, felt)| *f += felt / 100.0);
    }
    let network = run.model().network().unwrap();
    for body in network.bodies() {
        let weight = network.masses()[body.center()] * GRAVITY;
        let held: f64 = body.points().map(|i| forces[n + i]).sum();
        assert!((held / weight - 1.0).abs() < 0.02, "{held} N of {weight} N");
    }
}

/// Where the force hardly keeps surfaces apart, the safeguard does. Its impulses are opposite: a
/// body that falls on a cloth pushes it as much as it is pushed, except for the momentum lost by
/// cuts.
#[test]
fn impulses_of_the_guard_are_felt_and_balance() {
    let setup = a3_scenes::find("ball-on-cloth").unwrap().build(None);
    let mut scene = setup.unwrap().scene;
    if let Model::Network(network) = &mut scene.model {
        let mut touch = network.touch().unwrap().clone();
        for skin in &mut touch.skins {
            skin.stiffness *= 1e-9;
        }
        network.set_touch(Some(touch)).unwrap();
    }
    let step = 2e-3;
    let mut run = run(scene, "verlet", step);
    let mut largest = 0.0_f64;
    for _ in 0..400 {
        run.take_steps(1).unwrap();
        let (forces, n) = (run.contact_forces().unwrap(), run.particles());
        let up = &forces[n..2 * n];
        let most = up.iter().map(|f| f.abs()).sum::<f64>();
        let (sum, cut) = (up.iter().sum::<f64>(), run.contact().guarded.lost / step);
        assert!(sum.abs() <= cut + 1e-9 * most.max(1.0), "{sum} N, cut {cut}");
        largest = largest.max(most);
    }
    assert!(largest > 1.0, "{largest} N");
}

#[test]
fn where_nothing_can_touch_there_are_none() {
    let scene = a3_scenes::find("mit").unwrap().build(None).unwrap().scene;
    let mut free = run(scene, "verlet", 1e-3);
    assert!(free.contact_forces().is_none());
    assert!(!free.model().network().unwrap().can_touch());
    free.set_touching(true).unwrap();
    assert_eq!(free.contact_forces().unwrap().len(), 3 * free.particles());
}
