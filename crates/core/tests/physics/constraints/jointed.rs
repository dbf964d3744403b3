//! Joints of rigid bodies, against closed forms and integrations in other coordinates.

use super::*;
use crate::common::described;

/// A bar of 1.2 m, whose end is at the origin, turned by an angle about z from hanging straight
/// down, with what follows.
fn bar(angle: f64, rest: &str) -> String {
    let (sin, cos) = angle.sin_cos();
    format!(
        "gravity = [0, -{G}, 0]
        [[body]]
        parts = [{{ box = [0.1, 1.2, 0.2] }}]
        mass = 2
        at = [{}, {}, 0]
        rotation = [0, 0, {angle}]
        {rest}",
        0.6 * sin,
        -0.6 * cos,
    )
}

/// Moment of inertia of the bar about an axis along z at its end (kg m2).
fn about_end() -> f64 {
    2.0 * (0.01 + 1.44) / 12.0 + 2.0 * 0.36
}

/// A physical pendulum hangs straight down after a quarter of its period, a complete elliptic
/// integral: by an adaptive method to its tolerance, and by all others in their order.
#[test]
fn a_bar_on_a_hinge_has_the_period_of_an_elliptic_integral() {
    let angle = 2.5;
    let hinge = "[[joint]]\nbody = 0\nhinge = { at = [0, 0, 0], axis = [0, 0, 1] }";
    let scene = described(&bar(angle, hinge));
    let torque = 2.0 * G * 0.6;
    let quarter = period((torque / about_end()).sqrt(), angle) / 4.0;
    let speed = 0.6 * (2.0 * torque * (1.0 - angle.cos()) / about_end()).sqrt();
    let error = |name, value| {
        let run = simulated(&scene, name, value, quarter);
        let off = (run.position(0) - vector(0.0, -0.6, 0.0)).norm();
        let slow = (velocity_of(&run, 0) - vector(-speed, 0.0, 0.0)).norm();
        (off + slow, joint_error(&run))
    };
    let (off, broken) = error("dop853", 1e-12);
    assert!(off < 1e-8 && broken < 1e-10, "{off:e} {broken:e}");
    for name in [
        "euler",
        "symplectic",
        "heun",
        "midpoint",
        "verlet",
        "rk4",
        "implicit",
        "tr-bdf2",
        "implicit-midpoint",
    ] {
        let order = f64::from(method(name).order);
        let steps = if order < 1.5 { 1600.0 } else { 200.0 };
        let [(coarse, _), (fine, broken)] = [1.0, 2.0].map(|k| error(name, quarter / steps / k));
        let slope = (coarse / fine).log2();
        assert!((slope - order).abs() < 0.2, "{name}: {coarse:e} {fine:e}, slope {slope:.2}");
        if method(name).is_implicit() {
            assert!(broken < 1e-10, "{name}: {broken:e}");
        }
    }
}

/// A motor turns a balanced wheel with T / I, or to its speed with the time constant w0 I / T, and
/// its work is the energy.
#[test]
fn a_motor_turns_a_wheel_and_its_work_is_no_gain() {
    let moment = 3.0 * (0.16 + 0.04) / 12.0;
    let wheel = |motor: &str| {
        described(&format!(
            "[[body]]
            parts = [{{ box = [0.4, 0.2, 0.1] }}]
            mass = 3
            [[joint]]
            body = 0
            hinge = {{ at = [0, 0, 0], axis = [0, 0, 2], {motor} }}"
        ))
    };
    let torque = 0.2;
    let turned = |run: &Simulation| {
        let network = run.model().network().unwrap();
        network.rotation(0, run.state()).momentum / moment
    };
    for (name, value) in [("dop853", 1e-10), ("rk4", 0.01), ("tr-bdf2", 0.01)] {
        let constant = simulated(&wheel("torque = 0.2"), name, value, 2.0);
        let spin = turned(&constant) - vector(0.0, 0.0, torque * 2.0 / moment);
        assert!(spin.norm() < 1e-8, "{name}: {spin}");
        let work = 0.5 * (torque * 2.0).powi(2) / moment;
        assert!((energy(&constant) / work - 1.0).abs() < 1e-8, "{name}");
        assert!(constant.gained().is_none(), "{name}");
        let limited = simulated(&wheel("torque = 0.2, speed = 5"), name, value, 1.0);
        let spin = 5.0 * (1.0 - (-torque / (5.0 * moment)).exp());
        let off = turned(&limited).z / spin - 1.0;
        assert!(off.abs() < 1e-5, "{name}: {off:e}");
    }
}

