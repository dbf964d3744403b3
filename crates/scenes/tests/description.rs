//! Scenes as text: what is read is what was written, and what is wrong is named with its line and
//! key.

use a3_core::contact::{Obstacle, Shape};
use a3_core::{Grid, Model, Path, Scene, SpringKind, Vector3};
use a3_scenes::{Description, Fault, Mesh, SCENES, Setup, find};

/// A built-in scene, with this grid or its own.
fn scene(name: &str, grid: Option<[usize; 2]>) -> Setup {
    let grid = grid.map(|[rows, cols]| Grid::new(rows, cols).unwrap());
    find(name).unwrap().build(grid).unwrap()
}

fn mesh(name: &str) -> Result<Mesh, String> {
    match name {
        // Two triangles of a unit square, with a corner twice.
        "square.obj" => Ok(Mesh {
            positions: vec![
                [0.0, 0.0, 0.0],
                [1.0, 0.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 1.0, 0.0],
                [1.0, 1.0, 0.0],
                [0.0, 0.0, 0.0],
            ],
            triangles: vec![[0, 1, 2], [5, 4, 3]],
        }),
        _ => Err(format!("{name}: there is no such file")),
    }
}

fn set_up(text: &str) -> Result<Setup, Fault> {
    let built = Description::parse(text).and_then(|d| d.build(None, &mut mesh));
    built.map_err(|fault| fault.locate(text))
}

fn build(text: &str) -> Result<Scene, Fault> {
    set_up(text).map(|setup| setup.scene)
}

/// What is said of a text that is wrong.
fn said(text: &str) -> String {
    match build(text) {
        Ok(_) => panic!("this was taken:\n{text}"),
        Err(fault) => fault.to_string(),
    }
}

const CLOTH: &str = "\
gravity = [0, -9.81, 0]

[[cloth]]
grid = [3, 4]
spacing = 0.5
mass = 0.1
stiffness = [10, 5, 2]
at = [0, 2, 0]
";

/// A line of the cloth's, what stands there instead, and how what is said begins.
const WRONG: &[(&str, &str, &str)] = &[
    (
        "spacing = 0.5",
        "spacing = -0.5",
        "line 5: cloth.spacing: it must be a finite number above 0, not -0.5",
    ),
    (
        "spacing = 0.5",
        "spacing = nan",
        "line 5: cloth.spacing: it must be a finite number above 0",
    ),
    (
        "spacing = 0.5",
        "spacng = 0.5",
        "line 5: cloth.spacng: there is no key `spacng`; did you mean `spacing`? The keys are grid, ",
    ),
    (
        "spacing = 0.5",
        "",
        "line 3: cloth: one of the keys `width` and `spacing` is needed",
    ),
    (
        "spacing = 0.5",
        "spacing = 0.5\nwidth = 1",
        "line 5: cloth.spacing: give either `width` or `spacing`",
    ),
    (
        "grid = [3, 4]",
        "",
        "line 3: cloth: the key `grid` is missing",
    ),
    (
        "grid = [3, 4]",
        "grid = [1, 4]",
        "line 4: cloth.grid: a grid has at least 2x2",
    ),
    (
        "grid = [3, 4]",
        "grid = [4294967295, 4294967295]",
        "line 4: cloth.grid: a grid has at least 2x2",
    ),
    (
        "grid = [3, 4]",
        "grid = \"big\"",
        "line 4: cloth.grid: invalid type: string \"big\"",
    ),
    (
        "stiffness = [10, 5, 2]",
        "stiffness = [10, 5]",
        "line 7: cloth.stiffness: ",
    ),
    (
        "stiffness = [10, 5, 2]",
        "stiffness = [10, 5, inf]",
        "line 7: cloth.stiffness: a spring's stiffness must be a finite number",
    ),
    (
        "mass = 0.1",
        "mass = 0",
        "line 6: cloth.mass: it must be a finite number above 0, not 0",
    ),
    (
        "at = [0, 2, 0]",
        "at = [0, 2e300, 0]",
        "line 8: cloth.at: it must be a number from -1e9 to 1e9",
    ),
    (
        "at = [0, 2, 0]",
        "right = [0, 0, 0]",
        "line 8: cloth.right: it must be a direction",
    ),
    (
        "at = [0, 2, 0]",
        "right = [0, 1, 0]",
        "line 8: cloth.right: `right` and `down` must be perpendicular",
    ),
    (
        "at = [0, 2, 0]",
        "pin = [{ at = [\"tpo\"] }]",
        "line 8: cloth.pin.at: there is no `tpo`; did you mean `top`?",
    ),
    (
        "at = [0, 2, 0]",
        "pin = [{ at = [\"first\"] }]",
        "line 8: cloth.pin.at: a cloth has top, bottom",
    ),
    (
        "at = [0, 2, 0]",
        "pin = [{ particles = [12] }]",
        "line 8: cloth.pin.particles: there is no particle 12: they are numbered 0 to 11",
    ),
    (
        "at = [0, 2, 0]",
        "pin = [{}]",
        "line 8: cloth.pin: the pin holds nothing",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "gravty = [0, 0, 0]",
        "line 1: gravty: there is no key `gravty`; did you mean `gravity`?",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "solver = \"rk5\"",
        "line 1: solver: there is no `rk5`; the solvers are euler, ",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "step = 0.1",
        "line 1: step: a step also needs the key `solver`",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "solver = \"r\"\nstep = 0",
        "line 2: step: it must be a finite number above 0",
    ),
    ("gravity = [0, -9.81, 0]", "tear = 0.5", "line 1: tear: "),
    (
        "gravity = [0, -9.81, 0]",
        "torn = [[0, 1], [0, 700]]",
        "line 1: torn: there is no spring between particles 0 and 700",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "trail = 12",
        "line 1: trail: there is no particle 12",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "springs = [[0, 12, 1, 1, 0]]",
        "line 1: springs: spring 0, counted from 0: 0 and 12 must be two different particles from 0 to 11",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "wind = { force = [1, 0, 0], velocity = [1, 0, 0] }",
        "line 1: wind: give one of the keys",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "sphere = [{ center = [0, 0, 0], radius = -1 }]",
        "line 1: sphere.radius: it must be a finite number above 0",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "sphere = [{ center = [0, 0, 0], radius = 1, friction = -0.1 }]",
        "line 1: sphere.friction: it must be a finite number of at least 0, not -0.1",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "box = [{ center = [0, 0, 0], size = [1, 1, 1] }, { center = [0, 0, 0], size = [1, 1, 1], friction = nan }]",
        "line 1: box.1.friction: it must be a finite number of at least 0, not NaN",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "floor = { height = 0, friction = inf }",
        "line 1: floor.friction: it must be a finite number of at least 0, not inf",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "floor = { height = 0, frition = 0.4 }",
        "line 1: floor.frition: there is no key `frition`; did you mean `friction`? The keys are height, friction",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "floor = { friction = 0.4 }",
        "line 1: floor: the key `height` is missing",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "floor = true",
        "line 1: floor: invalid type: boolean `true`, expected a height (m), or a table with the keys `height` and `friction`",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "circle = { start = [1, 0, 0] }",
        "line 1: circle: it is of first order",
    ),
    (
        "gravity = [0, -9.81, 0]",
        "gravity = [0, -9.81, 0",
        "line 3: ",
    ),
];

