//! Pairs of primitives that may touch: a list that stays valid until a vertex moves farther than a
//! margin.
//!
//! The list is made for straight courses, on which vertices go on with their velocities. It has all
//! pairs that may touch while no vertex strays from its course by more than a margin, apart from a
//! displacement that all share. It is a cache and nothing else: who asks it gets every pair that is
//! near enough, in one canonical order, and perhaps others, whenever and from whatever states it
//! was made.

use nalgebra::Vector3;
use rayon::prelude::*;

use super::boxes::Course;
use super::listing::{CHUNK, Candidate, Listed, Listing};
use super::surface::Surface;
use crate::threads::threads;

/// How far a vertex may stray from its course, as a share of the largest thickness.
const MARGIN: f64 = 0.4;

/// How far the fastest vertex, relative to the mean, goes on the courses for which a list is made,
/// as a share of the largest thickness.
const LENGTH: f64 = 4.0;

/// Time for which a list is made, as a share of that for which the one before it held.
const HOLDING: f64 = 1.5;

/// Only the vertices that moved too far get new courses, if they are at most 1 / FEW of all.
const FEW: usize = 8;

/// Share of the margin from which on a vertex then gets a new course.
const STRAY: f64 = 0.5;

/// Longest time for which a list is made (s).
const LONGEST: f64 = 1.0;

/// Motion of all vertices in straight lines between two times, which may be the same one.
pub(super) struct Stretch<'a> {
    /// Times (s).
    pub times: [f64; 2],
    /// Positions at these times (m).
    pub ends: [&'a [Vector3<f64>]; 2],
    /// Velocities (m/s), if they are known.
    pub speeds: Option<&'a [Vector3<f64>]>,
}

impl Stretch<'_> {
    /// Velocity of a vertex (m/s); 0 if it is not known.
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
    /// [`MARGIN`] and [`LENGTH`].
    shares: [f64; 2],
    listing: Listing,
    pairs: Vec<Listed>,
    /// Time at which the courses begin (s).
    begin: f64,
    /// Positions there (m), and velocities (m/s).
    base: Vec<Vector3<f64>>,
    speeds: Vec<Vector3<f64>>,
    /// Mean velocity when all courses were new (m/s).
    mean: Vector3<f64>,
    /// Whether a vertex has a new course.
    renewed: Vec<bool>,
    /// Time for which the courses go on (s).
    horizon: f64,
    /// Time for which the list before this one held (s).
    held: f64,
    /// Length of the last stretch that was not a point in time (s): the courses begin so long
    /// before such a point, because what follows is likely the stretch around it.
    back: f64,
    /// How far a vertex may stray (m).
    margin: f64,
    /// Times since the beginning that are covered (s).
    since: [f64; 2],
    /// Displacement that all vertices share at the first of them (m).
    shared: Vector3<f64>,
    /// How far each vertex strays in them, and the most of that (m).
    travel: Vec<f64>,
    farthest: f64,
    parallel: bool,
}

