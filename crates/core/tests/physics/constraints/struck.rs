//! Impacts of particles that rods and wires hold, against closed forms of the impulses.

use a3_core::{Control, Simulation, Vector3, integrators};

use super::{G, of, vector};
use crate::common::described;

/// Masses of the ends of a rod (kg), where it begins (m), and its direction.
const MASSES: [f64; 2] = [1.0, 2.0];
const HEIGHT: f64 = 0.5;
const ALONG: Vector3<f64> = Vector3::new(0.36, 0.8, 0.48);

/// Methods with the control by which they run.
fn all() -> Vec<(&'static str, Control)> {
    let step = |name| (name, Control::Step(1e-3));
    let close = |name| (name, Control::Tolerance(1e-9));
    let fixed = ["rk4", "verlet", "implicit-midpoint"].map(step);
    let adaptive = ["dopri5", "dop853"].map(close);
    fixed.into_iter().chain(adaptive).collect()
}

fn run(scene: &str, (name, control): (&str, Control), t: f64) -> Simulation {
    let method = integrators::find(name).unwrap();
    let mut run = Simulation::new(described(scene), method, control).unwrap();
    run.advance_to(t).unwrap_or_else(|why| panic!("{name}: {why}"));
    assert_eq!(run.gained(), None, "{name}");
    run
}

/// Velocities (m/s) of both ends of a rod along `ALONG` after the lower one has struck a floor at
/// the velocity v (m/s): the impulse P at the floor and R along the rod. P grows along the normal
/// until the end rises as it has to, and along the floor until the end no longer slips or P is on
/// the cone of friction.
fn struck(v: Vector3<f64>, restitution: f64, friction: f64) -> [Vector3<f64>; 2] {
    let [a, b] = MASSES.map(f64::recip);
    // Friction is along the slip: its components change by one measure.
    let most = a + b;
    let own = |p: Vector3<f64>| p * a - ALONG * (ALONG.dot(&p) * a * a / (a + b));
    let y = Vector3::y();
    let mut impulse = Vector3::zeros();
    for _ in 0..10_000 {
        let after = v + own(impulse);
        impulse.y += (-restitution * v.y - after.y) / own(y).y;
        let slip = v + own(impulse);
        impulse.x -= 0.5 * slip.x / most;
        impulse.z -= 0.5 * slip.z / most;
        let rubbed = impulse.x.hypot(impulse.z);
        if rubbed > friction * impulse.y {
            impulse.x *= friction * impulse.y / rubbed;
            impulse.z *= friction * impulse.y / rubbed;
        }
    }
    let passed = ALONG * (ALONG.dot(&impulse) * a * b / (a + b));
    [v + own(impulse), v + passed]
}

/// A rod that falls on its lower end.
fn rod(restitution: f64, friction: f64, body: bool) -> String {
    let low = if body { HEIGHT + 0.1 } else { HEIGHT };
    let [x, y, z] = <[f64; 3]>::from(ALONG + vector(0.0, low, 0.0));
    let (positions, masses, rod, ball) = if body {
        let ball = format!(
            "[[body]]
            parts = [{{ ball = 0.1 }}]
            mass = 1
            at = [0, {low}, 0]
            restitution = {restitution}
            friction = {friction}"
        );
        (format!("[{x}, {y}, {z}]"), "2", "[1, 0]", ball)
    } else {
        let both = format!("[0, {low}, 0], [{x}, {y}, {z}]");
        (both, "1, 2", "[0, 1]", String::new())
    };
    format!(
        "gravity = [0, -{G}, 0]
        floor = {{ height = 0, restitution = {restitution}, friction = {friction} }}
        [particles]
        positions = [{positions}]
        masses = [{masses}]
        [[constraint]]
        rod = {rod}
        {ball}"
    )
}

/// Positions (m) of both ends at a time (s) after an impact at the velocities v (m/s): the middle
/// of mass flies on a parabola, and the rod turns at one rate.
fn flown(v: [Vector3<f64>; 2], low: Vector3<f64>, t: f64) -> [Vector3<f64>; 2] {
    let whole = MASSES[0] + MASSES[1];
    let drop = vector(0.0, -0.5 * G * t * t, 0.0);
    let speed = (v[0] * MASSES[0] + v[1] * MASSES[1]) / whole;
    let middle = low + ALONG * (MASSES[1] / whole) + speed * t + drop;
    let turning = v[1] - v[0];
    let angle = turning.norm() * t;
    let turned = ALONG * angle.cos() + turning.normalize() * angle.sin();
    [middle - turned * (MASSES[1] / whole), middle + turned * (MASSES[0] / whole)]
}

