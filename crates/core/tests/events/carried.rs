//! Particles that rest and slide on curved and moving obstacles, by methods with a tolerance.

use crate::common::{described, method};
use a3_core::{Control, Simulation};

/// Final state of the first particle of a scene: position and velocity (m, m/s).
fn end(text: &str, name: &str, tolerance: f64, until: f64) -> [f64; 6] {
    let control = Control::Tolerance(tolerance);
    let mut run = Simulation::new(described(text), method(name), control).unwrap();
    run.advance_to(until).unwrap();
    let n = run.particles();
    std::array::from_fn(|k| run.state()[k * n])
}

/// Checks that a scene's particle ends at this state.
fn ends_at(text: &str, until: f64, right: [f64; 6]) {
    for name in ["dop853", "verner65", "dopri5"] {
        for (tolerance, most) in [(1e-3, 2e-3), (1e-6, 4e-6), (1e-9, 1e-8)] {
            let state = end(text, name, tolerance, until);
            for (k, (a, b)) in state.iter().zip(right).enumerate() {
                let off = (a - b).abs();
                assert!(off < most, "{name} {tolerance}, number {k}: {off}\n{text}");
            }
        }
    }
}

#[test]
fn a_belt_carries_a_particle_along_until_it_stops() {
    // Friction accelerates it by mu g until it has the speed of the belt, and stops it as fast.
    let scene = "gravity = [0, -9.81, 0]
        particles = { positions = [[0.3, 0.1, 0], [5, 0, 0]], mass = 1 }
        [[box]]
        center = [0, 0, 0]
        size = [8, 0.2, 2]
        friction = 0.3
        shift = { by = [2, 0, 0], start = 0.2, end = 1.2 }";
    ends_at(scene, 2.0, [2.3, 0.1, 0.0, 0.0, 0.0, 0.0]);
}

/// A particle slides off a ball, from an angle to the vertical, and leaves it where the ball would
/// have to pull. The right states are those of the equation of the angle, by `SciPy` with a
/// tolerance of 1e-12.
#[test]
fn a_particle_leaves_a_ball_where_the_equation_of_its_angle_says() {
    let scene = |angle: f64, friction: f64, shape: &str| {
        let (sin, cos) = angle.to_radians().sin_cos();
        format!(
            "gravity = [0, -9.81, 0]
            particles = {{ positions = [[{sin}, {cos}, 0]], mass = 1 }}
            {shape}
            radius = 1
            friction = {friction}"
        )
    };
    let sphere = "[[sphere]]\ncenter = [0, 0, 0]";
    let capsule = "[[capsule]]\nfrom = [0, 0, -1]\nto = [0, 0, 1]";
    // After each step, the reaction acts along the mean of the normals at both ends, of order 2.
    let off = |angle: f64, control: Control, name: &str, right: f64| {
        let scene = described(&scene(angle, if angle == 30.0 { 0.1 } else { 0.0 }, sphere));
        let mut run = Simulation::new(scene, method(name), control).unwrap();
        run.advance_to(1.0).unwrap();
        (run.state()[0] - right).abs()
    };
    for (angle, right) in [(10.0, 1.202_006_61), (30.0, 1.571_934_53)] {
        for (h, most) in [(1e-2, 3e-4), (1e-3, 3e-6)] {
            let off = off(angle, Control::Step(h), "verlet", right);
            assert!(off < most, "{angle}, {h}: {off}");
        }
    }
    for (tolerance, most) in [(1e-6, 3e-5), (1e-9, 1e-6)] {
        let off = off(10.0, Control::Tolerance(tolerance), "dprkn86", 1.202_006_61);
        assert!(off < most, "{tolerance}: {off}");
    }
    for shape in [sphere, capsule] {
        let smooth = [1.202_006_61, -0.211_990_12, 0.0, 1.666_191_07, -4.550_272_69, 0.0];
        ends_at(&scene(10.0, 0.0, shape), 1.0, smooth);
        let rough = [1.571_934_53, -2.087_659_74, 0.0, 1.323_435_09, -7.468_612_89, 0.0];
        ends_at(&scene(30.0, 0.1, shape), 1.0, rough);
    }
}