impl Default for Candidates {
    fn default() -> Self {
        Self {
            shares: [MARGIN, LENGTH],
            listing: Listing::default(),
            pairs: vec![],
            begin: 0.0,
            base: vec![],
            speeds: vec![],
            mean: Vector3::zeros(),
            renewed: vec![],
            shared: Vector3::zeros(),
            horizon: 0.0,
            held: LONGEST,
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
    /// Gives the list other margins and lengths of courses than [`MARGIN`] and [`LENGTH`].
    #[cfg(test)]
    pub fn set_shares(&mut self, shares: [f64; 2]) {
        self.shares = shares;
    }

    /// Makes sure that the list has every pair that comes nearer than its thickness in a stretch.
    pub fn cover(&mut self, surface: &Surface, stretch: &Stretch) {
        let [first, last] = stretch.times;
        if last > first {
            self.back = last - first;
        }
        let is_ahead = first >= self.begin
            && last <= self.begin + self.horizon
            && self.base.len() == stretch.ends[0].len();
        if is_ahead {
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

    /// Finds how far each vertex strays from its course in a stretch. A displacement that all
    /// vertices share is none.
    fn measure(&mut self, stretch: &Stretch) {
        self.since = stretch.times.map(|t| t - self.begin);
        let [first, last] = self.since;
        let [from, to] = stretch.ends;
        let is_point = std::ptr::eq(from, to) && first == last;
        let Self {
            base,
            speeds,
            travel,
            ..
        } = self;
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

    /// Gives new courses to the vertices that stray, if they are few, and lists their pairs anew.
    /// Returns whether the list covers a stretch then.
    fn renew(&mut self, surface: &Surface, stretch: &Stretch) -> bool {
        let stray = STRAY * self.margin;
        self.renewed.clear();
        self.renewed
            .extend(self.travel.iter().map(|travel| *travel > stray));
        let count = self.renewed.iter().filter(|is_new| **is_new).count();
        if count * FEW > self.base.len() {
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

    /// Makes the list anew, for courses that begin with a stretch.
    fn make(&mut self, surface: &Surface, stretch: &Stretch) {
        let from = stretch.ends[0];
        let duration = stretch.times[1] - stretch.times[0];
        self.speeds.clear();
        self.speeds
            .extend((0..from.len()).map(|i| stretch.speed(i)));
        let before = if duration > 0.0 { 0.0 } else { self.back };
        self.begin = stretch.times[0] - before;
        self.base.clear();
        let starts = from.iter().zip(&self.speeds).map(|(x, v)| x - v * before);
        self.base.extend(starts);
        self.mean = self.speeds.iter().sum::<Vector3<f64>>() / from.len().max(1) as f64;
        let speeds = self.speeds.iter().map(|v| (v - self.mean).norm_squared());
        let fastest = speeds.fold(0.0, f64::max).sqrt();
        let thickest = surface.thickest();
        let horizon = (self.shares[1] * thickest / fastest).min(HOLDING * self.held);
        self.horizon = horizon.min(LONGEST).max(stretch.times[1] - self.begin);
        self.measure(stretch);
        self.margin = (self.shares[0] * thickest).max(2.0 * self.farthest);
        self.parallel = threads(surface.particles()) > 1;
        self.list(surface, false);
    }

    /// Lists the pairs anew: all, or those of vertices with new courses.
    fn list(&mut self, surface: &Surface, some: bool) {
        let course = Course {
            base: &self.base,
            speeds: &self.speeds,
            mean: self.mean,
            horizon: self.horizon,
            reach: 2.0 * self.margin,
        };
        let renewed = some.then_some(&self.renewed[..]);
        self.listing
            .list(surface, &course, renewed, self.parallel, &mut self.pairs);
    }

    /// Whether a pair may come nearer than a gap beyond its thickness (m) in what was covered last.
    fn is_near(&self, pair: &Listed, gap: f64) -> bool {
        let room = pair.gap(self.since) - gap;
        room < 2.0 * self.farthest && room < pair.candidate.approach(&self.travel)
    }

    /// The pairs, in canonical order, that may come nearer than a gap beyond their thickness (m),
    /// which is at most 0, in the stretch that was covered last.
    pub fn near(&self, gap: f64) -> impl Iterator<Item = &Candidate> {
        let near = self
            .pairs
            .iter()
            .filter(move |pair| self.is_near(pair, gap));
        near.map(|pair| &pair.candidate)
    }

    /// Visits what `find` has found for these pairs, in their order. Where there are many vertices,
    /// `find` is called by several threads.
    pub fn each<R: Send>(
        &self,
        gap: f64,
        find: impl Fn(&Candidate) -> Option<R> + Sync,
        visit: impl FnMut(R),
    ) {
        if self.parallel {
            let chunks = self.pairs.par_chunks(CHUNK);
            let found: Vec<R> = chunks
                .flat_map_iter(|pairs| {
                    let near = pairs.iter().filter(|pair| self.is_near(pair, gap));
                    near.filter_map(|pair| find(&pair.candidate))
                })
                .collect();
            found.into_iter().for_each(visit);
        } else {
            self.near(gap).filter_map(find).for_each(visit);
        }
    }
}
