//! Closed surfaces of triangles: their nearest points, and whether points are inside (Baerentzen
//! and Aanaes, *Signed distance computation using the angle weighted pseudonormal*, 2005).

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::bvh::{Aabb, Bvh};
use super::closest::{Nearest, PairKind, Separation, closest};
use super::parts::split;
use crate::error::{Error, finite};

/// Distance from a surface, over its greatest distance from the origin, up to which a point counts
/// as on it.
const ON_SURFACE_SHARE: f64 = 1e-10;

/// Closed surfaces of triangles, each of which bounds a solid. Solids may overlap: a point in any
/// of them is inside.
#[derive(Clone, Debug)]
pub struct ClosedMesh {
    points: Vec<Vector3<f64>>,
    triangles: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    /// Outward unit normals of the points, or zero where there is none.
    normals: Vec<Vector3<f64>>,
    /// Outward normals of the triangles, and those of the sides opposite to their corners, of any
    /// length.
    faces: Vec<MeshFace>,
    /// All triangles.
    whole: MeshTree,
    /// Triangles of each solid, if there are several.
    solids: Vec<MeshTree>,
    /// Boxes around the solids.
    places: Bvh,
    /// Greatest distance of a point from the origin (m).
    reach: f64,
}

/// Some triangles, and boxes around them.
#[derive(Clone, Debug)]
struct MeshTree {
    triangles: Vec<u32>,
    boxes: Bvh,
}

#[derive(Clone, Copy, Debug)]
struct MeshFace {
    normal: Vector3<f64>,
    sides: [Vector3<f64>; 3],
}

impl PartialEq for ClosedMesh {
    /// Compares points and triangles, which determine everything else.
    fn eq(&self, other: &Self) -> bool {
        (&self.points, &self.triangles) == (&other.points, &other.triangles)
    }
}

impl ClosedMesh {
    /// Largest number of triangles.
    pub const MAX_TRIANGLES: usize = 200_000;

    /// Creates the surface with these points (m) and triangles, whose corners are indices of
    /// points. Each connected part bounds its own solid: its triangles are reversed if they wind
    /// clockwise as seen from outside, unless it lies within another part, in which it then is a
    /// hole. Points and edges that parts share are duplicated.
    ///
    /// # Errors
    /// There are no triangles or more than [`MAX_TRIANGLES`](Self::MAX_TRIANGLES); a corner does
    /// not exist; a number is not finite; the triangles at an edge do not form pairs of the same
    /// orientation; or no volume is enclosed.
    pub fn new(points: Vec<Vector3<f64>>, triangles: Vec<[u32; 3]>) -> Result<Self, Error> {
        let invalid = |why: String| Err(Error::Invalid(why));
        let (count, most) = (triangles.len(), Self::MAX_TRIANGLES);
        if count == 0 || count > most {
            return invalid(format!("a closed mesh has 1 to {most} triangles, not {count}"));
        }
        let mut all = points.iter();
        all.try_for_each(|point| finite("a point of a closed mesh", *point))?;
        if let Some(i) = triangles.iter().flatten().find(|i| **i as usize >= points.len()) {
            return invalid(format!("a triangle of a closed mesh has no corner {i}"));
        }
        let volume: f64 = triangles.iter().map(|t| volume(&points, t)).sum();
        if volume == 0.0 {
            // If the surface is open, that is the better message.
            split(points, &triangles)?;
            return invalid("a closed mesh must enclose a volume".into());
        }
        let turned = |t: [u32; 3]| if volume < 0.0 { reversed(t) } else { t };
        let triangles: Vec<_> = triangles.into_iter().map(turned).collect();
        let parts = split(points, &triangles)?;
        let mesh = Self::of_parts(parts.points, parts.triangles, &parts.part_of, parts.count);
        Ok(if parts.count > 1 {
            mesh.with_oriented_parts(parts.part_of, parts.count)
        } else {
            mesh
        })
    }

