//! Flat faces: bodies that lie or glide on them do not notice the triangulation.

use a3_core::contact::Skin;
use a3_core::{Control, Mechanics, Model, Network, Scene, Simulation, Vector3, rotation};
use a3_scenes::{Description, Mesh};

use crate::common::method;
use crate::pairs::Random;

/// Thickness of all skins (m).
const THICKNESS: f64 = 0.02;
/// Stiffness of all skins (N/m): 1 kg rests at a gap of half the thickness.
const STIFFNESS: f64 = 9.81 / (THICKNESS * 0.125);
/// Height at which bodies begin to glide (m), below the thickness.
const LOW: f64 = 0.4 * THICKNESS;
/// Number of cells along a side of the mesh.
const CELLS: u32 = 6;

/// Ground, with its top at y = 0 from -2 m to 2 m along x and z.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Ground {
    /// Plane without triangles, for comparison.
    Floor,
    Box,
    /// Slab of 192 triangles, those of the top of random shapes.
    Mesh,
}

/// Orientation and unit of length of a scene.
#[derive(Clone, Copy)]
struct Frame {
    turn: Vector3<f64>,
    unit: f64,
}

const PLAIN: Frame = Frame { turn: Vector3::new(0.0, 0.0, 0.0), unit: 1.0 };

impl Frame {
    fn random(random: &mut Random) -> Self {
        let unit = [1e-3, 1.0, 1e3][(random.unit() * 3.0) as usize % 3];
        let turn = random.vector() * 2.0;
        Self { turn, unit }
    }

    /// Direction in the scene of one that is given upright.
    fn direction(self, v: [f64; 3]) -> [f64; 3] {
        (rotation(self.turn) * Vector3::from(v)).into()
    }

    /// Vector in the scene (in its unit of length) of one that is given in metres and upright.
    fn vector(self, v: [f64; 3]) -> [f64; 3] {
        (Vector3::from(self.direction(v)) * self.unit).into()
    }

    /// The inverse.
    fn back(self, v: Vector3<f64>) -> Vector3<f64> {
        rotation(-self.turn) * v / self.unit
    }
}

impl Ground {
    fn text(self, frame: Frame) -> String {
        let [d, size] = [THICKNESS, 4.0].map(|length| length * frame.unit);
        let turn: [f64; 3] = frame.turn.into();
        let at = frame.vector([0.0, -0.5, 0.0]);
        match self {
            Self::Floor => format!("floor = {{ height = 0, thickness = {d} }}\n"),
            Self::Box => format!(
                "[[box]]\ncenter = {at:?}\nsize = [{size}, {}, {size}]\nrotation = {turn:?}
                thickness = {d}\n",
                frame.unit
            ),
            Self::Mesh => format!(
                "[[obstacle]]\nfile = \"slab.obj\"\nscale = {}\nrotation = {turn:?}
                thickness = {d}\n",
                frame.unit
            ),
        }
    }
}

/// Slab below y = 0, of 4 CELLS (CELLS + 2) triangles.
fn slab() -> Mesh {
    let (n, mut random) = (CELLS + 1, Random(3));
    let mut mesh = Mesh::default();
    for y in [0.0, -1.0] {
        for i in 0..n {
            for j in 0..n {
                let inside = |k: u32| if k.is_multiple_of(CELLS) { 0.0 } else { 0.5 };
                let cell = 4.0 / f64::from(CELLS);
                let mut along =
                    |k| -2.0 + cell * (f64::from(k) + inside(k) * (random.unit() - 0.5));
                mesh.positions.push([along(i), y, along(j)]);
            }
        }
    }
    let mut quad = |a: u32, b: u32, c: u32, d: u32| {
        let halves =
            if random.unit() < 0.5 { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] };
        mesh.triangles.extend(halves);
    };
    let (at, below) = (|i, j| i * n + j, n * n);
    for i in 0..CELLS {
        for j in 0..CELLS {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j)];
            quad(a, b, c, d);
            quad(d + below, c + below, b + below, a + below);
        }
        for (a, b) in [
            (at(i + 1, 0), at(i, 0)),
            (at(i, CELLS), at(i + 1, CELLS)),
            (at(0, i), at(0, i + 1)),
            (at(CELLS, i + 1), at(CELLS, i)),
        ] {
            quad(b, a, a + below, b + below);
        }
    }
    mesh
}

