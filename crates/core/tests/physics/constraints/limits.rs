//! Constraints at their limits: too many, impossible, off their places, in a hand, refused.

use crate::common::{distance, integrate, method, size};
use a3_core::stability::{LargestMode, largest_step, rest, spectrum};
use a3_core::{
    Constraint, Control, Grid, Linearized, Mechanics, Model, Network, ParticleSystem, Path, Scene,
    Sheet, Simulation, integrators,
};

use super::*;

#[test]
fn a_rod_too_many_changes_nothing() {
    let start = state(&[ZERO, vector(0.6, -0.8, 0.0), vector(0.6, -0.8, 2.0)], &[ZERO; 3]);
    let plain = [rod(0, 1, 1.0), rod(1, 2, 2.0)];
    let run = |more: &[Constraint], pins: usize| {
        let mut network = network(&[1.0, 0.5, 2.0], &[&plain, more].concat());
        for i in 0..pins {
            let [x, _] = of(&start, i);
            network.pin(i, Path::Still(x)).unwrap();
        }
        integrate(&network, method("rk4"), &start, 1e-3, 2_000)
    };
    let expected = run(&[], 1);
    for more in [&plain[..], &[rod(2, 1, 2.0), rod(1, 2, 2.0)]] {
        assert!(distance(&run(more, 1), &expected) < 1e-10);
    }
    // A constraint between pins adds no force.
    let of_one = {
        let mut network = network(&[1.0, 0.5, 2.0], &plain[1..]);
        for i in 0..2 {
            network.pin(i, Path::Still(of(&start, i)[0])).unwrap();
        }
        integrate(&network, method("rk4"), &start, 1e-3, 2_000)
    };
    assert!(distance(&run(&[], 2), &of_one) < 1e-12);
    let far = run(&[rod(0, 1, 7.0)], 2);
    assert!(distance(&far, &of_one) < 1e-12);
}

/// Constraints may be redundant, as those of three rods between particles on a line are.
#[test]
fn a_flat_triangle_of_rods_turns_as_one() {
    let network = weightless(&[1.0; 3], &[rod(0, 1, 1.0), rod(1, 2, 1.0), rod(0, 2, 2.0)]);
    let at = |angle: f64| {
        let out = vector(angle.cos(), angle.sin(), 0.0);
        let across = vector(-angle.sin(), angle.cos(), 0.0);
        state(&[out, ZERO, -out], &[across * 2.0, ZERO, across * -2.0])
    };
    let y = integrate(&network, method("rk4"), &at(0.0), 1e-3, 3_000);
    assert!(distance(&y, &at(6.0)) < 1e-9);
}

#[test]
fn what_cannot_be_held_stays_finite() {
    let point = |x| Constraint::Point { particle: 0, position: vector(x, 0.0, 0.0) };
    let both = weightless(&[1.0], &[point(-1.0), point(2.0)]);
    let y = integrate(&both, method("rk4"), &state(&[vector(0.1, 0.3, 0.2)], &[ZERO]), 1e-3, 5_000);
    // Contradictory constraints are met as nearly as possible.
    assert!(distance(&y, &state(&[vector(0.5, 0.0, 0.0)], &[ZERO])) < 1e-9);
    let rods = [rod(0, 1, 1.0), rod(0, 1, 3.0), rod(1, 2, 1.0), rod(2, 0, 7.0)];
    let y = state(&[ZERO, vector(2.0, 0.0, 0.0), vector(3.0, 0.0, 0.0)], &[ZERO; 3]);
    let impossible = network(&[1.0, 2.0, 0.1], &rods);
    let y = integrate(&impossible, method("rk4"), &y, 1e-3, 1_000);
    assert!(size(&y) < 10.0, "{y:?}");
}

/// At the centre of a sphere no direction is defined: the constraint adds no force, and no NaN.
#[test]
fn in_a_centre_nothing_holds() {
    let sphere = Constraint::Sphere { particle: 0, center: ZERO, radius: 1.0 };
    let network = network(&[1.0, 1.0], &[sphere, rod(0, 1, 1.0)]);
    let mut f = [f64::NAN; 6];
    network.forces(0.0, &[0.0; 6], &[3.0; 6], &mut f);
    assert_eq!(f, [0.0, 0.0, -G, -G, 0.0, 0.0]);
    assert_eq!(network.constraint_error(&[0.0; 6]), Some(1.0));
}