#[test]
fn what_is_wrong_is_said_with_line_and_key() {
    for (line, instead, expected) in WRONG {
        assert!(CLOTH.contains(line));
        let text = CLOTH.replace(line, instead);
        let said = said(&text);
        assert!(said.starts_with(expected), "{said}\n{expected}\n{text}");
        assert!(!said.contains('\n'), "{said}");
    }
    assert!(build(CLOTH).is_ok());
}

#[test]
fn the_second_of_a_kind_is_named_by_its_number() {
    let two = format!(
        "{CLOTH}\n{}",
        CLOTH
            .split_once("\n\n")
            .unwrap()
            .1
            .replace("mass = 0.1", "mass = -1")
    );
    assert!(
        said(&two).starts_with("line 13: cloth.1.mass: "),
        "{}",
        said(&two)
    );
}

#[test]
fn nothing_at_all_is_said_to_be_too_little() {
    assert!(said("").contains("the scene is empty: it needs at least one of cloth"));
}

/// Sizes are looked at before memory is taken.
#[test]
fn what_is_too_much_is_refused_at_once() {
    let begun = std::time::Instant::now();
    let jelly = |grid: &str| {
        format!(
            "[[jelly]]\ngrid = {grid}\nsize = [1, 1, 1]\nmass = 1\nstiffness = [1, 1, 1]\nat = [0, 0, 0]"
        )
    };
    for (text, expected) in [
        (jelly("[100000, 100000, 100000]"), "line 1: jelly: the scene would have"),
        (jelly("[9223372036854775807, 9223372036854775807, 3]"), "line 2: jelly.grid: "),
        (jelly("[100, 100, 100]"), "line 1: jelly: the scene would have some 16000000 springs"),
        ("[[chain]]\nparticles = 99999999999\nfrom = [0, 0, 0]\nto = [1, 0, 0]\nmass = 1\nstiffness = 1".into(), "line 1: chain: the scene would have 99999999999 particles"),
    ] {
        assert!(said(&text).starts_with(expected), "{}", said(&text));
    }
    let deep = format!("a = {}", "[".repeat(100_000));
    assert!(said(&deep).starts_with("line 1: "), "{}", said(&deep));
    assert!(begun.elapsed().as_secs() < 5);
}

