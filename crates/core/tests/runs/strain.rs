//! Limit of strain: springs that are too long after a step are shortened, with any method.

use crate::common::{described, method, scene};
use a3_core::contact::{StrainLimit, StrainLimiter};
use a3_core::{
    Control, Model, Network, Path, Scene, Simulation, Spring, SpringKind, SpringLaw, Vector3,
    integrators,
};

/// Run of the default cloth with a limit of strain; undamped for methods that do not support
/// damping.
fn limited(method_name: &str, value: f64, limit: Option<f64>) -> Simulation {
    let method = method(method_name);
    let mut scene = scene("cloth");
    if let Model::Network(network) = &mut scene.model {
        let all = 0..network.particles();
        network.set_strain_limit(all, limit).unwrap();
        if method.positions_only() {
            network.scale_springs(1.0, 0.0).unwrap();
        }
    }
    Simulation::new(scene, method, method.control(value)).unwrap()
}

#[test]
fn a_curtain_at_rest_is_within_the_limit() {
    for (name, step) in [("trapezoid", 0.01), ("implicit", 1.0 / 60.0), ("verlet", 1e-3)] {
        let mut run = limited(name, step, Some(1.1));
        run.advance_to(9.0).unwrap();
        let mut worst: f64 = 0.0;
        while run.time() < 10.0 {
            run.take_steps(1).unwrap();
            worst = worst.max(run.largest_stretch().unwrap());
        }
        println!("{name}: {worst:.5}");
        assert!(worst > 1.09 && worst <= 1.101, "{name}: {worst}");
    }
    let mut free = limited("trapezoid", 0.01, None);
    free.advance_to(10.0).unwrap();
    assert!(free.largest_stretch().unwrap() > 1.15);
}

/// Adaptive methods do not stall, and no state within their steps has a spring that is much too
/// long.
#[test]
fn every_method_runs_within_the_limit() {
    for method in integrators::METHODS.iter().filter(|m| !m.plain_only()) {
        let mut run = limited(method.name, method.default_control.value(), Some(1.1));
        let mut worst: f64 = 0.0;
        for frame in 1..=60 {
            let time = f64::from(frame) / 60.0;
            run.advance_to(time).unwrap_or_else(|e| panic!("{}: {e}", method.name));
            worst = worst.max(run.largest_stretch().unwrap());
        }
        let (steps, work) = (run.steps(), run.work());
        println!("{}: {steps} steps, {:.0}, {worst:.4}", method.name, work.total());
        assert!(worst < 1.13, "{}: {worst}", method.name);
        let bounded = !method.is_adaptive() || steps < 3000;
        assert!(bounded, "{}: {steps} steps", method.name);
    }
}

/// Square of 6 x 6 free particles of different masses, stretched by 1.3 and thrown.
fn thrown() -> (Network, Vec<f64>) {
    let masses: Vec<_> = (0..36).map(|i| 0.1 + 0.05 * f64::from(i % 7)).collect();
    let mut network = Network::new(masses).unwrap();
    let structural = (0..36).flat_map(|i| {
        let right = (i % 6 < 5).then_some([i, i + 1]);
        right.into_iter().chain((i < 30).then_some([i, i + 6]))
    });
    let law = SpringLaw::new(10.0, 1.0, 0.0).unwrap();
    let kind = SpringKind::Structural;
    let springs = structural.map(|[i, j]| Spring { kind, i, j, law });
    network.add_springs(springs).unwrap();
    let mut y = vec![0.0; 216];
    for i in 0..36 {
        (y[i], y[36 + i]) = (1.3 * (i % 6) as f64, 1.3 * (i / 6) as f64);
        for axis in 0..3 {
            y[108 + 36 * axis + i] = 3.0 + (7.0 * i as f64 + 2.0 * axis as f64).sin();
        }
    }
    (network, y)
}

