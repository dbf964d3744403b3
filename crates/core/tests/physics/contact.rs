//! Contact with obstacles: nearest points of surfaces, and velocities after contact.

use a3_core::contact::{ClosedMesh, Obstacle, Shape, Step, resolve};
use a3_core::{Mechanics, Network, Path, Vector3};
use approx::assert_relative_eq;
use nalgebra::Rotation3;

const CENTER: Vector3<f64> = Vector3::new(0.3, -0.2, 0.5);
const HALVES: Vector3<f64> = Vector3::new(1.0, 0.6, 0.8);
const TURN: Vector3<f64> = Vector3::new(0.4, -1.1, 0.7);
const ENDS: [Vector3<f64>; 2] = [Vector3::new(-1.0, 0.2, 0.1), Vector3::new(0.7, -0.3, 0.9)];
const RADIUS: f64 = 0.4;
const CAPSULE: Shape = Shape::Capsule { ends: ENDS, radius: RADIUS };

fn with_box(path: Path) -> Network {
    let mut network = Network::new(vec![1.0]).unwrap();
    let shape = Shape::turned_box(HALVES, TURN).unwrap();
    network.add_obstacle(Obstacle::smooth(shape, path)).unwrap();
    network
}

fn with_capsule(path: Path) -> Network {
    let mut network = Network::new(vec![1.0]).unwrap();
    network.add_obstacle(Obstacle::smooth(CAPSULE, path)).unwrap();
    network
}

/// Position (m) and velocity (m/s) of a particle after contact at time t (s).
fn resolved(network: &Network, t: f64, x: Vector3<f64>, v: Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut y = [x.x, x.y, x.z, v.x, v.y, v.z];
    let (y0, h) = (y, 0.01);
    let (t, y0) = (t - h, &y0);
    resolve(network.obstacles(), network.inverse_masses(), &Step { t, h, y0 }, &mut y);
    [Vector3::from_column_slice(&y[..3]), Vector3::from_column_slice(&y[3..])]
}

/// Points of a grid inside and around an obstacle at the centre.
fn points() -> impl Iterator<Item = Vector3<f64>> {
    (0..13 * 13 * 13).map(|k| {
        let step = |k: i32| f64::from(k % 13 - 6) * 0.237;
        CENTER + Vector3::new(step(k), step(k / 13), step(k / 169))
    })
}

/// The turned box agrees with a computation by nalgebra's rotation.
#[test]
fn a_particle_in_a_box_is_put_on_the_nearest_face_and_one_outside_stays() {
    let network = with_box(Path::Still(CENTER));
    let turn = Rotation3::from_scaled_axis(TURN);
    let mut inside = 0;
    for p in points() {
        let [x, _] = resolved(&network, 0.0, p, Vector3::zeros());
        let local = turn.inverse() * (p - CENTER);
        let gaps = HALVES - local.abs();
        if gaps.min() < 0.0 {
            assert_eq!(x, p);
            continue;
        }
        inside += 1;
        let axis = gaps.imin();
        let mut expected = local;
        expected[axis] = HALVES[axis].copysign(local[axis]);
        assert_relative_eq!(x, CENTER + turn * expected, epsilon = 1e-14);
    }
    assert!(inside > 200);
}

#[test]
fn corners_and_edges_of_a_turned_box_are_sharp() {
    let network = with_box(Path::Still(CENTER));
    let turn = Rotation3::from_scaled_axis(TURN);
    let mut seen = 0;
    for k in 0..27 {
        let signs = Vector3::new(k % 3, k / 3 % 3, k / 9).map(|s| f64::from(s - 1));
        if signs.abs().sum() < 2.0 {
            continue;
        }
        seen += 1;
        let at = |scale: f64| CENTER + turn * (HALVES.component_mul(&signs) * scale);
        let [outside, _] = resolved(&network, 0.0, at(1.0 + 1e-12), Vector3::zeros());
        assert_eq!(outside, at(1.0 + 1e-12));
        let [x, _] = resolved(&network, 0.0, at(0.99), Vector3::zeros());
        // Least distance of the particle from one of the faces (m).
        let thinnest = (0..3)
            .filter(|axis| signs[*axis] != 0.0)
            .map(|axis| 0.01 * HALVES[axis])
            .fold(f64::INFINITY, f64::min);
        assert_relative_eq!((x - at(0.99)).norm(), thinnest, epsilon = 1e-14);
    }
    assert_eq!(seen, 12 + 8);
}