/// Errors of every kind of constraint decay by C'' = -w^2 C - 2 w C': 0.1 m becomes 0.1 (1 + w t)
/// exp(-w t) m.
#[test]
fn what_is_off_comes_back() {
    let slope = vector(0.6, 0.8, 0.0);
    for (constraint, x) in [
        (Constraint::Point { particle: 0, position: slope }, slope + vector(0.1, 0.0, 0.0)),
        (
            Constraint::Line { particle: 0, point: ZERO, direction: vector(-0.8, 0.6, 0.0) },
            slope * 0.1,
        ),
        (wire(), slope * 1.1),
        (wire(), slope + vector(0.0, 0.0, 0.1)),
        (Constraint::Sphere { particle: 0, center: ZERO, radius: 1.0 }, slope * 0.9),
        (rod(0, 1, 1.0), slope * 0.9),
    ] {
        for w in [10.0, 20.0] {
            let mut network = network(&[1.0, 3.0], &[constraint]);
            network.set_baumgarte_frequency(w).unwrap();
            let y = state(&[x, ZERO], &[ZERO; 2]);
            for t in [0.1, 0.4, 4.0] {
                let end = integrate(&network, method("dop853"), &y, t / 400.0, 400);
                let exact = 0.1 * (1.0 + w * t) * (-w * t).exp();
                let found = error(&network, &end);
                assert!((found - exact).abs() < 1e-9, "{constraint:?}, {t} s: {found}");
            }
        }
    }
}

#[test]
fn methods_that_do_not_serve_constraints_refuse_in_one_line() {
    let (constrained, y) = chain(2);
    let free = network(&[1.0], &[]);
    for m in integrators::METHODS.iter().filter(|m| !m.plain_only()) {
        assert!(m.check(&free).is_ok());
        let refuses = m.needs_springs() || m.positions_only();
        assert_eq!(m.check(&constrained).is_err(), refuses, "{}", m.name);
        if let Err(refused) = m.integrator(&constrained) {
            let line = refused.to_string();
            assert!(line.starts_with(m.title) && line.contains("explicit"), "{line}");
            assert!(!line.contains('\n'));
        } else {
            integrate(&constrained, m, &y, 1e-3, 3);
        }
    }
}

#[test]
fn constraints_that_make_no_sense_are_refused() {
    let mut network = network(&[1.0; 2], &[]);
    assert_eq!(network.constraint_error(&[0.0; 6]), None);
    assert!(!network.forces_in_use().contains(&"constraints"));
    let point = |particle, x| Constraint::Point { particle, position: vector(x, 0.0, 0.0) };
    let circle = |normal, radius| Constraint::Circle { particle: 0, center: ZERO, normal, radius };
    let sphere =
        |x, radius| Constraint::Sphere { particle: 1, center: vector(0.0, x, 0.0), radius };
    let line =
        |x, direction| Constraint::Line { particle: 1, point: vector(0.0, x, 0.0), direction };
    let up = vector(0.0, 1.0, 0.0);
    for (constraint, says) in [
        (point(2, 0.0), "0 to 1"),
        (point(0, f64::NAN), "finite"),
        (line(f64::INFINITY, up), "finite"),
        (line(0.0, ZERO), "direction"),
        (line(0.0, up * f64::NAN), "direction"),
        (circle(ZERO, 1.0), "direction"),
        (circle(up, 0.0), "radius"),
        (sphere(0.0, -1.0), "radius"),
        (sphere(f64::NAN, 1.0), "finite"),
        (rod(0, 2, 1.0), "0 to 1"),
        (rod(1, 1, 1.0), "twice"),
        (rod(0, 1, 0.0), "length"),
    ] {
        let refused = network.add_constraint(constraint).unwrap_err().to_string();
        assert!(refused.contains(says), "{refused}");
    }
    assert!(network.set_baumgarte_frequency(0.0).is_err());
    assert!(network.constraints().is_empty() && network.baumgarte_frequency().is_none());
    network.add_constraint(line(0.0, up * 3.0)).unwrap();
    assert_eq!(network.constraints(), [line(0.0, up)]);
    assert!(network.forces_in_use().contains(&"constraints"));
    assert!(!network.forces_in_use().contains(&"spring damping"));
    assert_eq!(network.baumgarte_frequency(), Some(10.0));
}

/// Evaluations do not depend on earlier ones, with which they share scratch.
#[test]
fn evaluations_are_functions_of_their_arguments() {
    let ((network, y), (other, z)) = (driven(0.5), chain(10));
    let evaluate = |network: &Network, y: &[f64]| {
        let mut out = vec![f64::NAN; y.len()];
        network.eval_f(0.3, y, &mut out);
        out
    };
    let first = evaluate(&network, &y);
    evaluate(&other, &z);
    let lost = evaluate(&other, &vec![f64::NAN; z.len()]);
    assert!(lost.iter().any(|a| a.is_nan()));
    assert_eq!(first, evaluate(&network, &y));
}

fn scene((network, state): (Network, Vec<f64>)) -> Scene {
    Scene::new("rods", Model::Network(Box::new(network)), state)
}

