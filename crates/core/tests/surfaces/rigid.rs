//! Rigid bodies that touch one another, obstacles and cloth.

use a3_core::{Control, Simulation, Vector3, integrators};
use a3_scenes::Description;

use crate::pairs::Random;

fn run(text: &str, method: &str, control: Control) -> Simulation {
    let setup = Description::parse(text)
        .and_then(|scene| scene.build(None, &mut |_| unreachable!("no file is named")))
        .unwrap();
    let method = integrators::find(method).unwrap();
    Simulation::new(setup.scene, method, control).unwrap()
}

/// Centre of body k, and its velocity.
fn center(run: &Simulation, k: usize) -> [Vector3<f64>; 2] {
    let network = run.model().network().unwrap();
    let place = network.pose(k, run.state()).place;
    [place.position, place.velocity]
}

/// A body on a slope of 30 degrees, with its skin in contact.
fn slope(part: &str, height: f64, friction: f64) -> String {
    let angle = std::f64::consts::FRAC_PI_6;
    let out = Vector3::new(-angle.sin(), angle.cos(), 0.0);
    let [x, y, z]: [f64; 3] = (out * height).into();
    let [bx, by, bz]: [f64; 3] = (out * -0.5).into();
    format!(
        "gravity = [0, -9.81, 0]
        [[box]]
        center = [{bx}, {by}, {bz}]
        size = [60, 1, 4]
        rotation = [0, 0, {angle}]
        friction = {friction}
        thickness = 0.01
        [[body]]
        parts = [{{ {part} }}]
        rotation = [0, 0, {angle}]
        at = [{x}, {y}, {z}]
        density = 500
        friction = {friction}
        thickness = 0.01
        "
    )
}

/// Acceleration down the slope between two times.
fn acceleration(text: &str, method: &str, step: f64) -> f64 {
    let mut run = run(text, method, Control::Step(step));
    let mut speed = |time: f64| {
        run.advance_to(time).unwrap();
        center(&run, 0)[1].norm()
    };
    let (first, last) = (speed(0.5), speed(1.5));
    last - first
}

#[test]
fn a_ball_rolls_down_a_slope() {
    let exact = 5.0 / 7.0 * 9.81 * 0.5;
    for (method, step) in [("rk4", 1e-3), ("verlet", 1e-3), ("implicit", 5e-3)] {
        let found = acceleration(&slope("ball = 0.3", 0.307, 0.5), method, step);
        assert!((found / exact - 1.0).abs() < 1e-3, "{method}: {found} {exact}");
    }
    // With less friction than rolling requires, it slides.
    let mu = 0.1;
    let exact = 9.81 * (0.5 - mu * 0.75_f64.sqrt());
    let found = acceleration(&slope("ball = 0.3", 0.307, mu), "rk4", 1e-3);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
}

#[test]
fn a_box_sticks_or_slides() {
    let text = |mu: f64| slope("box = [0.6, 0.2, 0.6]", 0.1065, mu);
    let exact = 9.81 * (0.5 - 0.3 * 0.75_f64.sqrt());
    let found = acceleration(&text(0.3), "rk4", 1e-3);
    assert!((found / exact - 1.0).abs() < 1e-3, "{found} {exact}");
    let mut stuck = run(&text(0.7), "rk4", Control::Step(1e-3));
    stuck.advance_to(1.5).unwrap();
    let before = center(&stuck, 0)[0];
    stuck.advance_to(3.0).unwrap();
    let moved = (center(&stuck, 0)[0] - before).norm();
    assert!(moved < 1e-5, "{moved}");
}

/// Friction tips a box in each step, and the floor turns it back: its pressure, by which friction
/// is bounded, is that which acted, also where the equations of a step are hard to solve.
#[test]
fn a_box_slides_as_far_in_long_steps() {
    let scene = "gravity = [0, -9.81, 0]
        floor = { height = 0, friction = 0.3 }
        body = [{ at = [0, 0.1008, 0], velocity = [1.5, 0, 0], mass = 1, friction = 0.3,
            parts = [{ box = [0.4, 0.2, 0.3] }] }]";
    let exact = 1.5 * 1.5 / (2.0 * 0.3 * 9.81);
    for (method, step) in [("implicit", 0.02), ("implicit", 0.005), ("verlet", 0.002)] {
        let mut run = run(scene, method, Control::Step(step));
        run.advance_to(1.0).unwrap();
        let way = center(&run, 0)[0].x;
        assert!((way / exact - 1.0).abs() < 0.05, "{method} {step}: {way} m");
    }
}