fn build(text: &str) -> Scene {
    let description = Description::parse(text);
    let setup = description.and_then(|d| d.build(None, &mut |_| Ok(slab())));
    setup.unwrap_or_else(|fault| panic!("{fault}\n{text}")).scene
}

/// Body above the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Thing {
    Particle,
    Ball,
    Cube,
    Cloth,
}

impl Thing {
    const ALL: [Self; 4] = [Self::Particle, Self::Ball, Self::Cube, Self::Cloth];
    const SINGLE: [Self; 2] = [Self::Particle, Self::Ball];

    /// Text of the body, whose lowest points are at that height (m).
    fn text(self, frame: Frame, [x, y, z]: [f64; 3], velocity: [f64; 3]) -> String {
        let d = THICKNESS * frame.unit;
        let length = |metres: f64| metres * frame.unit;
        let above = |up: f64| frame.vector([x, y + up, z]);
        let velocity = frame.vector(velocity);
        let turn: [f64; 3] = frame.turn.into();
        let body = |part: String, up: f64| {
            format!(
                "[[body]]\nparts = [{{ {part} }}]\nmass = 1\nthickness = {d}\nat = {:?}
                rotation = {turn:?}\nvelocity = {velocity:?}\n",
                above(up)
            )
        };
        match self {
            Self::Particle => format!(
                "[particles]\npositions = [{:?}]\nvelocities = [{velocity:?}]\nmass = 1\n",
                above(0.0)
            ),
            Self::Ball => body(format!("ball = {}", length(0.1)), 0.1),
            Self::Cube => body(format!("box = {:?}", [length(0.2); 3]), 0.1),
            Self::Cloth => format!(
                "[[cloth]]\ngrid = [4, 4]\nmass = 1\nstiffness = [1, 1, 1]\nwidth = {}
                at = {:?}\nright = {:?}\ndown = {:?}\nvelocity = {velocity:?}\nthickness = {d}\n",
                length(0.3),
                above(0.0),
                frame.direction([0.6, 0.0, 0.8]),
                frame.direction([0.8, 0.0, -0.6])
            ),
        }
    }
}

/// Scene of a body on a ground, without gravity.
fn scene(thing: Thing, ground: Ground, frame: Frame, at: [f64; 3], v: [f64; 3]) -> Scene {
    scene_on(&ground.text(frame), thing, frame, at, v)
}

/// Scene of a body on a ground with this text, without gravity.
fn scene_on(ground: &str, thing: Thing, frame: Frame, at: [f64; 3], v: [f64; 3]) -> Scene {
    let texts = [ground, &thing.text(frame, at, v)].concat();
    let mut scene = build(&("self_collision = true\n".to_owned() + &texts));
    if let Model::Network(network) = &mut scene.model {
        let mut touch = network.touch().unwrap().clone();
        touch.skins.fill(Skin {
            thickness: THICKNESS * frame.unit,
            stiffness: STIFFNESS,
            ..Skin::default()
        });
        network.set_touch(Some(touch)).unwrap();
    }
    scene
}

/// Forces on the last `count` particles, those of the body, in the upright frame, over the
/// stiffness times the thickness of contact.
fn forces(scene: &Scene, count: usize, frame: Frame) -> Vec<Vector3<f64>> {
    let network: &Network = scene.model.network().unwrap();
    let n = network.particles();
    let (x, v) = (&scene.state[..3 * n], &scene.state[3 * n..6 * n]);
    let mut f = vec![0.0; 3 * n];
    network.forces(0.0, x, v, &mut f);
    let row = |i| Vector3::new(f[i], f[n + i], f[2 * n + i]);
    let all = (n - count..n).map(|i| frame.back(row(i)));
    all.map(|f| f / (STIFFNESS * THICKNESS)).collect()
}

