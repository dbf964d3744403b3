//! Impacts of rigid and elastic bodies against closed forms, and restitution.

use a3_core::{Control, Simulation, Vector3, integrators};

use crate::common::{described, method};
use crate::pairs::Random;

const G: f64 = 9.81;

fn run(text: &str, name: &str, control: Control) -> Simulation {
    Simulation::new(described(text), method(name), control).unwrap()
}

/// Velocity and angular velocity of a body, its mass, and its centre.
struct Moving {
    x: Vector3<f64>,
    v: Vector3<f64>,
    spin: Vector3<f64>,
    momentum: Vector3<f64>,
    mass: f64,
}

fn moving(run: &Simulation, k: usize) -> Moving {
    let network = run.model().network().unwrap();
    let pose = network.pose(k, run.state());
    Moving {
        x: pose.place.position,
        v: pose.place.velocity,
        spin: pose.orientation.unwrap().spin,
        momentum: network.rotation(k, run.state()).momentum,
        mass: network.masses()[network.bodies()[k].center()],
    }
}

/// Momentum, angular momentum about the origin, and kinetic energy of all bodies.
fn conserved(run: &Simulation) -> (Vector3<f64>, Vector3<f64>, f64) {
    let (mut p, mut l) = (Vector3::zeros(), Vector3::zeros());
    for k in 0..run.model().network().unwrap().bodies().len() {
        let body = moving(run, k);
        p += body.v * body.mass;
        l += body.x.cross(&(body.v * body.mass)) + body.momentum;
    }
    (p, l, run.energy().unwrap().kinetic)
}

/// Greatest height of the lowest point after the first bounce, over that of the drop.
fn rebound(text: &str, name: &str, control: Control, scale: f64, size: f64) -> f64 {
    let mut run = run(text, name, control);
    let apex = (2.0 * scale / G).sqrt() * 1.8;
    let mut highest = 0.0_f64;
    for k in -10..=10 {
        run.advance_to(apex * (1.0 + 0.005 * f64::from(k))).unwrap();
        highest = highest.max(run.state()[run.model().particles()] - size);
    }
    highest / scale
}

/// A body that is dropped from a height rebounds to the square of the restitution, of the floor or
/// of the body, at any size.
#[test]
fn a_body_rebounds_to_the_square_of_its_restitution() {
    for scale in [1.0_f64, 1e-3, 100.0] {
        let [size, height] = [0.1 * scale, 1.1 * scale];
        let of_floor = "floor = { height = 0, restitution = 0.8 }";
        let bodies = [
            format!(
                "{of_floor}\n[[body]]\nparts = [{{ ball = {size} }}]\ndensity = 900\nat = [0, {height}, 0]"
            ),
            format!(
                "floor = 0\n[[body]]\nparts = [{{ ball = {size} }}]\ndensity = 9\nat = [0, {height}, 0]\nrestitution = 0.8"
            ),
            format!(
                "{of_floor}\n[[body]]\nparts = [{{ box = [{0}, {0}, {0}] }}]\ndensity = 900\nat = [0, {height}, 0]",
                2.0 * size
            ),
            format!(
                "floor = 0\n[particles]\npositions = [[0, {scale}, 0]]\nmass = 0.2\nrestitution = 0.8\nthickness = {}",
                0.01 * scale
            ),
        ];
        for (k, body) in bodies.iter().enumerate() {
            let text = format!("gravity = [0, -{G}, 0]\n{body}");
            let size = if k == 3 { 0.0 } else { size };
            for m in integrators::METHODS {
                let scene = described(&text);
                let is_slow = m.is_implicit() && (k < 3 || scale != 1.0);
                if is_slow || m.check(scene.model.system()).is_err() {
                    continue;
                }
                let mut controls = vec![];
                if m.check_control(Control::Step(1e-3)).is_ok() {
                    // A method of order 1 needs shorter steps for 1 %.
                    let step = if m.order == 1 { 2e-4 } else { 1e-3 };
                    controls.push(Control::Step(step * scale.sqrt()));
                }
                if m.check_control(Control::Tolerance(1e-6)).is_ok() && scale == 1.0 {
                    controls.push(Control::Tolerance(1e-6));
                }
                for control in controls {
                    let found = rebound(&text, m.name, control, scale, size);
                    let what = format!("{}, {control:?}, body {k}, {scale} m: {found}", m.name);
                    assert!((found / 0.64 - 1.0).abs() < 0.01, "{what}");
                }
            }
        }
    }
}