/// Where two equal faces lie on one another, dozens of pairs meet at each corner. Together they
/// hold a box up to the slope of Coulomb's law.
#[test]
fn a_box_sticks_to_another_or_slides() {
    let text = |degrees: f64| {
        let (sin, cos) = degrees.to_radians().sin_cos();
        format!(
            "gravity = [{}, {}, 0]
            floor = {{ height = 0, friction = 1, thickness = 0.01 }}
            [[body]]
            parts = [{{ box = [0.5, 0.5, 0.5] }}]
            at = [0, 0.2555, 0]
            mass = 60
            [[body]]
            parts = [{{ box = [0.5, 0.5, 0.5] }}]
            at = [0, 0.764, 0]
            mass = 30
            friction = 0.4",
            9.81 * sin,
            -9.81 * cos
        )
    };
    let moved = |degrees: f64, from: f64, to: f64| {
        let mut run = run(&text(degrees), "verlet", Control::Step(1e-3));
        let mut apart = |time: f64| {
            run.advance_to(time).unwrap();
            center(&run, 1)[0].x - center(&run, 0)[0].x
        };
        let before = apart(from);
        apart(to) - before
    };
    // The slope of friction 0.4 is 21.8 degrees.
    let stuck = moved(18.0, 0.5, 1.5);
    assert!(stuck.abs() < 1e-3, "{stuck} m");
    let slid = moved(25.0, 0.2, 0.5);
    assert!((0.02..0.2).contains(&slid), "{slid} m");
}

#[test]
fn a_stack_of_five_boxes_stands() {
    let setup = a3_scenes::find("boxes").unwrap().build(None).unwrap();
    let method = integrators::find("rk4").unwrap();
    let mut run = Simulation::new(setup.scene, method, Control::Step(2e-3)).unwrap();
    let before: Vec<_> = (0..5).map(|k| center(&run, k)[0]).collect();
    // Bodies at rest after four seconds, to 1e-6 m/s, move by less than 1e-3 m in sixty.
    run.advance_to(4.0).unwrap();
    for (k, before) in before.iter().enumerate() {
        let moved = (center(&run, k)[0] - before).norm();
        assert!(moved < 1e-4, "box {k} moved by {moved} m");
        assert!(center(&run, k)[1].norm() < 1e-6, "box {k} moves");
    }
}

#[test]
fn all_dominoes_fall() {
    let setup = a3_scenes::find("dominoes").unwrap().build(None).unwrap();
    let count = setup.scene.model.network().unwrap().bodies().len();
    let control = setup.defaults.control.unwrap();
    let method = setup.defaults.solver.unwrap();
    let mut run = Simulation::new(setup.scene, method, control).unwrap();
    run.advance_to(2.5).unwrap();
    for k in 0..count {
        let height = center(&run, k)[0].y;
        assert!(height < 0.2, "domino {k} stands at {height} m");
    }
    let network = run.model().network().unwrap();
    let crossed = network.crossed(run.time(), network.halves(run.state()).0);
    assert!(crossed.is_empty(), "{crossed:?}");
}

/// A box, a capsule and a mallet that meet in free space at these speeds, spinning.
fn meeting(speeds: [f64; 2], friction: f64) -> String {
    let [first, second] = speeds;
    format!(
        "[[body]]
        parts = [{{ box = [0.6, 0.3, 0.2] }}]
        density = 500
        spin = [0.1, 0.2, -0.3]
        friction = {friction}
        [[body]]
        parts = [{{ capsule = [0.6, 0.1] }}]
        density = 900
        at = [0.8, 0.1, 0.05]
        velocity = [-{first}, 0, 0]
        spin = [0, 0.1, 0.4]
        friction = {friction}
        [[body]]
        parts = [{{ ball = 0.2 }}, {{ box = [0.1, 0.6, 0.1] }}]
        density = 300
        at = [-0.8, 0.1, -0.1]
        velocity = [{second}, 0, 0]
        friction = {friction}"
    )
}