/// A motor between two bodies that float freely turns them against each other: momentum and angular
/// momentum stay zero.
#[test]
fn a_motor_between_two_bodies_gives_no_momentum() {
    let scene = described(
        "[[body]]
        parts = [{ box = [0.4, 0.2, 0.1] }]
        mass = 3
        [[body]]
        parts = [{ box = [0.1, 0.5, 0.3] }]
        mass = 1
        at = [0.3, 0.1, 0]
        [[joint]]
        bodies = [0, 1]
        hinge = { at = [0.2, 0.05, 0], axis = [0.3, 0.2, 1], torque = 0.1 }",
    );
    let run = simulated(&scene, "dop853", 1e-11, 2.0);
    let (p, l) = momenta(&run);
    assert!(p.norm() < 1e-10 && l.norm() < 1e-10, "{p} {l}");
    assert!(energy(&run) > 0.1 && joint_error(&run) < 1e-10);
}

/// The motor of a slider lifts a box with F / m - g, or takes it to its speed with the time
/// constant m w0 / F, and its work is the energy.
#[test]
fn a_motor_pushes_a_box_along_its_slider() {
    let lift = |keys: &str, motor: &str| {
        described(&format!(
            "{keys}\n[[body]]\nparts = [{{ box = [0.4, 0.2, 0.1] }}]\nmass = 3\n\
             [[joint]]\nbody = 0\nslider = {{ axis = [0, 2, 0], {motor} }}"
        ))
    };
    for (name, value) in [("dop853", 1e-10), ("rk4", 0.01), ("tr-bdf2", 0.01), ("verlet", 0.01)] {
        let weight = format!("gravity = [0, -{G}, 0]");
        let constant = simulated(&lift(&weight, "force = 36"), name, value, 1.5);
        let risen = constant.position(0) - vector(0.0, 0.5 * (12.0 - G) * 2.25, 0.0);
        assert!(risen.norm() < 1e-8, "{name}: {risen}");
        assert!(constant.gained().is_none(), "{name}");
        let work = energy(&constant) / (36.0 * constant.position(0).y) - 1.0;
        assert!(work.abs() < 1e-8, "{name}: {work:e}");
        let limited = simulated(&lift("", "force = -6, speed = -2"), name, value, 1.0);
        let off = velocity_of(&limited, 0).y / (-2.0 * (1.0 - (-1_f64).exp())) - 1.0;
        assert!(off.abs() < 1e-4, "{name}: {off:e}");
    }
}

/// The motor of a slider between two bodies that float freely: their momenta stay zero, also about
/// a line that is not through the centre of the second one, and the work of a constant force is
/// that of its displacement.
#[test]
fn a_motor_of_a_slider_between_two_bodies_gives_no_momentum() {
    let scene = described(
        "[[body]]
        parts = [{ box = [0.4, 0.2, 0.1] }]
        mass = 3
        [[body]]
        parts = [{ box = [0.1, 0.5, 0.3] }]
        mass = 1
        at = [0.3, 0.4, 0.1]
        [[joint]]
        bodies = [0, 1]
        slider = { axis = [1, 0, 0], force = 0.4 }",
    );
    let run = simulated(&scene, "dop853", 1e-11, 2.0);
    let (p, l) = momenta(&run);
    assert!(p.norm() < 1e-10 && l.norm() < 1e-10, "{p} {l}");
    let network = run.model().network().unwrap();
    let other = network.bodies()[1].center();
    let apart = run.position(other) - run.position(0);
    let slid = network.pose(0, run.state()).inwards(apart).x - 0.3;
    let work = energy(&run) / (0.4 * slid) - 1.0;
    assert!(slid > 0.5 && work.abs() < 1e-8, "{slid} {work:e}");
    let turned = network.rotation(0, run.state()).momentum.norm();
    assert!(turned > 5e-3 && joint_error(&run) < 1e-10, "{turned}");
}