/// A ball that rebounds without loss keeps its energy by methods with a tolerance, of whose steps
/// that with the impact may be of order 1.
#[test]
fn an_elastic_ball_keeps_its_energy_within_a_tolerance() {
    let text = format!(
        "gravity = [0, -{G}, 0]
        floor = {{ height = 0, restitution = 1 }}
        [[body]]
        parts = [{{ ball = 0.5 }}]
        mass = 1
        at = [0, 1.5, 0]"
    );
    for name in ["bdf", "dopri5"] {
        let mut run = run(&text, name, Control::Tolerance(1e-7));
        // Between the fourth and the fifth rebound.
        run.advance_to(4.0).unwrap();
        let ball = moving(&run, 0);
        let height = ball.x.y - 0.5 + ball.v.y * ball.v.y / (2.0 * G);
        assert!((height - 1.0).abs() < 1e-4, "{name}: {height}");
    }
}

/// Bodies that rebound come to rest, and lie still.
#[test]
fn bodies_that_rebound_come_to_rest() {
    for part in ["ball = 0.1", "box = [0.2, 0.2, 0.2]"] {
        let text = format!(
            "gravity = [0, -{G}, 0]
            floor = {{ height = 0, restitution = 0.8 }}
            [[body]]
            parts = [{{ {part} }}]
            density = 900
            at = [0, 0.6, 0]"
        );
        for (name, step) in [("rk4", 1e-3), ("verlet", 1e-3), ("verlet", 2e-3)] {
            let mut run = run(&text, name, Control::Step(step));
            run.advance_to(5.0).unwrap();
            let (mut fastest, mut furthest, at) = (0.0_f64, 0.0_f64, run.position(0));
            for _ in 0..200 {
                run.take_steps(1).unwrap();
                fastest = fastest.max(moving(&run, 0).v.norm());
                furthest = furthest.max((run.position(0) - at).norm());
            }
            // Steps of Verlet without motion begin and end with a velocity of order 2.
            let most = if name == "verlet" { 150.0 * step * step } else { 1e-4 };
            assert!(
                fastest < most && furthest < 1e-5,
                "{part} {name} {step}: {fastest} m/s, {furthest} m"
            );
        }
    }
}

/// Two free bodies, from a part of each and the other keys of the second.
fn pair(first: &str, second: &str, restitution: f64) -> String {
    format!("[[body]]\n{first}\n[[body]]\n{second}\nrestitution = {restitution}")
}

