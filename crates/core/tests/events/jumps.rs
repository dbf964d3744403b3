//! Velocities that jump: at starts that do not fit the constraints, and where pins begin and cease
//! to move. Every method has the same motion, which is known exactly.

use a3_core::{Scene, Simulation, Vector3};

use crate::common::{described, method, simulation};

/// Methods of each kind, in steps or to tolerances that are accurate enough for six digits.
const RUNS: [(&str, f64); 7] = [
    ("rk4", 2e-3),
    ("verlet", 1e-3),
    ("dop853", 1e-9),
    ("verner65", 1e-9),
    ("tr-bdf2", 2e-3),
    ("implicit-midpoint", 2e-3),
    ("implicit", 1e-3),
];

/// Run of a scene up to a time (s), in which nothing puts in energy.
fn run(scene: &Scene, (name, value): (&str, f64), until: f64) -> Simulation {
    let method = method(name);
    let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
    run.advance_to(until).unwrap();
    run.conclude().unwrap();
    assert!(run.gained().is_none(), "{name}: {:?}", run.gained());
    run
}

/// Compares the places of particles at a time (s) with those by every method.
fn expect(text: &str, until: f64, places: &[(usize, [f64; 3])], tolerance: f64) {
    let scene = described(text);
    for of in RUNS {
        let run = run(&scene, of, until);
        for (i, place) in places {
            let off = (run.position(*i) - Vector3::from(*place)).norm();
            assert!(off < tolerance, "{}: particle {i} is off by {off}", of.0);
        }
    }
}

#[test]
fn masses_that_part_on_a_rod_stay() {
    let text = "[particles]\npositions = [[0, 0, 0], [1, 0, 0]]\nmass = 1\n\
                velocities = [[-0.5, 0, 0], [0.5, 0, 0]]\n[[constraint]]\nrod = [0, 1]";
    let places = [(0, [0.0; 3]), (1, [1.0, 0.0, 0.0])];
    expect(text, 0.5, &places, 1e-12);
    assert!((described(text).fitted - 0.5).abs() < 1e-15);
    // Velocities that fit stay as they are.
    let fits = text.replace("[-0.5, 0, 0], [0.5, 0, 0]", "[0, -1, 0], [0, 1, 0]");
    assert_eq!(described(&fits).fitted, 0.0);
}

/// The bead keeps the part of its velocity along the wire, 1 m/s.
#[test]
fn a_bead_begins_along_its_wire() {
    let text = "[particles]\npositions = [[1, 0, 0]]\nmass = 1\nvelocities = [[0.6, 1, 0]]\n\
                [[constraint]]\nparticle = 0\n\
                circle = { center = [0, 0, 0], normal = [0, 0, 1], radius = 1 }";
    let (sin, cos) = 0.5_f64.sin_cos();
    let scene = described(text);
    for of in RUNS {
        let run = run(&scene, of, 0.5);
        let off = (run.position(0) - Vector3::new(cos, sin, 0.0)).norm();
        // Implicit Euler is of order 1.
        let most = if of.0 == "implicit" { 1e-3 } else { 2e-6 };
        assert!(off < most, "{}: {off}", of.0);
    }
}

/// The ends rebound as those of a rope that is a little longer and tightens later.
#[test]
fn a_rope_that_begins_taut_rebounds() {
    let text = "[particles]\npositions = [[0, 0, 0], [1, 0, 0]]\nmass = 1\n\
                velocities = [[-0.5, 0, 0], [0.5, 0, 0]]\n[[constraint]]\nrope = [0, 1]\n\
                restitution = 1";
    let places = [(0, [0.25, 0.0, 0.0]), (1, [0.75, 0.0, 0.0])];
    expect(text, 0.5, &places, 1e-12);
}

/// A pin lifts a rod from 0.1 s to 0.6 s at 1 m/s. The rod pulls a weight along, and stops it with
/// the pin.
#[test]
fn a_pin_that_starts_pulls_at_once() {
    let text = "[particles]\npositions = [[0, 0, 0], [0, -1, 0]]\nmass = 1\n\
                pin = [{ particles = [0], shift = { by = [0, 0.5, 0], start = 0.1, end = 0.6 } }]\n\
                [[constraint]]\nrod = [0, 1]";
    for (until, y) in [(0.1, -1.0), (0.35, -0.75), (0.6, -0.5), (0.9, -0.5)] {
        expect(text, until, &[(1, [0.0, y, 0.0])], 1e-9);
    }
    // The run is the same if its steps do not end where the pin starts, or if it is watched there.
    let scene = described(text);
    for (name, value) in [("rk4", 0.007), ("implicit", 0.007), ("verlet", 0.007)] {
        let method = method(name);
        let mut run = Simulation::new(scene.clone(), method, method.control(value)).unwrap();
        for time in [0.0999, 0.1, 0.1001, 0.104, 0.5] {
            run.advance_to(time).unwrap();
            let lifted = (time - 0.1).max(0.0);
            let y = run.position(1).y;
            assert!((y + 1.0 - lifted).abs() < 1e-9, "{name} at {time} s: {y}");
        }
        assert!(run.gained().is_none(), "{name}");
    }
}

