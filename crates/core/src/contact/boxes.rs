//! Courses of vertices, and trees of the boxes around items on them.

use nalgebra::Vector3;

use super::items::Items;
use super::surface::Surface;
use crate::geometry::bvh::{Aabb, Bvh, least, most};

/// Straight courses of all vertices, from which they may stray by half of the reach.
pub(super) struct Courses<'a> {
    /// Positions at the beginning (m).
    pub base: &'a [Vector3<f64>],
    /// Velocities (m/s).
    pub speeds: &'a [Vector3<f64>],
    /// Mean velocity (m/s).
    pub mean: Vector3<f64>,
    /// Duration of the courses (s).
    pub horizon: f64,
    /// Gap below which pairs are listed (m).
    pub reach: f64,
}

/// Axis-aligned boxes at the beginning and at the end of the courses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    low: [[f64; 3]; 2],
    high: [[f64; 3]; 2],
}

impl Bounds {
    fn with(mut self, other: &Self) -> Self {
        for t in 0..2 {
            for k in 0..3 {
                self.low[t][k] = self.low[t][k].min(other.low[t][k]);
                self.high[t][k] = self.high[t][k].max(other.high[t][k]);
            }
        }
        self
    }

    /// Lower bound of the squared distance of contents of two boxes: along an axis, the gap between
    /// points on straight courses is smallest at an end.
    pub fn apart(&self, other: &Self) -> f64 {
        let mut squared = 0.0;
        for k in 0..3 {
            let after = least(
                other.low[0][k] - self.high[0][k],
                other.low[1][k] - self.high[1][k],
            );
            let before = least(
                self.low[0][k] - other.high[0][k],
                self.low[1][k] - other.high[1][k],
            );
            let gap = most(0.0, most(after, before));
            squared += gap * gap;
        }
        squared
    }
}

/// Tree of the boxes of items, with the boxes of their vertices and edges.
#[derive(Debug, Default)]
pub(super) struct Tree {
    pub bvh: Bvh,
    /// Half of the reach of the list (m).
    half: f64,
    pub items: Vec<Bounds>,
    pub vertices: Vec<Bounds>,
    pub edges: Vec<Bounds>,
}

impl Tree {
    /// Updates the boxes of the items whose courses are new.
    pub fn take(
        &mut self,
        items: &Items,
        surface: &Surface,
        course: &Courses,
        is_new: &impl Fn(&[u32]) -> bool,
    ) {
        let around = |i: u32| {
            let begin = course.base[i as usize];
            let end = begin + (course.speeds[i as usize] - course.mean) * course.horizon;
            let radius = surface.radius(i);
            Bounds {
                low: [begin, end].map(|x| x.add_scalar(-radius).into()),
                high: [begin, end].map(|x| x.add_scalar(radius).into()),
            }
        };
        let first = self.items.len() != items.corners.len();
        self.half = 0.5 * (course.reach + surface.thickest());
        let triangle = |[i, j, k]: &[u32; 3]| around(*i).with(&around(*j)).with(&around(*k));
        if first {
            self.vertices = items.vertices.iter().map(|i| around(*i)).collect();
            let edges = items.edges.iter();
            self.edges = edges.map(|[i, j]| around(*i).with(&around(*j))).collect();
            self.items = items.corners.iter().map(triangle).collect();
            let leaves: Vec<_> = self.items.iter().map(|item| self.leaf(item)).collect();
            self.bvh = Bvh::new(&leaves);
            return;
        }
        for (i, bounds) in items.vertices.iter().zip(&mut self.vertices) {
            if is_new(&[*i]) {
                *bounds = around(*i);
            }
        }
        for (edge, bounds) in items.edges.iter().zip(&mut self.edges) {
            if is_new(edge) {
                *bounds = around(edge[0]).with(&around(edge[1]));
            }
        }
        for (k, corners) in items.corners.iter().enumerate() {
            if is_new(corners) {
                self.items[k] = triangle(corners);
                let leaf = self.leaf(&self.items[k]);
                self.bvh.set(k, leaf);
            }
        }
        self.bvh.refit();
    }

    /// Box of an item in the tree: around its boxes at both ends, enlarged by half of the reach.
    fn leaf(&self, item: &Bounds) -> Aabb {
        let ([a, b], [c, d]) = (item.low, item.high);
        Aabb::around([a, b, c, d].map(Vector3::from)).grown(self.half)
    }

    /// Visits the pairs of an item with a new course and an item of another tree whose boxes meet.
    pub fn meet(
        &self,
        other: &Self,
        items: &Items,
        is_new: &impl Fn(&[u32]) -> bool,
        mut visit: impl FnMut(u32, u32),
    ) {
        for (k, corners) in items.corners.iter().enumerate() {
            if is_new(corners) {
                let leaf = self.leaf(&self.items[k]);
                other.bvh.meeting(&leaf, |l| visit(k as u32, l));
            }
        }
    }
}
