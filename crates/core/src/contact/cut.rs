//! Cuts: displacements that impulses have left too long are truncated at planes (Wang et al.,
//! *Planar divide and truncate*).
//!
//! Each pair that still comes too near gets the plane between its closest points at the beginning
//! of the step. Kinematic vertices keep their displacement; any other vertex is stopped on its side
//! of the plane, by a factor of its displacement. A pair with a plane stays apart even if its
//! vertices are stopped earlier for other pairs. Therefore each round gives a plane to a pair that
//! had none, and at worst all pairs get one. The points of rigid bodies move along arcs, for which
//! a plane may not be enough: if such a pair still comes too near, its factors are halved.

use std::collections::BTreeSet;

use super::advance::rounding_error;
use super::candidates::Candidates;
use super::listing::Candidate;
use super::motion::Motion;
use super::solids::Field;
use super::surface::Surface;
use crate::error::Vertex;
use crate::geometry::{PairKind, closest, weighted};

/// Pair between which kinematic vertices leave no room: a vertex of either primitive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pinched {
    /// Vertices.
    pub vertices: [Vertex; 2],
}

/// Scratch of cuts.
#[derive(Debug, Default)]
pub(super) struct Cuts {
    before: Field,
    shares: Vec<f64>,
}

impl Cuts {
    /// Shortens displacements so that no pair comes too near. Returns the number of shortened
    /// displacements, and the sum of the magnitudes of the momentum that they lose (N s). If
    /// kinematic vertices leave no room, displacements stay as they are.
    pub fn cut(
        &mut self,
        surface: &Surface,
        candidates: &mut Candidates,
        motion: &mut Motion,
    ) -> Result<(usize, f64), Pinched> {
        self.before.clone_from(&motion.moves);
        self.shares.clear();
        self.shares.resize(motion.moves.len(), 1.0);
        let mut held = BTreeSet::new();
        let mut pinched = Ok(());
        loop {
            motion.cover(surface, candidates);
            let mut new = false;
            for pair in candidates.near(surface.nearest()) {
                let key = (pair.kind, pair.points);
                let is_rigid = pair.points.iter().any(|i| surface.solid(*i).is_some());
                if (held.contains(&key) && !is_rigid) || motion.impact(surface, pair).is_none() {
                    continue;
                }
                if held.insert(key) {
                    new = true;
                    pinched = pinched.and(self.separate(surface, pair, motion));
                } else {
                    new |= self.halve(surface, pair, motion);
                }
            }
            if let Err(pinched) = pinched {
                motion.moves.clone_from(&self.before);
                motion.cover(surface, candidates);
                return Err(pinched);
            }
            if !new {
                break;
            }
            self.shorten(motion);
        }
        let (mut vertices, mut lost) = (0, 0.0);
        for (i, share) in self.shares.iter().enumerate() {
            // For a rigid body, its centre counts.
            if *share < 1.0 && motion.inverse_masses[i] > 0.0 {
                vertices += 1;
                lost += motion.v[i].norm() * (1.0 - share) / motion.inverse_masses[i];
                let taken = motion.v[i] * ((share - 1.0) / motion.inverse_masses[i]);
                motion.impulses.add(i, taken);
                motion.v[i] *= *share;
            }
        }
        for (k, solid) in motion.solids.iter().enumerate() {
            motion.v.turns[k] *= self.shares[solid.center];
        }
        Ok((vertices, lost))
    }

    /// Multiplies the displacement of each vertex by its factor; that of a rigid body by the
    /// smallest factor of its vertices.
    fn shorten(&mut self, motion: &mut Motion) {
        for solid in &motion.solids {
            let all = solid.points.clone().chain([solid.center]);
            let least = all.clone().map(|i| self.shares[i]).fold(1.0, f64::min);
            all.for_each(|i| self.shares[i] = least);
        }
        let moves = motion.moves.points.iter_mut();
        for ((moved, before), share) in moves.zip(&self.before.points).zip(&self.shares) {
            *moved = before * *share;
        }
        for k in 0..motion.solids.len() {
            let share = self.shares[motion.solids[k].center];
            if share < 1.0 {
                let whole = self.before.turns[k];
                motion.moves.turns[k] = motion.solids[k].shortened(whole, share);
                motion.rotate_points(k);
            }
        }
    }

    /// Halves the factors of a pair that comes too near in spite of its plane; below a thousandth,
    /// they become 0. Returns whether any factor changed.
    fn halve(&mut self, surface: &Surface, pair: &Candidate, motion: &Motion) -> bool {
        let mut halved = false;
        for i in pair.points {
            let share = &mut self.shares[i as usize];
            if *share > 0.0 && !motion.is_kinematic(surface, i) {
                *share = if *share < 1e-3 { 0.0 } else { 0.5 * *share };
                halved = true;
            }
        }
        halved
    }

    /// Shortens the displacements of a pair at the plane between its primitives.
    fn separate(
        &mut self,
        surface: &Surface,
        pair: &Candidate,
        motion: &Motion,
    ) -> Result<(), Pinched> {
        let x = pair.of(&motion.x0);
        let moves = pair.of(&self.before);
        let kinematic = pair.points.map(|i| motion.is_kinematic(surface, i));
        let first = pair.kind.first();
        // Number of points that count: a floor has one.
        let last = if pair.kind == PairKind::VertexFloor { 2 } else { 4 };
        let near = closest(pair.kind, &x);
        let distance = near.offset.norm();
        let normal = near.offset / distance;
        let kept = Motion::kept(surface, pair, &x);
        // Approach of either side to the other, of all vertices or of kinematic ones only.
        let approach = |k: usize| {
            let towards = if k < first { -moves[k] } else { moves[k] };
            towards.dot(&normal).max(0.0)
        };
        let most = |range: std::ops::Range<usize>, only_kinematic: bool| {
            let counted = range.filter(|k| !only_kinematic || kinematic[*k]);
            counted.map(approach).fold(0.0, f64::max)
        };
        let [first_kinematic, second_kinematic] = [most(0..first, true), most(first..last, true)];
        let [first_all, second_all] = [most(0..first, false), most(first..last, false)];
        let room = distance - kept;
        let free = room - first_kinematic - second_kinematic;
        if free < -(rounding_error(&x) + rounding_error(&moves)) {
            let vertices = [0..first, first..last].map(|mut side| {
                let k = side.clone().find(|k| kinematic[*k]);
                surface.vertex(pair.points[k.or(side.next()).unwrap_or(0)])
            });
            return Err(Pinched { vertices });
        }
        let wishes = [first_all - first_kinematic, second_all - second_kinematic];
        let sum = wishes[0] + wishes[1];
        let share = if sum > 0.0 { wishes[1] / sum } else { 0.5 };
        let mut second_points = near.weights;
        second_points[..first].fill(0.0);
        let foot = -weighted(&second_points, &x).dot(&normal);
        let second_end = foot + second_kinematic + free.max(0.0) * share;
        let first_end = second_end + kept;
        for k in 0..last {
            if kinematic[k] {
                continue;
            }
            let (at, by) = (x[k].dot(&normal), moves[k].dot(&normal));
            let end = if k < first { first_end } else { second_end };
            let passes = if k < first { at + by < end } else { at + by > end };
            if passes && by != 0.0 {
                let share = ((end - at) / by).clamp(0.0, 1.0) * (1.0 - 1e-12);
                let i = pair.points[k] as usize;
                self.shares[i] = self.shares[i].min(share);
            }
        }
        Ok(())
    }
}