    /// Creates the surface of a number of parts, each of which bounds a solid.
    fn of_parts(
        points: Vec<Vector3<f64>>,
        triangles: Vec<[u32; 3]>,
        part_of: &[u32],
        count: usize,
    ) -> Self {
        let (normals, faces) = normals(&points, &triangles);
        let sides = triangles.iter().flat_map(|&[a, b, c]| [[a, b], [b, c], [c, a]]);
        let mut edges: Vec<_> = sides.filter(|[a, b]| a < b).collect();
        edges.sort_unstable();
        let all: Vec<_> = (0..triangles.len() as u32).collect();
        let whole = MeshTree::new(&points, &triangles, all);
        let mut solids = vec![];
        if count > 1 {
            let mut own = vec![vec![]; count];
            for (k, part) in part_of.iter().enumerate() {
                own[*part as usize].push(k as u32);
            }
            own.retain(|triangles| !triangles.is_empty());
            solids.extend(own.into_iter().map(|own| MeshTree::new(&points, &triangles, own)));
        }
        let boxes: Vec<_> = solids.iter().filter_map(|solid| solid.boxes.bounds()).collect();
        Self {
            normals,
            faces,
            whole,
            places: Bvh::new(&boxes),
            solids,
            reach: points.iter().map(Vector3::norm).fold(0.0, f64::max),
            points,
            triangles,
            edges,
        }
    }

    /// Reverses the triangles of parts that wind clockwise, except for parts within another one, in
    /// which they are holes.
    fn with_oriented_parts(self, mut part_of: Vec<u32>, count: usize) -> Self {
        let mut volumes = vec![0.0; count];
        for (t, part) in self.triangles.iter().zip(&part_of) {
            volumes[*part as usize] += volume(&self.points, t);
        }
        // The solid that each part belongs to, or `None` if the part is to be reversed.
        let mut owners: Vec<_> = (0..count).map(Some).collect();
        for part in (0..count).filter(|part| volumes[*part] < 0.0) {
            let own = self.solids[part].triangles.iter();
            let corners: Vec<_> = own.flat_map(|k| self.triangles[*k as usize]).collect();
            let Some(first) = corners.first().map(|i| self.points[*i as usize]) else {
                continue;
            };
            let is_within = |other: &usize| {
                let mut points = corners.iter().map(|i| self.points[*i as usize]);
                points.all(|d| self.is_inside(&self.solids[*other], d))
            };
            let mut around = vec![];
            let place = Aabb::around([first]);
            self.places.meeting(&place, |k| around.push(k as usize));
            around.sort_unstable();
            around.retain(|other| volumes[*other] > 0.0 && is_within(other));
            owners[part] = around.into_iter().min_by(|a, b| volumes[*a].total_cmp(&volumes[*b]));
        }
        let mut triangles = self.triangles;
        for (t, part) in triangles.iter_mut().zip(&mut part_of) {
            match owners[*part as usize] {
                Some(owner) => *part = owner as u32,
                None => *t = reversed(*t),
            }
        }
        Self::of_parts(self.points, triangles, &part_of, count)
    }

    /// Returns whether a point d is inside a solid.
    fn is_inside(&self, solid: &MeshTree, d: Vector3<f64>) -> bool {
        self.offset_inside(solid, d).is_some()
    }

    /// Returns the points (m).
    #[must_use]
    pub fn points(&self) -> &[Vector3<f64>] {
        &self.points
    }

    /// Returns the corners of the triangles, anticlockwise as seen from outside.
    #[must_use]
    pub fn triangles(&self) -> &[[u32; 3]] {
        &self.triangles
    }

    /// Returns the outward normals of the points: unit vectors, the mean of the normals of the
    /// triangles around a point with their angles there as weights, or zero where they cancel.
    #[must_use]
    pub fn normals(&self) -> &[Vector3<f64>] {
        &self.normals
    }

    /// Returns the ends of the edges, the lower number first, in order.
    #[must_use]
    pub fn edges(&self) -> &[[u32; 2]] {
        &self.edges
    }

    /// Returns the nearest point of the surface to a point d inside; where solids overlap, the
    /// point at which d is outside all of them after it was moved out of one after another.
    pub(crate) fn nearest(&self, d: Vector3<f64>) -> Option<Nearest> {
        let mut left = vec![];
        let (mut point, mut last) = (d, None);
        while let Some((solid, offset, normal)) = self.deepest(point, &left) {
            (point, last) = (point - offset, Some(normal));
            left.push(solid);
        }
        last.map(|normal| Nearest { point, normal: normal.normalize() })
    }