/// Every built-in file can be read, has a summary, and is written as what is read as the same.
#[test]
fn what_is_written_is_read_as_the_same() {
    for entry in SCENES {
        let description = entry.description().unwrap();
        assert_eq!(description.name.as_deref(), Some(entry.name));
        assert!(description.summary.is_some());
        let text = description.to_toml().unwrap();
        assert_eq!(Description::parse(&text).unwrap(), description, "{text}");
    }
}

/// Bodies of every kind in one scene, numbered one after another, with springs between them.
#[test]
fn bodies_are_numbered_through() {
    let text = format!(
        "{CLOTH}
[[cloth]]
grid = [2, 2]
width = 1
density = 2
stiffness = [1, 1, 1]

[[jelly]]
grid = [2, 2, 2]
size = [1, 1, 1]
density = 8
stiffness = [1, 1, 1]
at = [5, 0, 0]
pin = [{{ at = [\"bottom\"] }}]

[[mesh]]
file = \"square.obj\"
density = 3
stiffness = [7, 2]
pin = [{{ at = [\"top\"] }}]

[[chain]]
particles = 3
from = [0, 0, 0]
to = [0, 2, 0]
mass = 4
stiffness = 1
pin = [{{ at = [\"last\"], sine = {{ amplitude = [1, 0, 0], rate = 2 }} }}]

[particles]
positions = [[9, 9, 9], [8, 8, 8]]
velocities = [[1, 2, 3], [0, 0, 0]]
masses = [5, 6]
springs = [[0, 1, 3, 1, 0]]

[[pin]]
particles = [0]
"
    );
    // At the root, before the tables.
    let setup = set_up(&format!("springs = [[11, 27, 2, 1, 0]]\n{text}")).unwrap();
    let (scene, surface) = (setup.scene, &setup.presentation.surface);
    let network = scene.model.network().unwrap();
    assert_eq!(network.particles(), 12 + 4 + 8 + 4 + 3 + 2);
    assert_eq!(surface.bodies, [12, 16, 24, 28]);
    assert_eq!(surface.triangles.len(), 12 + 2 + 12 + 2);
    assert!(surface.triangles.iter().flatten().all(|i| *i < 28));
    let masses = network.masses();
    assert_eq!(
        (masses[0], masses[12], masses[16], masses[31]),
        (0.1, 2.0, 1.0, 5.0)
    );
    // Corners of the square belong to both triangles or to one.
    let thirds = [24, 25, 26, 27].map(|i| masses[i]);
    assert_eq!(thirds, [1.0, 0.5, 1.0, 0.5]);
    let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
    assert_eq!(pins, [0, 16, 17, 20, 21, 26, 27, 30]);
    let Some((_, Path::Sine { center, .. })) = network.pins().last() else {
        panic!("the chain's end swings")
    };
    assert_eq!(center, Vector3::new(0.0, 2.0, 0.0));
    let joins = |i, j| {
        network
            .springs()
            .any(|s| (s.i, s.j) == (i, j) || (s.i, s.j) == (j, i))
    };
    assert!(joins(11, 27) && joins(31, 32) && joins(28, 29) && joins(12, 13) && !joins(11, 12));
    let across: Vec<_> = network
        .springs_of(25)
        .filter(|s| s.kind == SpringKind::Bend)
        .collect();
    assert!(matches!(across[..], [s] if s.i + s.j == 25 + 27 && s.law.stiffness == 2.0));
    assert_eq!(scene.state[3 * 33 + 31], 1.0);
}

/// A second cloth is held together as the first is.
#[test]
fn every_cloth_has_its_springs() {
    let one = build(CLOTH).unwrap();
    let body = CLOTH.split_once("\n\n").unwrap().1;
    let two = build(&format!("{CLOTH}\n{body}")).unwrap();
    let count = |scene: &Scene| scene.model.network().unwrap().springs().count();
    assert_eq!(count(&two), 2 * count(&one));
}

/// The grid asked for samples the same cloth: as wide, as heavy, and damped alike.
#[test]
fn another_grid_is_the_same_cloth() {
    let (coarse, fine) = (scene("cloth", None), scene("cloth", Some([39, 39])));
    let mass = |setup: &Setup| {
        let network = setup.scene.model.network().unwrap();
        // Border particles stand for half a cell too much.
        network.masses()[0] * ((setup.scene.grid().unwrap().cols() - 1) as f64).powi(2)
    };
    assert!((mass(&coarse) - mass(&fine)).abs() < 1e-9);
    assert!((fine.defaults.step_scale - 0.5).abs() < 1e-12);
    assert!(scene("mit", Some([30, 30])).defaults.step_scale == 1.0);
}

#[test]
fn a_state_stands_for_that_of_the_bodies() {
    let text = "[state]\npositions = [[3, 4, 0]]\n\n[circle]\nstart = [1, 0, 0]\n";
    let scene = build(text).unwrap();
    assert!(matches!(scene.model, Model::FirstOrder(_)));
    assert_eq!(scene.state, [3.0, 4.0, 0.0]);
    let of = |rows: usize| {
        format!(
            "state = {{ positions = {:?} }}\n{CLOTH}",
            vec![[1.0, 2.0, 3.0]; rows]
        )
    };
    let scene = build(&of(12)).unwrap();
    assert_eq!(
        (scene.state[0], scene.state[12], scene.state[40]),
        (1.0, 2.0, 0.0)
    );
    assert!(said(&of(11)).starts_with("line 1: state.positions: there are 11, but 12 particles"));
}

#[test]
fn obstacles_wind_and_buckling_are_there() {
    let scene = build(&format!(
        "floor = {{ height = -1, friction = 0.4 }}
tear = 2
box = [{{ center = [0, 0, 0], size = [1, 2, 3], rotation = [0, 1, 0] }}]
capsule = [{{ from = [0, 0, 0], to = [1, 0, 0], radius = 0.1, friction = 0.5 }}]
sphere = [{{ center = [0, 0, 0], radius = 1, friction = 0.25, shift = {{ by = [1, 0, 0], end = 2 }} }}]
wind = {{ on = true, velocity = [1, 0, 0] }}
{}",
        CLOTH.replace(
            "[10, 5, 2]",
            "[10, 5, 2]\nbuckling = { bending = 0.001, compression = 10 }"
        )
    ))
    .unwrap();
    let network = scene.model.network().unwrap();
    assert_eq!(
        network
            .forces_in_use()
            .iter()
            .filter(|name| ["box", "capsule", "sphere", "wind", "floor"].contains(name))
            .count(),
        5
    );
    let [sphere, cuboid, capsule, floor] = network.obstacles() else {
        panic!("{:?}", network.obstacles());
    };
    assert_eq!(
        (sphere.path.at(1.0).position, sphere.friction),
        (Vector3::new(0.5, 0.0, 0.0), 0.25)
    );
    let half = Vector3::new(0.5, 1.0, 1.5);
    assert!(matches!(cuboid.shape, Shape::Box { half_extents, .. } if half_extents == half));
    assert!(matches!(capsule.shape, Shape::Capsule { radius: 0.1, .. }));
    assert_eq!((cuboid.friction, capsule.friction), (0.0, 0.5));
    assert_eq!(
        *floor,
        Obstacle {
            friction: 0.4,
            ..Obstacle::smooth(Shape::Floor, Path::Still(Vector3::new(0.0, -1.0, 0.0)))
        }
    );
    assert_eq!(network.buckling().count(), 3 * 2 + 4);
    assert_eq!(
        (network.triangles().len(), network.tear_limit()),
        (12, Some(2.0))
    );
}

#[test]
fn editors_get_a_schema() {
    let schema = Description::schema();
    for word in [
        "cloth",
        "damping_ratio",
        "additionalProperties",
        "top-left",
        "\"box\"",
    ] {
        assert!(schema.contains(word), "{word}");
    }
}

/// Texts that were damaged at random are read or refused, and nothing else; what is read can be
/// evaluated.
#[test]
fn damaged_texts_are_refused_or_read() {
    let mut seed = 1u64;
    let mut random = |below: usize| {
        seed = seed
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (seed >> 33) as usize % below
    };
    let words = [
        "-1",
        "0",
        "nan",
        "1e400",
        "[",
        "]",
        "{}",
        "\"",
        "=",
        "\n",
        "999999999999",
        "[[cloth]]",
        "true",
        "é",
    ];
    let (mut refused, mut read) = (0, 0);
    for k in 0..4000 {
        let mut text: Vec<char> = SCENES[k % SCENES.len()].text.chars().collect();
        for _ in 0..=random(3) {
            let at = random(text.len());
            match random(3) {
                0 => drop(text.remove(at)),
                1 => text.truncate(at.max(1)),
                _ => drop(text.splice(at..at, words[random(words.len())].chars())),
            }
        }
        let text: String = text.into_iter().collect();
        match build(&text) {
            Err(fault) => {
                assert!(
                    !fault.why.is_empty() && !fault.to_string().contains('\n'),
                    "{fault}"
                );
                refused += 1;
            }
            Ok(scene) => {
                let system = scene.model.system();
                if system.dim() < 10_000 {
                    let mut f = vec![0.0; system.dim()];
                    system.eval_f(0.0, &scene.state, &mut f);
                    assert!(f.iter().all(|f| f.is_finite()), "{text}");
                }
                read += 1;
            }
        }
    }
    assert!(refused > 500 && read > 500, "{refused} {read}");
}
