//! Building: every body, obstacle and force of a description is in the scene.

use a3_core::contact::{Obstacle, Shape};
use a3_core::{Model, Path, Scene, SpringKind, Vector3};
use a3_scenes::{SCENES, snapshot};

use super::*;

/// Every built-in scene has a summary, and is the same again after it was written and read.
#[test]
fn what_is_written_is_read_as_the_same() {
    for entry in SCENES {
        let description = entry.description().unwrap();
        assert_eq!(description.name.as_deref(), Some(entry.name));
        assert!(description.summary.is_some());
        let text = description.to_toml().unwrap();
        assert_eq!(read(&text), description, "{text}");
    }
}

/// Bodies of every kind in one scene, numbered one after another, with springs between them.
#[test]
fn bodies_are_numbered_through() {
    let text = format!(
        "{CLOTH}
[[cloth]]\ngrid = [2, 2]\nwidth = 1\ndensity = 2\nstiffness = [1, 1, 1]
[[jelly]]\ngrid = [2, 2, 2]\nsize = [1, 1, 1]\ndensity = 8\nstiffness = [1, 1, 1]\nat = [5, 0, 0]
pin = [{{ at = ['bottom'] }}]
[[mesh]]\nfile = 'square.obj'\ndensity = 3\nstiffness = [7, 2]\npin = [{{ at = ['top'] }}]
[[chain]]\nparticles = 3\nfrom = [0, 0, 0]\nto = [0, 2, 0]\nmass = 4\nstiffness = 1
pin = [{{ at = ['last'], sine = {{ amplitude = [1, 0, 0], rate = 2 }} }}]
[particles]\npositions = [[9, 9, 9], [8, 8, 8]]\nvelocities = [[1, 2, 3], [0, 0, 0]]
masses = [5, 6]\nsprings = [[0, 1, 3, 1, 0]]
[[pin]]\nparticles = [0]\n"
    );
    // Springs of the whole scene come before the tables.
    let setup = set_up(&format!("springs = [[11, 27, 2, 1, 0]]\n{text}")).unwrap();
    let (scene, surface) = (setup.scene, &setup.presentation.surface);
    let network = network(&scene);
    assert_eq!(network.particles(), 12 + 4 + 8 + 4 + 3 + 2);
    assert_eq!(surface.bodies, [12, 16, 24, 28]);
    assert_eq!(surface.triangles.len(), 12 + 2 + 12 + 2);
    assert!(surface.triangles.iter().flatten().all(|i| *i < 28));
    let masses = network.masses();
    assert_eq!([0, 12, 16, 31].map(|i| masses[i]), [0.1, 0.5, 1.0, 5.0]);
    // Corners of the square belong to both triangles or to one.
    let thirds = [24, 25, 26, 27].map(|i| masses[i]);
    assert_eq!(thirds, [1.0, 0.5, 1.0, 0.5]);
    let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
    assert_eq!(pins, [0, 16, 17, 20, 21, 26, 27, 30]);
    let Some((_, Path::Sine { center, .. })) = network.pins().last() else {
        panic!("the chain's end swings")
    };
    assert_eq!(center, Vector3::new(0.0, 2.0, 0.0));
    let joins = |i, j| network.springs().any(|s| [[i, j], [j, i]].contains(&[s.i, s.j]));
    assert!(joins(11, 27) && joins(31, 32) && joins(28, 29) && joins(12, 13) && !joins(11, 12));
    let of_corner = network.springs_of(25);
    let across: Vec<_> = of_corner.filter(|s| s.kind == SpringKind::Bend).collect();
    assert!(matches!(across[..], [s] if s.i + s.j == 25 + 27 && s.law.stiffness == 2.0));
    assert_eq!(scene.state[3 * 33 + 31], 1.0);
}

/// A second cloth has springs like the first.
#[test]
fn every_cloth_has_its_springs() {
    let one = build(CLOTH).unwrap();
    let body = CLOTH.split_once("\n\n").unwrap().1;
    let two = build(&format!("{CLOTH}\n{body}")).unwrap();
    let count = |scene: &Scene| network(scene).springs().count();
    assert_eq!(count(&two), 2 * count(&one));
}

