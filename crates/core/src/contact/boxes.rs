//! Courses of vertices, and trees of the boxes around primitives on them.
//!
//! The leaves are blocks of sixteen boxes in single precision, which SIMD vectors compare at once.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::surface::Surface;
use crate::geometry::bvh::{Aabb, Bvh};
use crate::vectors::Arch;

/// Number of boxes in a block, a multiple of the lengths of all SIMD vectors.
const LANES: usize = 16;

/// One bit for each box of a block.
const BITS: [f32; LANES] = [
    1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0, 256.0, 512.0, 1024.0, 2048.0, 4096.0, 8192.0,
    16384.0, 32768.0,
];

/// Largest magnitude of a coordinate of a box (m), whose square is finite in single precision.
/// Other coordinates are clamped to it, which makes no distance larger.
const FARTHEST: f64 = 1e18;

/// Factor by which squared distances in single precision may be too large.
const ROUNDING: f64 = 1.0 + 1e-6;

/// Straight courses of all vertices, from which they may stray by half of the reach.
pub(super) struct Courses<'a> {
    /// Positions at the beginning (m).
    pub base: &'a [Vector3<f64>],
    /// Velocities (m/s).
    pub speeds: &'a [Vector3<f64>],
    /// Mean velocity (m/s).
    pub mean: Vector3<f64>,
    /// Position that boxes are relative to (m).
    pub origin: Vector3<f64>,
    /// Duration of the courses (s).
    pub horizon: f64,
    /// Gap below which pairs are listed (m).
    pub reach: f64,
}

impl Courses<'_> {
    /// Returns the box around the course of a vertex.
    pub fn around(&self, surface: &Surface, i: usize) -> Bounds {
        let begin = self.base[i] - self.origin;
        let end = begin + (self.speeds[i] - self.mean) * self.horizon;
        let radius = surface.radius(i as u32);
        let (mut low, mut high) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
        for (t, x) in [begin, end].into_iter().enumerate() {
            for k in 0..3 {
                low[t][k] = single(x[k] - radius).next_down();
                high[t][k] = single(x[k] + radius).next_up();
            }
        }
        Bounds { low, high }
    }
}

fn single(x: f64) -> f32 {
    x.abs().min(FARTHEST).copysign(x) as f32
}

/// Axis-aligned boxes at the beginning and at the end of the courses (m).
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    low: [[f32; 3]; 2],
    high: [[f32; 3]; 2],
}

impl Bounds {
    fn with(mut self, other: &Self) -> Self {
        for t in 0..2 {
            for k in 0..3 {
                self.low[t][k] = least(self.low[t][k], other.low[t][k]);
                self.high[t][k] = most(self.high[t][k], other.high[t][k]);
            }
        }
        self
    }

    /// Returns the box around the boxes at both ends.
    fn hull(&self) -> Aabb {
        let ([a, b], [c, d]) = (self.low, self.high);
        Aabb::around([a, b, c, d].map(|x| Vector3::from(x.map(f64::from))))
    }
}

/// Returns the smaller of two numbers, by one instruction.
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// Returns the larger of two numbers, by one instruction.
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// Boxes of up to sixteen primitives.
#[derive(Clone, Debug)]
struct BoxBlock {
    /// Lowest and highest coordinates (m): end of the courses, axis, box. Those of boxes that are
    /// missing are infinite, so that nothing is near them.
    low: [[[f32; LANES]; 3]; 2],
    high: [[[f32; LANES]; 3]; 2],
}

impl BoxBlock {
    fn new() -> Self {
        Self { low: [[[f32::INFINITY; LANES]; 3]; 2], high: [[[f32::NEG_INFINITY; LANES]; 3]; 2] }
    }

    #[inline(always)]
    fn get(&self, lane: usize) -> Bounds {
        let (mut low, mut high) = ([[0.0; 3]; 2], [[0.0; 3]; 2]);
        for t in 0..2 {
            for k in 0..3 {
                low[t][k] = self.low[t][k][lane];
                high[t][k] = self.high[t][k][lane];
            }
        }
        Bounds { low, high }
    }

    fn set(&mut self, lane: usize, bounds: &Bounds) {
        for t in 0..2 {
            for k in 0..3 {
                self.low[t][k][lane] = bounds.low[t][k];
                self.high[t][k][lane] = bounds.high[t][k];
            }
        }
    }

    /// Returns the box around all boxes.
    fn whole(&self) -> Bounds {
        let mut whole = self.get(0);
        for t in 0..2 {
            for k in 0..3 {
                for lane in 1..LANES {
                    whole.low[t][k] = least(whole.low[t][k], self.low[t][k][lane]);
                    whole.high[t][k] = most(whole.high[t][k], self.high[t][k][lane]);
                }
            }
        }
        whole
    }

