//! Triangles of faces with many corners, by ear clipping (Meisters, *Polygons have ears*, 1975).
//! Every corner is kept, also one on a straight side, so that the neighbouring faces still meet it.
//! Sides that coincide, such as those of a bridge to a hole, do not count as a crossing.

use robust::{Coord, orient2d};

use super::data::{Mesh, check_triangles};
use crate::description::Triple;

/// Largest number of tests for the faces of a file, of ears and of corners in ears.
const MAX_TESTS: usize = 100_000_000;

/// Condition for an ear. That for a simple polygon comes first; the last serves polygons that cross
/// themselves.
#[derive(Clone, Copy, PartialEq)]
enum Asked {
    /// No corner is in it or on its sides.
    Clear,
    /// No corner is within it.
    Empty,
    /// It is not turned the other way.
    Any,
    Nothing,
}

/// Faces of a file, as numbers of points.
#[derive(Default)]
pub(super) struct Faces {
    corners: Vec<u32>,
    /// End of the corners of each face.
    ends: Vec<u32>,
    /// Number of triangles that the faces make.
    triangles: usize,
}

impl Faces {
    /// Returns the place of the first corner of the face that is not ended.
    fn begin(&self) -> usize {
        self.ends.last().map_or(0, |end| *end as usize)
    }

    /// Adds a corner to the face that is not ended.
    pub fn add_corner(&mut self, corner: u32) -> Result<(), String> {
        self.corners.push(corner);
        self.triangles += usize::from(self.corners.len() - self.begin() > 2);
        check_triangles(self.triangles)
    }

    /// Ends a face, and returns whether it is one: it has three corners or more.
    pub fn end(&mut self) -> bool {
        let is_face = self.corners.len() - self.begin() > 2;
        if is_face {
            self.ends.push(self.corners.len() as u32);
        } else {
            self.corners.truncate(self.begin());
        }
        is_face
    }

    /// Finds the first face with a corner that is not among `count` points, and that corner.
    pub fn beyond(&self, count: usize) -> Option<(usize, u32)> {
        let k = self.corners.iter().position(|i| *i as usize >= count)?;
        let face = self.ends.partition_point(|end| *end as usize <= k);
        Some((face, self.corners[k]))
    }

    /// Cuts all faces into triangles of the mesh. `too_many` says which face, of so many corners,
    /// takes too many tests.
    pub fn cut(
        &self,
        mesh: &mut Mesh,
        too_many: impl Fn(usize, usize) -> String,
    ) -> Result<(), String> {
        let (mut cutter, mut first) = (Cutter::default(), 0);
        mesh.triangles.reserve_exact(self.triangles);
        for (k, end) in self.ends.iter().enumerate() {
            let face = &self.corners[first..*end as usize];
            let cut = cutter.cut(face, &mesh.positions, &mut mesh.triangles);
            cut.ok_or_else(|| too_many(k, face.len()) + ": split them")?;
            first = *end as usize;
        }
        Ok(())
    }
}

/// Cutter of faces into triangles.
#[derive(Default)]
struct Cutter {
    /// Number of tests in all faces so far.
    tests: usize,
    /// Corners of the face in its plane, where they are in anticlockwise order, and in space.
    corners: Vec<Coord<f64>>,
    places: Vec<Triple>,
    /// Neighbours of each corner, among the corners that are left.
    beside: Vec<[u32; 2]>,
    /// Corners at which the face is not convex.
    reflex: Vec<u32>,
    /// Whether a corner was found to be no ear.
    blocked: Vec<bool>,
}

impl Cutter {
    /// Adds the triangles of a face, whose corners are given as numbers of points; `None` if that
    /// takes too many tests.
    fn cut(
        &mut self,
        face: &[u32],
        positions: &[Triple],
        triangles: &mut Vec<[u32; 3]>,
    ) -> Option<()> {
        let fan = |triangles: &mut Vec<[u32; 3]>| {
            let sides = face[1..].windows(2);
            triangles.extend(sides.map(|side| [face[0], side[0], side[1]]));
            Some(())
        };
        if face.len() < 4 || !self.flatten(face, positions) {
            return fan(triangles);
        }
        let count = face.len();
        if (2..count).all(|k| self.turn([0, k - 1, k]) > 0.0) {
            return fan(triangles);
        }
        self.begin();
        self.clip(|ear| triangles.push(ear.map(|k| face[k])))
    }