#[test]
fn a_state_stands_for_that_of_the_bodies() {
    let text = "[state]\npositions = [[3, 4, 0]]\n\n[circle]\nstart = [1, 0, 0]\n";
    let scene = build(text).unwrap();
    assert!(matches!(scene.model, Model::Points(_)));
    assert_eq!(scene.state, [3.0, 4.0, 0.0]);
    let of = |rows: usize| {
        let rows = vec![[1.0, 2.0, 3.0]; rows];
        format!("state = {{ positions = {rows:?} }}\n{CLOTH}")
    };
    let scene = build(&of(12)).unwrap();
    assert_eq!([0, 12, 40].map(|k| scene.state[k]), [1.0, 2.0, 0.0]);
    assert!(said(&of(11)).starts_with("line 1: state.positions: there are 11, but 12 particles"));
}

#[test]
fn obstacles_wind_and_buckling_are_there() {
    let buckling = "[10, 5, 2]\nbuckling = { bending = 0.001, compression = 10 }";
    let cloth = CLOTH.replace("[10, 5, 2]", buckling);
    let scene = build(&format!(
        "floor = {{ height = -1, friction = 0.4 }}
tear = 2
box = [{{ center = [0, 0, 0], size = [1, 2, 3], rotation = [0, 1, 0] }}]
capsule = [{{ from = [0, 0, 0], to = [1, 0, 0], radius = 0.1, friction = 0.5 }}]
sphere = [{{ center = [0, 0, 0], radius = 1, friction = 0.25, shift = {{ by = [1, 0, 0], end = 2 }} }}]
wind = {{ on = true, velocity = [1, 0, 0] }}
{cloth}"
    ))
    .unwrap();
    let network = network(&scene);
    let forces = network.forces_in_use();
    let named = ["box", "capsule", "sphere", "wind", "floor"];
    assert!(named.iter().all(|name| forces.contains(name)), "{forces:?}");
    let [sphere, cuboid, capsule, floor] = network.obstacles() else {
        panic!("{:?}", network.obstacles());
    };
    let halfway = Vector3::new(0.5, 0.0, 0.0);
    assert!(sphere.path.at(1.0).position == halfway && sphere.friction == 0.25);
    let half = Vector3::new(0.5, 1.0, 1.5);
    assert!(matches!(cuboid.shape, Shape::Box { half_extents, .. } if half_extents == half));
    assert!(matches!(capsule.shape, Shape::Capsule { radius: 0.1, .. }));
    assert_eq!((cuboid.friction, capsule.friction), (0.0, 0.5));
    let ground = Obstacle::smooth(Shape::Floor, Path::Still(Vector3::new(0.0, -1.0, 0.0)));
    let friction = 0.4;
    assert!(*floor == Obstacle { friction, ..ground });
    assert_eq!(network.buckling().count(), 3 * 2 + 4);
    assert!(network.triangles().len() == 12 && network.tear_limit() == Some(2.0));
}

#[test]
fn editors_get_a_schema() {
    let schema = Description::schema();
    for word in "cloth damping_ratio additionalProperties top-left \"box\"".split(' ') {
        assert!(schema.contains(word), "{word}");
    }
}

/// Returns the description of a text after a run of a scene began.
fn snapshot_of(text: &str, scene: Scene) -> Description {
    let (mut description, run) = (read(text), run(scene, "verlet", 0.01));
    snapshot::begin_with(&mut description, run.model(), &run.checkpoint());
    description
}

/// A limit of strain applies to the particles of its body only, and a snapshot has the limits of
/// the run.
#[test]
fn strain_is_limited_body_by_body() {
    let limited = CLOTH.replace("[10, 5, 2]", "[10, 5, 2]\nstrain_limit = 1.25");
    let text = format!(
        "{limited}
[[jelly]]\ngrid = [2, 2, 2]\nsize = [1, 1, 1]\nmass = 8\nstiffness = [1, 1, 1]\nat = [5, 0, 0]
[[mesh]]\nfile = 'square.obj'\ndensity = 3\nstiffness = [7, 2]\nstrain_limit = 1.5\n"
    );
    let mut scene = build(&text).unwrap();
    let n = scene.model.particles();
    let limits = network(&scene).strain_limits();
    assert_eq!(limits, [(0..12, 1.25), (20..n, 1.5)]);
    if let Model::Network(network) = &mut scene.model {
        network.set_strain_limit(20..n, Some(2.0)).unwrap();
    }
    let d = snapshot_of(&text, scene);
    let limits = [d.cloth[0].strain_limit, d.jelly[0].strain_limit, d.mesh[0].strain_limit];
    assert_eq!(limits, [Some(1.25), None, Some(2.0)]);
    let said = said(&format!("tear = 1.25\n{limited}"));
    assert!(said.contains("never break at 1.25 times"), "{said}");
}

