//! Simulations: steps, swing, wind, grab, pull, release, and changes of method and step during a
//! run.

use std::sync::Arc;

use crate::common::{method, scene, simulation};
use a3_core::contact::{Obstacle, Shape};
use a3_core::{
    Cause, Checkpoint, Control, Error, Model, Network, ParticleSystem, Path, Scene, Simulation,
    Vector3,
};
use approx::assert_relative_eq;

#[test]
fn the_end_is_hit_exactly_and_no_step_is_longer() {
    for (step, until, steps) in [
        (0.01, 1.0, 100),
        (0.3, 1.0, 4),
        (0.1, 0.35, 4),
        (5.0, 0.1, 1),
    ] {
        let mut run = simulation("simple", "rk4", step);
        run.advance_to(until).unwrap();
        assert_eq!((run.time(), run.steps()), (until, steps));
        run.advance_to(until).unwrap();
        assert_eq!(run.steps(), steps);
    }
    // The last step is shortened: RK4's error after 1 s in steps of 0.3 s is below that of one step
    // of 1 s.
    let mut run = simulation("simple", "rk4", 0.3);
    run.advance_to(1.0).unwrap();
    assert_relative_eq!(run.position(0).x, 1.0f64.cos(), epsilon = 1e-4);
}

#[test]
fn work_is_counted() {
    for (name, method_name, per_step) in [
        ("mit", "euler", 1),
        ("mit", "trapezoid", 2),
        ("mit", "rk4", 4),
        ("mit", "verlet", 1),
        ("cloth", "verlet", 2),
    ] {
        let mut run = simulation(name, method_name, 0.001);
        run.take_steps(7).unwrap();
        assert_eq!(
            (run.steps(), run.work().evaluations),
            (7, 7 * per_step),
            "{method_name} on {name}"
        );
    }
}

#[test]
fn a_reset_run_repeats_itself_to_the_bit() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    run.set_wind(true);
    run.set_swinging(true);
    run.advance_to(1.0).unwrap();
    let first = run.state().to_vec();
    run.grab(210).unwrap();
    run.pull(run.position(210) + Vector3::z());
    run.advance_to(1.5).unwrap();
    run.reset();
    assert_eq!((run.time(), run.steps(), run.grabbed()), (0.0, 0, None));
    assert!(run.windy() && run.swinging());
    assert!(run.state()[..1200] == run.scene().state[..1200]);
    run.advance_to(1.0).unwrap();
    assert!(run.state() == first);
}

#[test]
fn swinging_pins_start_and_stop_where_they_are() {
    let mut run = simulation("mit", "rk4", 0.01);
    let at = |run: &Simulation| run.position(14);
    let home = at(&run);
    run.advance_to(0.5).unwrap();
    assert_eq!(at(&run), home);
    run.set_swinging(true);
    run.advance_to(1.5).unwrap();
    // z = 2 sin(t / 1.5), with t from the time at which the swing was turned on.
    assert_relative_eq!(
        at(&run),
        home + Vector3::z() * 2.0 * (1.0f64 / 1.5).sin(),
        epsilon = 1e-12
    );
    run.set_swinging(false);
    let stopped = at(&run);
    run.advance_to(2.5).unwrap();
    assert_eq!(at(&run), stopped);
    run.set_swinging(true);
    run.advance_to(3.5).unwrap();
    assert_relative_eq!(
        at(&run),
        home + Vector3::z() * 2.0 * (2.0f64 / 1.5).sin(),
        epsilon = 1e-12
    );
}

#[test]
fn a_pulled_particle_goes_where_it_is_pulled_and_is_let_go_with_its_speed() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    run.advance_to(20.0).unwrap();
    let i = 210;
    run.grab(i).unwrap();
    let target = run.position(i) + Vector3::new(0.2, 0.1, 0.5);
    for _ in 0..60 {
        run.pull(target);
        run.advance_to(run.time() + 1.0 / 60.0).unwrap();
    }
    assert_relative_eq!(run.position(i), target, epsilon = 1e-9);
    assert!(run.model().network().unwrap().is_pinned(i));
    // The particle moves when it is released, and keeps its velocity.
    let from = run.position(i);
    run.pull(from + Vector3::z() * 0.3);
    run.advance_to(run.time() + 0.02).unwrap();
    run.release();
    assert!(run.grabbed().is_none() && !run.model().network().unwrap().is_pinned(i));
    assert_relative_eq!(run.velocities()[2 * 400 + i], 9.0, epsilon = 1e-9);
    run.advance_to(run.time() + 20.0).unwrap();
    assert!((run.position(i) - target).norm() > 0.2, "it fell back");
}

