//! Surfaces that begin crossed come apart, as the exact test of edges and triangles says.

use a3_core::contact::crossings;
use a3_core::{Control, Network, Scene, Simulation, untangle};
use a3_scenes::{Description, Mesh};

use crate::common::{method, state_random};

/// Builds a scene whose mesh files are an octahedron.
fn scene(text: &str) -> Scene {
    let faces = [[0, 2, 4], [2, 1, 4], [1, 3, 4], [3, 0, 4]];
    let corner = |i: usize| {
        let mut place = [0.0; 3];
        place[i / 2] = if i.is_multiple_of(2) { 0.3 } else { -0.3 };
        place
    };
    let octahedron = Mesh {
        positions: (0..6).map(corner).collect(),
        triangles: faces.iter().flat_map(|&[a, b, c]| [[a, b, c], [b, a, 5]]).collect(),
        ..Mesh::default()
    };
    let description = Description::parse(&format!("self_collision = true\n{text}")).unwrap();
    description.build(None, &mut |_| Ok(octahedron.clone())).unwrap().scene
}

fn network(scene: &Scene) -> &Network {
    scene.model.network().unwrap()
}

/// Counts crossings of the triangles of the particles alone, by their edges.
fn count_crossings(network: &Network, y: &[f64]) -> usize {
    let triangles = network.triangles();
    let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
    let edges: Vec<_> = sides.filter(|[a, b]| a < b).collect();
    crossings(&y[..3 * network.particles()], &[], triangles, &edges).len()
}

/// Brings the surfaces of a scene apart, and checks that pins stayed and that a run can follow.
/// Returns the farthest that a particle moved (m).
fn parted(scene: &Scene) -> f64 {
    let network = network(scene);
    let n = network.particles();
    let mut apart = scene.clone();
    untangle(network, &mut apart.state).unwrap_or_else(|why| panic!("{why}"));
    assert_eq!(count_crossings(network, &apart.state), 0);
    network.check_apart(0.0, &apart.state[..3 * n]).unwrap();
    assert_eq!(apart.state[3 * n..], scene.state[3 * n..], "velocities stay");
    let moved = |i: usize| {
        let by = |axis: usize| apart.state[axis * n + i] - scene.state[axis * n + i];
        by(0).hypot(by(1)).hypot(by(2))
    };
    for (pin, _) in network.pins() {
        assert_eq!(moved(pin), 0.0);
    }
    let mut run = Simulation::new(apart.clone(), method("verlet"), Control::Step(1e-3)).unwrap();
    run.advance_to(0.02).unwrap();
    network.check_apart(run.time(), &run.state()[..3 * n]).unwrap();
    (0..n).map(moved).fold(0.0, f64::max)
}

fn sheet(keys: &str) -> String {
    format!("[[cloth]]\ngrid = [9, 9]\nwidth = 1\ndensity = 0.2\nstiffness = [40, 20, 5]\n{keys}\n")
}

const LEVEL: &str = "at = [0, 0, 0]\ndown = [0, 0, 1]";

#[test]
fn a_sheet_that_pokes_through_another_goes_back() {
    // A strip of 0.15 m is above the level sheet.
    let pair =
        sheet(LEVEL) + &sheet("at = [0.1, 0.15, 0.45]\nright = [1, 0.1, 0]\ndown = [0.1, -1, 0.2]");
    let moved = parted(&scene(&pair));
    assert!(moved < 0.3, "{moved}");
    // In millimetres, and of 100 m, all is as it was.
    for scale in [1e-3, 100.0] {
        let mut scaled = scene(&pair);
        let network = network(&scaled).clone();
        let n = network.particles();
        scaled.state[..3 * n].iter_mut().for_each(|x| *x *= scale);
        let before = scaled.state.clone();
        untangle(&network, &mut scaled.state).unwrap();
        assert_eq!(count_crossings(&network, &scaled.state), 0);
        let far = scaled.state.iter().zip(&before).map(|(a, b)| (a - b).abs());
        assert!(far.fold(0.0, f64::max) < 0.3 * scale);
    }
}

