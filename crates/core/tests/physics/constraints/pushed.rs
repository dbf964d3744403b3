//! Friction of bodies that joints hold: of faces that push, and of wheels on axles. The force of
//! friction counts once, however often joints and contact take turns in a step.

use std::f64::consts::{FRAC_PI_2, PI};

use a3_core::{Control, Simulation, integrators};

use super::G;
use crate::common::described;

/// Methods, with the control by which they run.
const ALL: [(&str, Control); 4] = [
    ("rk4", Control::Step(1e-3)),
    ("verlet", Control::Step(1e-3)),
    ("implicit-midpoint", Control::Step(1e-3)),
    ("dopri5", Control::Tolerance(1e-6)),
];

/// Returns the places along x (m) of the centre of a body at these times (s). Particle `centre` of
/// the scene is that centre.
fn places<const N: usize>(
    scene: &str,
    (name, control): (&str, Control),
    centre: usize,
    times: [f64; N],
) -> [f64; N] {
    let method = integrators::find(name).unwrap();
    let mut run = Simulation::new(described(scene), method, control).unwrap();
    times.map(|t| {
        run.advance_to(t).unwrap_or_else(|why| panic!("{name}: {why}"));
        assert_eq!(run.gained(), None, "{name}");
        run.state()[centre]
    })
}

/// Returns the acceleration from three places at even times, `apart` (s) from one another.
fn acceleration([a, b, c]: [f64; 3], apart: f64) -> f64 {
    (c - 2.0 * b + a) / (apart * apart)
}

/// A box on a smooth slider is pressed against another one by a level force, and pushes it over the
/// floor, on which that one rubs. Friction between both faces may carry up to two percent of the
/// weight.
#[test]
fn a_box_on_a_slider_pushes_another_one_against_its_friction() {
    let scene = format!(
        "gravity = [5, -{G}, 0]
        floor = -0.102
        [[body]]
        parts = [{{ box = [0.2, 0.2, 0.2] }}]
        mass = 1
        at = [0, 0, 0]
        [[body]]
        parts = [{{ box = [0.2, 0.2, 0.2] }}]
        mass = 1
        at = [0.21, 0, 0]
        friction = 0.3
        [[joint]]
        body = 0
        slider = {{ axis = [1, 0, 0] }}"
    );
    let expected = 5.0 - 0.5 * 0.3 * G;
    for method in ALL {
        let found = acceleration(places(&scene, method, 0, [0.3, 0.5, 0.7]), 0.2);
        assert!((found / expected - 1.0).abs() < 0.02, "{}: {found}, {expected}", method.0);
    }
}

/// A cart rolls on two wheels, whose axles are hinges and which resist rolling: a torque of b times
/// the weight.
#[test]
fn a_cart_rolls_until_the_resistance_of_its_wheels_stops_it() {
    let (radius, length, b, mass): (f64, f64, f64, [f64; 2]) = (0.1, 0.3, 0.02, [2.0, 1.0]);
    let wheel = |x: f64| {
        format!(
            "[[body]]
            parts = [{{ capsule = [{length}, {radius}], rotation = [{FRAC_PI_2}, 0, 0] }}]
            mass = {}
            at = [{x}, 0, 0]
            velocity = [1, 0, 0]
            spin = [0, 0, {}]
            friction = 0.5
            rolling_friction = {b}",
            mass[1],
            -1.0 / radius
        )
    };
    let scene = format!(
        "gravity = [0, -{G}, 0]
        floor = -{radius}
        [[body]]
        parts = [{{ box = [0.6, 0.05, 0.3] }}]
        mass = {}
        at = [0, 0.2, 0]
        velocity = [1, 0, 0]
        {}
        {}
        [[joint]]
        bodies = [0, 1]
        hinge = {{ at = [-0.25, 0, 0], axis = [0, 0, 1] }}
        [[joint]]
        bodies = [0, 2]
        hinge = {{ at = [0.25, 0, 0], axis = [0, 0, 1] }}",
        mass[0],
        wheel(-0.25),
        wheel(0.25)
    );
    let parts = [PI * radius.powi(2) * length, 4.0 / 3.0 * PI * radius.powi(3)];
    let of_all = mass[1] / (parts[0] + parts[1]);
    let inertia = of_all * radius.powi(2) * (0.5 * parts[0] + 0.4 * parts[1]);
    let all = mass[0] + 2.0 * mass[1];
    let slowing = b * all * G / radius / (all + 2.0 * inertia / radius.powi(2));
    let end = 1.0 / slowing;
    for method in ALL {
        let [half, last, later] = places(&scene, method, 0, [0.5 * end, end, 1.2 * end]);
        assert!((half / (0.375 * end) - 1.0).abs() < 5e-3, "{}: {half}", method.0);
        assert!((last / (0.5 * end) - 1.0).abs() < 5e-3, "{}: {last}", method.0);
        assert!((later - last).abs() < 2e-3, "{}: {last}, {later}", method.0);
    }
}

