//! Pairs of primitives that may touch: a list that stays valid until a vertex moves farther than a
//! margin.
//!
//! The list is made for straight courses along the velocities of the vertices. It contains all
//! pairs that may touch while no vertex strays from its course by more than a margin, apart from a
//! displacement that all share. It is only a cache: a query returns every pair that is near enough,
//! in one canonical order, and perhaps others, no matter when and from which states the list was
//! made.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::bounds::{Block, LANES};
use super::boxes::Courses;
use super::listing::{CHUNK, Candidate, Listed, Listing};
use super::surface::Surface;
use crate::geometry::PairKind;
use crate::threads::threads;

/// Largest distance of a vertex from its course, as a share of the largest thickness.
const MARGIN_SHARE: f64 = 0.4;

/// Length of the course of the fastest vertex, relative to the mean, as a share of the largest
/// thickness.
const LENGTH_SHARE: f64 = 3.0;

/// Duration of a list, as a multiple of the time for which the previous one was valid.
const HORIZON_RATIO: f64 = 1.5;

/// Least number of vertices for each one that moved too far, with which only those get new courses.
/// With fewer, the whole list is made again.
const VERTICES_PER_RENEWED: usize = 8;

/// Distance, as a share of the margin, from which on a vertex then gets a new course.
const STRAY_SHARE: f64 = 0.25;

/// Longest duration of a list (s).
const MAX_HORIZON: f64 = 1.0;

/// Linear motion of all vertices between two times, which may be equal.
pub(super) struct Stretch<'a> {
    /// Times (s).
    pub times: [f64; 2],
    /// Positions at these times (m).
    pub ends: [&'a [Vector3<f64>]; 2],
    /// Velocities (m/s), if known.
    pub speeds: Option<&'a [Vector3<f64>]>,
}

impl Stretch<'_> {
    /// Returns the velocity of a vertex (m/s); 0 if unknown.
    fn speed(&self, i: usize) -> Vector3<f64> {
        let duration = self.times[1] - self.times[0];
        if duration > 0.0 {
            (self.ends[1][i] - self.ends[0][i]) / duration
        } else {
            self.speeds.map_or_else(Vector3::zeros, |speeds| speeds[i])
        }
    }
}

/// List of pairs.
#[derive(Debug)]
pub(super) struct Candidates {
    /// [`MARGIN_SHARE`] and [`LENGTH_SHARE`].
    shares: [f64; 2],
    listing: Listing,
    pairs: Vec<Listed>,
    /// Time at which the courses begin (s).
    pub begin: f64,
    /// Positions there (m), and velocities (m/s).
    base: Vec<Vector3<f64>>,
    speeds: Vec<Vector3<f64>>,
    /// Mean velocity when all courses were new (m/s).
    mean: Vector3<f64>,
    /// Mean position at the beginning, when all courses were new (m).
    origin: Vector3<f64>,
    /// Whether a vertex has a new course.
    renewed: Vec<bool>,
    /// Duration of the courses (s).
    horizon: f64,
    /// Time for which the previous list was valid (s).
    held: f64,
    /// Length of the last stretch of positive duration (s). Courses of a list for one time begin
    /// this much earlier, because the next stretch is likely to enclose that time.
    back: f64,
    /// Largest distance of a vertex from its course (m).
    margin: f64,
    /// Times since the beginning of the courses that are covered (s).
    since: [f64; 2],
    /// Displacement that all vertices share at the first of them (m).
    shared: Vector3<f64>,
    /// Distance of each vertex from its course at these times, and the largest of these (m).
    travel: Vec<f64>,
    farthest: f64,
    parallel: bool,
}

impl Default for Candidates {
    fn default() -> Self {
        Self {
            shares: [MARGIN_SHARE, LENGTH_SHARE],
            listing: Listing::default(),
            pairs: vec![],
            begin: 0.0,
            base: vec![],
            speeds: vec![],
            mean: Vector3::zeros(),
            origin: Vector3::zeros(),
            renewed: vec![],
            shared: Vector3::zeros(),
            horizon: 0.0,
            held: MAX_HORIZON,
            back: 0.0,
            margin: 0.0,
            since: [0.0; 2],
            travel: vec![],
            farthest: 0.0,
            parallel: false,
        }
    }
}

impl Candidates {
    /// Sets other margins and lengths of courses than [`MARGIN_SHARE`] and [`LENGTH_SHARE`].
    #[cfg(test)]
    pub fn set_shares(&mut self, shares: [f64; 2]) {
        self.shares = shares;
    }