    /// Finds, of the solids that contain a point d, without those in `but`, the one from whose
    /// surface it is farthest. Also returns the vector from there and the normal there.
    fn deepest(&self, d: Vector3<f64>, but: &[u32]) -> Option<(u32, Vector3<f64>, Vector3<f64>)> {
        let mut deepest: Option<(u32, Vector3<f64>, Vector3<f64>)> = None;
        let mut check = |k: u32, solid: &MeshTree| {
            let Some((offset, normal)) = self.offset_inside(solid, d) else {
                return;
            };
            let is_deeper = |(_, other, _): &(u32, Vector3<f64>, Vector3<f64>)| {
                offset.norm_squared() > other.norm_squared()
            };
            if deepest.as_ref().is_none_or(is_deeper) {
                deepest = Some((k, offset, normal));
            }
        };
        if self.solids.is_empty() {
            if but.is_empty() {
                check(0, &self.whole);
            }
        } else {
            self.places.meeting(&Aabb::around([d]), |k| {
                if !but.contains(&k) {
                    check(k, &self.solids[k as usize]);
                }
            });
        }
        deepest
    }

    /// Returns the separation of a point d.
    pub(crate) fn separation(&self, d: Vector3<f64>) -> Separation {
        let (offset, normal) = self.offset(d).unwrap_or_default();
        let (side, outwards) = (normal.dot(&offset), normal.try_normalize(0.0));
        let sign = if side < 0.0 { -1.0 } else { 1.0 };
        // On the surface, the direction of the offset is a rounding error.
        let none = ON_SURFACE_SHARE * self.reach;
        let away = offset.try_normalize(none).map(|away| away * sign);
        Separation {
            distance: sign * offset.norm(),
            normal: away.or(outwards).unwrap_or_else(Vector3::y),
        }
    }

    /// Returns the radius (m) of a ball around the origin that contains all points.
    pub(crate) fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the vector to a point d from the nearest point of the surface, and the outward
    /// normal there, of any length. If d is in solids, the surface is that of the one in which it
    /// is deepest.
    fn offset(&self, d: Vector3<f64>) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let inside = (!self.solids.is_empty()).then(|| self.deepest(d, &[])).flatten();
        match inside {
            Some((_, offset, normal)) => Some((offset, normal)),
            None => self.offset_from(&self.whole, d),
        }
    }

    /// Returns the vector from the nearest point to a point d inside a solid, and the normal there.
    fn offset_inside(
        &self,
        solid: &MeshTree,
        d: Vector3<f64>,
    ) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let bounds = solid.boxes.bounds()?;
        let found = (bounds.squared_distance(&d) == 0.0).then(|| self.offset_from(solid, d));
        found?.filter(|(offset, normal)| normal.dot(offset) < 0.0)
    }

    /// Returns the vector from the nearest point to d, and the normal there, for the triangles in a
    /// tree.
    fn offset_from(
        &self,
        tree: &MeshTree,
        d: Vector3<f64>,
    ) -> Option<(Vector3<f64>, Vector3<f64>)> {
        let (k, nearest) = tree.boxes.nearest(&d, |k| {
            let t = self.triangles[tree.triangles[k as usize] as usize];
            let [a, b, c] = t.map(|i| self.points[i as usize]);
            let closest = closest(PairKind::VertexTriangle, &[d, a, b, c]);
            (closest.offset.norm_squared(), closest)
        })?;
        let k = tree.triangles[k as usize] as usize;
        Some((nearest.offset, self.normal(k, &nearest.weights)))
    }

    /// Returns the normal at the point of triangle k with these weights, the last three of which
    /// are those of its corners.
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

/// Computes the normals of the points, of the triangles and of their sides.
fn normals(points: &[Vector3<f64>], triangles: &[[u32; 3]]) -> (Vec<Vector3<f64>>, Vec<MeshFace>) {
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
    let faces = triangles
        .iter()
        .zip(own)
        .map(|(t, normal)| MeshFace { normal, sides: [0, 1, 2].map(|k| sides[&side(t, k)]) });
    (corners, faces.collect())
}

/// Returns the triangle with the opposite orientation.
fn reversed([a, b, c]: [u32; 3]) -> [u32; 3] {
    [a, c, b]
}

/// Returns the signed volume between a triangle and the origin (m3), negative if it winds clockwise
/// as seen from outside.
fn volume(points: &[Vector3<f64>], triangle: &[u32; 3]) -> f64 {
    let [a, b, c] = triangle.map(|i| points[i as usize]);
    a.cross(&b).dot(&c) / 6.0
}

impl MeshTree {
    fn new(points: &[Vector3<f64>], triangles: &[[u32; 3]], own: Vec<u32>) -> Self {
        let around = |k: &u32| Aabb::around(triangles[*k as usize].map(|i| points[i as usize]));
        Self { boxes: Bvh::new(&own.iter().map(around).collect::<Vec<_>>()), triangles: own }
    }
}