    /// Finds the boxes of the block whose contents may come nearer to those of a box than a squared
    /// distance (m2), as bits: along an axis, the gap between points on straight courses is
    /// smallest at an end.
    #[inline(always)]
    fn near<S: Simd>(&self, simd: S, other: &Bounds, squared: f32) -> u32 {
        let (zero, squared) = (simd.splat_f32s(0.0), simd.splat_f32s(squared));
        let mut bits = 0.0;
        for part in 0..LANES / S::F32_LANES {
            let mut sum = zero;
            // Closures would not be inlined.
            for k in 0..3 {
                let gap = simd.max_f32s(
                    simd.min_f32s(
                        simd.sub_f32s(
                            load(simd, &self.low[0][k], part),
                            simd.splat_f32s(other.high[0][k]),
                        ),
                        simd.sub_f32s(
                            load(simd, &self.low[1][k], part),
                            simd.splat_f32s(other.high[1][k]),
                        ),
                    ),
                    simd.min_f32s(
                        simd.sub_f32s(
                            simd.splat_f32s(other.low[0][k]),
                            load(simd, &self.high[0][k], part),
                        ),
                        simd.sub_f32s(
                            simd.splat_f32s(other.low[1][k]),
                            load(simd, &self.high[1][k], part),
                        ),
                    ),
                );
                let gap = simd.max_f32s(gap, zero);
                sum = simd.add_f32s(sum, simd.mul_f32s(gap, gap));
            }
            let is_near = simd.less_than_f32s(sum, squared);
            bits += simd.reduce_sum_f32s(simd.select_f32s(is_near, load(simd, &BITS, part), zero));
        }
        bits as u32
    }
}

/// Reads SIMD vector number `part` of these numbers.
#[inline(always)]
fn load<S: Simd>(simd: S, numbers: &[f32; LANES], part: usize) -> S::f32s {
    let _ = simd;
    S::as_simd_f32s(numbers).0[part]
}

/// Tree of the boxes of primitives of one kind. Its topology is that of the first positions.
#[derive(Debug, Default)]
pub(super) struct Tree {
    /// Tree of the blocks.
    bvh: Bvh,
    blocks: Vec<BoxBlock>,
    /// Boxes around all boxes of each block.
    wholes: Vec<Bounds>,
    /// Primitives, block by block, and the place of each in that order.
    order: Vec<u32>,
    places: Vec<u32>,
    /// Boxes of each block that the last update changed, as bits.
    changed: Vec<u32>,
    /// Half of the distance up to which boxes are near (m).
    half: f64,
}

impl Tree {
    /// Updates the boxes of those primitives, given by their points, whose courses are new:
    /// `around` has the boxes of all vertices. Boxes are near within a `reach` (m).
    pub fn take<const N: usize>(
        &mut self,
        primitives: impl ExactSizeIterator<Item = [u32; N]> + Clone,
        around: &[Bounds],
        reach: f64,
        is_new: &impl Fn(&[u32]) -> bool,
    ) {
        self.half = 0.5 * reach;
        let bounds = |points: [u32; N]| {
            let mut bounds = around[points[0] as usize];
            for i in &points[1..] {
                bounds = bounds.with(&around[*i as usize]);
            }
            bounds
        };
        let first = self.order.len() != primitives.len();
        if first {
            self.plant(primitives.clone(), around);
        }
        self.changed.clear();
        self.changed.resize(self.blocks.len(), 0);
        for (points, place) in primitives.zip(&self.places) {
            if first || is_new(&points) {
                let place = *place as usize;
                self.blocks[place / LANES].set(place % LANES, &bounds(points));
                self.changed[place / LANES] |= 1 << (place % LANES);
            }
        }
        for number in 0..self.blocks.len() {
            if self.changed[number] != 0 {
                self.wholes[number] = self.blocks[number].whole();
                self.bvh.set(number, self.leaf(number));
            }
        }
        self.bvh.refit();
    }

