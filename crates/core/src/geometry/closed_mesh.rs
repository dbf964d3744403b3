//! Closed surfaces of triangles: the nearest of their points, and what is inside (Baerentzen and
//! Aanaes, *Signed distance computation using the angle weighted pseudonormal*, 2005).

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::bvh::{Aabb, Bvh};
use super::closest::{PairKind, closest};
use super::nearest::{Nearest, Separation};
use crate::error::{Error, finite};

/// Closed surface of triangles around a solid.
#[derive(Clone, Debug)]
pub struct ClosedMesh {
    points: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    /// Outward unit normals of the points, or zero where there is none.
    normals: Vec<Vector3<f64>>,
    /// Outward normals of the triangles, and those of the sides opposite to their corners, of any
    /// length.
    faces: Vec<Face>,
    tree: Bvh,
    /// Greatest distance of a point from the origin (m).
    reach: f64,
}

#[derive(Clone, Copy, Debug)]
struct Face {
    normal: Vector3<f64>,
    sides: [Vector3<f64>; 3],
}

impl PartialEq for ClosedMesh {
    /// Whether points and triangles are the same, on which all else depends.
    fn eq(&self, other: &Self) -> bool {
        (&self.points, &self.triangles) == (&other.points, &other.triangles)
    }
}

impl ClosedMesh {
    /// Largest number of triangles.
    pub const MAX_TRIANGLES: usize = 200_000;

    /// Surface with these points (m) and triangles, whose corners are numbers of points. The
    /// triangles are all turned around if they wind clockwise as seen from outside.
    ///
    /// # Errors
    /// There are no triangles or more than [`MAX_TRIANGLES`](Self::MAX_TRIANGLES); a corner does
    /// not exist; a number is not finite; an edge has other than two triangles, or its two do not
    /// wind alike; or nothing is enclosed.
    pub fn new(points: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        let invalid = |why: String| Err(Error::Invalid(why));
        let (count, most) = (triangles.len(), Self::MAX_TRIANGLES);
        if count == 0 || count > most {
            return invalid(format!(
                "a closed mesh has 1 to {most} triangles, not {count}"
            ));
        }
        let mut all = points.iter();
        all.try_for_each(|point| finite("a point of a closed mesh", *point))?;
        if let Some(i) = triangles
            .iter()
            .flatten()
            .find(|i| **i as usize >= points.len())
        {
            return invalid(format!("a triangle of a closed mesh has no corner {i}"));
        }
        let at = |i: u32| points[i as usize];
        let volume = |[a, b, c]: &[u32; 3]| at(*a).cross(&at(*b)).dot(&at(*c)) / 6.0;
        let volume: f64 = triangles.iter().map(volume).sum();
        let triangles: Vec<_> = if volume < 0.0 {
            triangles.iter().map(|&[a, b, c]| [a, c, b]).collect()
        } else {
            triangles
        };
        let edges = edges(&points, &triangles)?;
        if volume == 0.0 {
            return invalid("a closed mesh must enclose a volume".into());
        }
        let (normals, faces) = normals(&points, &triangles);
        Ok(Self {
            normals,
            faces,
            tree: tree(&points, &triangles),
            reach: points.iter().map(Vector3::norm).fold(0.0, f64::max),
            points,
            triangles,
            edges,
        })
    }

    /// Points (m).
    #[must_use]
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Corners of the triangles, anticlockwise as seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Outward normals of the points: unit vectors, the mean of the normals of the triangles around
    /// a point with their angles there as weights, or zero where they cancel.
    #[must_use]
    pub fn normals(&self) -> &[Vector3<f64>] {
        &self.normals
    }

    /// Ends of the edges, the lower number first, in order.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Nearest point of the surface to a point d inside.
    pub(crate) fn nearest(&self, d: Vector3<f64>) -> Option<Nearest> {
        let (offset, normal) = self.offset(d)?;
        (normal.dot(&offset) < 0.0).then(|| Nearest {
            point: d - offset,
            normal: normal.normalize(),
        })
    }

    /// Separation of a point d.
    pub(crate) fn separation(&self, d: Vector3<f64>) -> Separation {
        let (offset, normal) = self.offset(d).unwrap_or_default();
        let (side, outwards) = (normal.dot(&offset), normal.try_normalize(0.0));
        let sign = if side < 0.0 { -1.0 } else { 1.0 };
        let away = offset.try_normalize(0.0).map(|away| away * sign);
        Separation {
            distance: sign * offset.norm(),
            normal: away.or(outwards).unwrap_or_else(Vector3::y),
        }
    }