    /// Updates the list so that it contains every pair that comes nearer than its thickness in a
    /// stretch.
    pub fn cover(&mut self, surface: &Surface, stretch: &Stretch) {
        let [first, last] = stretch.times;
        if last > first {
            self.back = last - first;
        }
        let is_ahead = first >= self.begin && last <= self.begin + self.horizon;
        if (is_ahead || first == last) && self.base.len() == stretch.ends[0].len() {
            // Courses have no time of their own. Beyond their end, an instant is compared with them
            // where they were used last: it often is the beginning of the next step.
            self.since =
                if is_ahead { stretch.times.map(|t| t - self.begin) } else { [self.since[1]; 2] };
            self.measure(stretch);
            if self.farthest <= self.margin || self.renew(surface, stretch) {
                return;
            }
        }
        if last - self.begin > self.back {
            self.held = last - self.begin;
        }
        self.make(surface, stretch);
    }

    /// Finds the distance of each vertex from its course in a stretch, apart from a displacement
    /// that all vertices share.
    fn measure(&mut self, stretch: &Stretch) {
        let [first, last] = self.since;
        let [from, to] = stretch.ends;
        let is_point = std::ptr::eq(from, to) && first == last;
        let Self { base, speeds, travel, .. } = self;
        let astray = |x: &[Vector3<f64>], since: f64, i: usize| x[i] - base[i] - speeds[i] * since;
        let count = base.len();
        let mean = |x: &[Vector3<f64>], since: f64| {
            let sum = (0..count).fold(Vector3::zeros(), |sum, i| sum + astray(x, since, i));
            sum / count.max(1) as f64
        };
        travel.clear();
        let shared = mean(from, first);
        self.shared = shared;
        travel.extend((0..count).map(|i| (astray(from, first, i) - shared).norm_squared()));
        if !is_point {
            let shared = mean(to, last);
            for (i, travel) in travel.iter_mut().enumerate() {
                *travel = travel.max((astray(to, last, i) - shared).norm_squared());
            }
        }
        self.farthest = 0.0;
        for travel in travel {
            *travel = travel.sqrt();
            self.farthest = self.farthest.max(*travel);
        }
    }

    /// Gives new courses to the vertices that stray, if they are few, and lists their pairs again.
    /// Returns whether the list then covers the stretch.
    fn renew(&mut self, surface: &Surface, stretch: &Stretch) -> bool {
        let stray = STRAY_SHARE * self.margin;
        self.renewed.clear();
        self.renewed.extend(self.travel.iter().map(|travel| *travel > stray));
        let count = self.renewed.iter().filter(|is_new| **is_new).count();
        if count * VERTICES_PER_RENEWED > self.base.len() {
            return false;
        }
        let [first, _] = self.since;
        for i in (0..self.base.len()).filter(|i| self.renewed[*i]) {
            let speed = stretch.speed(i);
            self.speeds[i] = speed;
            self.base[i] = stretch.ends[0][i] - self.shared - speed * first;
        }
        self.measure(stretch);
        if self.farthest > self.margin {
            return false;
        }
        self.list(surface, true);
        true
    }

    /// Makes a new list, for courses that begin with a stretch.
    fn make(&mut self, surface: &Surface, stretch: &Stretch) {
        let from = stretch.ends[0];
        let duration = stretch.times[1] - stretch.times[0];
        self.speeds.clear();
        self.speeds.extend((0..from.len()).map(|i| stretch.speed(i)));
        let before = if duration > 0.0 { 0.0 } else { self.back };
        self.begin = stretch.times[0] - before;
        self.base.clear();
        let starts = from.iter().zip(&self.speeds).map(|(x, v)| x - v * before);
        self.base.extend(starts);
        let mean =
            |all: &[Vector3<f64>]| all.iter().sum::<Vector3<f64>>() / all.len().max(1) as f64;
        (self.mean, self.origin) = (mean(&self.speeds), mean(&self.base));
        let speeds = self.speeds.iter().map(|v| (v - self.mean).norm_squared());
        let fastest = speeds.fold(0.0, f64::max).sqrt();
        let thickest = surface.thickest();
        let horizon = (self.shares[1] * thickest / fastest).min(HORIZON_RATIO * self.held);
        self.since = stretch.times.map(|t| t - self.begin);
        self.horizon = horizon.min(MAX_HORIZON).max(self.since[1]);
        self.measure(stretch);
        self.margin = (self.shares[0] * thickest).max(2.0 * self.farthest);
        self.parallel = threads(surface.particles()) > 1;
        self.list(surface, false);
    }