    /// Projects the corners onto the plane of two axes in which the face is largest. A plane in
    /// which it is at least half as large is preferred if it keeps apart the corners that are apart
    /// in space. Returns whether the face has an area.
    fn flatten(&mut self, face: &[u32], positions: &[Triple]) -> bool {
        let at = |k: usize| positions[face[k] as usize];
        let (origin, mut normal) = (at(0), [0.0; 3]);
        for k in 1..face.len() - 1 {
            let side = |k: usize| [0, 1, 2].map(|axis| at(k)[axis] - origin[axis]);
            let (a, b) = (side(k), side(k + 1));
            for (axis, sum) in normal.iter_mut().enumerate() {
                let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
                *sum += a[u] * b[v] - a[v] * b[u];
            }
        }
        let mut axes = [0, 1, 2];
        axes.sort_by(|a, b| normal[*b].abs().total_cmp(&normal[*a].abs()));
        let least = 0.5 * normal[axes[0]].abs();
        self.places.clear();
        self.places.extend((0..face.len()).map(at));
        for axis in axes.into_iter().filter(|axis| normal[*axis].abs() >= least) {
            self.project(axis, normal[axis] > 0.0);
            if !self.falls_together() {
                return least > 0.0;
            }
        }
        self.project(axes[0], normal[axes[0]] > 0.0);
        least > 0.0
    }

    /// Projects the corners along an axis.
    fn project(&mut self, axis: usize, is_up: bool) {
        let (next, last) = ((axis + 1) % 3, (axis + 2) % 3);
        let (u, v) = if is_up { (next, last) } else { (last, next) };
        let flat = |place: &Triple| Coord { x: place[u], y: place[v] };
        self.corners.clear();
        self.corners.extend(self.places.iter().map(flat));
    }

    /// Returns whether a corner and one of the next two are at one place in the plane but not in
    /// space.
    fn falls_together(&self) -> bool {
        let n = self.corners.len();
        let together = |a: usize, b: usize| {
            self.corners[a] == self.corners[b] && self.places[a] != self.places[b]
        };
        (0..n).any(|k| together(k, (k + 1) % n) || together(k, (k + 2) % n))
    }

    /// Returns twice the signed area of a triangle of corners, or a number of the same sign.
    fn turn(&self, [a, b, c]: [usize; 3]) -> f64 {
        let [a, b, c] = [a, b, c].map(|k| self.corners[k]);
        orient2d(a, b, c)
    }

    fn begin(&mut self) {
        let count = self.corners.len();
        let beside = |k: usize| [((k + count - 1) % count) as u32, ((k + 1) % count) as u32];
        self.beside.clear();
        self.beside.extend((0..count).map(beside));
        self.blocked.clear();
        self.blocked.resize(count, false);
        self.reflex.clear();
        for k in 0..count {
            if self.turn(self.ear(k)) <= 0.0 {
                self.reflex.push(k as u32);
            }
        }
    }

    /// Returns the triangle of a corner and its two neighbours.
    fn ear(&self, k: usize) -> [usize; 3] {
        let [before, after] = self.beside[k];
        [before as usize, k, after as usize]
    }

