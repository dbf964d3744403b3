//! Turning pins and obstacles in runs: in descriptions, in checkpoints and in the hand.

use a3_core::{Control, Network, Place, Scene, Simulation, Vector3};
use a3_scenes::{Description, Mesh, snapshot};

use crate::common::method;

fn start(scene: Scene, name: &str) -> Simulation {
    Simulation::new(scene, method(name), Control::Step(0.01)).unwrap()
}

fn network(run: &Simulation) -> &Network {
    run.model().network().unwrap()
}

/// Turning pins and obstacles continue in a description, before, during and after their rotations.
#[test]
fn turns_go_on_from_where_they_are() {
    let text = "\
pin = [{ particles = [0, 1], shift = { by = [0.5, 0, 0], end = 1.2 },
    turn = { about = [0, 1, 0], axis = [2, 0, 0], angle = 4.7, start = 0.5, end = 2 } }]
particles = { positions = [[1, 2, 3], [0, 0, 1]], mass = 1 }
sphere = [{ center = [3, 0, 0], radius = 0.5, shift = { by = [0, 1, 0], end = 4 },
    turn = { axis = [0, 1, 0], about = [0, 1, 0], rate = 1, end = 3 } }]
box = [{ center = [0, -5, 0], size = [1, 2, 3], rotation = [0.1, 0.2, 0.3], sine = { amplitude = [1, 0, 0], rate = 2 },
    turn = { axis = [0, 1, 1], rate = 2, start = 0.7 } }]
capsule = [{ from = [0, -9, 0], to = [1, -9, 0], radius = 0.1, turn = { axis = [0, 0, 1], rate = -1, end = 1 } }]
obstacle = [{ file = 'solid', scale = 2, at = [0, 9, 0], rotation = [0.5, 0, 0], turn = { axis = [1, 2, 3], rate = 1 } }]
";
    let mut solid = |_: &str| {
        let (x, y) = ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]);
        Ok(Mesh {
            positions: vec![[0.0; 3], x, y, [0.0, 0.0, 1.0]],
            triangles: vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]],
            ..Mesh::default()
        })
    };
    let mut build = |text: &str| {
        let description = Description::parse(text).unwrap();
        let scene = description.build(None, &mut solid).unwrap().scene;
        start(scene, "rk4")
    };
    for time in [0.2, 1.0, 1.5, 2.5] {
        let mut run = build(text);
        run.advance_to(time).unwrap();
        let mut now = Description::parse(text).unwrap();
        snapshot::begin_with(&mut now, run.model(), &run.moment());
        let again = build(&now.to_toml().unwrap());
        for later in [0.0, 0.3, 0.9, 3.0] {
            let places = |run: &Simulation, t: f64| -> Vec<Place> {
                let pins = network(run).pins().map(|(_, path)| path.at(t));
                let obstacles = network(run).obstacles().iter();
                let points = obstacles.flat_map(|obstacle| {
                    let pose = obstacle.at(t);
                    let points = obstacle.shape.simplices().points.into_iter();
                    points.map(move |point| pose.of(point))
                });
                pins.chain(points).collect()
            };
            let (then, now) = (places(&run, run.time() + later), places(&again, later));
            assert_eq!((then.len(), now.len()), (17, 17));
            for (a, b) in then.iter().zip(&now) {
                let far = (a.position - b.position).norm() + (a.velocity - b.velocity).norm();
                assert!(far < 1e-12, "{time} + {later}: {a:?} {b:?}");
            }
        }
    }
}

/// A ball in the hand continues to turn, and a checkpoint with turning pins can be written and
/// read.
#[test]
fn what_turns_does_so_in_the_hand_and_after_a_checkpoint() {
    let text = "\
particles = { positions = [[0, 1, 0], [0, 2, 0]], mass = 1, springs = [[0, 1, 10, 1, 0.1]],
    pin = [{ particles = [0], turn = { about = [1, 1, 0], axis = [0, 0, 1], rate = 2 } }] }
sphere = [{ center = [3, 0, 0], radius = 0.5, turn = { axis = [0, 1, 0], about = [0, 0, 0], rate = 1 } }]
";
    let description = Description::parse(text).unwrap();
    let scene = description.build(None, &mut |_| Err(String::new())).unwrap().scene;
    let mut run = start(scene.clone(), "rk4");
    run.advance_to(0.5).unwrap();
    let ball = |run: &Simulation| network(run).obstacles()[0].at(run.time());
    let before = ball(&run);
    let written = serde_json::to_string(&run.checkpoint()).unwrap();
    let mut other = start(scene, "verlet");
    other.restore(&serde_json::from_str(&written).unwrap()).unwrap();
    run.advance_to(1.0).unwrap();
    other.advance_to(1.0).unwrap();
    assert_eq!(run.state(), other.state());
    assert_eq!(ball(&run), ball(&other));
    run.grab_obstacle(0).unwrap();
    let held = ball(&run);
    assert_eq!(held.place.velocity, Vector3::zeros());
    assert_eq!(held.orientation, ball(&other).orientation);
    run.advance_to(1.5).unwrap();
    assert_eq!(ball(&run).place, held.place);
    assert_ne!(ball(&run).orientation, held.orientation);
    assert_ne!(before.orientation, held.orientation);
}