    /// Lists pairs again: all, or those of vertices with new courses.
    fn list(&mut self, surface: &Surface, some: bool) {
        let course = Courses {
            base: &self.base,
            speeds: &self.speeds,
            mean: self.mean,
            origin: self.origin,
            horizon: self.horizon,
            reach: 2.0 * self.margin,
        };
        let renewed = some.then_some(&self.renewed[..]);
        self.listing.list(surface, &course, renewed, self.parallel, &mut self.pairs);
    }

    /// Returns whether a pair may come nearer than its thickness and a gap (m) in the stretch
    /// covered last.
    fn is_near(&self, pair: &Listed, gap: f64) -> bool {
        let room = pair.gap(self.since) - gap;
        room < 2.0 * self.farthest && room < pair.candidate.approach(&self.travel)
    }

    /// Returns the pairs, in canonical order, that may come nearer than their thickness and a gap
    /// (m), which is at most 0, in the stretch covered last.
    pub fn near(&self, gap: f64) -> impl Iterator<Item = &Candidate> {
        let near = self.pairs.iter().filter(move |pair| self.is_near(pair, gap));
        near.map(|pair| &pair.candidate)
    }

    /// Calls `find` for those of these pairs that may come nearer than a distance (m) in a motion,
    /// and `visit` for its results in their order. Pairs without a distance are left out. With many
    /// vertices, several threads call `find`.
    pub fn each<R: Send>(
        &self,
        gap: f64,
        motion: &Linear,
        distance: impl Fn(&Candidate) -> Option<f64> + Sync,
        find: impl Fn(&Candidate) -> Option<R> + Sync,
        mut visit: impl FnMut(R),
    ) {
        let search = |pairs: &[Listed], visit: &mut dyn FnMut(R)| {
            let near = pairs.iter().filter(|pair| self.is_near(pair, gap));
            motion.nearing(near.map(|pair| &pair.candidate), &distance, |candidate| {
                find(candidate).into_iter().for_each(&mut *visit);
            });
        };
        if self.parallel {
            let chunks = self.pairs.par_chunks(CHUNK);
            let found: Vec<Vec<R>> = chunks
                .map(|pairs| {
                    let mut found = vec![];
                    search(pairs, &mut |result| found.push(result));
                    found
                })
                .collect();
            found.into_iter().flatten().for_each(visit);
        } else {
            search(&self.pairs, &mut visit);
        }
    }
}

/// Linear motion of vertices.
pub(super) struct Linear<'a> {
    /// Positions at its beginning (m).
    pub x: &'a [Vector3<f64>],
    /// Displacements (m); none at an instant.
    pub moves: Option<&'a [Vector3<f64>]>,
    /// Bound of rounding errors of distances (m).
    pub rounding: f64,
}

impl Linear<'_> {
    /// Visits those of some pairs, in their order, that may come nearer than their distance (m).
    fn nearing<'a>(
        &self,
        pairs: impl Iterator<Item = &'a Candidate>,
        distance: &impl Fn(&Candidate) -> Option<f64>,
        mut visit: impl FnMut(&Candidate),
    ) {
        let mut block = Block::new();
        let mut members: [Option<(&Candidate, f64)>; LANES] = [None; LANES];
        let mut count = 0;
        let wanted = pairs.filter_map(|pair| Some((pair, distance(pair)?)));
        let mut wanted = wanted.peekable();
        while let Some((pair, distance)) = wanted.next() {
            if pair.kind == PairKind::VertexFloor {
                visit(pair);
                continue;
            }
            block.set(count, pair.points, self.x, self.moves);
            members[count] = Some((pair, distance));
            count += 1;
            if count < LANES && wanted.peek().is_some_and(|(next, _)| next.kind == pair.kind) {
                continue;
            }
            block.bound(pair.kind);
            for (lane, (pair, distance)) in members[..count].iter().flatten().enumerate() {
                let nearest = block.distance[lane] - block.closing[lane].max(0.0);
                if !nearest.is_finite() || nearest - self.rounding < *distance {
                    visit(pair);
                }
            }
            count = 0;
        }
    }
}
