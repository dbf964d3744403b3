//! The default cloth with the explicit trapezoid at a step of 0.01 s: it stays stable for any
//! action of a hand.

use crate::common::simulation;
use a3_core::{Simulation, Vector3};

const FRAME: f64 = 1.0 / 60.0;

/// Largest stretch up to time `until` (s), while `hand` acts on the run before every frame.
fn worst_stretch(
    run: &mut Simulation,
    until: f64,
    mut hand: impl FnMut(&mut Simulation, u64),
) -> f64 {
    let mut worst: f64 = 0.0;
    for frame in 0..(until / FRAME) as u64 {
        hand(run, frame);
        run.advance_to(run.time() + FRAME).unwrap_or_else(|e| panic!("{e}"));
        worst = worst.max(run.largest_stretch().unwrap());
    }
    worst
}

#[test]
fn it_hangs_without_sagging() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    assert!(run.particles() >= 256);
    let swaying = worst_stretch(&mut run, 5.0, |_, _| {});
    run.advance_to(60.0).unwrap();
    let rest = run.largest_stretch().unwrap();
    println!("stretch: {swaying:.3} swaying, {rest:.3} at rest");
    let energy = run.energy().unwrap();
    assert!(energy.kinetic < 1e-4, "it comes to rest: {energy:?}");
    assert!(rest <= 1.25 && swaying < 2.0, "{rest} {swaying}");
    assert!(run.lowest() > 0.05, "it hangs free of the floor: {}", run.lowest());
}

/// The cloth survives three simulated minutes of swing, wind, and pulls at any particle in all
/// directions, as far as a window shows.
#[test]
fn three_minutes_of_swing_wind_and_pulling() {
    let mut run = simulation("cloth", "trapezoid", 0.01);
    run.set_wind(true);
    run.set_swinging(true);
    let mut seed = 12345u64;
    let mut random = move || {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (seed >> 11) as f64 / (1u64 << 53) as f64
    };
    let mut target = Vector3::zeros();
    let worst = worst_stretch(&mut run, 180.0, |run, frame| {
        match frame % 120 {
            0 => run.grab((random() * 400.0) as usize).unwrap(),
            90 => run.release(),
            _ => {}
        }
        if frame % 15 == 0 {
            target = run.extent().0 + Vector3::from_fn(|_, _| 8.0 * random() - 4.0);
        }
        run.pull(target);
        if frame % 1800 == 900 {
            run.set_swinging(!run.swinging());
        }
        if frame % 7200 == 7199 {
            run.reset();
        }
    });
    println!("worst stretch {worst:.2}");
    assert!(worst > 2.0 && worst < 12.0, "{worst}");
}