/// Contact is as stiff as gravity asks, and stays so where gravity changes in a run, or is left
/// out.
#[test]
fn contact_keeps_the_gravity_of_the_scene() {
    let body = "[[body]]\nparts = [{ ball = 0.1 }]\nmass = 4\n";
    let skin = |description: &Description| {
        let skin = network(&built(description)).touch().unwrap().skins[0];
        [skin.stiffness, skin.damping]
    };
    for (gravity, stiffness) in [
        ("[0, -9.81, 0]", 100.0 / 0.004),
        ("[0, -981, 0]", 10_000.0 / 0.004),
        ("[0, 0, 0]", 100.0 / 0.004),
    ] {
        let text = format!("gravity = {gravity}\n{body}");
        let skin_of_own = skin(&read(&text));
        let off = (skin_of_own[0] / stiffness - 1.0).abs();
        assert!(off < 1e-12, "{gravity}");
        let mut scene = build(&text).unwrap();
        if let Model::Network(network) = &mut scene.model {
            network.set_gravity(Vector3::new(1.0, -5.0, 0.0));
        }
        let tuned = snapshot_of(&text, scene);
        assert_eq!(tuned.gravity, Some([1.0, -5.0, 0.0]));
        let again = read(&tuned.to_toml().unwrap());
        let weightless = a3_scenes::without(&tuned, &a3_scenes::parts(&tuned));
        assert!(weightless.gravity.is_none());
        assert_eq!([skin(&again), skin(&weightless)], [skin_of_own; 2]);
    }
    let unchanged = format!("gravity = [0, -1.62, 0]\n{body}");
    let written = snapshot_of(&unchanged, build(&unchanged).unwrap());
    assert_eq!(written.contact_gravity, None);
    let said = said(&format!("contact_gravity = 0\n{body}"));
    assert!(said.contains("contact_gravity"), "{said}");
}

/// A scene whose constraints are not met at the start is refused with the number of one of them.
#[test]
fn constraints_are_met_at_the_start() {
    let build = |text: &str| read(text).build(None, &mut mesh).map(drop);
    let particles = "[particles]\npositions = [[0, 0, 0], [1, 0, 0], [2, 0, 0]]\nmass = 1\n";
    let rods = |length: f64| {
        let second = format!("[[constraint]]\nrod = [1, 2]\nlength = {length}\n");
        format!("{particles}[[constraint]]\nrod = [0, 1]\n{second}")
    };
    build(&rods(1.0)).unwrap();
    build(&rods(1.0005)).unwrap();
    let refused = build(&rods(1.05)).unwrap_err();
    assert_eq!(refused.key, "constraint.1");
    let why = "constraint 1, the rod between particles 1 and 2, is off by 4.762 %";
    begins(refused.why, why);
    let itself = build(&rods(1.0).replace("[1, 2]", "[1, 1]")).unwrap_err();
    assert_eq!(itself.key, "constraint.1.rod");
    begins(itself.why, "it must join two different particles");
    let circle = "{ center = [0, 0, 0], normal = [0, 0, 1], radius = 1 }";
    for (name, wire) in [
        ("point", "[0, 0.5, 0]"),
        ("line", "{ point = [0, 0.5, 0], direction = [1, 0, 0] }"),
        ("circle", circle),
        ("sphere", "{ center = [0, 0, 0], radius = 1 }"),
    ] {
        let wired = format!("{particles}[[constraint]]\nparticle = 0\n{name} = {wire}\n");
        let expected = format!("constraint 0, the {name} of particle 0, is off by");
        begins(build(&wired).unwrap_err().why, &expected);
    }
    // A ball of 10 cm cannot hang half a metre from its middle.
    let hung = "[[body]]\nparts = [{ ball = 0.1 }]\nmass = 1\n\
        [[constraint]]\nparticle = 1\npoint = [0, 0.5, 0]\n";
    assert!(build(hung).is_err());
    // A scene with a given state reports the errors of its constraints in the run.
    let state = "[state]\npositions = [[0, 0, 0], [1, 0, 0], [2.05, 0, 0]]\n";
    build(&format!("{}{state}", rods(1.0))).unwrap();
}