#[test]
fn the_end_of_a_rod_rebounds_with_the_mass_that_the_rod_leaves_it() {
    let fall = (2.0 * HEIGHT / G).sqrt();
    for (restitution, friction) in [(1.0, 0.0), (0.6, 0.0), (0.9, 0.1), (0.7, 2.0)] {
        let after = struck(vector(0.0, -G * fall, 0.0), restitution, friction);
        let expected = flown(after, Vector3::zeros(), 0.05);
        for method in all() {
            let run = run(&rod(restitution, friction, false), method, fall + 0.05);
            for (i, expected) in expected.into_iter().enumerate() {
                let off = (of(run.state(), i)[0] - expected).norm();
                assert!(
                    off < 2e-5,
                    "{}, e {restitution}, friction {friction}, end {i}: {off:e} m",
                    method.0
                );
            }
        }
    }
}

/// A ball on a rod falls on a floor, as a particle in its place does.
#[test]
fn a_body_on_a_rod_rebounds_like_a_particle() {
    let fall = (2.0 * HEIGHT / G).sqrt();
    let after = struck(vector(0.0, -G * fall, 0.0), 1.0, 0.0);
    for name in ["rk4", "verlet"] {
        let run = run(&rod(1.0, 0.0, true), (name, Control::Step(2e-4)), fall + 0.02);
        let (n, y) = (run.model().particles(), run.state());
        // The rod turns by as much as it does without gravity.
        let expected = flown(after, vector(0.0, 0.1, 0.0), 0.02);
        for (i, expected) in [(1, expected[0]), (0, expected[1])] {
            let place = vector(y[i], y[n + i], y[2 * n + i]);
            let off = (place - expected).norm();
            assert!(off < 2e-4, "{name}, {i}: {off} m");
        }
    }
}

/// A rod of 1 m with equal masses slides down on its lower end, on a smooth floor: its middle goes
/// straight down, and its energy gives the rate at any angle. Contact moves the lower end, and the
/// rod passes that on, in every step: by methods of fixed steps that is of order 2, and adaptive
/// ones see its error, which is proportional to the cube of a step.
#[test]
fn a_rod_slides_down_on_its_end() {
    let (begun, ended, rate) = (1.1_f64, 0.5_f64, -0.5);
    let inertia = |angle: f64| 1.0 + angle.cos().powi(2);
    let rate_at = |angle: f64| {
        let energy = inertia(begun) * rate * rate + 4.0 * G * (begun.sin() - angle.sin());
        (energy / inertia(angle)).sqrt()
    };
    let (intervals, width) = (1000, (begun - ended) / 1000.0);
    let weighted = (0..=intervals).map(|k| {
        let ends = k == 0 || k == intervals;
        let weight = [2.0, 4.0][k % 2] * if ends { 0.5 } else { 1.0 };
        weight / rate_at(ended + width * k as f64)
    });
    let time = weighted.sum::<f64>() * width / 3.0;
    let ([sin, cos], half) = ([begun.sin(), begun.cos()], 0.5 * rate);
    let scene = format!(
        "gravity = [0, -{G}, 0]
        floor = 0
        [particles]
        positions = [[{}, 0, 0], [{}, {sin}, 0]]
        velocities = [[{}, 0, 0], [{}, {}, 0]]
        mass = 1
        [[constraint]]
        rod = [0, 1]",
        -0.5 * cos,
        0.5 * cos,
        half * sin,
        -half * sin,
        rate * cos
    );
    let expected = vector(0.5 * ended.cos(), ended.sin(), 0.0);
    let error = |method| (of(run(&scene, method, time).state(), 1)[0] - expected).norm();
    for name in ["rk4", "verlet", "midpoint", "implicit-midpoint"] {
        let [coarse, fine] = [64.0, 128.0].map(|count| error((name, Control::Step(time / count))));
        assert!(coarse < 1e-4 && fine < 0.3 * coarse, "{name}: {coarse:e} m, {fine:e} m");
    }
    for name in ["dopri5", "dop853"] {
        for tolerance in [1e-4, 1e-6, 1e-8] {
            let off = error((name, Control::Tolerance(tolerance)));
            assert!(off < 0.5 * tolerance.powf(2.0 / 3.0), "{name} {tolerance:e}: {off:e} m");
        }
    }
}

