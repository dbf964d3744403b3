//! Steps of a simulation, its work, its reset, its blow-ups, and contact with obstacles.

use std::sync::Arc;

use crate::common::{method, scene, simulation};
use a3_core::contact::{Obstacle, Shape};
use a3_core::{
    Cause, Control, Error, Model, Network, ParticleSystem, Path, Refusal, Scene, Simulation,
    Vector3,
};
use approx::assert_relative_eq;

#[test]
fn the_end_is_hit_exactly_and_no_step_is_longer() {
    for (step, until, steps) in [(0.01, 1.0, 100), (0.3, 1.0, 4), (0.1, 0.35, 4), (5.0, 0.1, 1)] {
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
        ("cloth", "verlet", 3),
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
fn method_and_step_change_on_the_way() {
    let mut run = simulation("pendulum", "trapezoid", 0.01);
    run.take_steps(50).unwrap();
    run.set_method(method("verlet"), Control::Step(0.01)).unwrap();
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
        Err(Error::Unsupported { method: method("verlet").title, why: Refusal::LacksMasses })
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
    assert!(matches!(
        blow_up.cause,
        Cause::Gained { particle, .. } | Cause::Away { particle, .. } if particle < 225
    ));
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
    let sphere = run.model().network().unwrap().obstacles()[0].clone();
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
    network.add_obstacle(ball.clone()).unwrap();
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
    assert_relative_eq!(run.position(0), Vector3::new(0.2 + 1.0, 0.0, 0.0), epsilon = 1e-12);
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
    for value in [|| f64::NAN, || f64::INFINITY, || f64::NEG_INFINITY, || 1e300] {
        for entry in [0, 1, 4] {
            let model = Model::Points(Arc::new(Failing(value, entry)));
            let mut run =
                Simulation::new(bare(model, vec![0.5; 6]), method("euler"), Control::Step(0.1))
                    .unwrap();
            let Err(Error::BlowUp(lost)) = run.advance_to(1.0) else {
                panic!("{} survived", value())
            };
            let cause = Cause::NotFinite { particle: entry % 2 };
            assert_eq!((lost.step, lost.cause), (5, cause), "{}", value());
            assert_eq!((lost.control, lost.method), (Control::Step(0.1), "explicit Euler"));
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
    assert_relative_eq!(run.position(0).norm(), 1.25f64.powf(run.time()), max_relative = 1e-12);
    assert_relative_eq!(run.time(), 0.5 * run.steps() as f64, max_relative = 1e-12);
    assert!(run.position(0).norm() > 1.5);
}

#[test]
fn scenes_that_do_not_fit_their_model_are_refused() {
    let scene =
        |length: usize| bare(Model::Points(Arc::new(Failing(|| 0.0, 0))), vec![0.0; length]);
    let refused = Simulation::new(scene(5), method("euler"), Control::Step(0.1)).err();
    assert_eq!(refused, Some(Error::Dimension { expected: 6, found: 5 }));
    let mut run = Simulation::new(scene(6), method("euler"), Control::Step(0.1)).unwrap();
    for end in [f64::NAN, f64::INFINITY] {
        assert!(run.advance_to(end).is_err());
    }
}
