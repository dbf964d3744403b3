//! Particles pass from one obstacle to the next where they are level, land on thin meshes, and stop
//! where one obstacle stands on another.

use std::fmt::Write;

use a3_core::integrators::METHODS;
use a3_core::{Control, Method, Simulation};
use a3_scenes::{Description, Mesh};

use crate::common::method;

/// Plate of 4 x 4 m and a thickness of 0.2 m, whose upper face, at height 0, has n x n cells of two
/// triangles.
fn plate(n: usize) -> Mesh {
    let mut text = String::new();
    for y in [0.0, -0.2] {
        for k in 0..(n + 1) * (n + 1) {
            let [x, z] = [k / (n + 1), k % (n + 1)].map(|i| 4.0 * i as f64 / n as f64 - 2.0);
            writeln!(text, "v {x} {y} {z}").unwrap();
        }
    }
    let at = |layer: usize, i: usize, j: usize| 1 + (layer * (n + 1) + i) * (n + 1) + j;
    let mut side = |corners: [usize; 4]| {
        let [a, b, c, d] = corners;
        writeln!(text, "f {a} {b} {c}\nf {a} {c} {d}").unwrap();
    };
    for i in 0..n {
        for j in 0..n {
            side([at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j)]);
            side([at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1)]);
        }
        side([at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0)]);
        side([at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n)]);
        side([at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1)]);
        side([at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i)]);
    }
    Mesh::from_obj(text.as_bytes()).unwrap()
}

