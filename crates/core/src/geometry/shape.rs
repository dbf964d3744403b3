//! Shapes of obstacles.

use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

use nalgebra::{Matrix3, Vector3};

use super::closed_mesh::ClosedMesh;
use crate::error::{Error, finite, positive};
use crate::path::rotation;

/// Shape of an obstacle.
#[derive(Clone, Debug, PartialEq)]
pub enum Shape {
    /// All points within a radius of the place.
    Sphere {
        /// Radius (m).
        radius: f64,
    },
    /// Box around the place.
    Box {
        /// Half the length along each of the axes (m).
        half_extents: Vector3<f64>,
        /// Directions of the edges: perpendicular unit vectors.
        axes: [Vector3<f64>; 3],
    },
    /// All points within a radius of a line segment.
    Capsule {
        /// Ends of the segment, relative to the place (m).
        ends: [Vector3<f64>; 2],
        /// Radius (m).
        radius: f64,
    },
    /// All points that a closed surface of triangles encloses.
    Mesh(Arc<ClosedMesh>),
    /// All points below the place.
    Floor,
}

/// All points within a radius of points, edges and triangles, in the obstacle's own frame before it
/// turned.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Simplices {
    /// Points (m).
    pub points: Vec<Vector3<f64>>,
    /// Ends of the edges, as numbers of points.
    pub edges: Vec<[u32; 2]>,
    /// Corners of the triangles, as numbers of points, anticlockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// Radius (m).
    pub radius: f64,
}

/// Flat faces that consist of several triangles, by numbers of points.
#[derive(Clone, Debug, Default)]
pub(crate) struct FlatFaces {
    /// Edges between two triangles of a face, the lower end first.
    pub edges: BTreeSet<[u32; 2]>,
    /// Points inside a face.
    pub inside: BTreeSet<u32>,
    /// Triangles with those others of the same face that share a corner with them.
    pub beside: BTreeMap<[u32; 3], Vec<[u32; 3]>>,
}

impl FlatFaces {
    /// Adds faces whose points are numbered from `first`.
    pub fn add(&mut self, faces: &Self, first: u32) {
        self.edges.extend(faces.edges.iter().map(|ends| ends.map(|i| first + i)));
        self.inside.extend(faces.inside.iter().map(|i| first + i));
        let of = |corners: &[u32; 3]| corners.map(|i| first + i);
        let beside = faces.beside.iter();
        self.beside.extend(beside.map(|(own, all)| (of(own), all.iter().map(of).collect())));
    }
}

/// Sine of the angle between two triangles up to which they count as coplanar.
const COPLANAR_SINE: f64 = 1e-9;

impl Simplices {
    /// Finds the flat faces that consist of several triangles.
    pub(crate) fn flat_faces(&self) -> FlatFaces {
        let normals: Vec<_> = (self.triangles.iter())
            .map(|corners| {
                let [p, q, r] = corners.map(|i| self.points[i as usize]);
                (q - p).cross(&(r - p)).normalize()
            })
            .collect();
        let mut around = vec![vec![]; self.points.len()];
        for (k, corners) in self.triangles.iter().enumerate() {
            for i in corners {
                around[*i as usize].push(k);
            }
        }
        let is_coplanar = |k: usize, l: usize| {
            normals[k].cross(&normals[l]).norm() < COPLANAR_SINE
                && normals[k].dot(&normals[l]) > 0.0
        };
        let mut faces = FlatFaces::default();
        for (k, own) in self.triangles.iter().enumerate() {
            let near = own.iter().flat_map(|i| &around[*i as usize]);
            let beside: BTreeSet<_> =
                near.copied().filter(|l| *l != k && is_coplanar(k, *l)).collect();
            for l in &beside {
                let mut common = own.iter().filter(|i| self.triangles[*l].contains(i));
                if let (Some(i), Some(j)) = (common.next(), common.next()) {
                    faces.edges.insert([*i.min(j), *i.max(j)]);
                }
            }
            if !beside.is_empty() {
                faces.beside.insert(*own, beside.iter().map(|l| self.triangles[*l]).collect());
            }
        }
        let inside = (0..around.len()).filter(|i| {
            let sides = around[*i].iter().flat_map(|k| self.triangles[*k]);
            let mut edges = sides.filter(|j| *j as usize != *i).map(|j| {
                let i = *i as u32;
                [i.min(j), i.max(j)]
            });
            !around[*i].is_empty() && edges.all(|edge| faces.edges.contains(&edge))
        });
        faces.inside = inside.map(|i| i as u32).collect();
        faces
    }
}