/// Two balls that collide off centre: the closed form of an impact without friction.
#[test]
fn balls_meet_as_the_closed_form_says() {
    let mut random = Random(7);
    for (k, restitution) in [0.0, 0.3, 0.8, 1.0, 0.5, 0.9].into_iter().enumerate() {
        let scale = [1.0_f64, 1e-3, 100.0][k % 3];
        let [a, b] = [(); 2].map(|()| scale * (0.1 + 0.2 * random.unit()));
        let [m1, m2] = [(); 2].map(|()| 0.1 + 3.0 * random.unit());
        let off = (a + b) * (0.1 + 0.7 * random.unit());
        let speed = 4.0 * scale.sqrt();
        let thickness = 0.002 * scale;
        let text = pair(
            &format!(
                "parts = [{{ ball = {a} }}]\nmass = {m1}\nthickness = {thickness}\nspin = [0, 0, 1]"
            ),
            &format!(
                "parts = [{{ ball = {b} }}]\nmass = {m2}\nthickness = {thickness}\nat = [{}, {off}, 0]\nvelocity = [-{speed}, 0, 0]",
                2.0 * (a + b)
            ),
            restitution,
        );
        let mut run = run(&text, "rk4", Control::Step(1e-3 * scale.sqrt()));
        let (p0, l0, e0) = conserved(&run);
        run.advance_to(2.5 * (a + b) / speed).unwrap();
        let (p1, l1, e1) = conserved(&run);
        assert!((p1 - p0).norm() < 1e-12 * p0.norm());
        // Runge-Kutta itself loses some momentum in the contact layer.
        assert!((l1 - l0).norm() < 1e-9 * l0.norm(), "{l0} {l1}");
        // Along the line of centres at the touch.
        let sin = off / (a + b);
        let along = Vector3::new((1.0 - sin * sin).sqrt(), sin, 0.0);
        let approach = speed * along.x;
        let impulse = (1.0 + restitution) * approach / (1.0 / m1 + 1.0 / m2);
        let exact = along * (-impulse / m1);
        let found = moving(&run, 0).v;
        let lost =
            0.5 * (1.0 - restitution * restitution) * approach * approach / (1.0 / m1 + 1.0 / m2);
        assert!((found - exact).norm() < 0.01 * speed, "{found} {exact}");
        assert!((e0 - e1 - lost).abs() < 0.01 * e0, "{} {lost}", e0 - e1);
    }
}

/// Faces that meet without restitution stay together, at any speed: the repulsion gives nothing
/// back.
#[test]
fn boxes_without_restitution_stay_together() {
    for (name, control) in [
        ("rk4", Control::Step(3e-3)),
        ("verlet", Control::Step(3e-3)),
        ("implicit-euler", Control::Step(3e-3)),
        ("dopri5", Control::Tolerance(1e-3)),
        ("dopri5", Control::Tolerance(1e-6)),
        ("dop853", Control::Tolerance(1e-6)),
    ] {
        for speed in [0.002, 0.02, 0.3, 2.0] {
            let text = format!(
                "gravity = [0, 0, 0]
                contact_gravity = 9.81
                [[body]]
                parts = [{{ box = [0.2, 0.2, 0.2] }}]
                mass = 1
                velocity = [{speed}, 0, 0]
                [[body]]
                parts = [{{ box = [0.2, 0.2, 0.2] }}]
                mass = 3
                at = [0.21, 0, 0]"
            );
            let mut run = run(&text, name, control);
            run.advance_to(0.02 / speed + 0.3).unwrap();
            let found = [0, 1].map(|k| moving(&run, k).v);
            for v in found {
                let off = (v - Vector3::x() * (0.25 * speed)).norm();
                assert!(off < 2e-3 * speed, "{name}, {speed} m/s: {found:?}");
            }
            assert_eq!(run.gained(), None, "{name}, {speed} m/s");
        }
    }
}

/// A ball that hits a rod near its end: the rod turns away.
#[test]
fn a_rod_hit_at_its_end_turns() {
    for (restitution, arm, step) in
        [(0.0, 0.45, 1e-3), (0.8, 0.45, 1e-3), (1.0, 0.3, 1e-3), (0.8, 0.45, 1e-4)]
    {
        let (mass, ball, speed) = (2.0, 0.5, 3.0);
        let text = pair(
            &format!("parts = [{{ box = [0.02, 1, 0.02] }}]\nmass = {mass}"),
            &format!(
                "parts = [{{ ball = 0.05 }}]\nmass = {ball}\nat = [-0.5, {arm}, 0]\nvelocity = [{speed}, 0, 0]"
            ),
            restitution,
        );
        let mut run = run(&text, "rk4", Control::Step(step));
        let (p0, l0, _) = conserved(&run);
        run.advance_to(0.3).unwrap();
        let (p1, l1, _) = conserved(&run);
        assert!((p1 - p0).norm() < 1e-12 * p0.norm());
        // Runge-Kutta itself loses some momentum in the contact layer.
        assert!((l1 - l0).norm() < 1e-9 * l0.norm(), "{l0} {l1}");
        let inertia = mass * (1.0 + 0.02 * 0.02) / 12.0;
        let impulse = (1.0 + restitution) * speed / (1.0 / ball + 1.0 / mass + arm * arm / inertia);
        let [rod, of_ball] = [0, 1].map(|k| moving(&run, k));
        let exact = [impulse / mass, -arm * impulse / inertia, speed - impulse / ball];
        let found = [rod.v.x, rod.spin.z, of_ball.v.x];
        for (found, exact) in found.iter().zip(exact) {
            assert!((found - exact).abs() < 0.01 * speed, "{found} {exact}");
        }
    }
}