#[test]
fn a_pinned_particle_is_moved_and_stays() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    run.grab(0).unwrap();
    let target = run.position(0) + Vector3::new(-0.1, 0.1, 0.1);
    for _ in 0..30 {
        run.pull(target);
        run.take_steps(2).unwrap();
    }
    run.release();
    run.advance_to(5.0).unwrap();
    assert_relative_eq!(run.position(0), target, epsilon = 1e-9);
    run.reset();
    assert_eq!(run.model().network().unwrap().pins().count(), 20);
    assert!((run.position(0) - target).norm() > 0.1);
}

#[test]
fn there_is_nothing_to_grab_out_of_range_or_without_masses() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    assert!(run.grab(400).unwrap_err().to_string().contains("0 to 399"));
    let mut run = simulation("simple", "rk4", 0.01);
    run.grab(0).unwrap();
    assert_eq!(run.grabbed(), None);
}

#[test]
fn method_and_step_change_on_the_way() {
    let mut run = simulation("pendulum", "trapezoid", 0.01);
    run.take_steps(50).unwrap();
    run.set_method(method("verlet"), Control::Step(0.01))
        .unwrap();
    run.set_control(Control::Step(0.001)).unwrap();
    run.take_steps(500).unwrap();
    assert_relative_eq!(run.time(), 1.0, epsilon = 1e-12);
    let mut whole = simulation("pendulum", "rk4", 0.0005);
    whole.advance_to(1.0).unwrap();
    assert_relative_eq!(run.position(1), whole.position(1), epsilon = 1e-2);
    assert!(
        run.set_control(Control::Step(-1.0)).is_err()
            && run.set_control(Control::Step(f64::NAN)).is_err()
    );
    let mut circle = simulation("simple", "rk4", 0.01);
    assert_eq!(
        circle.set_method(method("verlet"), Control::Step(0.01)),
        Err(Error::NeedsMechanics { method: "verlet" })
    );
    assert_eq!(circle.method().name, "rk4");
    circle.take_steps(1).unwrap();
}

#[test]
fn a_lost_run_shows_its_last_good_state_until_it_is_reset() {
    let mut run = Simulation::new(scene("mit"), method("rk4"), Control::Step(0.05)).unwrap();
    let blow_up = loop {
        if let Err(Error::BlowUp(blow_up)) = run.take_steps(2) {
            break blow_up;
        }
    };
    assert_eq!(run.blow_up(), Some(blow_up));
    assert!(matches!(blow_up.cause, Cause::Away { particle, .. } if particle < 225));
    assert!(blow_up.time > run.time() && blow_up.time <= run.time() + 2.0);
    let (middle, radius) = run.extent();
    assert!((0..225).all(|i| (run.position(i) - middle).norm() <= 3.0 * radius));
    assert!(run.state().iter().all(|y| y.is_finite()));
    assert_eq!(run.take_steps(1), Err(Error::BlowUp(blow_up)));
    run.reset();
    assert_eq!(run.blow_up(), None);
    run.take_steps(1).unwrap();
}

/// Centre and radius (m) of the first obstacle, a sphere.
fn sphere(run: &Simulation) -> (Vector3<f64>, f64) {
    let sphere = run.model().network().unwrap().obstacles()[0];
    let Shape::Sphere { radius } = sphere.shape else {
        panic!("{sphere:?}");
    };
    (sphere.path.at(run.time()).position, radius)
}