/// A table turns about the vertical: with enough friction a particle goes round with it, with
/// little it slides out. Then the right state is that of its equation in the plane, by DOP853 of
/// `SciPy`.
#[test]
fn a_turntable_carries_a_particle_or_throws_it_off() {
    let scene = |friction: f64| {
        format!(
            "gravity = [0, -9.81, 0]
            particles = {{ positions = [[0.3, 0.1, 0]], velocities = [[0, 0, -0.3]], mass = 1 }}
            [[box]]
            center = [0, 0, 0]
            size = [2, 0.2, 2]
            friction = {friction}
            turn = {{ axis = [0, 1, 0], rate = 1 }}"
        )
    };
    let (sin, cos) = 2.0_f64.sin_cos();
    let round = [0.3 * cos, 0.1, -0.3 * sin, -0.3 * sin, 0.0, -0.3 * cos];
    ends_at(&scene(0.8), 2.0, round);
    let out = [-0.063_599_47, 0.1, -0.480_285_42, -0.336_688_75, 0.0, -0.127_240_01];
    ends_at(&scene(0.02), 2.0, out);
}

/// A box that swings up and down throws a particle where it accelerates downwards faster than it
/// falls, and catches it: the particle then has the speed of the box.
#[test]
fn a_swinging_box_throws_a_particle_and_catches_it() {
    let (amplitude, rate, gravity): (f64, f64, f64) = (0.05, 20.0, 9.81);
    let scene = format!(
        "gravity = [0, -{gravity}, 0]
        particles = {{ positions = [[0.3, 0.1, 0]], mass = 1 }}
        [[box]]
        center = [0, 0, 0]
        size = [2, 0.2, 2]
        sine = {{ amplitude = [0, {amplitude}, 0], rate = {rate} }}"
    );
    let height = |t: f64| 0.1 + amplitude * (rate * t).sin();
    let speed = |t: f64| amplitude * rate * (rate * t).cos();
    let thrown = (gravity / (amplitude * rate * rate)).asin() / rate;
    let until = thrown + 0.1;
    let fallen = [
        height(thrown) + speed(thrown) * 0.1 - 0.5 * gravity * 0.01,
        speed(thrown) - gravity * 0.1,
    ];
    ends_at(&scene, until, [0.3, fallen[0], 0.0, 0.0, fallen[1], 0.0]);
    let carried = 0.6 * thrown;
    ends_at(&scene, carried, [0.3, height(carried), 0.0, 0.0, speed(carried), 0.0]);
    // Caught before the box is at its lowest, it rises with it again.
    let again = (std::f64::consts::TAU - 0.5) / rate;
    ends_at(&scene, again, [0.3, height(again), 0.0, 0.0, speed(again), 0.0]);
}

/// A tilted capsule that turns about its axis catches a particle, which slides until it sticks, is
/// carried along, slides again and leaves. The right state is that of each of these phases, by
/// DOP853 of `SciPy` with a tolerance of 1e-13.
#[test]
fn a_slide_begins_in_the_direction_in_which_a_particle_is_driven() {
    let scene = "gravity = [0, -9.81, 0]
        particles = { positions = [[0.02, 0.3, 0.01]], velocities = [[0.1, 0, 0.05]], mass = 0.1 }
        [[capsule]]
        from = [0, 0, -1]
        to = [0, 0.1, 1]
        radius = 0.2
        friction = 0.4
        turn = { axis = [0, 0.0499376, 0.9987523], rate = 2 }";
    let right =
        [-0.168_333_85, 0.158_884_63, 0.014_886_48, -0.594_038_87, -0.923_593_48, -0.005_153_28];
    for name in ["dop853", "verner65", "dopri5"] {
        for (tolerance, most) in [(1e-6, 2e-5), (1e-9, 2e-6)] {
            let state = end(scene, name, tolerance, 0.6);
            let off = state.iter().zip(right).map(|(a, b)| (a - b).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < most, "{name} {tolerance}: {off}");
        }
    }
    for (h, most) in [(1e-2, 5e-4), (1e-3, 2.5e-4), (1e-4, 2e-5)] {
        let mut run =
            Simulation::new(described(scene), method("verlet"), Control::Step(h)).unwrap();
        run.advance_to(0.6).unwrap();
        for (a, b) in run.state().iter().zip(&right[..3]) {
            assert!((a - b).abs() < most, "{h}: {a}, not {b}");
        }
    }
}