/// A bead on a wire, or on a taut rope, rebounds elastically from balls in any direction: the bead
/// on the wire just turns back, and no energy is lost. At the end of a step it is on the ball up to
/// rounding, inside or outside.
#[test]
fn beads_rebound_from_balls_at_any_angle() {
    for k in 0..40 {
        let angle = 0.05 + 0.03 * f64::from(k);
        let (sin, cos) = angle.sin_cos();
        let [x, y] = [0.3 * cos, 0.3 * sin];
        for is_rope in [false, true] {
            let constraint = if is_rope {
                "rope = [0, 1]".to_string()
            } else {
                "particle = 0
                line = { point = [0.45, 0.1, 0], direction = [1, 0, 0] }"
                    .to_string()
            };
            let scene = format!(
                "contact_gravity = {G}
                [particles]
                positions = [[0.45, 0.1, 0], [0.45, 0.6, 0]]
                velocities = [[-2, 0, 0], [0, 0, 0]]
                mass = 1
                pin = [{{ particles = [1] }}]
                [[constraint]]
                {constraint}
                [[sphere]]
                center = [{}, {}, 0]
                radius = 0.3
                restitution = 1",
                0.3 - x,
                0.1 - y * 0.3
            );
            for method in all() {
                let speed = speeds(&run(&scene, method, 0.25), [0])[0].norm();
                assert!((speed - 2.0).abs() < 1e-3, "{}, {angle}, {is_rope}: {speed}", method.0);
            }
        }
    }
}

/// A ladder leans on a smooth wire with its foot on a rough floor: for a rod of equal masses that
/// needs the friction tan(angle) / 2, and no more. With less it slides.
#[test]
fn the_foot_of_a_ladder_stays_where_friction_holds_it() {
    let moved = |friction: f64, method| {
        let scene = format!(
            "gravity = [0, -{G}, 0]
            floor = {{ height = 0, friction = {friction} }}
            [particles]
            positions = [[0, 0.8, 0], [0.6, 0, 0]]
            mass = 1
            [[constraint]]
            rod = [0, 1]
            [[constraint]]
            particle = 0
            line = {{ point = [0, 0, 0], direction = [0, 1, 0] }}"
        );
        (of(run(&scene, method, 0.9).state(), 1)[0] - vector(0.6, 0.0, 0.0)).norm()
    };
    let loose = [("dopri5", Control::Tolerance(1e-4)), ("dop853", Control::Tolerance(1e-6))];
    for method in all().into_iter().chain(loose) {
        let [held, sliding] = [0.4, 0.35].map(|friction| moved(friction, method));
        assert!(held < 2e-4 && sliding > 0.2, "{}: {held:e} m, {sliding} m", method.0);
    }
}

/// A rod of two particles of 1 kg falls along the side of a box, which its lower end touches, and
/// its upper end strikes the top. The box holds the lower end while that is struck: with the speeds
/// s of the upper end upwards and r across, the ends have the velocities (0, r - 1) and (-r, s),
/// and the rod at 45 degrees demands 2 r = 1 + s.
#[test]
fn a_rod_that_is_struck_pushes_what_touches() {
    for restitution in [0.0, 0.3, 0.5, 1.0] {
        let scene = format!(
            "contact_gravity = {G}
            [particles]
            positions = [[0, -0.3, 0], [0.4, 0.1, 0]]
            velocities = [[0, -1, 0], [0, -1, 0]]
            mass = 1
            [[constraint]]
            rod = [0, 1]
            [[box]]
            center = [0.5, -0.5, 0]
            size = [1, 1, 1]
            restitution = {restitution}"
        );
        let across = 0.5 * (1.0 + restitution);
        let expected = [vector(0.0, across - 1.0, 0.0), vector(-across, restitution, 0.0)];
        for method in all() {
            let found = speeds(&run(&scene, method, 0.101), [0, 1]);
            for (found, expected) in found.into_iter().zip(expected) {
                let off = (found - expected).norm();
                assert!(off < 4e-3, "{}, e {restitution}: {found}", method.0);
            }
        }
    }
}

