//! Orders of convergence of bounces that the force of contact turns: each method's own, up to about
//! 4, since the third derivative of the force jumps where it begins.

use a3_core::accuracy::{Frames, Metric, Precision, Reference, Scope, choose};
use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::{Method, Network, Path, Touch, Vector3, integrators};

use crate::common::{described, distance, method};

/// Length of all runs (s).
const UNTIL: f64 = 1.0;

/// A particle above a floor, or a particle above a free triangle, with gravity and a little drag.
fn system(on_floor: bool) -> (Network, Vec<f64>) {
    let skin = Skin {
        thickness: 0.2,
        stiffness: 600.0,
        damping: 0.0,
        friction: 0.0,
    };
    let count = if on_floor { 1 } else { 4 };
    let mut network = Network::new(vec![1.0; count]).unwrap();
    if on_floor {
        let floor = Obstacle {
            thickness: 0.2,
            ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::zeros()))
        };
        network.add_obstacle(floor).unwrap();
        network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    } else {
        network.set_triangles([[1, 2, 3]]).unwrap();
    }
    network.set_drag(0.3).unwrap();
    let touch = Touch {
        skins: vec![skin; count],
        edges: vec![[0, 0]],
        bodies: true,
    };
    network.set_touch(Some(touch)).unwrap();
    let places = [
        [0.0, 0.35, 0.0],
        [1.0, 0.0, 0.1],
        [-0.6, 0.05, 0.9],
        [-0.5, 0.0, -0.8],
    ];
    let mut y = vec![0.0; 6 * count];
    for (i, place) in places[..count].iter().enumerate() {
        for axis in 0..3 {
            y[axis * count + i] = place[axis];
        }
    }
    if on_floor {
        y[3] = 0.2;
    } else {
        y[3 * count] = 0.1;
        y[4 * count] = -0.9;
    }
    (network, y)
}

/// Order by the root mean squares of the errors at many steps, and at a quarter of each: where in a
/// step a bounce begins makes single errors larger or smaller.
fn order(system: &Network, method: &Method, y0: &[f64], exact: &[f64], fewest: u32) -> f64 {
    let square = |steps: u32| {
        let mut integrator = method.integrator(system).unwrap();
        let mut y = y0.to_vec();
        let h = UNTIL / f64::from(steps);
        for k in 0..steps {
            let t = f64::from(k) * h;
            integrator.step(system, t, h, &mut y).unwrap();
        }
        distance(&y, exact).powi(2)
    };
    let counts = || (0..12).map(|k| fewest + k * fewest / 24);
    let [coarse, fine] = [1, 4].map(|more| counts().map(|n| square(more * n)).sum::<f64>());
    (coarse / fine).log2() / 4.0
}

#[test]
fn methods_keep_their_order_up_to_four() {
    for on_floor in [true, false] {
        let (network, y0) = system(on_floor);
        let exact = {
            let m = method("rk4");
            let mut integrator = m.integrator(&network).unwrap();
            let mut y = y0.clone();
            let h = UNTIL / 50_000.0;
            for k in 0..50_000 {
                integrator
                    .step(&network, f64::from(k) * h, h, &mut y)
                    .unwrap();
            }
            y
        };
        for m in integrators::METHODS {
            if m.check(&network).is_err() {
                continue;
            }
            // Methods of higher order are soon as exact as double precision allows.
            let (fewest, own) = match m.order {
                order @ 1..=2 => (1000, f64::from(order)..=f64::from(order)),
                4 => (800, 4.0..=4.0),
                _ => (200, 3.7..=4.9),
            };
            let found = order(&network, m, &y0, &exact, fewest);
            assert!(
                (own.start() - 0.2..own.end() + 0.2).contains(&found),
                "{}, on a floor: {on_floor}: order {found:.2}, not {own:?}",
                m.name
            );
        }
    }
}

/// The scene of the chart in docs/methods.md: its reference is sure, no run of these steps is held
/// by the guard, and what is chosen for an error meets it.
#[test]
fn the_chart_of_a_bounce_has_a_sure_reference() {
    let scene = described(include_str!("../../../../docs/scenes/bounce.toml"));
    let precision = Precision {
        metric: Metric::Position,
        uncertainty: 1e-10,
        most: 80_000.0,
    };
    let (frames, scope, go_on) = (Frames::new(UNTIL), Scope::default(), || true);
    let reference = Reference::new(&scene, frames, scope, precision, &go_on)
        .unwrap()
        .unwrap();
    assert!(
        reference.floor.position < 1e-9,
        "{:e} m",
        reference.floor.position
    );
    let best = choose(&scene, &reference, Metric::Position, 1e-4, &go_on, |_| ())
        .unwrap()
        .unwrap();
    let outcome = best[0].outcome;
    assert!(
        outcome.errors.position <= 1e-4,
        "{:e} m",
        outcome.errors.position
    );
    assert_eq!(outcome.guarded.impulses, 0);
}