/// The step that ends with the pin's motion ends a rounding error later: 350 x 0.001 > 0.35.
#[test]
fn no_part_of_a_step_is_a_rounding_error() {
    let text = "[particles]\npositions = [[0, 0, 0], [0, -1, 0]]\nmass = 1\n\
                pin = [{ particles = [0], shift = { by = [0, 0.3, 0], start = 0.05, end = 0.35 } }]\n\
                [[constraint]]\nrod = [0, 1]";
    let scene = described(text);
    for name in ["rk4", "verlet", "tr-bdf2", "implicit-midpoint", "implicit"] {
        let run = run(&scene, (name, 0.001), 0.351);
        // The rod stops the weight with the pin.
        let y = run.position(1).y;
        assert!((y + 0.7).abs() < 1e-9, "{name}: {y}");
    }
}

/// Pin on a circle about the other end of a rod, which stays, until 0.2 s. Then both turn about the
/// middle, at half of the pin's speed.
#[test]
fn a_pin_lets_go_of_a_rod_that_turns() {
    let text = "[particles]\npositions = [[0, 0, 0], [0, -1, 0]]\nmass = 1\n\
                pin = [{ particles = [0], turn = { about = [0, -1, 0], axis = [0, 0, 1], rate = 3 }, \
                until = 0.2 }]\n[[constraint]]\nrod = [0, 1]";
    let at = |angle: f64| Vector3::new(-angle.sin(), angle.cos(), 0.0);
    let along = Vector3::new(-(0.6_f64.cos()), -(0.6_f64.sin()), 0.0);
    let since = 0.3;
    let middle = Vector3::new(0.0, -1.0, 0.0) + 0.5 * at(0.6) + 1.5 * since * along;
    let expected = middle - 0.5 * at(0.6 + 3.0 * since);
    let scene = described(text);
    for of in RUNS {
        let run = run(&scene, of, 0.2 + since);
        let off = (run.position(1) - expected).norm();
        let most = if of.0 == "implicit" { 1e-2 } else { 2e-5 };
        assert!(off < most, "{}: {off}", of.0);
    }
}

/// A body that a pin leads at 3 m/s for a second tows a ball on a rope with 0.3 m of slack.
#[test]
fn a_body_that_is_led_tows_another_one() {
    let text = "[[body]]\nparts = [{ ball = 0.1 }]\nmass = 1\n[[body]]\n\
                parts = [{ box = [0.2, 0.2, 0.2] }]\nmass = 1\nat = [1, 0, 0]\n\
                pin = [{ particles = [0], shift = { by = [3, 0, 0], end = 1 } }]\n\
                [[constraint]]\nrope = [0, 2]\nlength = 1.3";
    for (until, x) in [(0.1, 0.0), (0.5, 1.2), (1.0, 2.7), (1.2, 3.3)] {
        expect(text, until, &[(0, [x, 0.0, 0.0])], 1e-8);
    }
}

/// A pin pulls a weight over a rough floor by a rod: the weight follows at the pin's speed, and the
/// rod keeps its length in spite of friction.
#[test]
fn a_rod_pulls_a_weight_over_a_rough_floor() {
    let text = "gravity = [0, -9.81, 0]\nfloor = { height = 0, friction = 0.5 }\n[particles]\n\
                positions = [[0, 0, 0], [1, 0, 0]]\nmass = 1\n\
                pin = [{ particles = [0], shift = { by = [-3, 0, 0], end = 3 } }]\n\
                [[constraint]]\nrod = [0, 1]";
    expect(text, 1.0, &[(1, [0.0, 0.0, 0.0])], 2e-5);
}

/// Two weights on rods, whose upper end begins to swing to and fro at its greatest speed. The place
/// is that by implicit midpoint and TR-BDF2 at small steps, and by a model that shares no code.
#[test]
fn a_double_pendulum_swings_from_its_first_moment() {
    for (name, value) in
        [("rk4", 1e-3), ("verner65", 1e-9), ("dop853", 1e-8), ("implicit-midpoint", 1e-3)]
    {
        let mut run = simulation("double-pendulum", name, value);
        run.set_swinging(true);
        run.advance_to(1.0).unwrap();
        let off = run.position(2) - Vector3::new(1.033_99, -1.823_35, 0.0);
        assert!(off.norm() < 3e-5, "{name}: {}", run.position(2));
    }
}

/// A pendulum stands upright on a pivot that shakes quickly (Kapitza).
#[test]
fn a_pendulum_stands_on_a_pivot_that_shakes() {
    let text = "gravity = [0, -9.81, 0]\n[particles]\npositions = [[0, 0, 0], [0.1, 0.995, 0]]\n\
                mass = 1\npin = [{ particles = [0], sine = { amplitude = [0, 0.1, 0], rate = 60 } }]\n\
                [[constraint]]\nrod = [0, 1]";
    let scene = described(text);
    let ends = [("rk4", 1e-3), ("verner65", 1e-8), ("implicit-midpoint", 5e-4)];
    let ends = ends.map(|of| run(&scene, of, 1.0).position(1));
    assert!(ends.iter().all(|end| (end - ends[0]).norm() < 2e-3), "{ends:?}");
    assert!(ends[0].y > 0.8);
}