/// Three links on ball joints, of which the first hangs from the world.
#[test]
fn a_chain_on_ball_joints_keeps_energy_and_angular_momentum() {
    let links = (0..3).map(|k| {
        format!(
            "[[body]]\nparts = [{{ box = [0.5, 0.1, 0.2] }}]\nmass = 1\nat = [{}, 0, 0]\n\
             spin = [0.5, 1, {}]\n",
            0.25 + 0.5 * f64::from(k),
            0.3 * f64::from(k),
        )
    });
    let scene = described(&format!(
        "gravity = [0, -{G}, 0]\n{}
        [[joint]]
        body = 0
        ball = [0, 0, 0]
        [[joint]]
        bodies = [0, 1]
        ball = [0.5, 0, 0]
        [[joint]]
        bodies = [1, 2]
        ball = [1, 0, 0]",
        links.collect::<String>()
    ));
    let begun = simulated(&scene, "dop853", 1e-11, 0.0);
    let (before, vertical) = (energy(&begun), momenta(&begun).1.y);
    for (name, value, most) in [("dop853", 1e-11, 1e-8), ("tr-bdf2", 2e-3, 1e-2)] {
        let run = simulated(&scene, name, value, 1.0);
        let gained = energy(&run) - before;
        let turned = momenta(&run).1.y - vertical;
        assert!(gained.abs() < most, "{name}: {gained:e} J");
        assert!(turned.abs() < most, "{name}: {turned:e}");
        assert!(joint_error(&run) < 1e-9, "{name}: {:e}", joint_error(&run));
    }
}

/// Angle of the crank after 0.8 s (rad) and its rate (rad/s). Its equation of motion is d/dt (J
/// q'^2 / 2 + V) = T q', with J and V of all links at the angle q. It was integrated in Python by
/// 8000 steps of Runge-Kutta, with derivatives by q from complex steps.
const CRANK: [f64; 2] = [8.553_989_261_8, 14.271_053_112_6];

/// A four-bar linkage in a plane, driven by a motor, against its one coordinate: the crank's angle.
/// Its four hinges have three equations too many.
#[test]
fn a_four_bar_linkage_moves_as_by_its_crank_alone() {
    let scene = linkage([0.0, -G, 0.0]);
    let [angle, rate] = CRANK;
    for (name, value, most) in [("dop853", 1e-10, 1e-7), ("rk4", 1e-3, 1e-5)] {
        let run = simulated(&scene, name, value, 0.8);
        let place = vector(0.2 * angle.cos(), 0.2 * angle.sin(), 0.0);
        let speed = vector(-place.y, place.x, 0.0) * rate;
        let off = (run.position(0) - place).norm() + (velocity_of(&run, 0) - speed).norm();
        assert!(off < most, "{name}: {off:e}");
        assert!(joint_error(&run) < most, "{name}");
    }
}

/// Stages of implicit methods miss the constraints a little, and the equations that are too many
/// then contradict the others: not only in the plane of the linkage, where a load acts across it.
#[test]
fn implicit_methods_move_a_linkage_under_an_oblique_load() {
    let scene = linkage([-3.0, -8.0, 5.0]);
    let exact = simulated(&scene, "dop853", 1e-10, 0.3);
    for (name, value, most) in
        [("implicit", 2e-3, 0.02), ("implicit-midpoint", 5e-3, 2e-3), ("tr-bdf2", 5e-3, 2e-3)]
    {
        let run = simulated(&scene, name, value, 0.3);
        let off = (run.position(0) - exact.position(0)).norm();
        assert!(off < most, "{name}: {off:e}");
    }
}