/// Momentum, angular momentum and kinetic energy.
fn conserved(run: &Simulation) -> (Vector3<f64>, Vector3<f64>, f64) {
    let network = run.model().network().unwrap();
    let (mut momentum, mut angular) = (Vector3::zeros(), Vector3::zeros());
    for (k, body) in network.bodies().iter().enumerate() {
        let [x, v] = center(run, k);
        let p = v * network.masses()[body.center()];
        momentum += p;
        angular += x.cross(&p) + network.rotation(k, run.state()).momentum;
    }
    (momentum, angular, run.energy().unwrap().kinetic)
}

#[test]
fn bodies_that_collide_keep_their_momenta() {
    for (method, step, speeds, friction) in [
        ("rk4", 1e-3, [0.2, 0.1], 0.0),
        ("verlet", 5e-4, [0.2, 0.1], 0.0),
        ("rk4", 1e-3, [0.2, 0.1], 0.4),
        ("rk4", 1e-3, [3.0, 2.0], 0.4),
    ] {
        let mut run = run(&meeting(speeds, friction), method, Control::Step(step));
        let (p0, l0, e0) = conserved(&run);
        run.advance_to(0.6 / speeds[1]).unwrap();
        let (p1, l1, e1) = conserved(&run);
        let size = p0.norm() + (2.0 * e0 * 100.0).sqrt();
        let what = format!("{method} {step} {friction}");
        assert!((p1 - p0).norm() < 1e-12 * size, "{what}: {p0} {p1}");
        assert!(e1 < 0.95 * e0, "{what}: nothing met: {e0} {e1}");
        // Friction and impulses act on either side at its own surface, across the gap.
        let most = if friction > 0.0 { 2e-2 } else { 1e-6 };
        let off = (l1 - l0).norm() / l0.norm();
        assert!(off < most, "{what}: {off}");
    }
}

#[test]
fn a_ball_and_a_box_rest_on_a_cloth() {
    let setup = a3_scenes::find("ball-on-cloth").unwrap().build(None).unwrap();
    let control = setup.defaults.control.unwrap();
    let mut run = Simulation::new(setup.scene, setup.defaults.solver.unwrap(), control).unwrap();
    let mut lowest = f64::INFINITY;
    for frame in 1..=14 {
        run.advance_to(0.05 * f64::from(frame)).unwrap();
        let network = run.model().network().unwrap();
        let crossed = network.crossed(run.time(), network.halves(run.state()).0);
        assert!(crossed.is_empty(), "{crossed:?}");
        lowest = lowest.min(center(&run, 0)[0].y);
    }
    // The ball fell on the cloth, which gave way and holds it.
    assert!(lowest < 0.1 && center(&run, 0)[0].y > -1.0, "{lowest}");
    assert!(run.energy().unwrap().contact > 0.0);
}

#[test]
fn bodies_that_begin_within_one_another_are_named() {
    let text = "[[body]]\nparts = [{ ball = 0.2 }]\nmass = 1\n\
        [[body]]\nparts = [{ box = [0.3, 0.3, 0.3] }]\nat = [0.3, 0, 0]\nmass = 1\n";
    let setup = Description::parse(text)
        .and_then(|scene| scene.build(None, &mut |_| unreachable!("no file is named")))
        .unwrap();
    let method = integrators::find("rk4").unwrap();
    let made = Simulation::new(setup.scene, method, Control::Step(1e-3));
    let error = made.err().unwrap().to_string();
    assert!(error.contains("body 0 crosses body 1"), "{error}");
}

/// A box on an obstacle with a restitution of 1/2.
fn on_elastic(obstacle: &str, gap: f64) -> String {
    let height = 0.1 + gap;
    format!(
        "gravity = [0, -9.81, 0]
        {obstacle}
        restitution = 0.5
        [[body]]
        parts = [{{ box = [0.2, 0.2, 0.2] }}]
        at = [0, {height}, 0]
        mass = 1
        "
    )
}

