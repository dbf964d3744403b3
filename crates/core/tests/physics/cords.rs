//! Springs that only pull.

use std::fmt::Write;

use a3_core::{Linearized, Mechanics, Simulation};

use crate::common::{described, method, state_random};

const G: f64 = 9.81;

/// A mass is thrown up from a spring that only pulls: it flies freely, falls, and is caught again
/// with half an oscillation.
#[test]
fn a_cord_lets_go_and_catches_again() {
    let scene = described(&format!(
        "gravity = [0, -{G}, 0]\n[particles]\npositions = [[0, 0, 0], [0, -1, 0]]\nmass = 2\n\
         velocities = [[0, 0, 0], [0, 3, 0]]\nsprings = [[0, 1, 50, 1, 0]]\ntension_only = true\n\
         pin = [{{ particles = [0] }}]\n"
    ));
    // It comes back to the length of the cord after 2 v / g, with the same speed, and then x = a
    // (1 - cos wt) + v/w sin wt below that, with a = m g / k.
    let (flight, w, a) = (6.0 / G, 5.0_f64, 2.0 * G / 50.0);
    let t = 0.3;
    let below = a * (1.0 - (w * t).cos()) + 3.0 / w * (w * t).sin();
    for (name, value, bound) in [
        ("dop853", 1e-9, 1e-6),
        ("verlet", 1e-3, 1e-4),
        ("rk4", 1e-3, 1e-5),
        ("bdf", 1e-7, 1e-4),
        ("tr-bdf2", 1e-3, 1e-4),
        ("implicit-midpoint", 1e-3, 1e-4),
    ] {
        let method = method(name);
        let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
        run.advance_to(flight + t).unwrap();
        let error = (run.position(1).y + 1.0 + below).abs();
        assert!(error < bound, "{name}: {error:e}");
    }
    for name in ["xpbd", "vbd"] {
        let method = method(name);
        assert!(Simulation::new(scene.clone(), method, method.control(0.01)).is_err());
    }
}

/// Springs at random places, some of them slack: the differential agrees with difference quotients
/// of the forces, and no spring pushes, however fast its ends approach.
#[test]
fn the_differential_is_the_slope_of_the_forces() {
    let mut text = String::from("[particles]\nmass = 1\ntension_only = true\npositions = [");
    let places = state_random(24, 3);
    for i in 0..8 {
        let [x, y, z] = [0, 8, 16].map(|axis| places[axis + i]);
        write!(text, "[{x}, {y}, {z}], ").unwrap();
    }
    text += "]\nsprings = [";
    for i in 0..8 {
        for j in i + 1..8 {
            write!(text, "[{i}, {j}, 20, 1.1, 0.5], ").unwrap();
        }
    }
    let scene = described(&(text + "]\n"));
    let network = scene.model.network().unwrap();
    let (x, noise) = (&scene.state[..24], state_random(72, 4));
    let (v, d, dv) = (&noise[..24], &noise[24..48], &noise[48..]);
    let forces = |s: f64| {
        let at = |a: &[f64], d: &[f64]| -> Vec<f64> {
            a.iter().zip(d).map(|(a, d)| a + s * d).collect()
        };
        let mut f = vec![0.0; 24];
        network.forces(0.0, &at(x, d), &at(v, dv), &mut f);
        f
    };
    let mut df = vec![0.0; 24];
    network.force_differential(0.0, x, v, d, dv, &mut df);
    let e = 1e-6;
    let (ahead, behind) = (forces(e), forces(-e));
    for k in 0..24 {
        let difference = (ahead[k] - behind[k]) / (2.0 * e);
        assert!((difference - df[k]).abs() < 1e-5, "{difference} {}", df[k]);
    }
    // Two particles alone, at all lengths and rates.
    let pair = described(
        "[particles]\nmass = 1\ntension_only = true\npositions = [[0, 0, 0], [1, 0, 0]]\nsprings = [[0, 1, 10, 1, 3]]\n",
    );
    let pair = pair.model.network().unwrap();
    for (length, rate, pull) in
        [(0.9, 5.0, 0.0), (1.1, 0.5, 2.5), (1.1, -1.0, 0.0), (1.0, 1.0, 0.0)]
    {
        let mut f = [0.0; 6];
        pair.forces(
            0.0,
            &[0.0, length, 0.0, 0.0, 0.0, 0.0],
            &[0.0, rate, 0.0, 0.0, 0.0, 0.0],
            &mut f,
        );
        assert!((f[0] - pull).abs() < 1e-12 && f[0] == -f[1], "{length} {rate}: {f:?}");
    }
}
