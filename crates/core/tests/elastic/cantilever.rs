//! A bar that is held at one end and bends a little under its weight. Linear tetrahedra are too
//! stiff in bending (locking), but less so if they are smaller.

use a3_core::elements::Hyperelastic;
use a3_core::{Path, Vector3};

use crate::box_of::{Bar, DENSITY, rubber};
use crate::common::method;

const SIZE: [f64; 3] = [1.0, 0.1, 0.1];

/// Deflection of the end of Timoshenko's beam under its weight (m), of a square section: by
/// bending, q L4 / 8 E I, and by shear, q L2 / 2 k G A (Cowper, 1966).
fn deflection(young: f64, poisson: f64, gravity: f64) -> f64 {
    let [length, height, width] = SIZE;
    let (area, inertia) = (height * width, width * height.powi(3) / 12.0);
    let load = DENSITY * area * gravity;
    let shear = young / (2.0 * (1.0 + poisson));
    let share = 10.0 * (1.0 + poisson) / (12.0 + 11.0 * poisson);
    load * length.powi(4) / (8.0 * young * inertia)
        + load * length.powi(2) / (2.0 * share * shear * area)
}

/// Deflection of a bar with `across` cells in its width and twice as many in its height, over that
/// of the beam: one step of implicit Euler, so long that inertia is negligible, solves the linear
/// equations.
fn of_cells(across: usize) -> f64 {
    let material = rubber(Hyperelastic::NeoHookean);
    let gravity = 1e-4;
    let mut bar = Bar::new([5 * across, across, across], SIZE, material);
    let n = bar.rest.len();
    for i in (0..n).filter(|i| bar.rest[*i].x == 0.0).collect::<Vec<_>>() {
        bar.network.pin(i, Path::Still(bar.rest[i])).unwrap();
    }
    bar.network.set_gravity(Vector3::new(0.0, -gravity, 0.0));
    let mut y = [bar.moved(|p| p), vec![0.0; 3 * n]].concat();
    let mut implicit = method("implicit").integrator(&bar.network).unwrap();
    implicit.step(&bar.network, 0.0, 1e4, &mut y).unwrap();
    let tip = (0..n).filter(|i| bar.rest[*i].x == SIZE[0]).collect::<Vec<_>>();
    let fallen = |i: &usize| bar.rest[*i].y - y[n + i];
    let mean = tip.iter().map(fallen).sum::<f64>() / tip.len() as f64;
    mean / deflection(material.young, material.poisson, gravity)
}

/// The error is 87, 65 and 33 % with 1, 2 and 4 cells across.
#[test]
fn a_cantilever_bends_more_the_finer_it_is() {
    for (across, expected) in [(1, 0.130), (2, 0.352), (4, 0.668)] {
        let share = of_cells(across);
        assert!((share - expected).abs() < 5e-4, "{across}: {share}");
    }
}
