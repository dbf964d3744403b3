//! Axis-aligned boxes, and trees of them to find boxes that meet, or the nearest primitive
//! (bounding volume hierarchies; Ericson, *Real-Time Collision Detection*, 2005, chapter 6).

use nalgebra::Vector3;

/// Returns the smaller of two numbers, by one instruction.
pub(crate) fn least(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers, by one instruction.
pub(crate) fn most(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Number of cells along each axis, from 0, into which a curve divides a box.
const CELLS: u32 = (1 << 21) - 1;

/// Moves the first 21 bits of a number three places apart.
fn spread(x: u64) -> u64 {
    let masks = [
        (32, 0x001f_0000_0000_ffff),
        (16, 0x001f_0000_ff00_00ff),
        (8, 0x100f_00f0_0f00_f00f),
        (4, 0x10c3_0c30_c30c_30c3),
        (2, 0x1249_2492_4924_9249),
    ];
    masks.iter().fold(x, |x, (by, mask)| (x | x << by) & mask)
}

/// Axis-aligned box.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Aabb {
    low: [f64; 3],
    high: [f64; 3],
}

impl Aabb {
    /// Returns the smallest box around all points of a primitive.
    pub fn around<const N: usize>(points: [Vector3<f64>; N]) -> Self {
        let each = |pick: fn(f64, f64) -> f64| {
            let of = |k: usize| points.iter().map(|x| x[k]).reduce(pick).unwrap_or(f64::NAN);
            [of(0), of(1), of(2)]
        };
        Self { low: each(f64::min), high: each(f64::max) }
    }

    /// Returns the box enlarged by a distance (m) on all sides.
    pub fn grown(self, by: f64) -> Self {
        Self { low: self.low.map(|x| x - by), high: self.high.map(|x| x + by) }
    }

    /// Returns the place of the centre of another box along a curve through this box that keeps
    /// near places near each other (Morton, *A computer oriented geodetic data base*, 1966).
    pub fn place_of(&self, other: &Self) -> u64 {
        let (all, center) = (self.center(), other.center());
        let width = |k: usize| self.high[k] - self.low[k];
        let longest = width(0).max(width(1)).max(width(2));
        let cells = f64::from(CELLS);
        // From 0 to CELLS along the longest axis: a number that is not finite counts as 0.
        let cell = |k: usize| (cells * (0.5 + 0.5 * (center[k] - all[k]) / longest)) as u64;
        [0, 1, 2].iter().fold(0, |place, k| place | spread(cell(*k)) << k)
    }

    /// Returns the smallest box around two boxes.
    pub fn with(&self, other: &Self) -> Self {
        Self {
            low: [0, 1, 2].map(|k| least(self.low[k], other.low[k])),
            high: [0, 1, 2].map(|k| most(self.high[k], other.high[k])),
        }
    }

    /// Returns whether two boxes have a point in common, such as a corner.
    fn meets(&self, other: &Self) -> bool {
        // One branch for all axes.
        let gap = |k: usize| most(self.low[k] - other.high[k], other.low[k] - self.high[k]);
        most(most(gap(0), gap(1)), gap(2)) <= 0.0
    }

    /// Returns the squared distance (m2) of a point from the box: 0 inside.
    pub fn squared_distance(&self, point: &Vector3<f64>) -> f64 {
        let outside = |k: usize| (self.low[k] - point[k]).max(point[k] - self.high[k]).max(0.0);
        [0, 1, 2].map(|k| outside(k).powi(2)).iter().sum()
    }

    /// Returns twice the centre.
    fn center(&self) -> [f64; 3] {
        [0, 1, 2].map(|k| self.low[k] + self.high[k])
    }
}

/// Node of a tree. A node of one item has no children; the first child of any other node follows
/// it.
#[derive(Clone, Debug)]
struct Node {
    bounds: Aabb,
    /// The second child, or 0 if this is the node of an item.
    second: u32,
    item: u32,
}

/// Binary tree of boxes around items, which are numbered as they are listed. Refitting changes the
/// boxes but not the topology.
#[derive(Clone, Debug, Default)]
pub(crate) struct Bvh {
    /// Parents before their children.
    nodes: Vec<Node>,
    /// Node of each item.
    places: Vec<u32>,
}

impl Bvh {
    /// Creates a tree of these boxes: each child of a node gets half of its boxes, split along the
    /// axis on which their centres are spread most.
    pub fn new(boxes: &[Aabb]) -> Self {
        let mut tree = Self {
            nodes: Vec::with_capacity((2 * boxes.len()).saturating_sub(1)),
            places: vec![0; boxes.len()],
        };
        let mut items: Vec<_> = (0..boxes.len() as u32).collect();
        if !items.is_empty() {
            tree.add(boxes, &mut items);
            tree.refit();
        }
        tree
    }

    /// Adds the nodes of these items. Their bounds are set later.
    fn add(&mut self, boxes: &[Aabb], items: &mut [u32]) {
        let (place, item) = (self.nodes.len(), items[0]);
        self.nodes.push(Node { bounds: boxes[item as usize], second: 0, item });
        if items.len() == 1 {
            self.places[item as usize] = place as u32;
            return;
        }
        let center = |item: u32| boxes[item as usize].center();
        let mut spread = Aabb::around([Vector3::from(center(item))]);
        for item in &*items {
            spread = spread.with(&Aabb::around([Vector3::from(center(*item))]));
        }
        let width = |k: &usize| spread.high[*k] - spread.low[*k];
        let axis = (0..3).max_by(|a, b| width(a).total_cmp(&width(b)));
        let along = |item: u32| center(item)[axis.unwrap_or(0)];
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| along(*a).total_cmp(&along(*b)).then(a.cmp(b)));
        let (first, second) = items.split_at_mut(half);
        self.add(boxes, first);
        self.nodes[place].second = self.nodes.len() as u32;
        self.add(boxes, second);
    }

    /// Returns the box around all items, if there are any.
    pub fn bounds(&self) -> Option<Aabb> {
        self.nodes.first().map(|root| root.bounds)
    }

    /// Changes the box of an item. [`refit`](Self::refit) must follow.
    pub fn set(&mut self, item: usize, bounds: Aabb) {
        self.nodes[self.places[item] as usize].bounds = bounds;
    }

    /// Fits the boxes of all nodes to those of the items.
    pub fn refit(&mut self) {
        for k in (0..self.nodes.len()).rev() {
            let second = self.nodes[k].second as usize;
            if second != 0 {
                self.nodes[k].bounds = self.nodes[k + 1].bounds.with(&self.nodes[second].bounds);
            }
        }
    }

    /// Visits the items whose boxes meet this one.
    pub fn meeting(&self, bounds: &Aabb, mut visit: impl FnMut(u32)) {
        if !self.nodes.is_empty() {
            self.meeting_below(0, bounds, &mut visit);
        }
    }

    fn meeting_below(&self, place: usize, bounds: &Aabb, visit: &mut impl FnMut(u32)) {
        let node = &self.nodes[place];
        if !node.bounds.meets(bounds) {
            return;
        }
        if node.second == 0 {
            visit(node.item);
        } else {
            self.meeting_below(place + 1, bounds, visit);
            self.meeting_below(node.second as usize, bounds, visit);
        }
    }

    /// Visits each pair of items whose boxes meet, until `visit` returns false. Returns whether it
    /// never did.
    pub fn pairs(&self, mut visit: impl FnMut(u32, u32) -> bool) -> bool {
        // Any two items are below different children of exactly one node.
        let mut nodes = self.nodes.iter().enumerate();
        nodes.all(|(place, node)| {
            let children = [place + 1, node.second as usize];
            node.second == 0 || self.pairs_below(children, self, &mut visit)
        })
    }

    /// Visits each pair of an item and an item of another tree whose boxes meet.
    pub fn pairs_with(&self, other: &Self, mut visit: impl FnMut(u32, u32)) {
        let mut visit = |a, b| {
            visit(a, b);
            true
        };
        if !self.nodes.is_empty() && !other.nodes.is_empty() {
            self.pairs_below([0, 0], other, &mut visit);
        }
    }

    fn pairs_below(
        &self,
        [a, b]: [usize; 2],
        other: &Self,
        visit: &mut impl FnMut(u32, u32) -> bool,
    ) -> bool {
        let (first, second) = (&self.nodes[a], &other.nodes[b]);
        if !first.bounds.meets(&second.bounds) {
            return true;
        }
        let mut below = |a, b| self.pairs_below([a, b], other, visit);
        match (first.second as usize, second.second as usize) {
            (0, 0) => visit(first.item, second.item),
            (0, d) => below(a, b + 1) && below(a, d),
            (c, 0) => below(a + 1, b) && below(c, b),
            (c, d) => below(a + 1, b + 1) && below(a + 1, d) && below(c, b + 1) && below(c, d),
        }
    }

    /// Finds the item with the least squared distance from a point by `measure`, and the other
    /// result of that; of several at the same distance, the first. `None` without items.
    pub fn nearest<T>(
        &self,
        point: &Vector3<f64>,
        measure: impl Fn(u32) -> (f64, T),
    ) -> Option<(u32, T)> {
        self.nodes.first()?;
        let mut best = None;
        self.nearest_below(0, point, &measure, &mut best);
        best.map(|(_, item, found)| (item, found))
    }

    fn nearest_below<T>(
        &self,
        place: usize,
        point: &Vector3<f64>,
        measure: &impl Fn(u32) -> (f64, T),
        best: &mut Option<(f64, u32, T)>,
    ) {
        let Node { second, item, .. } = self.nodes[place];
        if second == 0 {
            let (distance, found) = measure(item);
            if (best.as_ref()).is_none_or(|best| (distance, item) < (best.0, best.1)) {
                *best = Some((distance, item, found));
            }
            return;
        }
        let bound = |place: usize| (self.nodes[place].bounds.squared_distance(point), place);
        let (first, second) = (bound(place + 1), bound(second as usize));
        let nearer_first = if second.0 < first.0 { [second, first] } else { [first, second] };
        for (bound, place) in nearer_first {
            if best.as_ref().is_none_or(|best| bound <= best.0) {
                self.nearest_below(place, point, measure, best);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::SplitMix;

    /// Draws boxes of various sizes at random places of a grid, on which many touch or are equal.
    fn random_boxes(count: usize, random: &mut SplitMix) -> Vec<Aabb> {
        let boxes = (0..count).map(|_| {
            let low = Vector3::from_fn(|_, _| random.between(0.0, 12.0).floor());
            let size = random.between(0.0, 3.0).powi(2);
            let high = low.map(|x| x + random.between(0.0, size).floor());
            Aabb::around([high, low])
        });
        boxes.collect()
    }

    fn sorted<T: Ord>(mut list: Vec<T>) -> Vec<T> {
        list.sort_unstable();
        list
    }

    /// Lists all pairs of items that meet, by comparison of each with each.
    fn all_pairs(first: &[Aabb], second: &[Aabb]) -> Vec<(u32, u32)> {
        let all = (0..first.len()).flat_map(|a| (0..second.len()).map(move |b| (a, b)));
        let meet = all.filter(|(a, b)| first[*a].meets(&second[*b]));
        meet.map(|(a, b)| (a as u32, b as u32)).collect()
    }

    #[test]
    fn trees_find_what_comparing_each_with_each_finds() {
        let mut random = SplitMix(6);
        for count in [0, 1, 2, 3, 7, 64, 200] {
            let mut boxes = random_boxes(count, &mut random);
            let mut tree = Bvh::new(&boxes);
            // First as it was built, then after boxes have moved.
            for _ in 0..2 {
                let mut found = vec![];
                assert!(tree.pairs(|a, b| {
                    found.push((a.min(b), a.max(b)));
                    true
                }));
                let mut expected = all_pairs(&boxes, &boxes);
                expected.retain(|(a, b)| a < b);
                assert_eq!(sorted(found), expected);
                let others = random_boxes(40, &mut random);
                let mut found = vec![];
                tree.pairs_with(&Bvh::new(&others), |a, b| found.push((a, b)));
                let expected = all_pairs(&boxes, &others);
                assert_eq!(sorted(found), expected);
                let mut found = vec![];
                for (b, other) in others.iter().enumerate() {
                    tree.meeting(other, |a| found.push((a, b as u32)));
                }
                assert_eq!(sorted(found), expected);
                for point in &others {
                    let point = Vector3::from(point.low) + Vector3::repeat(0.25);
                    let squared = |k: usize| boxes[k].squared_distance(&point);
                    let least = (0..count)
                        .map(|k| (squared(k), k))
                        .reduce(|a, b| if b.0 < a.0 { b } else { a });
                    let nearest = tree.nearest(&point, |k| (squared(k as usize), ()));
                    let expected = least.map(|(_, k)| (k as u32, ()));
                    assert_eq!(nearest, expected);
                }
                for (k, moved) in random_boxes(count / 2, &mut random).into_iter().enumerate() {
                    boxes[2 * k] = moved;
                    tree.set(2 * k, moved);
                }
                tree.refit();
            }
        }
    }

    #[test]
    fn a_search_ends_when_it_is_told_to() {
        let boxes = [Aabb::around([Vector3::zeros()]); 10];
        let mut left = 7;
        let all = Bvh::new(&boxes).pairs(|_, _| {
            left -= 1;
            left > 0
        });
        assert!(!all && left == 0);
    }
}
