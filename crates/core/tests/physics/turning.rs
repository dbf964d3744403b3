//! Turning pins and obstacles: derivatives of their paths, and particles that friction carries
//! round.

use crate::common::method;
use a3_core::contact::{ClosedMesh, Obstacle, Shape, Step, resolve};
use a3_core::{Control, Model, Network, Path, Scene, Simulation, Turn, Vector3};

const G: f64 = 9.81;

/// Turn about y from the beginning.
fn about_y(rate: f64) -> Turn {
    Turn { axis: Vector3::y(), rate, start: 0.0, end: None }
}

/// A pin on a helix about x: 270 degrees between 0.5 s and 2 s, while the axis moves along itself.
#[test]
fn a_turning_pin_has_the_velocity_and_acceleration_of_its_position() {
    let quarter = std::f64::consts::FRAC_PI_2;
    let arm = Vector3::new(0.3, 0.5, 0.0);
    let path = Path::Turn {
        turn: Turn { axis: Vector3::x(), rate: 2.0 * quarter, start: 0.5, end: Some(2.0) },
        arm,
        from: Vector3::new(1.0, 2.0, 3.0),
        to: Vector3::new(2.0, 2.0, 3.0),
        start: 0.0,
        end: 1.0,
    };
    let at = |t: f64| path.at(t);
    assert_eq!(at(0.0).position, Vector3::new(1.3, 2.5, 3.0));
    // y turns to z, to -y, and to -z.
    let turned = Vector3::new(2.3, 2.0, 2.5);
    for t in [2.0, 7.0] {
        assert!((at(t).position - turned).norm() < 1e-15, "{}", at(t).position);
        assert_eq!(at(t).velocity, Vector3::zeros());
    }
    let h = 1e-5;
    for t in [0.2, 0.7, 1.3, 1.9, 2.5] {
        let slope = (at(t + h).position - at(t - h).position) / (2.0 * h);
        assert!((slope - at(t).velocity).norm() < 1e-9, "{t}");
        let slope = (at(t + h).velocity - at(t - h).velocity) / (2.0 * h);
        assert!((slope - at(t).acceleration).norm() < 1e-8, "{t}");
    }
    assert!(at(1.3).acceleration.norm() > 1.0);
}

fn run(obstacle: Obstacle, x: Vector3<f64>, v: Vector3<f64>) -> Simulation {
    let mut network = Network::new(vec![0.3]).unwrap();
    network.add_obstacle(obstacle).unwrap();
    network.set_gravity(Vector3::new(0.0, -G, 0.0));
    let state = [x.as_slice(), v.as_slice()].concat();
    let scene = Scene::new("particle", Model::Network(Box::new(network)), state);
    Simulation::new(scene, method("rk4"), Control::Step(0.005)).unwrap()
}

/// On a turntable a particle stays where it lies while mu g exceeds w^2 r, and is thrown off
/// otherwise. A mesh of the same shape does the same.
#[test]
fn a_turntable_carries_a_particle_round() {
    let (rate, start) = (1.5, Vector3::new(0.6, 0.5, 0.2));
    let table = Shape::turned_box(Vector3::new(1.5, 0.5, 1.5), Vector3::zeros()).unwrap();
    let simplices = table.simplices();
    let mesh = ClosedMesh::new(simplices.points, simplices.triangles).unwrap();
    for shape in [table, Shape::Mesh(mesh.into())] {
        let table = |friction| Obstacle {
            turn: Some(about_y(rate)),
            friction,
            ..Obstacle::smooth(shape.clone(), Path::Still(Vector3::zeros()))
        };
        let v = Vector3::y().cross(&start) * rate;
        let mut held = run(table(0.5), start, v);
        held.take_steps(600).unwrap();
        let there = table(0.5).at(3.0).of(start);
        let error = (held.position(0) - there.position).norm();
        assert!(error < 1e-11, "{} {error:e}", shape.name());
        let velocity = Vector3::from_column_slice(&held.velocities());
        assert!((velocity - there.velocity).norm() < 1e-11);
        // w^2 r / g is 0.145.
        let mut thrown = run(table(0.1), start, v);
        thrown.take_steps(100).unwrap();
        let radius = |x: Vector3<f64>| x.xz().norm();
        assert!(radius(thrown.position(0)) > radius(start) + 0.01);
    }
}

/// A ball that turns under a particle accelerates it by mu g.
#[test]
fn a_turning_ball_drags_a_particle() {
    let ball = Obstacle {
        turn: Some(Turn { axis: Vector3::z(), ..about_y(3.0) }),
        friction: 0.3,
        ..Obstacle::smooth(Shape::Sphere { radius: 1.0 }, Path::Still(Vector3::new(0.0, -1.0, 0.0)))
    };
    let mut run = run(ball, Vector3::zeros(), Vector3::zeros());
    run.take_steps(10).unwrap();
    let found = run.velocities()[0] / run.time();
    assert!((found / (-0.3 * G) - 1.0).abs() < 0.005, "{found}");
}

/// A smooth turning box pushes a particle as fast as the point of its side moves along the normal.
#[test]
fn the_side_of_a_turning_box_pushes() {
    let shape = Shape::turned_box(Vector3::new(1.0, 1.0, 1.0), Vector3::zeros()).unwrap();
    let obstacle = Obstacle {
        turn: Some(about_y(2.0)),
        ..Obstacle::smooth(shape, Path::Still(Vector3::zeros()))
    };
    let (t, h) = (0.4, 0.01);
    let after = obstacle.at(t + h);
    let inside = after.of(Vector3::new(0.99, 0.0, 0.5)).position;
    let mut y = [inside.x, inside.y, inside.z, 0.0, 0.0, 0.0];
    resolve(&[obstacle], &[1.0], &Step { t, h, y0: &[] }, &mut y);
    let surface = after.of(Vector3::new(1.0, 0.0, 0.5)).position;
    let normal = after.outwards(Vector3::x());
    assert!((Vector3::from_column_slice(&y[..3]) - surface).norm() < 1e-14);
    assert!((Vector3::from_column_slice(&y[3..]) - normal).norm() < 1e-14);
}
