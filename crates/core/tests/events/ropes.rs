//! Ropes that tighten and slacken within steps, against closed forms and integrations by hand.

use a3_core::{Scene, Simulation, Vector3};

use crate::common::{described, method};

const G: f64 = 9.81;

/// Particle on a rope of 1 m from a pin at the origin.
fn on_rope(at: [f64; 3], velocity: [f64; 3], restitution: f64) -> Scene {
    described(&format!(
        "gravity = [0, -{G}, 0]\n\
         particles = {{ positions = [[0, 0, 0], {at:?}], velocities = [[0, 0, 0], {velocity:?}], \
         mass = 2, pin = [{{ particles = [0] }}] }}\n\
         [[constraint]]\nrope = [0, 1]\nlength = 1\nrestitution = {restitution}\n"
    ))
}

fn run(scene: &Scene, name: &str, value: f64, until: f64) -> Simulation {
    let method = method(name);
    let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run
}

/// Angle from the vertical and its rate after a time of a pendulum of 1 m, by steps of Runge's and
/// Kutta's method; or the time (s) at which its tension vanishes, if that is earlier.
fn swing(mut angle: f64, mut rate: f64, time: f64) -> (f64, f64, Option<f64>) {
    let (steps, f) = (200_000, |a: f64| -G * a.sin());
    let h = time / f64::from(steps);
    for k in 0..steps {
        if rate * rate + G * angle.cos() < 0.0 {
            return (angle, rate, Some(f64::from(k) * h));
        }
        let (a1, r1) = (rate, f(angle));
        let (a2, r2) = (rate + 0.5 * h * r1, f(angle + 0.5 * h * a1));
        let (a3, r3) = (rate + 0.5 * h * r2, f(angle + 0.5 * h * a2));
        let (a4, r4) = (rate + h * r3, f(angle + h * a3));
        angle += h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        rate += h / 6.0 * (r1 + 2.0 * r2 + 2.0 * r3 + r4);
    }
    (angle, rate, None)
}

/// A particle falls from 0.6 m beside the pin until the rope is tight, 0.8 m below, and swings on
/// with the part of its speed across the rope.
#[test]
fn a_fall_ends_in_a_swing_in_the_order_of_the_method() {
    let scene = on_rope([0.6, 0.0, 0.0], [0.0; 3], 0.0);
    let (tight, until) = ((1.6 / G).sqrt(), 1.3);
    let (angle, _, slack) = swing(0.6_f64.asin(), -0.6 * G * tight, until - tight);
    assert!(slack.is_none());
    let end = Vector3::new(angle.sin(), -angle.cos(), 0.0);
    let error = |name, value| (run(&scene, name, value, until).position(1) - end).norm();
    for (name, tolerance, bound) in
        [("dop853", 1e-10, 1e-8), ("dopri5", 1e-8, 1e-6), ("bdf", 1e-8, 1e-5)]
    {
        let error = error(name, tolerance);
        assert!(error < bound, "{name}: {error:e}");
    }
    // Ratios of errors of steps that are twice as long, by the order.
    for (name, least) in [
        ("euler", 1.7),
        ("symplectic", 1.7),
        ("heun", 3.4),
        ("midpoint", 3.4),
        ("verlet", 3.4),
        ("rk4", 10.0),
        ("implicit", 1.7),
        ("tr-bdf2", 3.4),
        ("implicit-midpoint", 3.4),
    ] {
        let [coarse, fine] = [4e-3, 2e-3].map(|h| error(name, h));
        assert!(coarse / fine > least, "{name}: {coarse:e} {fine:e}");
    }
}

/// With a restitution of 1, no energy is lost, and the first rebound is the mirror image of the
/// speed along the rope.
#[test]
fn a_rebound_has_the_restitution_of_the_rope() {
    for restitution in [1.0, 0.5] {
        let scene = on_rope([0.6, 0.0, 0.0], [0.0; 3], restitution);
        let (tight, rest) = ((1.6 / G).sqrt(), 0.1);
        let (speed, out) = (G * tight, Vector3::new(0.6, -0.8, 0.0));
        let across = Vector3::new(-0.8, -0.6, 0.0) * (0.6 * speed);
        let after = across - out * (restitution * 0.8 * speed);
        let down = Vector3::new(0.0, -G, 0.0);
        let end = out + after * rest + down * (0.5 * rest * rest);
        for (name, value, bound) in
            [("dop853", 1e-9, 1e-8), ("verlet", 1e-3, 1e-5), ("tr-bdf2", 1e-3, 1e-5)]
        {
            let run = run(&scene, name, value, tight + rest);
            let error = (run.position(1) - end).norm();
            assert!(error < bound, "{name}: {error:e}");
        }
    }
    let scene = on_rope([0.6, 0.0, 0.0], [0.0; 3], 1.0);
    let run = run(&scene, "dop853", 1e-9, 4.0);
    let energy = run.energy().unwrap().total();
    assert!(energy.abs() < 1e-4, "{energy:e}");
}