impl Shape {
    /// Creates a box rotated from the upright about the vector `turn` by its length (rad).
    ///
    /// # Errors
    /// A half extent is not above 0, or a number is not finite.
    pub fn turned_box(half_extents: Vector3<f64>, turn: Vector3<f64>) -> Result<Self, Error> {
        finite("the turn of a box", turn)?;
        let rotation = rotation(turn);
        let axes = [0, 1, 2].map(|k| rotation.column(k).into_owned());
        let shape = Self::Box { half_extents, axes };
        shape.check()?;
        Ok(shape)
    }

    /// Returns the shape rotated by a matrix about its place.
    ///
    /// # Errors
    /// Rounding reduces the volume of a mesh to zero.
    pub fn turned(&self, by: &Matrix3<f64>) -> Result<Self, Error> {
        Ok(match self {
            Self::Box { half_extents, axes } => {
                Self::Box { half_extents: *half_extents, axes: axes.map(|axis| by * axis) }
            }
            Self::Capsule { ends, radius } => {
                Self::Capsule { ends: ends.map(|end| by * end), radius: *radius }
            }
            Self::Mesh(mesh) => {
                let points = mesh.points().iter().map(|point| by * point);
                let turned = ClosedMesh::new(points.collect(), mesh.triangles().to_vec())?;
                Self::Mesh(Arc::new(turned))
            }
            Self::Sphere { .. } | Self::Floor => self.clone(),
        })
    }

    /// Returns the name as in scene files.
    #[must_use]
    pub fn name(&self) -> &'static str {
        match self {
            Self::Sphere { .. } => "sphere",
            Self::Box { .. } => "box",
            Self::Capsule { .. } => "capsule",
            Self::Mesh(_) => "obstacle",
            Self::Floor => "floor",
        }
    }

    /// Returns the surface as points, edges and triangles with a radius; none for a floor, which is
    /// unbounded.
    #[must_use]
    pub fn simplices(&self) -> Simplices {
        match self {
            Self::Sphere { radius } => Simplices {
                points: vec![Vector3::zeros()],
                radius: *radius,
                ..Simplices::default()
            },
            Self::Box { half_extents, axes } => {
                // Bit k of a corner's number tells its side along axis k.
                let corner = |number: u32| {
                    let along = |k: usize| axes[k] * half_extents[k];
                    (0..3).fold(Vector3::zeros(), |sum, k| {
                        let positive = number >> k & 1 == 1;
                        sum + if positive { along(k) } else { -along(k) }
                    })
                };
                let pairs = (0..8).flat_map(|a| [1, 2, 4].map(|bit| [a, a | bit]));
                // Corners of the faces, anticlockwise as seen from outside if the axes are a
                // right-handed system.
                let faces: [[u32; 4]; 6] = [
                    [0, 4, 6, 2],
                    [1, 3, 7, 5],
                    [0, 1, 5, 4],
                    [2, 6, 7, 3],
                    [0, 2, 3, 1],
                    [4, 5, 7, 6],
                ];
                let [x, y, z] = axes;
                let mirrored = x.cross(y).dot(z) < 0.0;
                let triangles = faces
                    .iter()
                    .flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]])
                    .map(|[a, b, c]| if mirrored { [a, c, b] } else { [a, b, c] });
                Simplices {
                    points: (0..8).map(corner).collect(),
                    edges: pairs.filter(|[a, b]| a != b).collect(),
                    triangles: triangles.collect(),
                    radius: 0.0,
                }
            }
            Self::Capsule { ends, radius } => Simplices {
                points: ends.to_vec(),
                edges: vec![[0, 1]],
                triangles: vec![],
                radius: *radius,
            },
            Self::Mesh(mesh) => Simplices {
                points: mesh.points().to_vec(),
                edges: mesh.edges().to_vec(),
                triangles: mesh.triangles().to_vec(),
                radius: 0.0,
            },
            Self::Floor => Simplices::default(),
        }
    }

    /// Checks the numbers of the shape.
    ///
    /// # Errors
    /// A radius or a half extent is not above 0, or a number is not finite.
    pub(crate) fn check(&self) -> Result<(), Error> {
        match self {
            Self::Sphere { radius } => positive("a sphere's radius", *radius),
            Self::Box { half_extents, axes } => {
                let mut halves = half_extents.iter();
                halves.try_for_each(|half| positive("half the extent of a box", *half))?;
                axes.iter().try_for_each(|axis| finite("an axis of a box", *axis))
            }
            Self::Capsule { ends, radius } => {
                let mut ends = ends.iter();
                ends.try_for_each(|end| finite("the end of a capsule", *end))?;
                positive("a capsule's radius", *radius)
            }
            // A closed mesh was checked at its construction.
            Self::Mesh(_) | Self::Floor => Ok(()),
        }
    }
}