/// A bead on an inclined wire falls on a floor, and goes back up the wire at e times its speed.
#[test]
fn a_bead_on_a_wire_rebounds_along_it() {
    let scene = format!(
        "gravity = [0, -{G}, 0]
        floor = {{ height = 0, restitution = 0.6 }}
        [particles]
        positions = [[0, 0.6, 0]]
        mass = 1.5
        [[constraint]]
        particle = 0
        line = {{ point = [0, 0.6, 0], direction = [0.8, -0.6, 0] }}"
    );
    let along = 0.6 * G;
    let fall = (2.0 / along).sqrt();
    for method in all() {
        let run = run(&scene, method, fall + 0.1);
        let [_, v] = of(run.state(), 0);
        let speed = v.dot(&vector(-0.8, 0.6, 0.0));
        let expected = 0.6 * along * fall - along * 0.1;
        assert!((speed - expected).abs() < 1e-4, "{}: {speed}", method.0);
    }
}

/// Chains of rods thrown at a rough elastic floor gain no energy.
#[test]
fn chains_on_an_elastic_floor_gain_no_energy() {
    for seed in 0..8_u32 {
        let number = |k: u32| f64::from((seed * 7919 + k * 104_729) % 1000) / 1000.0;
        let links = (0..4).map(|k| {
            let [a, b, c] = [0, 1, 2].map(|axis| number(3 * k + axis) - 0.5);
            [a, 0.6 + 0.5 * f64::from(k) + 0.3 * b, c]
        });
        let positions: Vec<_> = links.collect();
        let scene = format!(
            "gravity = [0, -{G}, 0]
            floor = {{ height = 0, friction = 0.4, restitution = 1 }}
            [particles]
            positions = {positions:?}
            masses = [0.4, 0.6, 1.8, 1.4]
            [[constraint]]
            rod = [0, 1]
            [[constraint]]
            rod = [1, 2]
            [[constraint]]
            rod = [2, 3]"
        );
        for (name, control) in [
            ("rk4", Control::Step(5e-4)),
            ("verlet", Control::Step(5e-4)),
            ("dopri5", Control::Tolerance(1e-6)),
        ] {
            let mut run = run(&scene, (name, control), 0.0);
            let begun = run.energy().unwrap().total();
            for k in 1..=20 {
                let end = run.advance_to(0.1 * f64::from(k));
                end.unwrap_or_else(|why| panic!("{seed} by {name}: {why}"));
                let gained = run.energy().unwrap().total() - begun;
                assert!(gained < 0.01 * begun, "{seed} by {name}: {gained} of {begun} J");
            }
        }
    }
}

/// A rope whose ends lie on a floor rebounds as it does without one.
#[test]
fn a_rope_on_a_floor_keeps_its_restitution() {
    for restitution in [0.5, 1.0] {
        let scene = format!(
            "gravity = [0, -{G}, 0]
            floor = 0
            [particles]
            positions = [[0, 0, 0], [0.3, 0, 0]]
            velocities = [[0, 0, 0], [2, 0, 0]]
            mass = 1
            [[constraint]]
            rope = [0, 1]
            length = 0.51
            restitution = {restitution}"
        );
        for method in all() {
            let run = run(&scene, method, 0.2);
            let speeds = [0, 1].map(|i| of(run.state(), i)[1].x);
            let expected = [1.0 + restitution, 1.0 - restitution];
            let off = (0..2).map(|i| (speeds[i] - expected[i]).abs());
            let off = off.fold(0.0, f64::max);
            assert!(off < 1e-9, "{}: {speeds:?}", method.0);
        }
    }
}

/// Velocities (m/s) of particles or bodies at a time (s).
fn speeds<const N: usize>(run: &Simulation, centers: [usize; N]) -> [Vector3<f64>; N] {
    let (n, v) = (run.particles(), run.velocities());
    centers.map(|i| vector(v[i], v[n + i], v[2 * n + i]))
}