/// Two bodies of random shapes that spin and meet.
fn meeting(seed: usize, scale: f64, restitution: f64, random: &mut Random) -> String {
    let mut body = |k: usize| {
        let [a, b, c] = [(); 3].map(|()| scale * (0.1 + 0.2 * random.unit()));
        let part = match k % 3 {
            0 => format!("box = [{a}, {b}, {c}]"),
            1 => format!("capsule = [{}, {}]", 2.0 * a, 0.5 * b),
            _ => format!("ball = {}", 0.7 * a),
        };
        let [x, y, z] = [(); 3].map(|()| (4.0 * random.unit() - 2.0) / scale.sqrt());
        format!(
            "parts = [{{ {part} }}]\nmass = {}\nrotation = [{x}, {y}, {z}]\nspin = [{y}, {z}, {x}]",
            0.2 + random.unit()
        )
    };
    let (first, second) = (body(seed), body(seed / 3));
    let [off, up] = [(); 2].map(|()| scale * 0.1 * (random.unit() - 0.5));
    let speed = 4.0 * scale.sqrt();
    pair(
        &first,
        &format!("{second}\nat = [{scale}, {off}, {up}]\nvelocity = [-{speed}, {off}, 0]"),
        restitution,
    )
}

/// Boxes, capsules and balls that spin and collide anywhere, without friction.
#[test]
fn impacts_conserve_momenta() {
    let mut random = Random(11);
    let mut impulses = 0;
    for seed in 0..24 {
        let scale = [1.0_f64, 1e-3, 100.0][seed % 3];
        let restitution = [0.0, 0.5, 1.0, 0.8][seed % 4];
        let text = meeting(seed, scale, restitution, &mut random);
        // Runge-Kutta itself loses some momentum in the contact layer.
        for (name, most) in [("rk4", 1e-7), ("verlet", 1e-12)] {
            let mut run = run(&text, name, Control::Step(1e-3 * scale.sqrt()));
            let (p0, l0, e0) = conserved(&run);
            run.advance_to(0.5 * scale.sqrt()).unwrap();
            let (p1, l1, e1) = conserved(&run);
            impulses += run.guarded().impulses;
            let size = scale * p0.norm();
            assert!((p1 - p0).norm() < 1e-12 * p0.norm());
            assert!((l1 - l0).norm() < most * size, "{seed} {name}: {:e}", (l1 - l0).norm() / size);
            // The contact layer of the smallest bodies is hardly resolved.
            assert!(e1 < e0 * 1.05, "{seed} {name}: {e0} {e1}");
        }
    }
    assert!(impulses > 40, "{impulses}");
}