#[test]
fn nothing_enters_the_sphere_or_the_floor() {
    let mut run = simulation("mit-sphere", "rk4", 0.01);
    run.set_swinging(true);
    let mut touched = false;
    for _ in 0..800 {
        run.take_steps(1).unwrap();
        let (center, radius) = sphere(&run);
        for i in 0..run.particles() {
            let distance = (run.position(i) - center).norm();
            assert!(distance > radius - 1e-9);
            touched |= distance < radius + 1e-9;
        }
        assert!(run.lowest() >= -5.0);
    }
    assert!(touched);
}

fn bare(model: Model, state: Vec<f64>) -> Scene {
    Scene::new("bare", model, state)
}

/// A sphere moving at 2 m/s hits a particle with a tangential velocity of 3 m/s: the particle is
/// put on the surface, gets the sphere's velocity along the normal, and keeps its tangential
/// velocity.
#[test]
fn a_moving_sphere_pushes_without_friction() {
    let mut network = Network::new(vec![1.0]).unwrap();
    let path = Path::Line {
        from: Vector3::zeros(),
        to: Vector3::new(20.0, 0.0, 0.0),
        start: 0.0,
        end: 10.0,
    };
    let ball = Obstacle::smooth(Shape::Sphere { radius: 1.0 }, path);
    network.add_obstacle(ball).unwrap();
    // The particle moves towards the sphere at 1 m/s. At t = 0.1 s it would be 0.7 m from the
    // sphere's centre, on the line of the sphere's motion.
    let state = vec![1.0, 0.0, -0.3, -1.0, 0.0, 3.0];
    let mut run = Simulation::new(
        bare(Model::Network(Box::new(network)), state),
        method("rk4"),
        Control::Step(0.1),
    )
    .unwrap();
    run.take_steps(1).unwrap();
    assert_relative_eq!(
        run.position(0),
        Vector3::new(0.2 + 1.0, 0.0, 0.0),
        epsilon = 1e-12
    );
    let v = run.velocities();
    assert_relative_eq!(
        Vector3::new(v[0], v[1], v[2]),
        Vector3::new(2.0, 0.0, 3.0),
        epsilon = 1e-12
    );
    // A particle that is faster than the sphere leaves it freely.
    let mut network = Network::new(vec![1.0]).unwrap();
    network.add_obstacle(ball).unwrap();
    let state = vec![0.9, 0.0, 0.0, 5.0, 0.0, 0.0];
    let mut run = Simulation::new(
        bare(Model::Network(Box::new(network)), state),
        method("rk4"),
        Control::Step(0.01),
    )
    .unwrap();
    run.take_steps(1).unwrap();
    assert_eq!(run.velocities(), [5.0, 0.0, 0.0]);
}

#[test]
fn a_sphere_goes_where_it_is_pulled_pushes_cloth_and_comes_back_with_a_reset() {
    for name in ["rk4", "dopri5"] {
        let mut run = simulation("mit-sphere", name, method(name).default_control.value());
        // Between its steps, an adaptive method shows particles that have not been put out of the
        // sphere yet.
        let sunk = if run.method().is_adaptive() {
            1e-3 * run.extent().1
        } else {
            1e-9
        };
        run.advance_to(0.5).unwrap();
        let (home, radius) = sphere(&run);
        assert!(run.grab_obstacle(1).is_err() && run.grabbed_obstacle().is_none());
        run.grab_obstacle(0).unwrap();
        run.advance_to(0.6).unwrap();
        assert_eq!((run.grabbed_obstacle(), sphere(&run).0), (Some(0), home));
        let target = home + Vector3::new(0.3, 0.8, -0.2);
        let mut touched = false;
        while run.time() < 1.6 {
            run.pull_obstacle(target);
            run.advance_to(run.time() + 1.0 / 60.0).unwrap();
            let center = sphere(&run).0;
            for i in 0..run.particles() {
                let distance = (run.position(i) - center).norm();
                assert!(distance > radius - sunk, "{name}");
                touched |= distance < radius + 1e-9;
            }
        }
        assert!(touched, "{name}");
        assert_relative_eq!(sphere(&run).0, target, epsilon = 1e-12);
        // The sphere moves when it is released: it stops there, and a pull no longer moves it.
        run.pull_obstacle(home);
        run.advance_to(run.time() + 0.01).unwrap();
        run.release_obstacle();
        let left = sphere(&run).0;
        assert!((left - target).norm() > 0.1 && (left - home).norm() > 0.1);
        run.pull_obstacle(home);
        run.advance_to(run.time() + 0.1).unwrap();
        assert_eq!((run.grabbed_obstacle(), sphere(&run).0), (None, left));
        run.grab_obstacle(0).unwrap();
        run.reset();
        assert_eq!((run.grabbed_obstacle(), sphere(&run).0), (None, home));
    }
    // A floor cannot be grabbed, and the scene has no other obstacle.
    let mut run = simulation("cloth", "rk4", 0.01);
    assert!(run.grab_obstacle(1).is_err());
    assert!(
        run.grab_obstacle(0)
            .unwrap_err()
            .to_string()
            .contains("a floor cannot be pushed")
    );
    simulation("simple", "rk4", 0.01).grab_obstacle(0).unwrap();
}