/// Two weights on a taut rope at an angle from the vertical fall on a floor: the lower one
/// rebounds, and the upper one, which no rope can push, does not notice.
#[test]
fn a_taut_rope_pushes_nothing() {
    for (angle, friction, gravity) in
        [(0.0_f64, 0.0, 0.0), (0.0, 0.0, G), (0.7, 0.0, 0.0), (0.7, 0.5, 0.0), (1.4, 0.5, 0.0)]
    {
        for is_body in [false, true] {
            let low = if is_body { 0.35 } else { 0.3 };
            let [x, y] = [angle.sin(), low + angle.cos()];
            let weights = if is_body {
                let ball = |at: [f64; 2], mass: f64| {
                    format!(
                        "[[body]]
                        parts = [{{ ball = 0.05 }}]
                        mass = {mass}
                        at = [{}, {}, 0]
                        velocity = [0.2, -3, 0]
                        restitution = 1
                        friction = {friction}",
                        at[0], at[1]
                    )
                };
                format!("{}\n{}", ball([x, y], 2.0), ball([0.0, low], 1.0))
            } else {
                format!(
                    "[particles]
                    positions = [[{x}, {y}, 0], [0, {low}, 0]]
                    velocities = [[0.2, -3, 0], [0.2, -3, 0]]
                    masses = [2, 1]"
                )
            };
            let ends: [usize; 2] = if is_body { [0, 2] } else { [0, 1] };
            let scene = format!(
                "gravity = [0, -{gravity}, 0]
                contact_gravity = {G}
                floor = {{ height = 0, restitution = 1, friction = {friction} }}
                {weights}
                [[constraint]]
                rope = {ends:?}
                length = 1"
            );
            let fixed = [2e-3, 1e-3, 5e-4].map(|step| ("rk4", Control::Step(step)));
            let adaptive = [1e-3, 1e-6].map(|tolerance| ("dopri5", Control::Tolerance(tolerance)));
            for (name, control) in fixed.into_iter().chain(adaptive) {
                let run = run(&scene, (name, control), 0.12);
                let [high, low] = speeds(&run, ends);
                let rise = (3.0_f64 * 3.0 + 2.0 * gravity * 0.3).sqrt();
                let down = vector(0.0, -gravity * 0.12, 0.0);
                let up = vector(0.0, 2.0 * rise, 0.0) + down;
                let fallen = vector(0.2, -3.0, 0.0);
                let what = format!("{angle} rad, friction {friction}, body {is_body}, {control:?}");
                assert!((high - fallen - down).norm() < 2e-3, "{what}: {high}");
                // Friction stops the slip of a particle, and turns a ball.
                let slid = if friction == 0.0 {
                    0.2
                } else if is_body {
                    0.2 * 5.0 / 7.0
                } else {
                    0.0
                };
                let expected = vector(slid, -3.0, 0.0) + up;
                assert!((low - expected).norm() < 5e-3, "{what}: {low}");
            }
        }
    }
}

/// A weight on a taut rope from a pin, with another one on a rod at it, which strikes a rough
/// floor after 1 ms: the impulses of floor, friction, rod and rope solve a problem of
/// complementarity, whose solution was found by enumeration of what slips, sticks and pulls.
#[test]
fn rope_rod_and_friction_are_struck_together() {
    let scene = "gravity = [0, 0, 0]
        floor = { height = 0.6620118498440949, restitution = 1, friction = 0.5 }
        [particles]
        positions = [[0, 1, 0], [1, 1, 0], [0.057777659331341935, 0.6650118498440949, 0]]
        velocities = [[0, 0, 0], [0, -3, 0], [0, -3, 0]]
        masses = [1, 1, 1.5]
        pin = [{ particles = [0] }]
        [[constraint]]
        rope = [0, 1]
        length = 1
        [[constraint]]
        rod = [1, 2]";
    let fixed = ["rk4", "verlet"].map(|name| (name, Control::Step(1e-4)));
    for method in fixed.into_iter().chain([("dopri5", Control::Tolerance(1e-8))]) {
        let run = run(scene, method, 0.0011);
        let found = speeds(&run, [1, 2]);
        let expected = [vector(-0.0008, -0.2745, 0.0), vector(-1.1659, 3.0024, 0.0)];
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).norm() < 1e-3, "{}: {found}", method.0);
        }
    }
}