#[test]
fn a_particle_in_a_capsule_is_put_on_the_nearest_point_and_one_outside_stays() {
    let network = with_capsule(Path::Still(CENTER));
    // Nearest point of the segment, by search among many.
    let distance = |p: Vector3<f64>| {
        let at = |s: f64| (p - CENTER - ENDS[0].lerp(&ENDS[1], s)).norm();
        let s = (0..=1000).map(|k| f64::from(k) / 1000.0);
        let near = s.min_by(|a, b| at(*a).total_cmp(&at(*b))).unwrap();
        let finer = (-1000..=1000).map(|k| (near + f64::from(k) * 1e-6).clamp(0.0, 1.0));
        finer.map(at).fold(f64::INFINITY, f64::min)
    };
    let (mut inside, mut beyond) = (0, 0);
    for p in points() {
        let [x, _] = resolved(&network, 0.0, p, Vector3::zeros());
        let d = distance(p);
        if d >= RADIUS {
            assert_eq!(x, p);
            continue;
        }
        inside += 1;
        assert_relative_eq!(distance(x), RADIUS, epsilon = 1e-10);
        assert_relative_eq!((x - p).norm(), RADIUS - d, epsilon = 1e-10);
        let along = (p - CENTER - ENDS[0]).dot(&(ENDS[1] - ENDS[0]));
        beyond += usize::from(along < 0.0);
    }
    assert!(inside > 50 && beyond > 2, "{inside} {beyond}");
}

/// Contact with an obstacle that moves at (2, -1, 0.5) m/s removes only the inward normal part of
/// the relative velocity.
#[test]
fn contact_takes_the_inward_part_of_the_relative_velocity_and_nothing_else() {
    let velocity = Vector3::new(2.0, -1.0, 0.5);
    let path = Path::Line { from: CENTER - velocity, to: CENTER + velocity, start: 0.0, end: 2.0 };
    let mut hit = 0;
    for (k, p) in points().enumerate() {
        for network in [with_box(path), with_capsule(path)] {
            for sign in [1.0, -1.0] {
                let k = k as f64;
                let v = sign * Vector3::new(k.sin(), (1.7 * k).cos(), (2.3 * k).sin());
                let [x, after] = resolved(&network, 1.0, p, velocity + v);
                let normal = x - p;
                // For a particle on the surface, the direction of the displacement is a rounding
                // error.
                if normal.norm() < 1e-6 {
                    assert!(normal.norm() > 0.0 || after == velocity + v);
                    continue;
                }
                hit += 1;
                let normal = normal.normalize();
                let expected = velocity + v - normal * v.dot(&normal).min(0.0);
                assert_relative_eq!(after, expected, epsilon = 1e-9);
            }
        }
    }
    assert!(hit > 500);
}

#[test]
fn what_has_no_nearest_point_is_put_somewhere_all_the_same() {
    let turn = Rotation3::from_scaled_axis(TURN);
    let [x, v] = resolved(&with_box(Path::Still(CENTER)), 0.0, CENTER, Vector3::new(1.0, 2.0, 3.0));
    // The nearest faces are those perpendicular to the second edge.
    assert_relative_eq!(x, CENTER + turn * Vector3::y() * HALVES.y, epsilon = 1e-14);
    assert!(v.iter().all(|v| v.is_finite()));
    let still = Path::Still(Vector3::zeros());
    for (ends, expected) in [
        ([-Vector3::x(), Vector3::x()], Vector3::y()),
        ([-Vector3::y(), Vector3::y()], Vector3::x()),
        (
            [Vector3::new(-1.0, -1.0, 0.0), Vector3::new(1.0, 1.0, 0.0)],
            Vector3::new(-1.0, 1.0, 0.0).normalize(),
        ),
        ([Vector3::zeros(); 2], Vector3::y()),
    ] {
        let mut network = Network::new(vec![1.0]).unwrap();
        let radius = RADIUS;
        let shape = Shape::Capsule { ends, radius };
        network.add_obstacle(Obstacle::smooth(shape, still)).unwrap();
        let [x, v] = resolved(&network, 0.0, Vector3::zeros(), -expected);
        assert_relative_eq!(x, RADIUS * expected, epsilon = 1e-15);
        assert_relative_eq!(v, Vector3::zeros(), epsilon = 1e-15);
    }
}

