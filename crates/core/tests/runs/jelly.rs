//! The jelly: the springs and the skin of its lattice, its fall, its oscillation, and its state of
//! rest.

use std::collections::BTreeMap;

use crate::common::{method, scene, simulation};
use a3_core::{Control, Scene, Simulation, SpringKind, Vector3};
use a3_scenes::Description;

/// Jelly with these numbers of particles along its edges, without gravity.
fn lattice(grid: [usize; 3]) -> Scene {
    let text = format!(
        "[[jelly]]\ngrid = {grid:?}\nsize = [1, 2, 3]\nmass = 1\nstiffness = [1, 1, 1]\nat = [0, 0, 0]"
    );
    let none = &mut |_: &str| Err(String::new());
    Description::parse(&text).unwrap().build(None, none).unwrap().scene
}

/// Volume within the skin (m3): a sixth of the sum of a . (b x c) over its triangles.
fn volume(run: &Simulation) -> f64 {
    let triangles = run.model().network().unwrap().triangles().iter();
    let spat = triangles.map(|t| {
        let [a, b, c] = t.map(|i| run.position(i as usize));
        a.dot(&b.cross(&c))
    });
    spat.sum::<f64>() / 6.0
}

#[test]
fn springs_are_counted_by_kind() {
    for [x, y, z] in [[2, 2, 2], [3, 4, 5], [2, 3, 2]] {
        let scene = lattice([x, y, z]);
        let network = scene.model.network().unwrap();
        let count = |kind| network.springs().filter(|s| s.kind == kind).count();
        let pairs = |a: usize, b: usize, c: usize| (a - 1) * b * c;
        assert_eq!(count(SpringKind::Structural), pairs(x, y, z) + pairs(y, x, z) + pairs(z, x, y));
        let faces = |a: usize, b: usize, c: usize| 2 * (a - 1) * (b - 1) * c;
        assert_eq!(
            count(SpringKind::Shear),
            faces(x, y, z) + faces(y, z, x) + faces(x, z, y) + 4 * (x - 1) * (y - 1) * (z - 1)
        );
        let next = |a: usize, b: usize, c: usize| a.saturating_sub(2) * b * c;
        assert_eq!(count(SpringKind::Bend), next(x, y, z) + next(y, x, z) + next(z, x, y));
    }
}

/// All springs initially have their rest length, and no two connect the same particles.
#[test]
fn springs_are_at_rest_at_first() {
    let scene = lattice([3, 4, 5]);
    let run = Simulation::new(scene, method("r"), Control::Step(0.01)).unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for s in run.model().network().unwrap().springs() {
        let length = (run.position(s.i) - run.position(s.j)).norm();
        assert!((length - s.law.rest_length).abs() < 1e-12);
        assert!(seen.insert((s.i.min(s.j), s.i.max(s.j))));
    }
    assert!(run.energy().unwrap().elastic < 1e-24);
}

/// The skin is closed, and all its triangles face outwards: they pass each edge once in each
/// direction.
#[test]
fn the_skin_is_closed_and_faces_outwards() {
    let scene = lattice([3, 4, 5]);
    let mut edges = BTreeMap::new();
    for &[a, b, c] in scene.model.network().unwrap().triangles() {
        for edge in [[a, b], [b, c], [c, a]] {
            *edges.entry(edge).or_insert(0) += 1;
        }
    }
    assert!(edges.iter().all(|([a, b], n)| *n == 1 && edges.contains_key(&[*b, *a])));
    let run = Simulation::new(scene, method("r"), Control::Step(0.01)).unwrap();
    assert!((volume(&run) - 6.0).abs() < 1e-12);
}

/// The jelly falls, bounces, and comes to rest on the floor with its volume kept to 5 %.
#[test]
fn it_wobbles_and_keeps_its_volume() {
    let mut run = simulation("jelly", "r", 0.01);
    assert!((volume(&run) - 1.0).abs() < 1e-12);
    let mut least = 1.0f64;
    for frame in 1..=150 {
        run.advance_to(f64::from(frame) * 0.02).unwrap();
        least = least.min(volume(&run));
        assert!(run.lowest() >= 0.0);
    }
    assert!(least < 0.99 && least > 0.7, "{least}");
    // Implicit Euler brings it to rest quickly.
    run.set_method(method("i"), Control::Step(0.02)).unwrap();
    run.advance_to(20.0).unwrap();
    let rest = volume(&run);
    assert!(run.energy().unwrap().kinetic < 1e-6, "{:?}", run.energy());
    assert!((rest - 1.0).abs() < 0.05, "{rest}");
    assert!(run.lowest() < 1e-9);
}

/// Rotation turns the jelly and does not change its springs.
#[test]
fn turned_it_is_the_same() {
    let scene = scene("jelly");
    let n = scene.model.particles();
    let at = |i: usize| Vector3::new(scene.state[i], scene.state[n + i], scene.state[2 * n + i]);
    assert!((at(7) - at(0)).norm() - 1.0 < 1e-12 && (at(7) - at(0)).y.abs() > 0.1);
}