/// Place (m) above the inside of the ground, at which bodies of 1 m stay inside.
fn place(random: &mut Random) -> [f64; 3] {
    let [x, _, z]: [f64; 3] = (random.vector() * 1.1).into();
    [x, THICKNESS * (0.05 + 0.9 * random.unit()), z]
}

/// Boxes and meshes repel particles and balls as much as a floor does, wherever they are, upright
/// and rotated, in metres, millimetres and kilometres.
#[test]
fn a_flat_face_repels_as_a_floor() {
    let mut random = Random(11);
    for thing in Thing::ALL {
        for ground in [Ground::Box, Ground::Mesh] {
            let mut most = 0.0_f64;
            for _ in 0..60 {
                let at = place(&mut random);
                let frame = Frame::random(&mut random);
                let on_floor = scene(thing, Ground::Floor, PLAIN, at, [0.0; 3]);
                let count = on_floor.model.network().unwrap().particles();
                let expected = forces(&on_floor, count, PLAIN);
                let found = forces(&scene(thing, ground, frame, at, [0.0; 3]), count, frame);
                for (found, expected) in found.iter().zip(&expected) {
                    most = most.max(expected.norm());
                    let error = (found - expected).norm();
                    assert!(
                        error < 1e-9,
                        "{thing:?} on {ground:?} at {at:?}: {found}, not {expected}"
                    );
                }
            }
            assert!(most > 0.1, "{thing:?} on {ground:?}: {most}");
        }
    }
}

/// Place and velocity of particle i, upright and in metres.
fn particle(run: &Simulation, i: usize, frame: Frame) -> [Vector3<f64>; 2] {
    let n = run.model().network().unwrap().particles();
    let y = run.state();
    [i, 3 * n + i].map(|k| frame.back(Vector3::new(y[k], y[k + n], y[k + 2 * n])))
}

#[test]
fn particles_and_balls_glide_straight_on() {
    let mut random = Random(5);
    for ground in [Ground::Box, Ground::Mesh] {
        for (thing, up) in [(Thing::Particle, 0.0), (Thing::Ball, 0.1)] {
            for frame in [PLAIN, Frame::random(&mut random)] {
                let at = [-1.0, LOW, 0.3 + 0.2 * random.unit()];
                let v = [1.0, 0.0, -0.4];
                let mut scene = scene(thing, ground, frame, at, v);
                if let Model::Network(network) = &mut scene.model {
                    let gravity = Vector3::from(frame.vector([0.0, -9.81, 0.0]));
                    network.set_gravity(gravity);
                }
                let mut run = Simulation::new(scene, method("rk4"), Control::Step(1e-3)).unwrap();
                run.advance_to(2.0).unwrap();
                let [x, moved] = particle(&run, 0, frame);
                let what = format!("{thing:?} on {ground:?}, unit {}", frame.unit);
                assert!(x.y - up < THICKNESS && x.y - up > 0.0, "{what}: {x}");
                let straight = Vector3::from(at) + Vector3::from(v) * 2.0;
                let [aside, faster] = [x - straight, moved - Vector3::from(v)]
                    .map(|d| Vector3::new(d.x, 0.0, d.z).norm());
                assert!(aside < 1e-6 && faster < 1e-6, "{what}: {aside} m, {faster} m/s");
            }
        }
    }
}

