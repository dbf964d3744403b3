//! Time for which motion can be predicted.

use crate::common::{described, scene};
use a3_core::accuracy::horizon;
use a3_core::{Ode, Scene};

/// A planar truss under a load buckles out of its plane; a double pendulum is chaotic in its own.
#[test]
fn buckling_out_of_a_plane_is_no_chaos() {
    let truss = described(
        "gravity = [0, -9.81, 0]
        [particles]
        positions = [[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0], [1, 1, 0], [2, 1, 0]]
        mass = 0.5
        springs = [[0, 1, 400, 1, 0], [1, 2, 400, 1, 0], [3, 4, 400, 1, 0], [4, 5, 400, 1, 0],
            [0, 4, 400, 1.41421356, 0], [1, 3, 400, 1.41421356, 0], [1, 5, 400, 1.41421356, 0],
            [2, 4, 400, 1.41421356, 0], [1, 4, 400, 1, 0], [2, 5, 400, 1, 0]]
        pin = [{ particles = [0, 3] }]",
    );
    let found = horizon(&truss, f64::INFINITY, &|| true).unwrap().unwrap();
    assert!(found.buckles && found.lyapunov < 1.0, "{found:?}");
    let found = horizon(&scene("double-pendulum"), f64::INFINITY, &|| true).unwrap().unwrap();
    assert!(!found.buckles && found.lyapunov.is_finite(), "{found:?}");
}

/// A box that falls by 3 mm and then rests on a rough slope is predictable: the contact, which is
/// absent at the start, needs shorter steps.
#[test]
fn contact_to_come_is_no_chaos() {
    let box_on_slope = described(
        "gravity = [4.905, -8.496, 0]
        floor = { height = 0, friction = 0.7 }
        [[body]]
        parts = [{ box = [0.4, 0.2, 0.3] }]
        density = 500
        at = [0, 0.1035, 0]
        friction = 0.7",
    );
    let found = horizon(&box_on_slope, f64::INFINITY, &|| true).unwrap();
    let found = found.unwrap();
    assert!(found.lyapunov.is_infinite(), "{found:?}");
    assert!(found.until == 10.0 && found.motion < 0.01, "{found:?}");
}

/// Rod that stands upright on a pin under a weak gravity: differences grow as cosh(w t), 10-fold in
/// 10 s. That is too little for a Lyapunov time, and more than hardly.
#[test]
fn growth_is_told_where_it_is_no_chaos() {
    let upright = |gravity: f64| {
        described(&format!(
            "gravity = [0, {gravity}, 0]
            [particles]
            positions = [[0, 0, 0], [0, 1, 0]]
            mass = 1
            pin = [{{ particles = [0] }}]
            [[constraint]]
            rod = [0, 1]"
        ))
    };
    let find = |gravity| horizon(&upright(gravity), f64::INFINITY, &|| true);
    let grown = [-0.09, 0.09].map(|gravity| find(gravity).unwrap().unwrap());
    assert!(grown.iter().all(|found| found.lyapunov.is_infinite() && found.until == 10.0));
    assert!((3.0..10.2).contains(&grown[0].growth), "{grown:?}");
    assert!((0.9..1.1).contains(&grown[1].growth), "{grown:?}");
}

/// A solution that a stiff system approaches at once attracts its neighbours.
#[test]
fn stiff_motion_that_dies_out_is_no_chaos() {
    for k in [1e2, 1e5, 1e8] {
        let system = Ode::new(1, move |t: f64, y: &[f64], dydt: &mut [f64]| {
            dydt[0] = -k * (y[0] - t.cos());
        });
        let scene = Scene::new("follower", system.unwrap(), vec![1.0]);
        let found = horizon(&scene, f64::INFINITY, &|| true).unwrap().unwrap();
        assert!(found.lyapunov.is_infinite() && found.growth < 2.0, "{k:e}: {found:?}");
    }
}

/// Numbers that grow from a small start to their size are predictable, though the errors of both
/// runs are larger than the distance at which they begin.
#[test]
fn growth_from_a_small_start_is_no_chaos() {
    for (unit, until) in [(1.0, 10.0), (1e10, 1e11)] {
        let driven = Ode::new(1, move |t: f64, _: &[f64], dydt: &mut [f64]| {
            dydt[0] = (t / unit).cos() / unit;
        });
        let scene = Scene::new("driven", driven.unwrap(), vec![1e-8]);
        let found = horizon(&scene, until, &|| true).unwrap().unwrap();
        assert!(found.lyapunov.is_infinite() && found.growth < 2.0, "{unit:e}: {found:?}");
    }
}

/// Hares and foxes that turn in a cycle: in other units, their numbers are predictable as long, and
/// an epidemic, too.
#[test]
fn numbers_of_any_size_are_as_predictable() {
    for [hares, foxes] in [[1.0, 1.0], [1e4, 1e-2], [1e-6, 1e9]] {
        let cycle = move |_t: f64, y: &[f64], dydt: &mut [f64]| {
            dydt[0] = y[0] * (1.0 - y[1] / foxes);
            dydt[1] = y[1] * (y[0] / hares - 1.0);
        };
        let cycle =
            Scene::new("cycle", Ode::new(2, cycle).unwrap(), vec![0.5 * hares, 0.5 * foxes]);
        let found = horizon(&cycle, f64::INFINITY, &|| true).unwrap().unwrap();
        assert!(found.until == 10.0 && found.growth < 10.0, "{hares} {foxes}: {found:?}");
    }
    let epidemic = |_t: f64, y: &[f64], dydt: &mut [f64]| {
        let (caught, healed) = (0.5e-7 * y[0] * y[1], 0.1 * y[1]);
        dydt.copy_from_slice(&[-caught, caught - healed, healed]);
    };
    let epidemic = Scene::new("epidemic", Ode::new(3, epidemic).unwrap(), vec![1e7, 1.0, 0.0]);
    let found = horizon(&epidemic, 120.0, &|| true).unwrap().unwrap();
    assert!(found.until == 120.0 && found.lyapunov.is_infinite(), "{found:?}");
}
