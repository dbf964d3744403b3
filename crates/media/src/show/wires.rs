//! Constraints as lines: rods, ropes, the wires that particles slide on, and the axes of joints.

use a3_core::constraints::{Joint, JointKind};
use a3_core::{Constraint, Network, Pose, Vector3};
use a3_render::Line;

use super::vectors::{perpendicular, to_f32};

/// Number of straight pieces of a circle.
const PIECES: usize = 96;
/// Number of straight pieces of a rope that hangs slack.
const ROPE_PIECES: usize = 32;
/// Length of a straight wire to either side of its point, in units of length of the scene.
const HALF_LENGTH: f64 = 20.0;

/// Length of the pin of a hinge to either side, and of the rail of a slider, over the size of its
/// body; and radius of a ball joint.
const PIN: f64 = 0.25;
const RAIL: f64 = 0.8;
const BALL: f64 = 0.06;

/// Returns lines for the constraints of a network. `at` gives the positions of particles (m), and
/// `pose` the place and orientation of body k; `unit` is the unit of length of the scene (m).
pub fn lines(
    network: &Network,
    at: impl Fn(usize) -> [f32; 3],
    pose: impl Fn(usize) -> Pose,
    unit: f64,
    color: [f32; 4],
) -> impl Iterator<Item = Line> {
    let faint = [color[0], color[1], color[2], 0.45];
    network.constraints().iter().flat_map(move |constraint| match *constraint {
        Constraint::Rod { i, j, .. } => {
            vec![Line::new(at(i), at(j), 4.0, color).with_shadow()]
        }
        Constraint::Rope { i, j, length, .. } => {
            let down = network.gravity().unwrap_or_else(|| -Vector3::y());
            rope([at(i), at(j)], length as f32, down.normalize(), color)
        }
        Constraint::Line { point, direction, .. } => {
            let way = direction * (HALF_LENGTH * unit);
            let ends = [point - way, point + way];
            let [a, b] = ends.map(to_f32);
            vec![Line::new(a, b, 1.6, faint)]
        }
        Constraint::Circle { center, normal, radius, .. } => circle(center, normal, radius, faint),
        Constraint::Sphere { center, radius, .. } => {
            let normals = [Vector3::x(), Vector3::y(), Vector3::z()];
            let circles = normals.map(|normal| circle(center, normal, radius, faint));
            circles.concat()
        }
        Constraint::Joint(joint) => {
            let body = network.body_of(joint.first);
            body.map_or_else(Vec::new, |k| pin(&joint, &pose(k), color))
        }
        Constraint::Point { .. } | Constraint::Stop(_) => vec![],
    })
}

/// Returns the lines of a joint whose first body has this pose: its axis, or a ball.
fn pin(joint: &Joint, pose: &Pose, color: [f32; 4]) -> Vec<Line> {
    let place = pose.of(joint.anchors[0]).position;
    let axes = [0, 1, 2].map(|k| pose.outwards(joint.axes[0].column(k).into_owned()));
    let along = |share: f64, width: f32| {
        let way = axes[0] * (share * joint.length);
        vec![Line::new(to_f32(place - way), to_f32(place + way), width, color).with_shadow()]
    };
    match joint.kind {
        JointKind::Ball => {
            let circles = axes.map(|normal| circle(place, normal, BALL * joint.length, color));
            circles.concat()
        }
        JointKind::Hinge => along(PIN, 6.0),
        JointKind::Slider => along(RAIL, 2.4),
        JointKind::Fixed => vec![],
    }
}