    /// Radius (m) of a ball around the origin that contains all points.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Vector to a point d from the nearest point of the surface, and the outward normal there, of
    /// any length.
    fn offset(&self, d: Vector3<f64>) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let (k, nearest) = self.tree.nearest(&d, |k| {
            let [a, b, c] = self.triangles[k as usize].map(|i| self.points[i as usize]);
            let closest = closest(PairKind::VertexTriangle, &[d, a, b, c]);
            (closest.offset.norm_squared(), closest)
        })?;
        Some((nearest.offset, self.normal(k as usize, &nearest.weights)))
    }

    /// Normal at the point of triangle k with these weights, of which the last three are those of
    /// its corners.
    fn normal(&self, k: usize, weights: &[f64; 4]) -> Vector3<f64> {
        let zero = |k: usize| weights[k + 1] == 0.0;
        let corner = (0..3).find(|k| zero((k + 1) % 3) && zero((k + 2) % 3));
        let side = (0..3).find(|k| zero(*k));
        match (corner, side) {
            (Some(corner), _) => self.normals[self.triangles[k][corner] as usize],
            (None, Some(side)) => self.faces[k].sides[side],
            (None, None) => self.faces[k].normal,
        }
    }
}

/// Edges of a closed surface in order, the lower number of their ends first.
fn edges(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Result<Vec<[u32; 2]>, Error> {
    // The number of triangles that pass an edge upwards, and that of those that pass it downwards.
    let mut passed: BTreeMap<[u32; 2], [usize; 2]> = BTreeMap::new();
    for &[a, b, c] in triangles {
        for [from, to] in [[a, b], [b, c], [c, a]] {
            let edge = [from.min(to), from.max(to)];
            passed.entry(edge).or_default()[usize::from(from > to)] += 1;
        }
    }
    let Some((&[a, b], [up, down])) = passed.iter().find(|(_, ways)| **ways != [1, 1]) else {
        return Ok(passed.into_keys().collect());
    };
    let place = |i: u32| {
        let [x, y, z]: [f64; 3] = points[i as usize].into();
        format!("point {i} at ({x}, {y}, {z})")
    };
    let why = match up + down {
        2 => "whose normals point to different sides".into(),
        1 => "not 1".into(),
        count => format!("not {count}"),
    };
    Err(Error::Invalid(format!(
        "a closed mesh has two triangles at each edge, but at that from {} to {} {why}",
        place(a),
        place(b),
    )))
}

/// Normals of the points, and those of the triangles and their sides.
fn normals(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> (Vec<Vector3<f64>>, Vec<Face>) {
    let mut corners = vec![Vector3::zeros(); points.len()];
    let mut sides: BTreeMap<[u32; 2], Vector3<f64>> = BTreeMap::new();
    let side = |t: &[u32; 3], k: usize| {
        let (a, b) = (t[(k + 1) % 3], t[(k + 2) % 3]);
        [a.min(b), a.max(b)]
    };
    let mut own = vec![];
    for t in triangles {
        let at = t.map(|i| points[i as usize]);
        let normal = (at[1] - at[0]).cross(&(at[2] - at[0]));
        let normal = normal.try_normalize(0.0).unwrap_or_default();
        for k in 0..3 {
            let (along, back) = (at[(k + 1) % 3] - at[k], at[(k + 2) % 3] - at[k]);
            let angle = libm::atan2(along.cross(&back).norm(), along.dot(&back));
            corners[t[k] as usize] += normal * angle;
            *sides.entry(side(t, k)).or_default() += normal;
        }
        own.push(normal);
    }
    for normal in &mut corners {
        *normal = normal.try_normalize(0.0).unwrap_or_default();
    }
    let faces = triangles.iter().zip(own).map(|(t, normal)| Face {
        normal,
        sides: [0, 1, 2].map(|k| sides[&side(t, k)]),
    });
    (corners, faces.collect())
}

/// Tree of boxes around the triangles.
fn tree(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> Bvh {
    let around = |t: &[u32; 3]| Aabb::around(t.map(|i| points[i as usize]));
    Bvh::new(&triangles.iter().map(around).collect::<Vec<_>>())
}
