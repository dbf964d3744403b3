//! Hands: swing, grabbing, pulling, pinning and releasing particles and spheres, and going back.

use crate::common::{method, simulation};
use a3_core::contact::Shape;
use a3_core::{Simulation, Vector3};
use approx::assert_relative_eq;

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

/// Centre and radius (m) of the first obstacle, a sphere.
fn sphere(run: &Simulation) -> (Vector3<f64>, f64) {
    let sphere = run.model().network().unwrap().obstacles()[0].clone();
    let Shape::Sphere { radius } = sphere.shape else {
        panic!("{sphere:?}");
    };
    (sphere.path.at(run.time()).position, radius)
}

#[test]
fn a_sphere_goes_where_it_is_pulled_pushes_cloth_and_comes_back_with_a_reset() {
    for name in ["rk4", "dopri5"] {
        let mut run = simulation("mit-sphere", name, method(name).default_control.value());
        // Within a step, particles have not been moved out of the sphere yet.
        let sunk = 1e-3 * run.extent().1;
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
    assert!(run.grab_obstacle(0).unwrap_err().to_string().contains("a floor cannot be pushed"));
    simulation("simple", "rk4", 0.01).grab_obstacle(0).unwrap();
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
    assert_relative_eq!(run.position(211) - before, run.position(0) - corner, epsilon = 1e-9);
    assert!(run.toggle_pin(400).is_err());
    run.reset();
    assert!(!pinned(&run, 211));
    assert_eq!(simulation("simple", "rk4", 0.1).toggle_pin(0), Ok(false));
}

#[test]
fn a_rewound_run_repeats_itself() {
    for method in ["trapezoid", "verlet", "dop853"] {
        let value = if method == "dop853" { 1e-8 } else { 0.007_812_5 };
        let mut run = simulation("cloth", method, value);
        run.set_swinging(true);
        run.advance_to(0.5).unwrap();
        let then = run.moment();
        run.advance_to(1.0).unwrap();
        let end = run.state().to_vec();
        run.rewind(&then).unwrap();
        assert_eq!((run.time(), run.steps()), (then.time(), then.run.steps));
        assert_eq!(run.state(), then.run.y);
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
    broken.run.y[7] = f64::INFINITY;
    assert!(run.rewind(&broken).is_err());
    broken.run.y.pop();
    assert!(run.rewind(&broken).is_err());
    let mut broken = start;
    broken.run.since = f64::NAN;
    assert!(run.rewind(&broken).is_err());
}