/// A pendulum that starts at the bottom too slowly for a whole circle leaves it where its weight
/// alone bends its course enough, and then flies freely.
#[test]
fn a_pendulum_that_is_too_slow_leaves_its_circle() {
    let rate = (3.5 * G).sqrt();
    let scene = on_rope([0.0, -1.0, 0.0], [rate, 0.0, 0.0], 0.0);
    let (angle, left, slack) = swing(0.0, rate, 2.0);
    let time = slack.unwrap();
    // At that height, v2 = g cos a and v2 = 3.5 g - 2 g (1 + cos a), with a from the top.
    assert!((-angle.cos() - 0.5).abs() < 1e-4);
    let flight = 0.2;
    let at = Vector3::new(angle.sin(), -angle.cos(), 0.0);
    let v = Vector3::new(angle.cos(), angle.sin(), 0.0) * left;
    let end = at + v * flight + Vector3::new(0.0, -0.5 * G * flight * flight, 0.0);
    assert!(end.norm() < 0.99);
    for (name, value, bound) in [
        ("dop853", 1e-10, 3e-5),
        ("verlet", 1e-3, 1e-4),
        ("rk4", 5e-3, 1e-4),
        ("tr-bdf2", 1e-3, 1e-4),
        ("implicit-midpoint", 1e-3, 1e-4),
        ("bdf", 1e-7, 1e-4),
    ] {
        let run = run(&scene, name, value, time + flight);
        let error = (run.position(1) - end).norm();
        assert!(error < bound, "{name}: {error:e}");
    }
}

/// A box and a ball fly apart until a rope from a corner of the box is tight: momentum and angular
/// momentum are conserved, and the ends approach at the speed of restitution.
#[test]
fn an_impact_of_a_rigid_body_conserves_momentum() {
    let scene = described(
        "[[body]]\nparts = [{ box = [0.4, 0.2, 0.3] }]\nmass = 3\nat = [0, 0, 0]\nspin = [0.3, -0.2, 0.5]\n\
         [particles]\npositions = [[1, 0.3, 0.2]]\nvelocities = [[2, 0.4, -0.3]]\nmass = 0.7\n\
         [[constraint]]\nrope = [0, 2]\nlength = 1.4\nrestitution = 0.6\n",
    );
    let network = scene.model.network().unwrap();
    let n = network.particles();
    let row = |y: &[f64], i: usize| Vector3::new(y[i], y[n + i], y[2 * n + i]);
    let moments = |y: &[f64]| {
        let mut sum = [Vector3::zeros(), network.rotation(0, y).momentum];
        for (i, m) in network.masses().iter().enumerate() {
            let p = row(&y[3 * n..], i) * *m;
            sum = [sum[0] + p, sum[1] + row(y, i).cross(&p)];
        }
        sum
    };
    let before = moments(&scene.state);
    let speeds = [0.0, 1.0].map(|until| {
        let run = run(&scene, "dop853", 1e-10, until);
        let after = moments(run.state());
        for (a, b) in before.iter().zip(after) {
            assert!((a - b).norm() < 1e-8, "{a} {b}");
        }
        run.energy().unwrap().kinetic
    });
    // The impact happened, and lost energy.
    assert!(speeds[1] < 0.99 * speeds[0], "{speeds:?}");
}

/// Three balls in a row on two ropes: the first, thrown away, takes the others along one by one.
#[test]
fn ropes_in_a_row_tighten_one_after_another() {
    let scene = described(
        "[particles]\npositions = [[0, 0, 0], [0.5, 0, 0], [1, 0, 0]]\n\
         velocities = [[0, 0, 0], [0, 0, 0], [3, 0, 0]]\nmass = 1\n\
         [[constraint]]\nrope = [0, 1]\nlength = 1\n[[constraint]]\nrope = [1, 2]\nlength = 1\n",
    );
    for (name, value) in [("dop853", 1e-9), ("verlet", 0.01), ("euler", 0.01)] {
        let run = run(&scene, name, value, 3.0);
        let speeds = [9, 10, 11].map(|k| run.state()[k]);
        assert!(speeds.iter().all(|v| (v - 1.0).abs() < 1e-9), "{name}: {speeds:?}");
        assert!((run.position(2).x - run.position(0).x - 2.0).abs() < 1e-6);
    }
}

#[test]
fn a_run_on_a_rope_continues_from_a_checkpoint_bit_for_bit() {
    let scene = on_rope([0.6, 0.0, 0.1], [0.0; 3], 0.3);
    for (name, value) in [("dopri5", 1e-6), ("verlet", 0.01), ("bdf", 1e-4), ("tr-bdf2", 0.01)] {
        for cut in [0.2, 0.41, 1.0] {
            let mut whole = run(&scene, name, value, cut);
            let checkpoint = whole.checkpoint();
            let mut rest = run(&scene, name, value, 0.0);
            rest.restore(&checkpoint).unwrap();
            for run in [&mut whole, &mut rest] {
                run.advance_to(2.0).unwrap();
            }
            assert_eq!(whole.state(), rest.state(), "{name} {cut}");
        }
    }
}