fn momentum(network: &Network, y: &[f64]) -> Vector3<f64> {
    let n = network.particles();
    let of = |axis: usize| -> f64 {
        let v = &y[(3 + axis) * n..(4 + axis) * n];
        v.iter().zip(network.masses()).map(|(v, m)| m * v).sum()
    };
    Vector3::new(of(0), of(1), of(2))
}

#[test]
fn momentum_is_conserved() {
    let (mut network, y) = thrown();
    network.set_strain_limit(0..36, Some(1.1)).unwrap();
    let before = momentum(&network, &y);
    let scene = Scene::new("thrown", Model::Network(Box::new(network)), y);
    let mut run = Simulation::new(scene, method("verlet"), Control::Step(0.01)).unwrap();
    run.take_steps(50).unwrap();
    let network = run.model().network().unwrap();
    let change = momentum(network, run.state()) - before;
    assert!(change.norm() < 1e-12 * before.norm(), "{change}");
    let stretch = run.largest_stretch().unwrap();
    assert!(stretch < 1.12, "it was 1.3, and is {stretch}");
}

/// Kinetic energy does not grow, even if all springs begin too long.
#[test]
fn the_limit_adds_no_kinetic_energy() {
    let (network, y0) = thrown();
    let w: Vec<_> = network.masses().iter().map(|m| 1.0 / m).collect();
    let springs = network.springs().map(|s| ([s.i, s.j], 1.1));
    let limit = StrainLimit::new(springs, &w);
    let mut limiter = StrainLimiter::new(y0.len());
    let kinetic = |y: &[f64]| network.energy(&y[..108], &y[108..]).kinetic;
    for h in [1e-3, 0.01, 0.1, 1.0] {
        let mut y = y0.clone();
        let strained = limiter.resolve(&limit, &w, h, &mut y);
        assert!(strained.sweeps > 1 && (strained.excess - (1.3 / 1.1 - 1.0)).abs() < 1e-12);
        assert!(limit.excess(&y[..108]) < 0.02, "{}", limit.excess(&y[..108]));
        let (before, after) = (kinetic(&y0), kinetic(&y));
        assert!(after <= before * (1.0 + 1e-12), "h = {h}: {before} to {after}");
    }
    let mut still = y0.clone();
    still[108..].fill(0.0);
    limiter.resolve(&limit, &w, 1e-3, &mut still);
    assert_eq!(kinetic(&still), 0.0);
}

#[test]
fn nothing_changes_where_nothing_is_too_long() {
    for (name, value) in [("verlet", 0.01), ("dopri5", 1e-3), ("bdf", 1e-3)] {
        let [mut with, mut without] = [Some(9.0), None].map(|limit| limited(name, value, limit));
        for run in [&mut with, &mut without] {
            run.advance_to(0.5).unwrap();
        }
        assert_eq!(with.state(), without.state(), "{name}");
        assert_eq!(with.work(), without.work(), "{name}");
    }
}

/// A hand that pulls any particle back and forth as far as the scene allows leaves a run that comes
/// to rest within the limit, and pins stay in their places.
#[test]
fn a_hand_does_not_blow_it_up() {
    for (name, step) in [("trapezoid", 0.01), ("implicit", 1.0 / 60.0)] {
        let mut run = limited(name, step, Some(1.1));
        let mut fastest: f64 = 0.0;
        for frame in 0..600_usize {
            if frame % 60 == 0 {
                run.grab(20 + 37 * (frame / 60)).unwrap();
            }
            let target = 4.0 * (1.3 * frame as f64).sin();
            run.pull(Vector3::new(target, 2.0, -target));
            run.advance_to((frame + 1) as f64 / 60.0).unwrap();
            fastest = run.velocities().iter().fold(fastest, |most, v| most.max(v.abs()));
        }
        run.release();
        println!("{name}: up to {fastest:.0} m/s");
        assert!(fastest < 100.0, "{name}: {fastest} m/s");
        let start = run.scene().state.clone();
        for k in [0, 19] {
            assert_eq!(run.position(k).x, start[k], "pin {k}");
        }
        run.advance_to(25.0).unwrap();
        assert!(run.largest_stretch().unwrap() < 1.102);
    }
}