#[test]
fn bodies_of_all_kinds_come_apart() {
    let jelly = |keys: &str| {
        format!(
            "[[jelly]]\ngrid = [4, 4, 4]\nsize = [0.4, 0.4, 0.4]\nmass = 0.05\nstiffness = [200, 125, 85]\n{keys}\n"
        )
    };
    let ball =
        "[[mesh]]\nfile = 'ball.obj'\ndensity = 0.2\nstiffness = [60, 10]\nat = [0.2, 0.1, 0.3]\n";
    let bar = "[[solid]]\ngrid = [7, 3, 3]\nsize = [0.8, 0.1, 0.1]\ndensity = 100\nyoung = 1e4\npoisson = 0.3\n\
               at = [0.1, 0.02, 0.5]\nrotation = [0, 0, 0.4]\n";
    let body = |keys: &str| format!("[[body]]\nmass = 1\n{keys}\n");
    for (text, most) in [
        (sheet(LEVEL) + &jelly("at = [0.1, 0.1, 0.5]\nrotation = [0.2, 0.3, 0.1]"), 0.4),
        (
            jelly("at = [0, 0, 0]") + &jelly("at = [0.3, 0.3, 0.28]\nrotation = [0.3, 0.2, 0.4]"),
            0.4,
        ),
        (sheet(LEVEL) + ball, 0.8),
        (sheet(LEVEL) + bar, 0.5),
        (
            sheet(&format!("{LEVEL}\npin = [{{ at = ['top'] }}]"))
                + "[[box]]\ncenter = [0.1, -0.1, 0.7]\nsize = [0.3, 0.25, 0.3]\n",
            0.3,
        ),
        (sheet(LEVEL) + "[[sphere]]\ncenter = [0.05, -0.1, 0.5]\nradius = 0.25\n", 0.4),
        (sheet("at = [0, 0.3, 0]") + "[[box]]\ncenter = [0, -1, 0]\nsize = [3, 0.5, 3]\n", 0.1),
        ("floor = 0\n".to_owned() + &sheet("at = [0, 0.3, 0]\nthickness = 0.01"), 2.5),
        (
            body("parts = [{ box = [0.4, 0.3, 0.3] }]\nat = [0, 0, 0]")
                + &body(
                    "parts = [{ box = [0.4, 0.3, 0.3] }]\nat = [0.25, 0.12, 0.1]\nrotation = [0.3, 0.4, 0.1]",
                ),
            0.4,
        ),
        (sheet(LEVEL) + &body("parts = [{ ball = 0.2 }]\nat = [0, 0.05, 0.4]"), 0.6),
        (
            sheet(LEVEL)
                + "[[chain]]\nparticles = 8\nfrom = [0.02, -0.2, 0.5]\nto = [0.1, 0.5, 0.6]\nmass = 0.01\nstiffness = 50\n",
            0.4,
        ),
    ] {
        let moved = parted(&scene(&text));
        assert!(moved < most, "{moved} m in {text}");
    }
}

#[test]
fn a_rigid_body_moves_without_turning_or_bending() {
    let bodies = scene(
        "[[body]]\nmass = 1\nparts = [{ box = [0.4, 0.3, 0.3] }]\nat = [0, 0, 0]\n\
         [[body]]\nmass = 3\nparts = [{ box = [0.4, 0.3, 0.3] }]\nat = [0.3, 0.05, 0]\nrotation = [0, 0, 0.2]\n",
    );
    let network = network(&bodies);
    let n = network.particles();
    let mut y = bodies.state.clone();
    untangle(network, &mut y).unwrap();
    let moved = |i: usize| [0, 1, 2].map(|axis| y[axis * n + i] - bodies.state[axis * n + i]);
    let mut shifts = vec![];
    for body in network.bodies() {
        let own = moved(body.center());
        for i in body.points() {
            assert!(moved(i).iter().zip(own).all(|(a, b)| (a - b).abs() < 1e-12));
        }
        shifts.push(own);
    }
    // They part in opposite directions, and the lighter one moves farther.
    let [light, heavy] = [shifts[0][0], shifts[1][0]];
    assert!(light < -1.5 * heavy && heavy > 0.0, "{shifts:?}");
}

#[test]
fn random_heaps_of_sheets_and_jellies_come_apart() {
    let mut crossed = 0;
    for seed in 0..12 {
        let numbers: Vec<_> = state_random(18, 1 + 7919 * seed).iter().map(|x| 0.5 * x).collect();
        let body = |k: usize| {
            let [x, y, z] = [0, 1, 2].map(|axis| 0.6 * numbers[3 * k + axis]);
            let [a, b, c] = [0, 1, 2].map(|axis| 3.0 * numbers[9 + 3 * k + axis]);
            let at = format!("at = [{x}, {y}, {z}]");
            if k == 1 && seed.is_multiple_of(2) {
                format!(
                    "[[jelly]]\ngrid = [4, 4, 4]\nsize = [0.4, 0.4, 0.4]\nmass = 0.05\nstiffness = [200, 125, 85]\n{at}\nrotation = [{a}, {b}, {c}]\n"
                )
            } else {
                let [d, e, f] = [b * z - c * y, c * x - a * z, a * y - b * x];
                sheet(&format!("{at}\ndown = [{a}, {b}, {c}]\nright = [{d}, {e}, {f}]"))
            }
        };
        let text: String = (0..3).map(body).collect();
        let scene = scene(&text);
        crossed += count_crossings(network(&scene), &scene.state);
        let moved = parted(&scene);
        assert!(moved < 1.0, "{moved} m in {text}");
    }
    assert!(crossed > 200, "{crossed}");
}

#[test]
fn what_cannot_come_apart_is_named() {
    let all: Vec<_> = (0..81).collect();
    let pins = format!("pin = [{{ particles = {all:?} }}]");
    let text = sheet(&format!("{LEVEL}\n{pins}"))
        + &sheet(&format!(
            "at = [0.1, 0.5, 0.45]\nright = [1, 0.1, 0]\ndown = [0.1, -1, 0.2]\n{pins}"
        ));
    let scene = scene(&text);
    let mut y = scene.state.clone();
    let why = untangle(network(&scene), &mut y).unwrap_err().to_string();
    assert!(why.contains("do not come apart") && why.contains("part 1 (81 particles"), "{why}");
    assert_eq!(y, scene.state);
}