    /// Cuts off ears until none is left, and passes each to `add`.
    fn clip(&mut self, mut add: impl FnMut([usize; 3])) -> Option<()> {
        let (mut left, mut k) = (self.corners.len(), 0);
        let (mut asked, mut looked, mut is_stale) = (Asked::Clear, 0, false);
        while left >= 3 {
            let ear @ [before, _, after] = self.ear(k);
            let is_nothing = self.is_nothing(ear);
            if !is_nothing && !self.is_ear(ear, asked)? {
                (k, looked) = (after, looked + 1);
                if looked > left {
                    // A corner that blocked an ear may have been cut off since.
                    if !is_stale {
                        asked = asked.less();
                    }
                    (looked, is_stale) = (0, false);
                    self.blocked.fill(false);
                    self.tests += self.blocked.len();
                }
                continue;
            }
            if !is_nothing {
                add(ear);
            }
            self.beside[before][1] = after as u32;
            self.beside[after][0] = before as u32;
            self.reflex.retain(|other| *other != k as u32);
            self.tests += self.reflex.len();
            for other in [before, after] {
                self.blocked[other] = false;
                let is_reflex = self.turn(self.ear(other)) <= 0.0;
                let place = self.reflex.iter().position(|r| *r == other as u32);
                match place {
                    Some(place) if !is_reflex => drop(self.reflex.swap_remove(place)),
                    None if is_reflex => self.reflex.push(other as u32),
                    _ => {}
                }
            }
            // Two neighbouring ears make thin triangles.
            let [_, _, next] = self.ear(after);
            k = if is_nothing { after } else { next };
            (left, looked, is_stale) = (left - 1, 0, true);
            if asked != Asked::Clear {
                asked = Asked::Clear;
                self.blocked.fill(false);
                self.tests += self.blocked.len();
            }
        }
        Some(())
    }

    /// Returns whether a corner coincides with a neighbour, or is the end of a line that goes there
    /// and back.
    fn is_nothing(&self, [a, b, c]: [usize; 3]) -> bool {
        let [a, b, c] = [a, b, c].map(|k| self.places[k]);
        a == b || b == c || a == c
    }

    /// Returns whether a triangle meets the condition for an ear; `None` after too many tests.
    fn is_ear(&mut self, ear: [usize; 3], asked: Asked) -> Option<bool> {
        self.tests += 1;
        if self.blocked[ear[1]] {
            return Some(false);
        }
        self.tests += self.reflex.len();
        if self.tests > MAX_TESTS {
            return None;
        }
        let area = self.turn(ear);
        let is = match asked {
            Asked::Nothing => true,
            Asked::Any => area >= 0.0,
            _ => {
                let is_in_way = |k: &u32| self.is_in_way(*k as usize, ear, asked == Asked::Clear);
                area > 0.0 && !self.reflex.iter().any(is_in_way)
            }
        };
        self.blocked[ear[1]] = !is;
        Some(is)
    }

    /// Returns whether a corner is in an ear, or on its sides if these count.
    fn is_in_way(&self, k: usize, ear: [usize; 3], sides_count: bool) -> bool {
        if ear.contains(&k) {
            return false;
        }
        let (at, corners) = (self.corners[k], ear.map(|k| self.corners[k]));
        let beyond = |low: fn(&Coord<f64>) -> f64| {
            let [a, b, c] = corners.map(|corner| low(&corner));
            low(&at) < a.min(b).min(c) || low(&at) > a.max(b).max(c)
        };
        if beyond(|at| at.x) || beyond(|at| at.y) {
            return false;
        }
        let turns = |to: Coord<f64>| {
            [0, 1, 2].map(|side| orient2d(corners[side], corners[(side + 1) % 3], to))
        };
        if let Some(corner) = corners.iter().position(|corner| *corner == at) {
            // If two corners are at one place, the sides of the other one may lead into the ear.
            let leads_in = |to: &u32| {
                let turns = turns(self.corners[*to as usize]);
                turns[corner] > 0.0 && turns[(corner + 2) % 3] > 0.0
            };
            return sides_count && self.beside[k].iter().any(leads_in);
        }
        let least = turns(at).into_iter().fold(f64::INFINITY, f64::min);
        least > 0.0 || sides_count && least == 0.0
    }
}

impl Asked {
    fn less(self) -> Self {
        match self {
            Self::Clear => Self::Empty,
            Self::Empty => Self::Any,
            Self::Any | Self::Nothing => Self::Nothing,
        }
    }
}