/// A hand that pulls at rods in any direction keeps their lengths and bounds their velocities.
#[test]
fn a_hand_gets_no_farther_than_rods_let_it() {
    for grabbed in [3, 10] {
        let run = Simulation::new(scene(chain(10)), method("rk4"), Control::Step(0.005));
        let mut run = run.unwrap();
        run.grab(grabbed).unwrap();
        // Within the chain's reach, the particle comes to the target.
        let target = vector(0.3, 0.5, 0.4) * (0.15 * grabbed as f64);
        for _ in 0..150 {
            run.pull(target);
            run.take_steps(4).unwrap();
        }
        let left = (run.position(grabbed) - target).norm();
        assert!(left < 0.2, "{left} m");
        let mut furthest = 0.0f64;
        for k in 0..600 {
            let turn = f64::from(k / 20) * 2.4;
            run.pull(vector(8.0 * turn.cos(), 8.0 * (1.3 * turn).sin(), turn.sin()));
            run.take_steps(4).unwrap();
            furthest = furthest.max(error(run.model().network().unwrap(), run.state()));
        }
        assert!(furthest < 1e-2, "{furthest} m");
        run.release();
        run.take_steps(1000).unwrap();
        assert!(error(run.model().network().unwrap(), run.state()) < 1e-4);
    }
}

/// A hand moves the end of a rod between pins to at least 0.95 and at most 1.05 lengths from the
/// other end.
#[test]
fn a_hand_keeps_the_length_of_a_rod() {
    let mut network = weightless(&[1.0; 2], &[rod(0, 1, 2.0)]);
    let y = state(&[ZERO, vector(2.0, 0.0, 0.0)], &[ZERO; 2]);
    for i in 0..2 {
        network.pin(i, Path::Still(of(&y, i)[0])).unwrap();
    }
    for (target, end) in [
        (vector(9.0, 0.0, 0.0), vector(2.1, 0.0, 0.0)),
        (vector(-9.0, 0.0, 0.0), vector(1.9, 0.0, 0.0)),
        (vector(2.0, 0.4, 0.0), vector(2.0, 0.4, 0.0)),
    ] {
        let scene = scene((network.clone(), y.clone()));
        let mut run = Simulation::new(scene, method("rk4"), Control::Step(0.01)).unwrap();
        run.grab(1).unwrap();
        run.pull(target);
        run.advance_to(3.0).unwrap();
        assert!((run.position(1) - end).norm() < 1e-12, "{}", run.position(1));
    }
}

/// Baumgarte stabilisation limits the step too. No state of rest is found for a scene with
/// constraints, whose modes around it would leave these out.
#[test]
fn stability_knows_of_the_feedback() {
    let scene = scene(chain(3));
    let system = scene.model.system();
    let modes = spectrum(system, 0.0, &scene.state);
    let euler = largest_step(method("euler"), &modes).unwrap().unwrap();
    assert!((euler.step - 0.2).abs() < 1e-3, "{}", euler.step);
    let mechanics = system.mechanics().unwrap().linearized().unwrap();
    let x = &scene.state[..scene.state.len() / 2];
    let fastest = LargestMode::default().estimate(mechanics, 0.0, x).unwrap();
    assert_eq!(fastest.frequency(), 10.0);
    assert!(rest(&scene, || true).unwrap().is_none());
}

/// A sheet that hangs from point constraints moves like one that hangs from pins; it is stepped by
/// whole arrays, as sweeps do not support constraints.
#[test]
fn a_sheet_hangs_from_points_as_from_pins() {
    let grid = Grid::new(4, 5).unwrap();
    let n = grid.particles();
    let x: Vec<_> =
        (0..n).map(|k| vector(0.5 * (k % 5) as f64, 0.0, 0.5 * (k / 5) as f64)).collect();
    let y = state(&x, &vec![ZERO; n]);
    let sheet = |constraints: &[Constraint]| {
        let mut network = network(&vec![0.5; n], constraints);
        let sheet = Sheet::new(grid, 0.5, [40.0, 20.0, 10.0], 0.01).unwrap();
        network.add(sheet).unwrap();
        network
    };
    let point = |particle: usize| Constraint::Point { particle, position: x[particle] };
    let pointed = sheet(&[point(0), point(4)]);
    let mut pinned = sheet(&[]);
    for i in [0, 4] {
        pinned.pin(i, Path::Still(x[i])).unwrap();
    }
    for name in ["rk4", "verlet", "symplectic"] {
        let [a, b] =
            [&pointed, &pinned].map(|network| integrate(network, method(name), &y, 1e-4, 10_000));
        assert!(distance(&a, &b) < 1e-4, "{name}: {}", distance(&a, &b));
        assert!(error(&pointed, &a) < 1e-12, "{name}");
    }
}