#[test]
fn obstacles_without_a_size_are_refused() {
    let path = Path::Still(CENTER);
    for wrong in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert!(Shape::turned_box(Vector3::new(1.0, wrong, 1.0), TURN).is_err());
        for shape in [Shape::Sphere { radius: wrong }, Shape::Capsule { ends: ENDS, radius: wrong }]
        {
            let mut network = Network::new(vec![1.0]).unwrap();
            let obstacle = Obstacle::smooth(shape.clone(), path);
            assert!(network.add_obstacle(obstacle).is_err());
            network.add_obstacle(Obstacle::smooth(Shape::Floor, path)).unwrap();
            assert!(network.reshape_obstacle(0, shape).is_err());
            assert_eq!(network.obstacles()[0].shape, Shape::Floor);
        }
    }
    let nowhere = Vector3::new(0.0, f64::NAN, 0.0);
    let error = Shape::turned_box(HALVES, nowhere).unwrap_err().to_string();
    assert_eq!(error, "the turn of a box must be three finite numbers, not 0, NaN, 0");
    for friction in [-0.1, f64::NAN, f64::INFINITY] {
        let obstacle = Obstacle { friction, ..Obstacle::smooth(CAPSULE, path) };
        let mut network = Network::new(vec![1.0]).unwrap();
        let error = network.add_obstacle(obstacle).unwrap_err().to_string();
        assert!(error.starts_with("the friction of an obstacle must be"));
    }
}

#[test]
fn a_network_names_the_obstacles_it_pays_for() {
    let mut network = with_box(Path::Still(CENTER));
    assert_eq!(network.forces_in_use(), ["box"]);
    let capsule = Obstacle::smooth(CAPSULE, Path::Still(CENTER));
    network.add_obstacle(capsule.clone()).unwrap();
    assert_eq!(network.forces_in_use(), ["box", "capsule"]);
    assert_eq!(network.obstacles()[1], capsule);
    network.remove_obstacle(0).unwrap();
    assert_eq!(network.forces_in_use(), ["capsule"]);
    assert!(network.remove_obstacle(1).is_err());
}

/// The triangles of a box enclose its volume, in the outward orientation for either handedness of
/// its axes; its edges have its dimensions.
#[test]
fn a_box_has_the_triangles_and_edges_of_its_surface() {
    let Shape::Box { axes, .. } = Shape::turned_box(HALVES, TURN).unwrap() else {
        panic!("not a box");
    };
    let [x, y, z] = axes;
    for axes in [[x, y, z], [x, y, -z]] {
        let half_extents = HALVES;
        let found = Shape::Box { half_extents, axes }.simplices();
        let corner = |i: u32| found.points[i as usize];
        let volumes = found.triangles.iter().map(|t| {
            let [a, b, c] = t.map(corner);
            a.cross(&b).dot(&c) / 6.0
        });
        assert!(volumes.clone().all(|volume| volume > 0.0));
        assert!((volumes.sum::<f64>() - 8.0 * HALVES.product()).abs() < 1e-14);
        let lengths = found.edges.iter().map(|e| (corner(e[1]) - corner(e[0])).norm());
        assert!((lengths.sum::<f64>() - 8.0 * HALVES.sum()).abs() < 1e-14);
        assert_eq!((found.triangles.len(), found.radius), (12, 0.0));
        let closed = ClosedMesh::new(found.points, found.triangles).unwrap();
        let own = |edge: &[u32; 2]| closed.edges().contains(edge);
        assert!(found.edges.iter().all(own));
    }
}