/// A box that begins with hardly any gap above an elastic obstacle never passes through it: where
/// a step leads to the other side of the gap and the force there throws the box, the run says so.
#[test]
fn a_box_that_begins_close_to_an_elastic_one_stays_above() {
    let obstacle = "[[box]]\ncenter = [0, -0.5, 0]\nsize = [4, 1, 4]";
    let methods = [("verlet", 5e-3), ("verlet", 1e-3), ("rk4", 5e-3), ("implicit", 1e-2)];
    for gap in [1e-9, 1e-8, 1e-7, 1e-6, 1e-5] {
        for (method, step) in methods {
            let mut run = run(&on_elastic(obstacle, gap), method, Control::Step(step));
            for part in 1..=20 {
                let ended = run.advance_to(0.05 * f64::from(part)).is_err();
                let network = run.model().network().unwrap();
                let crossed = network.crossed(run.time(), network.halves(run.state()).0);
                assert!(crossed.is_empty(), "{gap:e} {method} {step}: {crossed:?}");
                if ended {
                    break;
                }
            }
        }
    }
}

/// A box that begins at gap 0 above a floor moves as one with hardly any gap, also by the implicit
/// method.
#[test]
fn a_box_that_touches_a_floor_is_repelled() {
    let floor = "[floor]\nheight = 0";
    for (method, step) in [("verlet", 5e-3), ("rk4", 5e-3), ("implicit", 1e-2)] {
        let [touching, near] = [0.0, 1e-12].map(|gap| {
            let mut run = run(&on_elastic(floor, gap), method, Control::Step(step));
            assert!(run.energy().unwrap().contact > 0.0, "{method}");
            run.advance_to(0.5).unwrap();
            center(&run, 0)[0].y
        });
        assert!((touching - near).abs() < 1e-6, "{method}: {touching} {near}");
    }
}

/// Boxes, balls and capsules that fall on one another.
fn heap(seed: u64, bodies: usize) -> String {
    let mut random = Random(seed);
    let mut text = "gravity = [0, -9.81, 0]
        floor = { height = 0, friction = 0.5, thickness = 0.01 }
        "
    .to_string();
    for k in 0..bodies {
        let [a, b, c, friction] = [(); 4].map(|()| 0.08 + 0.12 * random.unit());
        let part = match k % 3 {
            0 => format!("capsule = [{}, {}]", 2.0 * a, 0.6 * b),
            1 => format!("box = [{}, {}, {}]", 2.0 * a, 2.0 * b, 2.0 * c),
            _ => format!("ball = {a}"),
        };
        let height = 0.35 + 0.52 * k as f64;
        let [x, z, turned, spin] =
            [0.15, 0.15, 3.0, 2.0].map(|most| most * (2.0 * random.unit() - 1.0));
        let body = format!(
            "[[body]]
            parts = [{{ {part} }}]
            rotation = [{turned}, {spin}, 1]
            density = 1000
            at = [{x}, {height}, {z}]
            spin = [{spin}, 1, {turned}]
            friction = {}
            ",
            3.0 * friction
        );
        text.push_str(&body);
    }
    text
}

/// Steps of any length, which end wherever a frame is shown, do not press bodies into one another,
/// however little they approach in each step.
#[test]
fn no_bodies_of_a_heap_cross() {
    for seed in 0..3 {
        let mut run = run(&heap(seed, 10), "dopri5", Control::Tolerance(1e-5));
        let mut pushed = 0;
        for frame in 1..=75 {
            run.advance_to(f64::from(frame) / 60.0).unwrap();
            let network = run.model().network().unwrap();
            let crossed = network.crossed(run.time(), network.halves(run.state()).0);
            assert!(crossed.is_empty(), "{seed}, frame {frame}: {crossed:?}");
            pushed = run.guarded().impulses;
        }
        assert!(pushed > 100, "{seed}: {pushed}");
    }
}