/// Two particles that fly apart, and one that holds the first.
fn flying() -> Simulation {
    let mut network = Network::new(vec![1.0; 3]).unwrap();
    let law = SpringLaw::new(1.0, 1.0, 0.0).unwrap();
    let kind = SpringKind::Structural;
    for i in 0..2 {
        let spring = Spring { kind, i, j: i + 1, law };
        network.add_spring(spring).unwrap();
    }
    network.pin(0, Path::Still(Vector3::zeros())).unwrap();
    network.set_strain_limit(0..3, Some(1.2)).unwrap();
    let mut y = vec![0.0; 18];
    (y[1], y[2], y[11]) = (1.0, 2.0, 5.0);
    let scene = Scene::new("flying", Model::Network(Box::new(network)), y);
    Simulation::new(scene, method("verlet"), Control::Step(0.01)).unwrap()
}

#[test]
fn what_is_broken_or_let_go_is_not_limited() {
    let mut held = flying();
    held.take_steps(100).unwrap();
    assert!(held.position(2).x < 2.4 * 1.001, "{}", held.position(2));
    let mut broken = flying();
    broken.adjust(|network| network.break_springs(&[[1, 2]]).unwrap());
    broken.take_steps(100).unwrap();
    assert!(broken.position(2).x > 6.0 && broken.position(1).x <= 1.2 * 1.001);
    let mut free = flying();
    free.take_steps(1).unwrap();
    free.adjust(|network| network.unpin(0));
    free.take_steps(100).unwrap();
    assert!(free.position(2).x > 3.0, "{}", free.position(2));
}

#[test]
fn a_run_goes_on_from_a_checkpoint_to_the_same_bits() {
    for name in ["verlet", "dopri5"] {
        let mut run = limited(name, method(name).default_control.value(), Some(1.1));
        run.advance_to(0.7).unwrap();
        let checkpoint = run.checkpoint();
        run.advance_to(1.3).unwrap();
        let end = run.state().to_vec();
        run.restore(&checkpoint).unwrap();
        run.advance_to(1.3).unwrap();
        assert_eq!(run.state(), end, "{name}");
    }
}

#[test]
fn limits_that_make_no_sense_are_refused() {
    let (mut network, _) = thrown();
    for limit in [1.0, 0.5, f64::NAN, f64::INFINITY] {
        let refused = network.set_strain_limit(0..36, Some(limit)).unwrap_err();
        assert!(refused.to_string().contains("above 1"), "{refused}");
    }
    assert!(network.set_strain_limit(30..37, Some(1.1)).is_err());
    network.set_tear(Some(2.0)).unwrap();
    let refused = network.set_strain_limit(0..36, Some(2.0)).unwrap_err();
    assert!(refused.to_string().contains("never break"), "{refused}");
    network.set_strain_limit(0..36, Some(2.5)).unwrap();
    assert!(network.set_tear(Some(3.0)).is_err());
    assert!(network.forces_in_use().contains(&"strain limit"));
    network.set_strain_limit(3..4, None).unwrap();
    assert!(!network.forces_in_use().contains(&"strain limit"));
}

/// Particles that begin in the floor are moved out of it, farther than their springs allow: neither
/// gives way, however short a step is, and an adaptive run continues nevertheless.
#[test]
fn what_cannot_be_shortened_does_not_stop_a_run() {
    let toml = "
        floor = -0.2
        [[jelly]]
        at = [0, 0, 0]
        density = 59
        grid = [3, 2, 2]
        size = [0.058, 0.595, 0.419]
        stiffness = [9.3, 0.15, 0.92]
        strain_limit = 1.25
        [[jelly.pin]]
        particles = [1]
        shift = { by = [0.3, -0.9, 0], end = 1.7 }
    ";
    let dop853 = method("dop853");
    let mut run = Simulation::new(described(toml), dop853, dop853.control(1e-6)).unwrap();
    run.take_steps(2000).unwrap();
    assert!(run.time() > 1e-3, "{}", run.time());
}