/// A particle bounces in the contact layer and glides over the diagonal of a box: the force is
/// smooth all the time.
#[test]
fn the_order_of_rk4_is_kept_over_a_diagonal() {
    let at = [-0.2, LOW, 0.1];
    let mut scene = scene(Thing::Particle, Ground::Box, PLAIN, at, [1.0, 0.0, 0.2]);
    let Model::Network(network) = &mut scene.model else {
        panic!("no network");
    };
    network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
    let until = 0.5;
    let height = |steps: u32| {
        let control = Control::Step(until / f64::from(steps));
        let mut run = Simulation::new(scene.clone(), method("rk4"), control).unwrap();
        run.advance_to(until).unwrap();
        particle(&run, 0, PLAIN)[0].y
    };
    let exact = height(64_000);
    let order = ((height(500) - exact) / (height(2000) - exact)).abs().log2() / 2.0;
    assert!((order - 4.0).abs() < 0.1, "{order}");
}

/// Grounds whose tops at y = 0 consist of two faces that adjoin at x = 0.
const SEAMS: [&str; 4] = [
    "[[box]]\ncenter = [-1, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02
    [[box]]\ncenter = [1, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02\n",
    "[[box]]\ncenter = [-1, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02
    [[box]]\ncenter = [1, -1, 0.2]\nsize = [2, 2, 3]\nthickness = 0.02\n",
    "[[box]]\ncenter = [-1, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02
    [[box]]\ncenter = [1.0001, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02\n",
    "floor = { height = 0, thickness = 0.02 }
    [[box]]\ncenter = [1, -0.5, 0]\nsize = [2, 1, 2]\nthickness = 0.02\n",
];

/// Two flush faces repel a particle and a ball as a floor does, wherever it is: exactly on the
/// seam, beside it, and above a gap of a tenth of a millimetre.
#[test]
fn a_seam_repels_as_a_floor() {
    let force = |ground: &str, thing: Thing, at: [f64; 3]| {
        let scene = scene_on(ground, thing, PLAIN, at, [0.0; 3]);
        let count = scene.model.network().unwrap().particles();
        let all = forces(&scene, count, PLAIN);
        all.iter().sum::<Vector3<f64>>()
    };
    let floor = Ground::Floor.text(PLAIN);
    for (number, ground) in SEAMS.iter().enumerate() {
        for thing in Thing::SINGLE {
            for y in [0.004, 0.01, 0.016] {
                for x in [0.0, 1e-17, -1e-9, 2e-5, -1e-4, 3e-3, -0.02, 0.07] {
                    for z in [0.0, 0.1, 0.5] {
                        let at = [x, y, z];
                        let expected = force(&floor, thing, at);
                        let found = force(ground, thing, at);
                        let error = (found - expected).norm() / expected.norm();
                        // Within the gap, the edges on both sides repel.
                        let is_within = number == 2 && (0.0..1e-4).contains(&x);
                        assert!(
                            is_within || error < 1e-7,
                            "{thing:?} at {at:?} on {number}: {found}, {expected}"
                        );
                    }
                }
            }
        }
    }
}

/// A ball glides straight over a seam of two boxes, and of a floor and a box.
#[test]
fn balls_notice_no_seam() {
    let ball = |at: [f64; 3], v: f64| {
        format!(
            "[[body]]\nparts = [{{ ball = 0.1 }}]\nmass = 1
            at = {at:?}\nvelocity = [{v}, 0, 0]\n"
        )
    };
    for (number, ground) in SEAMS.iter().enumerate() {
        for (name, step) in [("rk4", 1e-3), ("verlet", 2e-3), ("implicit", 4e-3)] {
            let text =
                format!("gravity = [0, -9.81, 0]\n{ground}{}", ball([-0.25, 0.10592, 0.1], 1.0));
            let mut run = Simulation::new(build(&text), method(name), Control::Step(step)).unwrap();
            run.advance_to(0.2).unwrap();
            let (mut least, mut most) = (f64::INFINITY, 0.0_f64);
            for k in 1..=20 {
                run.advance_to(0.2 + 0.005 * f64::from(k)).unwrap();
                let y = run.position(0).y;
                (least, most) = (least.min(y), most.max(y));
            }
            let x = run.position(0).x;
            let what = format!("{name} on {number}: {x}, {least} to {most}");
            assert!(most - least < 1e-4 && (x - 0.05).abs() < 1e-6, "{what}");
        }
    }
}