/// Elastic balls come back to where they were dropped, and others to the square of the restitution,
/// bounce after bounce: wherever they meet a floor or a box, at the default steps.
#[test]
fn every_rebound_has_its_height() {
    let grounds = [
        "floor = { height = 0, restitution = 0.8 }",
        "[[box]]\ncenter = [0.3, -0.5, 0.2]\nsize = [8, 1, 8]\nrestitution = 1",
    ];
    for (ground, share) in grounds.iter().zip([0.64_f64, 1.0]) {
        for x in [0.0, 0.1, 3.0] {
            let text = format!(
                "gravity = [0, -{G}, 0]\n{ground}\n[[body]]\nparts = [{{ ball = 0.1 }}]
                mass = 1\nat = [{x}, 1.1, 0]"
            );
            for name in ["rk4", "verlet", "symplectic", "implicit", "dopri5"] {
                let m = method(name);
                let mut run = Simulation::new(described(&text), m, m.default_control).unwrap();
                let (mut t, mut height) = ((2.0 / G).sqrt(), 1.0);
                for bounce in 1..=6 {
                    height *= share;
                    let up = (2.0 * height / G).sqrt();
                    run.advance_to(t + up).unwrap();
                    t += 2.0 * up;
                    let found = run.position(0).y - 0.1;
                    let what = format!("{name} at {x}, {share}, bounce {bounce}: {found}");
                    assert!((found / height - 1.0).abs() < 0.01, "{what}");
                }
            }
        }
    }
}

/// Balls on hinges are a cradle: the last one takes all speed of the first, and no energy is won or
/// lost.
#[test]
fn balls_on_hinges_are_a_cradle() {
    let ball = |k: u32, angle: f64| {
        let (hinge, k) = (f64::from(k) * 0.205, f64::from(k));
        format!(
            "[[body]]\nparts = [{{ ball = 0.1 }}]\nmass = 1\nrestitution = 1
            at = [{}, {}, 0]\nrotation = [0, 0, {angle}]
            [[joint]]\nbody = {k}\nhinge = {{ at = [{hinge}, 0, 0], axis = [0, 0, 1] }}\n",
            hinge + angle.sin(),
            -angle.cos(),
        )
    };
    let text =
        [format!("gravity = [0, -{G}, 0]\n"), ball(0, -0.6), ball(1, 0.0), ball(2, 0.0)].concat();
    for (name, until) in [("rk4", 8.0), ("verlet", 4.0), ("dop853", 4.0)] {
        let m = method(name);
        let mut run = Simulation::new(described(&text), m, m.default_control).unwrap();
        // Energy above that of hanging at rest.
        let energy = |run: &Simulation| run.energy().unwrap().total() + 3.0 * G;
        let begun = energy(&run);
        run.advance_to(0.65).unwrap();
        let speeds = [0, 1, 2].map(|k| moving(&run, k).v.norm());
        assert!(speeds[0].max(speeds[1]) < 0.02 && speeds[2] > 1.5, "{name}: {speeds:?}");
        run.advance_to(until).unwrap();
        let gained = energy(&run) / begun - 1.0;
        assert!(gained.abs() < 0.01, "{name}: {gained}");
    }
}

/// Boxes thrown at a rough floor with restitution 1, in which friction reverses slips: no impact
/// gives energy (Kane, *A dynamics puzzle*, 1984).
#[test]
fn friction_with_restitution_gains_no_energy() {
    for seed in 0..12 {
        let mut random = Random(seed);
        let [turn, v, spin] = [2.0, 1.0, 8.0].map(|size| <[f64; 3]>::from(random.vector() * size));
        let text = format!(
            "gravity = [0, -{G}, 0]
            floor = {{ height = 0, friction = 0.5, restitution = 1 }}
            [[body]]
            parts = [{{ box = [0.5, 0.1, 0.12] }}]
            mass = 1
            at = [0, 0.8, 0]
            rotation = {turn:?}
            velocity = {v:?}
            spin = {spin:?}"
        );
        for (name, step) in [("rk4", 1e-3), ("verlet", 2.5e-4)] {
            let mut run = run(&text, name, Control::Step(step));
            let begun = run.energy().unwrap().total();
            for k in 1..=50 {
                run.advance_to(0.02 * f64::from(k)).unwrap();
                let gained = run.energy().unwrap().total() - begun;
                assert!(gained < 2e-3 * begun, "{seed} by {name}: {gained} of {begun} J");
            }
        }
    }
}