/// State after a time (s) of a particle that begins at x (m) with the velocity v (m/s).
fn after(
    (method, control): (&'static Method, Control),
    obstacles: &str,
    [x, v]: [[f64; 3]; 2],
    t: f64,
) -> Simulation {
    let text = format!(
        "gravity = [0, -9.81, 0]
        particles = {{ positions = [{x:?}], velocities = [{v:?}], mass = 1 }}
        {obstacles}"
    );
    let description = Description::parse(&text).unwrap();
    let cells = if obstacles.contains("fine") { 9 } else { 1 };
    let setup = description.build(None, &mut |_| Ok(plate(cells))).unwrap();
    let mut run = Simulation::new(setup.scene, method, control).unwrap();
    run.advance_to(t).unwrap_or_else(|why| panic!("{}, {control:?}: {why}", method.name));
    assert_eq!(run.gained(), None, "{}", method.name);
    run
}

/// All methods for the motion of points, with the controls by which they run.
fn all() -> Vec<(&'static Method, Control)> {
    let mut all = vec![];
    for method in METHODS.iter().filter(|method| !method.plain_only()) {
        let controls = [Control::Step(2e-3), Control::Tolerance(1e-3), Control::Tolerance(1e-6)];
        let fits = |control: &Control| method.check_control(*control).is_ok();
        all.extend(controls.into_iter().filter(fits).map(|control| (method, control)));
    }
    all
}

#[test]
fn a_particle_glides_over_the_seam_of_level_boxes() {
    let second = |left: f64| {
        format!(
            "[[box]]
            center = [-1, -0.1, 0]
            size = [2, 0.2, 2]
            [[box]]
            center = [{}, -0.1, 0]
            size = [2, 0.2, 2]",
            left + 1.0
        )
    };
    for overlap in [0.0, 0.1] {
        for who in all() {
            let run = after(who, &second(-overlap), [[-0.6, 0.0, 0.05], [2.2, 0.0, 0.1]], 1.0);
            let (x, speed) = (run.position(0), run.state()[3]);
            let off = (x.x - 1.6).abs() + x.y.abs() + (speed - 2.2).abs();
            let name = who.0.name;
            assert!(off < 1e-3, "{name}, {:?}, overlap {overlap}: {x}", who.1);
        }
    }
}

#[test]
fn a_particle_lands_on_a_thin_mesh() {
    for who in all() {
        for name in ["coarse", "fine"] {
            let plate = format!("[[obstacle]]\nfile = \"{name}.obj\"\nat = [0, 0, 0]");
            let run = after(who, &plate, [[0.1, 0.3, 0.05], [0.4, 0.0, 0.0]], 0.6);
            let x = run.position(0);
            let off = (x.x - 0.34).abs() + x.y.abs();
            assert!(off < 2e-3, "{}, {:?}, {name}: {x}", who.0.name, who.1);
        }
    }
}

#[test]
fn friction_stops_a_slide_over_the_triangles_of_a_mesh() {
    let plate = "[[obstacle]]\nfile = \"fine.obj\"\nat = [0, 0, 0]\nfriction = 0.2";
    let (v, u) = (1.5, 0.2 * 9.81);
    let end = -0.6 + 0.5 * v * v / u;
    // These refuse friction.
    let refuses = |method: &Method| method.name.starts_with("dprkn");
    for who in all().into_iter().filter(|(method, _)| !refuses(method)) {
        let run = after(who, plate, [[-0.6, 0.0, 0.05], [v, 0.0, 0.0]], 1.0);
        let x = run.position(0);
        let off = (x.x - end).abs() + x.y.abs();
        assert!(off < 5e-3, "{}, {:?}: {x}", who.0.name, who.1);
    }
}

/// A rod lands on a plate that turns, is carried along by friction, and slides off it.
#[test]
fn a_rod_slides_off_a_turning_mesh() {
    let bar = "v -1 -0.1 -0.5\nv -1 -0.1 0.5\nv -1 0.1 -0.5\nv -1 0.1 0.5
        v 1 -0.1 -0.5\nv 1 -0.1 0.5\nv 1 0.1 -0.5\nv 1 0.1 0.5
        f 1 2 4 3\nf 5 7 8 6\nf 1 5 6 2\nf 3 4 8 7\nf 1 3 7 5\nf 2 6 8 4";
    let text = "gravity = [0, -9.81, 0]
        [[obstacle]]
        file = \"bar.obj\"
        at = [0, 0.05, 0]
        friction = 0.3
        turn = { axis = [0, 1, 0], rate = 4 }
        [particles]
        positions = [[0.1, 0.4, 0], [0.4, 0.45, 0]]
        mass = 1
        [[constraint]]
        rod = [0, 1]";
    for (name, step) in [("rk4", 1e-3), ("rk4", 5e-4), ("verlet", 1e-3)] {
        let description = Description::parse(text).unwrap();
        let mesh = Mesh::from_obj(bar.as_bytes()).unwrap();
        let setup = description.build(None, &mut |_| Ok(mesh.clone())).unwrap();
        let control = Control::Step(step);
        let mut run = Simulation::new(setup.scene, method(name), control).unwrap();
        run.advance_to(0.8).unwrap_or_else(|why| panic!("{name}, {step}: {why}"));
        let length = (run.position(1) - run.position(0)).norm();
        assert!((length - 0.0925_f64.sqrt()).abs() < 1e-4, "{length}");
    }
}

#[test]
fn a_box_that_stands_on_something_stops_what_slides_along_it() {
    let grounds = ["[floor]\nheight = 0", "[[box]]\ncenter = [0, -0.5, 0]\nsize = [8, 1, 8]"];
    for ground in grounds {
        for (restitution, end) in [(0.0, 0.5), (0.5, -0.25)] {
            let scene = format!(
                "{ground}
                [[box]]
                center = [1, 0.5, 0]
                size = [1, 1, 2]
                restitution = {restitution}"
            );
            for who in all() {
                let run = after(who, &scene, [[0.0; 3], [2.0, 0.0, 0.013]], 1.0);
                let x = run.position(0);
                let off = (x.x - end).abs() + x.y.abs();
                let name = who.0.name;
                assert!(off < 2e-2, "{name}, {:?}, {restitution}: {x}", who.1);
            }
        }
    }
}

/// A particle that reaches a wall just at the end of a step rebounds all the same.
#[test]
fn a_rebound_at_the_end_of_a_step_is_none_the_less_one() {
    let wall = "[[box]]\ncenter = [1.5, 1, 0]\nsize = [1, 30, 2]\nrestitution = 1";
    for name in ["euler", "symplectic", "implicit", "verlet", "rk4"] {
        for step in [2e-3, 1e-3, 1e-4, 1.7e-3] {
            let who = (method(name), Control::Step(step));
            let run = after(who, wall, [[0.0, 0.5, 0.0], [2.0, 0.0, 0.0]], 0.9);
            let speed = run.state()[3];
            assert!((speed + 2.0).abs() < 1e-9, "{name} {step}: {speed}");
        }
    }
}