/// Crank of 0.4 m from the origin, upright; coupler of 1 m; rocker of 0.8 m from (0.9, 0).
fn linkage(gravity: [f64; 3]) -> Scene {
    let (a, d) = (vector(0.0, 0.4, 0.0), vector(0.9, 0.0, 0.0));
    let between = d - a;
    let l = between.norm();
    let along = (1.0 - 0.64 + l * l) / (2.0 * l);
    let up = vector(-between.y, between.x, 0.0) / l;
    let c = a + between / l * along + up * (1.0 - along * along).sqrt();
    let ends = [(ZERO, a), (a, c), (d, c)];
    let links = ends.iter().map(|(from, to)| {
        let (middle, way) = ((from + to) * 0.5, to - from);
        format!(
            "[[body]]\nparts = [{{ box = [{}, 0.02, 0.05] }}]\nmass = {}\nat = [{}, {}, 0]\n\
             rotation = [0, 0, {}]\n",
            way.norm(),
            way.norm(),
            middle.x,
            middle.y,
            way.y.atan2(way.x)
        )
    });
    described(&format!(
        "gravity = {gravity:?}\n{}
        [[joint]]
        body = 0
        hinge = {{ at = [0, 0, 0], axis = [0, 0, 1], torque = 3 }}
        [[joint]]
        bodies = [0, 1]
        hinge = {{ at = [{}, {}, 0], axis = [0, 0, 1] }}
        [[joint]]
        bodies = [1, 2]
        hinge = {{ at = [{}, {}, 0], axis = [0, 0, 1] }}
        [[joint]]
        body = 2
        hinge = {{ at = [0.9, 0, 0], axis = [0, 0, 1] }}",
        links.collect::<String>(),
        a.x,
        a.y,
        c.x,
        c.y,
    ))
}

/// What is fixed together falls and tumbles as one body of both.
#[test]
fn fixed_bodies_move_as_one() {
    let part = |x: f64, fixed: bool| {
        format!(
            "[[body]]\nparts = [{{ box = [0.4, 0.3, 0.2] }}]\nmass = 1\nat = [{x}, 0, 0]\n{}",
            if fixed { "velocity = [0, 0, 0]\nspin = [1, 2, 0.5]\n" } else { "" }
        )
    };
    let joined = described(&format!(
        "{}{}[[joint]]\nbodies = [0, 1]\nfixed = true\n",
        part(-0.2, true),
        part(0.2, true)
    ));
    let begun = simulated(&joined, "dop853", 1e-11, 0.0);
    // Where they begin, the momenta are those of a single body that turns.
    let (p, l) = momenta(&begun);
    let whole = |run: &Simulation| run.position(9) - run.position(0);
    let single = described(&format!(
        "[[body]]\nparts = [{{ box = [0.8, 0.3, 0.2] }}]\nmass = 2\nspin = [{}, {}, {}]\n",
        l.x / (2.0 * (0.09 + 0.04) / 12.0),
        l.y / (2.0 * (0.64 + 0.04) / 12.0),
        l.z / (2.0 * (0.64 + 0.09) / 12.0),
    ));
    assert!(p.norm() < 1e-12);
    let both = simulated(&joined, "dop853", 1e-11, 2.0);
    let one = simulated(&single, "dop853", 1e-11, 2.0);
    let network = one.model().network().unwrap();
    let axes = network.pose(0, one.state()).orientation.unwrap().rotation;
    let begin = simulated(&single, "dop853", 1e-11, 0.0);
    let own = network.pose(0, begin.state()).orientation.unwrap().rotation;
    let turned = axes * own.transpose() * vector(0.4, 0.0, 0.0);
    let off = whole(&both) - turned;
    assert!(off.norm() < 1e-8 && joint_error(&both) < 1e-9, "{off}");
}