/// Bodies in a row, tied by ropes, slide to rest over the floor as each would alone, and the ropes
/// stay as they are.
#[test]
fn boxes_tied_by_a_rope_slide_like_one() {
    let body = |x: f64, mass: f64| {
        format!(
            "[[body]]
            parts = [{{ box = [0.2, 0.1, 0.2] }}]
            mass = {mass}
            at = [{x}, 0, 0]
            velocity = [1.5, 0, 0]
            friction = 0.3"
        )
    };
    let scene = format!(
        "gravity = [0, -{G}, 0]
        floor = -0.05
        {}
        {}
        [[constraint]]
        rope = [0, 9]",
        body(0.0, 1.0),
        body(0.5, 4.0)
    );
    let expected = -0.3 * G;
    for method in ALL {
        let found = acceleration(places(&scene, method, 0, [0.1, 0.25, 0.4]), 0.15);
        assert!((found / expected - 1.0).abs() < 0.02, "{}: {found}, {expected}", method.0);
    }
}

/// Particle that is the centre of the ball of [`plank`]: the centre of the plank and its eight
/// corners come first.
const BALL: usize = 9;

/// A ball of some mass (kg) that begins at a place (m), rolling at a speed (m/s), on a plank of
/// 1 kg that a joint holds.
fn plank(mass: f64, ([x, y], speed): ([f64; 2], f64), joint: &str) -> String {
    let radius = 0.15;
    format!(
        "gravity = [0, -{G}, 0]
        [[body]]
        parts = [{{ box = [2, 0.05, 0.4] }}]
        mass = 1
        at = [0, 0, 0]
        friction = 0.5
        [[body]]
        parts = [{{ ball = {radius} }}]
        mass = {mass}
        at = [{x}, {y}, 0]
        velocity = [{speed}, 0, 0]
        spin = [0, 0, {}]
        [[joint]]
        body = 0
        {joint}",
        -speed / radius
    )
}

/// A ball rolls over a plank that is fixed and has a hundredth or a thousandth of its mass: the
/// force that holds the plank, not its mass, stops the ball.
#[test]
fn a_heavy_ball_rolls_over_a_light_plank() {
    for (mass, method) in [(100.0, ALL[0]), (1000.0, ALL[0]), (100.0, ALL[1]), (100.0, ALL[2])] {
        let scene = plank(mass, ([0.2, 0.1751], 0.5), "fixed = true");
        let [end] = places(&scene, method, BALL, [0.4]);
        assert!((end - 0.4).abs() < 1e-4, "{}, {mass} kg: {end}", method.0);
    }
}

/// Two jaws of 50 g on sliders hold a box of 2 kg, by friction that could carry twice its weight.
#[test]
fn light_jaws_hold_a_heavy_box() {
    let jaw = |x: f64| {
        format!(
            "[[body]]
            parts = [{{ box = [0.1, 0.3, 0.3] }}]
            mass = 0.05
            at = [{x}, 0, 0]
            friction = 0.5"
        )
    };
    let scene = format!(
        "gravity = [0, -{G}, 0]
        {}
        {}
        [[body]]
        parts = [{{ box = [0.4, 0.2, 0.2] }}]
        mass = 2
        at = [0, 0, 0]
        friction = 0.5
        [[joint]]
        body = 0
        slider = {{ axis = [1, 0, 0], force = 40, speed = 1e6 }}
        [[joint]]
        body = 1
        slider = {{ axis = [-1, 0, 0], force = 40, speed = 1e6 }}",
        jaw(-0.2511),
        jaw(0.2511)
    );
    for (name, control) in [("rk4", Control::Step(1e-3)), ("implicit-euler", Control::Step(2e-3))] {
        let method = integrators::find(name).unwrap();
        let mut run = Simulation::new(described(&scene), method, control).unwrap();
        run.advance_to(0.3).unwrap();
        let n = 27;
        let fallen = -run.state()[n + 18];
        assert!((0.0..3e-4).contains(&fallen), "{name}: {fallen:e} m");
    }
}

/// A ball rolls up a light plank that its weight has tipped onto the limit of a hinge.
#[test]
fn the_limit_of_a_hinge_bears_a_heavy_ball() {
    let limit = 0.2_f64;
    let hinge =
        format!("hinge = {{ at = [0, 0, 0], axis = [0, 0, 1], limits = [-{limit}, {limit}] }}");
    for (mass, method) in [(100.0, ALL[0]), (1000.0, ALL[0]), (1000.0, ALL[1])] {
        let scene = plank(mass, ([-0.6, 0.177], 1.5), &hinge);
        let found = acceleration(places(&scene, method, BALL, [0.16, 0.24, 0.32]), 0.08);
        let expected = -5.0 / 7.0 * G * limit.sin() * limit.cos();
        assert!((found / expected - 1.0).abs() < 0.02, "{}, {mass} kg: {found}", method.0);
    }
}