/// Returns the lines of a rope of a length (m) between two points. It hangs in a parabola, whose
/// sag is exact for a rope that is almost straight and for one whose ends meet.
fn rope(ends: [[f32; 3]; 2], length: f32, down: Vector3<f64>, color: [f32; 4]) -> Vec<Line> {
    let [a, b] = ends.map(Vector3::from);
    let distance = (b - a).norm();
    let slack = (length - distance).max(0.0);
    let line = |a: Vector3<f32>, b: Vector3<f32>| Line::new(a.into(), b.into(), 2.4, color);
    if slack <= 1e-3 * length {
        return vec![line(a, b).with_shadow()];
    }
    let sag = (0.375 * distance * slack + 0.25 * slack * slack).sqrt();
    let place = |k: usize| {
        let u = k as f32 / ROPE_PIECES as f32;
        a + (b - a) * u + down.cast::<f32>() * (4.0 * sag * u * (1.0 - u))
    };
    (0..ROPE_PIECES).map(|k| line(place(k), place(k + 1)).with_shadow()).collect()
}

/// Returns the lines of a circle.
fn circle(center: Vector3<f64>, normal: Vector3<f64>, radius: f64, color: [f32; 4]) -> Vec<Line> {
    let side = perpendicular(normal);
    let other = normal.cross(&side);
    let place = |k: usize| {
        let (sin, cos) = (std::f64::consts::TAU * k as f64 / PIECES as f64).sin_cos();
        to_f32(center + (side * cos + other * sin) * radius)
    };
    (0..PIECES).map(|k| Line::new(place(k), place(k + 1), 1.6, color)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn still(_: usize) -> Pose {
        Pose { place: a3_core::Path::Still(Vector3::new(1.0, 2.0, 3.0)).at(0.0), orientation: None }
    }

    #[test]
    fn a_hinge_has_a_pin_along_its_axis() {
        let (own, at) = (still(0), Vector3::new(1.5, 2.0, 3.0));
        let joint = Joint::new(JointKind::Hinge, ((0, &own), None), (at, Vector3::y()), 2.0);
        let lines = pin(&joint.unwrap(), &own, [0.0; 4]);
        assert_eq!((lines[0].from, lines[0].to), ([1.5, 1.5, 3.0], [1.5, 2.5, 3.0]));
    }

    #[test]
    fn a_rope_keeps_about_its_length_where_it_hangs() {
        let mut network = Network::new(vec![1.0; 2]).unwrap();
        let rope = Constraint::Rope { i: 0, j: 1, length: 1.2, restitution: 0.0 };
        network.add_constraint(rope).unwrap();
        for (distance, error) in [(1.1, 0.01), (1e-4, 1e-3), (0.6, 0.15), (1.2, 1e-6)] {
            let at = |i: usize| [i as f32 * distance, 0.0, 0.0];
            let lines = lines(&network, at, still, 1.0, [0.0; 4]);
            let of_line = |line: Line| (Vector3::from(line.to) - Vector3::from(line.from)).norm();
            let length: f32 = lines.map(of_line).sum();
            assert!((length - 1.2).abs() < error, "{distance}: {length}");
        }
    }

    #[test]
    fn rods_join_their_particles_and_wires_lie_where_they_are() {
        let mut network = Network::new(vec![1.0; 2]).unwrap();
        let rod = Constraint::Rod { i: 0, j: 1, length: 1.0 };
        let (center, normal, radius) = (Vector3::new(1.0, 2.0, 3.0), Vector3::z(), 0.5);
        let circle = Constraint::Circle { particle: 0, center, normal, radius };
        for constraint in [rod, circle] {
            network.add_constraint(constraint).unwrap();
        }
        let at = |i: usize| [i as f32, 0.0, 0.0];
        let lines: Vec<_> = lines(&network, at, still, 1.0, [0.0; 4]).collect();
        assert_eq!((lines[0].from, lines[0].to), (at(0), at(1)));
        assert_eq!(lines.len(), 1 + PIECES);
        for line in &lines[1..] {
            let [x, y, z] = line.from;
            assert!(((x - 1.0).hypot(y - 2.0) - 0.5).abs() < 1e-6 && (z - 3.0).abs() < 1e-6);
        }
    }
}
