//! Single pairs of primitives, as networks, at random places within their thickness.

use a3_core::contact::{Obstacle, Shape, Skin};
use a3_core::{Network, Path, Touch, Vector3};

/// Thickness of all skins (m).
pub const THICKNESS: f64 = 0.1;
/// Stiffness of all skins (N/m).
pub const STIFFNESS: f64 = 50.0;

/// Kind of a pair.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    VertexTriangle,
    EdgeEdge,
    NearlyParallel,
    VertexFloor,
    TriangleSphere,
    EdgeCapsule,
}

impl Kind {
    pub const ALL: [Self; 6] = [
        Self::VertexTriangle,
        Self::EdgeEdge,
        Self::NearlyParallel,
        Self::VertexFloor,
        Self::TriangleSphere,
        Self::EdgeCapsule,
    ];

    /// Whether no obstacle is part of the pair.
    pub fn is_free(self) -> bool {
        matches!(self, Self::VertexTriangle | Self::EdgeEdge | Self::NearlyParallel)
    }

    /// The pair, without any other force.
    pub fn network(self, damping: f64) -> Network {
        let skin = Skin {
            thickness: THICKNESS,
            stiffness: STIFFNESS,
            damping,
            friction: 0.0,
            ..Skin::default()
        };
        let (count, triangles, edges): (_, &[[usize; 3]], &[[u32; 2]]) = match self {
            Self::VertexTriangle => (4, &[[1, 2, 3]], &[[0, 0]]),
            Self::EdgeEdge | Self::NearlyParallel => (4, &[], &[[0, 1], [2, 3]]),
            Self::VertexFloor => (1, &[], &[[0, 0]]),
            Self::TriangleSphere => (3, &[[0, 1, 2]], &[]),
            Self::EdgeCapsule => (2, &[], &[[0, 1]]),
        };
        let mut network = Network::new(vec![0.1; count]).unwrap();
        network.set_triangles(triangles.iter().copied()).unwrap();
        let half = Vector3::new(0.5, 0.1, 0.2);
        let shape = match self {
            Self::VertexFloor => Some(Shape::Floor),
            Self::TriangleSphere => Some(Shape::Sphere { radius: 0.3 }),
            Self::EdgeCapsule => Some(Shape::Capsule { ends: [-half, half], radius: 0.2 }),
            _ => None,
        };
        if let Some(shape) = shape {
            let obstacle = Obstacle {
                thickness: THICKNESS,
                ..Obstacle::smooth(shape, Path::Still(Vector3::zeros()))
            };
            network.add_obstacle(obstacle).unwrap();
        }
        let touch =
            Touch { skins: vec![skin; count], edges: edges.to_vec(), drops: vec![], bodies: true };
        network.set_touch(Some(touch)).unwrap();
        network
    }

    /// Random positions, n x 3, at which the gap of the primitives is a random share of the
    /// thickness.
    pub fn positions(self, random: &mut Random) -> Vec<f64> {
        let gap = Vector3::y() * (THICKNESS * (0.05 + 0.9 * random.unit()));
        let flat =
            |random: &mut Random| random.vector().component_mul(&Vector3::new(1.0, 0.1, 1.0));
        let points = match self {
            Self::VertexTriangle => {
                let corners = [0.0, 2.1, 4.2].map(|turn| {
                    Vector3::new(f64::cos(turn), 0.0, f64::sin(turn)) + 0.3 * flat(random)
                });
                let [s, t] = [random.unit(), random.unit()];
                let (s, t) = if s + t > 1.0 { (1.0 - s, 1.0 - t) } else { (s, t) };
                let [a, b, c] = corners;
                let at = a + (b - a) * s + (c - a) * t;
                vec![at + gap, a, b, c]
            }
            Self::EdgeEdge => {
                let at = 0.3 * flat(random);
                let (a, b) = (Vector3::x() + 0.3 * flat(random), Vector3::z() + 0.3 * flat(random));
                vec![at - a, at + a, at + gap - b, at + gap + b]
            }
            Self::NearlyParallel => {
                let along = Vector3::x() + 0.3 * flat(random);
                let other =
                    along + 0.2 * random.vector().component_mul(&Vector3::new(1.0, 0.0, 1.0));
                let at = 0.3 * flat(random);
                vec![-along, along, at + gap - other, at + gap + other]
            }
            Self::VertexFloor => {
                vec![random.vector().component_mul(&Vector3::new(1.0, 0.0, 1.0)) + gap]
            }
            Self::TriangleSphere => {
                let below = Vector3::y() * 0.3 + gap;
                let corners = [0.0, 2.1, 4.2];
                let corner = |turn| {
                    Vector3::new(f64::cos(turn), 0.0, f64::sin(turn))
                        + 0.2 * random.vector()
                        + below
                };
                corners.map(corner).to_vec()
            }
            Self::EdgeCapsule => {
                let above = Vector3::y() * 0.2 + gap;
                let along = Vector3::z() + 0.3 * flat(random);
                vec![above - along, above + along]
            }
        };
        (0..3).flat_map(|axis| points.iter().map(move |p| p[axis]).collect::<Vec<_>>()).collect()
    }
}

/// Repeatable random numbers.
pub struct Random(pub u64);

impl Random {
    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        self.0 =
            self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// A vector of numbers from -1 to 1.
    pub fn vector(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| 2.0 * self.unit() - 1.0)
    }

    /// `count` numbers from -1 to 1.
    pub fn numbers(&mut self, count: usize) -> Vec<f64> {
        (0..count).map(|_| 2.0 * self.unit() - 1.0).collect()
    }
}