/// System at rest whose derivative, at t > 0.35 s, takes the function's value at this index.
struct Failing(fn() -> f64, usize);

impl ParticleSystem for Failing {
    fn dim(&self) -> usize {
        6
    }

    fn eval_f(&self, t: f64, _y: &[f64], dydt: &mut [f64]) {
        dydt.fill(0.0);
        if t > 0.35 {
            dydt[self.1] = self.0();
        }
    }
}

#[test]
fn what_is_not_finite_is_a_blow_up_that_names_its_particle() {
    for value in [
        || f64::NAN,
        || f64::INFINITY,
        || f64::NEG_INFINITY,
        || 1e300,
    ] {
        for entry in [0, 1, 4] {
            let model = Model::FirstOrder(Arc::new(Failing(value, entry)));
            let mut run = Simulation::new(
                bare(model, vec![0.5; 6]),
                method("euler"),
                Control::Step(0.1),
            )
            .unwrap();
            let Err(Error::BlowUp(lost)) = run.advance_to(1.0) else {
                panic!("{} survived", value())
            };
            let cause = Cause::NotFinite {
                particle: entry % 2,
            };
            assert_eq!((lost.step, lost.cause), (5, cause), "{}", value());
            assert_eq!(
                (lost.control, lost.method),
                (Control::Step(0.1), "explicit Euler")
            );
            assert!(run.state().iter().all(|y| y.is_finite()));
            assert_eq!((run.time(), run.steps()), (0.0, 0));
        }
    }
}

#[test]
fn the_state_goes_back_to_the_time_it_had_whatever_the_step_is_by_then() {
    let mut run = simulation("simple", "euler", 0.5);
    while run.position(0).norm() < 4.0 {
        run.take_steps(1).unwrap();
    }
    run.set_control(Control::Step(0.7)).unwrap();
    while run.take_steps(1).is_ok() {}
    // The radius after n steps of 0.5 s is 1.25^(n/2), which determines the time.
    assert_relative_eq!(
        run.position(0).norm(),
        1.25f64.powf(run.time()),
        max_relative = 1e-12
    );
    assert_relative_eq!(run.time(), 0.5 * run.steps() as f64, max_relative = 1e-12);
    assert!(run.position(0).norm() > 1.5);
}

#[test]
fn scenes_that_do_not_fit_their_model_are_refused() {
    let scene = |length: usize| {
        bare(
            Model::FirstOrder(Arc::new(Failing(|| 0.0, 0))),
            vec![0.0; length],
        )
    };
    let refused = Simulation::new(scene(5), method("euler"), Control::Step(0.1)).err();
    assert_eq!(
        refused,
        Some(Error::Dimension {
            expected: 6,
            found: 5
        })
    );
    let mut run = Simulation::new(scene(6), method("euler"), Control::Step(0.1)).unwrap();
    for end in [f64::NAN, f64::INFINITY] {
        assert!(run.advance_to(end).is_err());
    }
}