/// Two boxes on a slider at its limit, where no force holds them, fall on a floor: at the lower
/// limit both rebound as one, at the upper one they part.
#[test]
fn the_limit_of_a_slider_passes_impulses_one_way() {
    for (limits, after) in [("[0, 0.5]", [3.0, 3.0]), ("[-0.5, 0]", [3.0, -3.0])] {
        let scene = format!(
            "gravity = [0, 0, 0]
            contact_gravity = {G}
            floor = {{ height = 0, restitution = 1 }}
            [[body]]
            parts = [{{ box = [0.1, 0.1, 0.1] }}]
            mass = 1
            at = [0, 0.35, 0]
            velocity = [0, -3, 0]
            [[body]]
            parts = [{{ box = [0.1, 0.1, 0.1] }}]
            mass = 2
            at = [0, 1.35, 0]
            velocity = [0, -3, 0]
            [[joint]]
            bodies = [0, 1]
            slider = {{ axis = [0, 1, 0], limits = {limits} }}"
        );
        let fixed = [2e-3, 1e-3, 5e-4, 1e-4].map(|step| ("rk4", Control::Step(step)));
        let adaptive = [1e-3, 1e-6].map(|tolerance| ("dopri5", Control::Tolerance(tolerance)));
        for (name, control) in fixed.into_iter().chain(adaptive) {
            let run = run(&scene, (name, control), 0.15);
            let found = speeds(&run, [0, 9]).map(|v| v.y);
            for (found, after) in found.into_iter().zip(after) {
                assert!((found - after).abs() < 0.01, "{limits} {control:?}: {found}");
            }
        }
    }
}

/// An observer who moves along sees the same impact: what a moving box does to the end of a rod, of
/// a particle or a ball, does not depend on the frame.
#[test]
fn rods_rebound_alike_from_moving_boxes() {
    let (friction, restitution, time) = (0.4, 0.6, 0.06);
    let seen = |body: bool, w: Vector3<f64>, method| {
        let write = |v: Vector3<f64>| format!("[{}, {}, {}]", v.x, v.y, v.z);
        let velocity = |v: Vector3<f64>| write(v + w);
        let (fast, slow) = (vector(-2.4, -2.0, 1.8), vector(-1.9, -2.06, 1.82));
        let upper = vector(0.08, 0.62, -0.17);
        // The rates of both ends along the rod are the same.
        let along = upper - vector(0.0, 0.06, 0.0);
        let slow = slow + along * ((fast - slow).dot(&along) / along.norm_squared());
        let lower = if body {
            format!(
                "[[body]]
                parts = [{{ ball = 0.05 }}]
                mass = 1
                at = [0, 0.11, 0]
                velocity = {}
                friction = {friction}
                restitution = {restitution}",
                velocity(fast)
            )
        } else {
            String::new()
        };
        let (positions, velocities, masses, rod) = if body {
            (write(upper), velocity(fast), "1.5", "[1, 0]")
        } else {
            let positions = format!("[0, 0.06, 0], {}", write(upper));
            let velocities = format!("{}, {}", velocity(fast), velocity(slow));
            (positions, velocities, "1, 1.5", "[0, 1]")
        };
        let scene = format!(
            "gravity = [0, 0, 0]
            [particles]
            positions = [{positions}]
            velocities = [{velocities}]
            masses = [{masses}]
            [[box]]
            center = [0, -2, 0]
            size = [40, 4, 40]
            friction = {friction}
            restitution = {restitution}
            shift = {{ by = {}, end = 10 }}
            [[constraint]]
            rod = {rod}
            {lower}",
            write(w * 10.0)
        );
        let run = run(&scene, method, time);
        let (n, y) = (run.model().particles(), run.state());
        let place = |i: usize| vector(y[i], y[n + i], y[2 * n + i]) - w * time;
        [place(0), place(1)]
    };
    for method in all() {
        for body in [false, true] {
            let still = seen(body, Vector3::zeros(), method);
            for w in [vector(0.1, 0.0, 0.0), vector(0.0, 0.01, 0.0), vector(0.3, 0.5, -0.2)] {
                let apart = seen(body, w, method);
                let apart = (0..2).map(|i| (apart[i] - still[i]).norm());
                let apart = apart.fold(0.0, f64::max);
                assert!(apart < 1e-6, "{}, {body}, {w:?}: {apart:e} m", method.0);
            }
        }
    }
}