/// A particle on two ropes flies to and fro between them, at a triangle wave; where there are too
/// many rebounds for a fixed step, or for one time, it comes to rest.
#[test]
fn rebounds_between_two_ropes_end() {
    let speed: f64 = 0.5;
    let between = |gap: f64| {
        let length = 1.0 + gap;
        described(&format!(
            "particles = {{ positions = [[-1, 0, 0], [1, 0, 0], [0, 0, 0]], velocities = [[0, 0, 0], \
             [0, 0, 0], [{speed}, 0, 0]], mass = 2, pin = [{{ particles = [0, 1] }}] }}\n\
             [[constraint]]\nrope = [0, 2]\nlength = {length}\nrestitution = 1\n\
             [[constraint]]\nrope = [1, 2]\nlength = {length}\nrestitution = 1\n"
        ))
    };
    let (gap, until) = (1.03e-3, 1.0);
    let phase = (speed * until / gap + 1.0).rem_euclid(4.0);
    let expected = gap * (1.0 - (phase - 2.0).abs());
    for (name, value) in [("verlet", 0.01), ("rk4", 0.01), ("dopri5", 1e-6)] {
        let x = run(&between(gap), name, value, until).position(2).x;
        assert!((x - expected).abs() < 1e-6, "{name}: {x} {expected}");
    }
    for (gap, name, value) in
        [(1e-7, "verlet", 0.01), (1e-7, "rk4", 0.01), (0.0, "verlet", 0.01), (0.0, "dopri5", 1e-6)]
    {
        let run = run(&between(gap), name, value, 1.0);
        let (x, v) = (run.position(2).x, run.state()[11]);
        assert!(x.abs() < 1e-6 && v.abs() < 1e-6, "{name} {gap}: {x:e} {v:e}");
    }
}

/// A pin lifts a particle on its rope and stops. The rope does not push: the particle flies on, and
/// is caught where it falls back to its length.
#[test]
fn a_particle_flies_on_where_its_pin_stops() {
    let (speed, stop) = (0.4, 0.5);
    let scene = described(&format!(
        "gravity = [0, -{G}, 0]\n\
         particles = {{ positions = [[0, 0, 0], [0, -1, 0]], mass = 1 }}\n\
         [[pin]]\nparticles = [0]\nshift = {{ by = [0, {}, 0], start = 0, end = {stop} }}\n\
         [[constraint]]\nrope = [0, 1]\nrestitution = 0\n",
        speed * stop
    ));
    for (name, value, bound) in [
        ("rk4", 1e-3, 1e-9),
        ("verlet", 1e-3, 1e-9),
        ("tr-bdf2", 1e-3, 1e-9),
        ("implicit-midpoint", 1e-3, 1e-9),
        ("implicit", 1e-3, 3e-4),
        ("dop853", 1e-9, 1e-8),
        ("bdf", 1e-7, 1e-6),
    ] {
        for late in [0.02, 0.06, 0.2] {
            let run = run(&scene, name, value, stop + late);
            let height = run.position(1).y - speed * stop + 1.0;
            let right = (speed * late - 0.5 * G * late * late).max(0.0);
            assert!((height - right).abs() < bound, "{name} {late}: {height}");
        }
    }
}

/// Shorter steps are no worse, near the origin and far away: errors of the implicit equations are
/// rounding errors.
#[test]
fn implicit_steps_on_ropes_converge_wherever_they_are() {
    for far in [0.0, 1e4] {
        let at = |x: f64, y: f64| format!("[{}, {y}, {}]", x + far, 0.3 * x);
        let scene = described(&format!(
            "gravity = [0, -{G}, 0]\n\
             particles = {{ positions = [{}, {}, {}, {}], mass = 1, pin = [{{ particles = [0] }}] }}\n\
             [[constraint]]\nrope = [0, 1]\n[[constraint]]\nrod = [1, 2]\n[[constraint]]\nrope = [2, 3]\n",
            at(0.0, 0.0),
            at(0.8, 0.1),
            at(1.5, -0.2),
            at(2.1, 0.3)
        ));
        let until = 0.3;
        let exact = run(&scene, "dop853", 1e-11, until);
        for name in ["tr-bdf2", "implicit-midpoint"] {
            let error = |h: f64| {
                let run = run(&scene, name, h, until);
                let apart = (0..4).map(|i| (run.position(i) - exact.position(i)).norm());
                apart.fold(0.0, f64::max)
            };
            let errors = [2e-3, 5e-4, 1e-4].map(error);
            let [long, middle, short] = errors;
            let rounding = 1e-11 * (1.0 + far);
            assert!(
                middle < 0.15 * long + rounding && short < 0.15 * middle + rounding,
                "{far} {name}: {errors:?}"
            );
        }
    }
}