/// The chain can be pulled although it hangs stretched to several times its rest length.
#[test]
fn soft_springs_give_way() {
    let mut run = simulation("chain", "verlet", 0.005);
    run.advance_to(1.5).unwrap();
    assert!(run.largest_stretch().unwrap() > 4.0);
    run.grab(2).unwrap();
    let target = run.position(2) + Vector3::new(1.0, -0.5, 0.3);
    for _ in 0..60 {
        run.pull(target);
        run.advance_to(run.time() + 1.0 / 60.0).unwrap();
    }
    assert_relative_eq!(run.position(2), target, epsilon = 1e-9);
}

/// A particle is pinned where it is during a run, and released from there. It swings with the other
/// pins while they do.
#[test]
fn a_particle_is_pinned_and_let_go() {
    let mut run = simulation("cloth", "rk4", 0.005);
    let pinned = |run: &Simulation, i| run.model().network().unwrap().is_pinned(i);
    run.advance_to(0.5).unwrap();
    let place = run.position(210);
    assert_eq!(run.toggle_pin(210), Ok(true));
    run.advance_to(1.0).unwrap();
    assert_eq!(run.position(210), place);
    // Unpinning a grabbed particle takes effect when the hand releases it.
    run.grab(210).unwrap();
    assert_eq!(run.toggle_pin(210), Ok(false));
    assert!(pinned(&run, 210));
    run.release();
    assert!(!pinned(&run, 210));
    run.advance_to(1.5).unwrap();
    assert!((run.position(210) - place).norm() > 0.01);
    run.set_swinging(true);
    assert_eq!(run.toggle_pin(211), Ok(true));
    let (before, corner) = (run.position(211), run.position(0));
    run.advance_to(2.0).unwrap();
    assert_relative_eq!(
        run.position(211) - before,
        run.position(0) - corner,
        epsilon = 1e-9
    );
    assert!(run.toggle_pin(400).is_err());
    run.reset();
    assert!(!pinned(&run, 211));
    assert_eq!(simulation("simple", "rk4", 0.1).toggle_pin(0), Ok(false));
}

#[test]
fn a_rewound_run_repeats_itself() {
    for method in ["trapezoid", "verlet", "dop853"] {
        let value = if method == "dop853" {
            1e-8
        } else {
            0.007_812_5
        };
        let mut run = simulation("cloth", method, value);
        run.set_swinging(true);
        run.advance_to(0.5).unwrap();
        let then = run.moment();
        run.advance_to(1.0).unwrap();
        let end = run.state().to_vec();
        run.rewind(&then).unwrap();
        assert_eq!((run.time(), run.steps()), (then.time(), then.steps));
        assert_eq!(run.state(), then.y);
        run.advance_to(1.0).unwrap();
        let worst = run.state().iter().zip(&end).map(|(a, b)| (a - b).abs());
        // An adaptive method chooses other steps.
        let bound = if method == "dop853" { 1e-5 } else { 0.0 };
        assert!(worst.fold(0.0, f64::max) <= bound, "{method}");
    }
}

/// After a rewind, pins are at their former positions and stay there, whatever hands did in
/// between.
#[test]
fn rewinding_puts_pins_back_where_they_were_and_ends_a_blow_up() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    run.advance_to(0.2).unwrap();
    let (corner, then) = (run.position(0), run.moment());
    run.grab(0).unwrap();
    run.pull(corner + Vector3::new(0.3, 0.2, 0.0));
    run.advance_to(0.4).unwrap();
    run.rewind(&then).unwrap();
    assert_eq!((run.grabbed(), run.position(0)), (None, corner));
    run.advance_to(0.5).unwrap();
    assert_eq!(run.position(0), corner);

    let mut run = simulation("mit", "rk4", 0.05);
    let start = run.moment();
    while run.take_steps(1).is_ok() {}
    run.rewind(&start).unwrap();
    assert!(run.blow_up().is_none() && run.take_steps(1).is_ok());
    let mut broken = start.clone();
    broken.y[7] = f64::INFINITY;
    assert!(run.rewind(&broken).is_err());
    broken.y.pop();
    assert!(run.rewind(&broken).is_err());
    let since = f64::NAN;
    assert!(run.rewind(&Checkpoint { since, ..start }).is_err());
}
