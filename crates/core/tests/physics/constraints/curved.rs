//! Rods that slide over obstacles whose normal turns within a step: a ball, and a board that turns.
//! The reaction acts along the mean of the normals at both ends of a step, and friction along the
//! mean of the slips.

use a3_core::{Control, Simulation, integrators};

use super::G;
use crate::common::described;

/// Methods, the control by which they run, and the error that each may make (m).
const ALL: [(&str, Control, f64); 4] = [
    ("rk4", Control::Step(1e-3), 3e-5),
    ("verlet", Control::Step(1e-3), 3e-5),
    ("dopri5", Control::Tolerance(1e-6), 5e-5),
    ("dop853", Control::Tolerance(1e-8), 1e-5),
];

/// Returns the place (m) of the first particle at time t (s).
fn place(scene: &str, (name, control): (&str, Control), t: f64) -> [f64; 3] {
    let method = integrators::find(name).unwrap();
    let mut run = Simulation::new(described(scene), method, control).unwrap();
    run.advance_to(t).unwrap_or_else(|why| panic!("{name}: {why}"));
    assert_eq!(run.gained(), None, "{name}");
    let n = run.state().len() / 6;
    [0, 1, 2].map(|axis| run.state()[axis * n])
}

/// Angle from the vertical (rad) of the first of two particles, of these masses (kg), that a rod
/// joins on a ball, after a time t (s) from rest. The rod pulls each along its chord, by `pull`.
fn slid(masses: [f64; 2], [first, apart]: [f64; 2], radius: f64, friction: f64, t: f64) -> f64 {
    let half = 0.5 * apart;
    let acceleration = |[angle, rate]: [f64; 2]| {
        // Of each: the acceleration along the ball is a + b pull.
        let of = |k: usize| {
            let (m, angle) = (masses[k], angle + [0.0, apart][k]);
            let pressed = G * angle.cos() - radius * rate * rate;
            let a = G * angle.sin() - friction * pressed;
            let b = ([1.0, -1.0][k] * half.cos() - friction * half.sin()) / m;
            (a, b)
        };
        let [(a, b), (c, d)] = [of(0), of(1)];
        let pull = (c - a) / (b - d);
        (a + b * pull) / radius
    };
    let steps = 20_000;
    let h = t / f64::from(steps);
    let mut y = [first, 0.0];
    for _ in 0..steps {
        let moved = |k: [f64; 2], share: f64| [y[0] + k[0] * share * h, y[1] + k[1] * share * h];
        let rate = |y: [f64; 2]| [y[1], acceleration(y)];
        let middle = rate(moved(rate(y), 0.5));
        y = moved(middle, 1.0);
    }
    y[0]
}

#[test]
fn a_rod_slides_over_a_ball() {
    let (masses, angles, radius, t) = ([1.0, 2.0], [0.0, 0.4], 0.8, 0.45_f64);
    for friction in [0.0, 0.1] {
        let at = |angle: f64| [radius * angle.sin(), radius * angle.cos()];
        let [[x, y], [u, w]] = [at(angles[0]), at(angles[0] + angles[1])];
        let scene = format!(
            "gravity = [0, -{G}, 0]
            [particles]
            positions = [[{x}, {y}, 0], [{u}, {w}, 0]]
            masses = [{}, {}]
            [[constraint]]
            rod = [0, 1]
            [[sphere]]
            center = [0, 0, 0]
            radius = {radius}
            friction = {friction}",
            masses[0], masses[1]
        );
        let angle = slid(masses, angles, radius, friction, t);
        assert!(angle > 0.2, "{angle}");
        for (name, control, most) in ALL {
            let [x, y, _] = place(&scene, (name, control), t);
            let error = (x - at(angle)[0]).hypot(y - at(angle)[1]);
            assert!(error < most, "{name}, friction {friction}: {error:e} m");
        }
    }
}

#[test]
fn a_rod_slides_over_a_board_that_turns() {
    let (rate, height, first, t) = (1.0_f64, 0.05, 0.2, 0.6);
    let scene = format!(
        "gravity = [0, -{G}, 0]
        [particles]
        positions = [[{first}, {height}, 0], [{}, {height}, 0]]
        masses = [1, 2]
        [[constraint]]
        rod = [0, 1]
        [state]
        velocities = [[-{height}, {first}, 0], [-{height}, {}, 0]]
        [[box]]
        center = [0, 0, 0]
        size = [4, {}, 4]
        turn = {{ axis = [0, 0, 1], rate = {rate} }}",
        first + 0.5,
        first + 0.5,
        2.0 * height
    );
    // On the board, the centre of mass moves by s'' = w2 s - g sin w t.
    let centre = first + 0.5 * 2.0 / 3.0;
    let pulled = 0.5 * G / rate.powi(2);
    let along = centre * (rate * t).cosh() - pulled * (rate * t).sinh() + pulled * (rate * t).sin();
    let own = along - (centre - first);
    let (sin, cos) = (rate * t).sin_cos();
    let expected = [own * cos - height * sin, own * sin + height * cos];
    for (name, control, most) in ALL {
        let [x, y, _] = place(&scene, (name, control), t);
        let error = (x - expected[0]).hypot(y - expected[1]);
        assert!(error < most, "{name}: {error:e} m");
    }
}

/// A rod that spins as it slides over a floor.
#[test]
fn friction_of_a_rod_that_spins_follows_its_slip() {
    let scene = &format!(
        "gravity = [0, -{G}, 0]
        floor = {{ height = 0, friction = 0.2 }}
        [particles]
        positions = [[0.2, 0, 0], [0.7, 0, 0]]
        masses = [1, 2]
        [[constraint]]
        rod = [0, 1]
        [state]
        velocities = [[0, 0, 0.3], [0, 0, -0.8]]"
    );
    let (mut x, mut v) = ([[0.2, 0.0], [0.7, 0.0]], [[0.0, 0.3], [0.0, -0.8]]);
    let (t, steps, masses) = (0.3, 30_000, [1.0, 2.0]);
    let h = t / f64::from(steps);
    let rates = |x: &[[f64; 2]; 2], v: &[[f64; 2]; 2]| {
        let rubbed = v.map(|[a, b]| [a, b].map(|part| -0.2 * G * part / f64::hypot(a, b)));
        let [d, u, f] = [x, v, &rubbed].map(|it| [it[1][0] - it[0][0], it[1][1] - it[0][1]]);
        let dot = |a: [f64; 2], b: [f64; 2]| a[0] * b[0] + a[1] * b[1];
        // The pull keeps the length: d . d'' + |d'|2 = 0.
        let pull = (dot(d, f) + dot(u, u)) / (dot(d, d) * (1.0 / masses[0] + 1.0 / masses[1]));
        let along =
            |k: usize, sign: f64| [0, 1].map(|c| rubbed[k][c] + sign * d[c] * pull / masses[k]);
        [along(0, 1.0), along(1, -1.0)]
    };
    for _ in 0..steps {
        let add = |a: [[f64; 2]; 2], b: [[f64; 2]; 2], by: f64| {
            [0, 1].map(|k| [0, 1].map(|c| a[k][c] + b[k][c] * by))
        };
        let [middle, speed] = [add(x, v, 0.5 * h), add(v, rates(&x, &v), 0.5 * h)];
        x = add(x, speed, h);
        v = add(v, rates(&middle, &speed), h);
    }
    for (name, control, most) in ALL {
        let [found, _, z] = place(scene, (name, control), t);
        let error = (found - x[0][0]).hypot(z - x[0][1]);
        assert!(error < most, "{name}: {error:e} m");
    }
}