    /// Makes a tree of primitives, with the boxes of all vertices: in the order of a curve through
    /// their first vertices.
    fn plant<const N: usize>(
        &mut self,
        primitives: impl Iterator<Item = [u32; N]>,
        around: &[Bounds],
    ) {
        let hulls: Vec<_> = primitives.map(|points| around[points[0] as usize].hull()).collect();
        let whole = hulls.iter().copied().reduce(|a, b| a.with(&b));
        let along = |hull: &Aabb| whole.as_ref().map_or(0, |whole| whole.place_of(hull));
        let keys: Vec<u64> = hulls.iter().map(along).collect();
        self.order = (0..keys.len() as u32).collect();
        self.order.sort_by_key(|k| keys[*k as usize]);
        self.places = vec![0; self.order.len()];
        for (place, k) in self.order.iter().enumerate() {
            self.places[*k as usize] = place as u32;
        }
        // The boxes of the blocks, which are set later, lie where those of their first primitives
        // do.
        let firsts = self.order.iter().step_by(LANES);
        let hulls: Vec<_> = firsts.map(|k| hulls[*k as usize]).collect();
        self.blocks = vec![BoxBlock::new(); hulls.len()];
        self.wholes = self.blocks.iter().map(BoxBlock::whole).collect();
        self.bvh = Bvh::new(&hulls);
    }

    /// Returns a block's box in the tree: around its boxes at both ends, grown by half the reach.
    fn leaf(&self, number: usize) -> Aabb {
        self.wholes[number].hull().grown(self.half)
    }

    /// Returns the primitives of a block.
    fn members(&self, block: u32) -> &[u32] {
        let first = block as usize * LANES;
        &self.order[first..self.order.len().min(first + LANES)]
    }

    /// Finds the pairs of blocks that may hold near boxes, of this tree and another, or of one tree
    /// alone, where each pair is found once: all, or only those with a box that changed.
    pub fn blocks_near(&self, other: &Self, changed: bool, pairs: &mut Vec<[u32; 2]>) {
        let is_one = std::ptr::eq(self, other);
        pairs.clear();
        if changed {
            for s in self.changed_blocks() {
                other.bvh.meeting(&self.leaf(s as usize), |t| {
                    if !is_one || s <= t || self.changed[t as usize] == 0 {
                        pairs.push([s, t]);
                    }
                });
            }
            for t in other.changed_blocks().filter(|_| !is_one) {
                self.bvh.meeting(&other.leaf(t as usize), |s| {
                    if self.changed[s as usize] == 0 {
                        pairs.push([s, t]);
                    }
                });
            }
        } else if is_one {
            pairs.extend((0..self.blocks.len() as u32).map(|s| [s; 2]));
            self.bvh.pairs(|s, t| {
                pairs.push([s, t]);
                true
            });
        } else {
            self.bvh.pairs_with(&other.bvh, |s, t| pairs.push([s, t]));
        }
    }

    fn changed_blocks(&self) -> impl Iterator<Item = u32> {
        let all = self.changed.iter().enumerate();
        all.filter(|(_, changed)| **changed != 0).map(|(s, _)| s as u32)
    }
}

/// Search for the pairs of primitives whose boxes are near, in pairs of blocks of two trees. Of
/// one tree, each pair is found once.
pub(super) struct Meeting<'a> {
    pub trees: [&'a Tree; 2],
    /// Whether only pairs with a box that changed are searched for.
    pub changed: bool,
    pub blocks: &'a [[u32; 2]],
    pub found: &'a mut Vec<[u32; 2]>,
}

impl Meeting<'_> {
    /// Adds the pairs to `found`.
    pub fn find(self) {
        Arch::new().dispatch(self);
    }
}

impl WithSimd for Meeting<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let [first, second] = self.trees;
        let is_one = std::ptr::eq(first, second);
        let squared = ((2.0 * first.half).powi(2) * ROUNDING) as f32;
        for [s, t] in self.blocks {
            let (own, other) = (&first.blocks[*s as usize], &second.blocks[*t as usize]);
            let [own_members, members] = [first.members(*s), second.members(*t)];
            let [own_changed, changed] = if self.changed {
                [first.changed[*s as usize], second.changed[*t as usize]]
            } else {
                [u32::MAX; 2]
            };
            // Most boxes are far from all boxes of the other block.
            let mut left = own.near(simd, &second.wholes[*t as usize], squared);
            while left != 0 {
                let lane = left.trailing_zeros();
                left &= left - 1;
                let is_changed = own_changed >> lane & 1 != 0;
                if !is_changed && changed == 0 {
                    continue;
                }
                let mut near = other.near(simd, &own.get(lane as usize), squared);
                if !is_changed {
                    near &= changed;
                }
                if is_one && s == t {
                    // Those after this one.
                    near &= !1 << lane;
                }
                let k = own_members[lane as usize];
                while near != 0 {
                    let l = members[near.trailing_zeros() as usize];
                    near &= near - 1;
                    self.found.push([k, l]);
                }
            }
        }
    }
}
