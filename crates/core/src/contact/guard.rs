//! Guard after a step: no two primitives pass through one another.
//!
//! Vertices move in straight lines from the state at the beginning of the step to that at its end.
//! Friction holds pairs that the contact force keeps apart. Then pairs that would come too near get
//! inelastic impulses with Coulomb friction, in canonical order and in several passes (Bridson,
//! Fedkiw, Anderson, *Robust treatment of collisions, contact and friction for cloth animation*,
//! 2002). What is left after them is [cut](super::cut).

use std::ops::AddAssign;

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use super::candidates::Candidates;
use super::closest::{closest, weighted};
use super::cut::Squeezed;
use super::layer::{ContactLayer, Scratch};
use super::listing::Candidate;
use super::motion::Motion;
use super::repulsion::Pair;
use super::surface::Surface;

/// Passes of impulses before what is left is cut.
const PASSES: usize = 12;

/// Passes of friction between surfaces that the contact force keeps apart.
const FRICTION_PASSES: usize = 4;

/// What the guard did in a step.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Guarded {
    /// Number of impulses.
    pub impulses: usize,
    /// Sum of the magnitudes of the impulses and of friction (N s).
    pub impulse: f64,
    /// Number of vertices whose way was cut.
    pub cuts: usize,
    /// Sum of the magnitudes of the momentum that cuts took (N s).
    pub lost: f64,
    /// Share of the step at which the first impulse was needed; 1 if none was.
    pub first: f64,
}

impl Default for Guarded {
    fn default() -> Self {
        Self {
            impulses: 0,
            impulse: 0.0,
            cuts: 0,
            lost: 0.0,
            first: 1.0,
        }
    }
}

impl AddAssign for Guarded {
    fn add_assign(&mut self, other: Self) {
        self.impulses += other.impulses;
        self.impulse += other.impulse;
        self.cuts += other.cuts;
        self.lost += other.lost;
        self.first = self.first.min(other.first);
    }
}

/// Direction of a pair's contact: the weights of its closest points, the normal from the second
/// primitive to the first, and the sum of the weighted inverse masses (1/kg).
struct Contact {
    points: [u32; 4],
    weights: [f64; 4],
    normal: Vector3<f64>,
    inverse_mass: f64,
}

impl Contact {
    fn new(points: [u32; 4], weights: [f64; 4], normal: Vector3<f64>, motion: &Motion) -> Self {
        let inverse_masses = points.map(|i| motion.inverse_masses[i as usize]);
        let terms = weights.iter().zip(inverse_masses).map(|(w, m)| w * w * m);
        Self {
            points,
            weights,
            normal,
            inverse_mass: terms.sum(),
        }
    }

    /// The relative vector of the closest points.
    fn relative(&self, all: &[Vector3<f64>]) -> Vector3<f64> {
        weighted(&self.weights, &self.points.map(|i| all[i as usize]))
    }

    /// Changes the relative vector of the closest points by `change`.
    fn apply(&self, change: Vector3<f64>, inverse_masses: &[f64], all: &mut [Vector3<f64>]) {
        let by = change / self.inverse_mass;
        for (i, weight) in self.points.iter().zip(self.weights) {
            let i = *i as usize;
            if inverse_masses[i] > 0.0 && weight != 0.0 {
                all[i] += by * (weight * inverse_masses[i]);
            }
        }
    }

    /// Stops an approach, and by friction at most mu times as much of a slip. Returns the impulse's
    /// magnitude over the effective mass, 0 if there was no approach.
    fn stop(&self, friction: f64, inverse_masses: &[f64], all: &mut [Vector3<f64>]) -> f64 {
        let relative = self.relative(all);
        let approach = -relative.dot(&self.normal);
        if approach <= 0.0 {
            return 0.0;
        }
        let slip = relative + self.normal * approach;
        let held = hold(slip, friction * approach);
        let change = self.normal * approach - held;
        self.apply(change, inverse_masses, all);
        change.norm()
    }
}

/// The part of a slip that friction takes, which is at most so long.
fn hold(slip: Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = slip.norm();
    if length > most {
        slip * (most / length)
    } else {
        slip
    }
}

impl ContactLayer {
    /// Guards the step of h (s) from the state y0 at time t (s) to y1, which it changes where
    /// surfaces would pass through one another or friction acts. Inverse masses are in 1/kg.
    ///
    /// # Errors
    /// Vertices that are led leave no room.
    pub(crate) fn guard(
        &self,
        inverse_masses: &[f64],
        (t, h): (f64, f64),
        y0: &[f64],
        y1: &mut [f64],
    ) -> Result<Guarded, Squeezed> {
        self.with_scratch(|scratch| self.guard_with(scratch, inverse_masses, (t, h), y0, y1))
    }

    fn guard_with(
        &self,
        scratch: &mut Scratch,
        inverse_masses: &[f64],
        (t, h): (f64, f64),
        y0: &[f64],
        y1: &mut [f64],
    ) -> Result<Guarded, Squeezed> {
        let surface = self.surface();
        let half = y1.len() / 2;
        let Scratch {
            candidates,
            motion,
            cuts,
            ..
        } = scratch;
        motion.times = [t, t + h];
        surface.place(self.obstacles(), t, &y0[..half], &mut motion.x0);
        surface.place(self.obstacles(), t + h, &y1[..half], &mut motion.moves);
        for (end, start) in motion.moves.iter_mut().zip(&motion.x0) {
            *end -= start;
        }
        surface.speeds(self.obstacles(), t + h, &y1[half..], &mut motion.v);
        motion.inverse_masses.clear();
        motion.inverse_masses.extend_from_slice(inverse_masses);
        motion.inverse_masses.resize(motion.x0.len(), 0.0);
        let mut guarded = Guarded::default();
        motion.cover(surface, candidates);
        let mut changed = rub(surface, h, candidates, motion, &mut guarded);
        let mut moved = vec![];
        let mut clear = false;
        for pass in 0..PASSES {
            let hits = find(
                surface,
                candidates,
                motion,
                (pass > 0).then_some(&moved[..]),
            );
            if hits.is_empty() {
                clear = true;
                break;
            }
            changed = true;
            moved.clear();
            moved.resize(motion.x0.len(), false);
            for (candidate, time) in hits {
                guarded.first = guarded.first.min(time);
                push(
                    surface,
                    &candidate,
                    time,
                    h,
                    motion,
                    &mut guarded,
                    &mut moved,
                );
            }
            motion.cover(surface, candidates);
        }
        if !clear {
            (guarded.cuts, guarded.lost) = cuts.cut(surface, candidates, motion)?;
        }
        if changed {
            write_back(motion, y0, y1);
        }
        Ok(guarded)
    }
}

/// Writes what was changed to y1 = [x | v].
fn write_back(motion: &Motion, y0: &[f64], y1: &mut [f64]) {
    let n = y0.len() / 6;
    let (x, v) = y1.split_at_mut(3 * n);
    for i in 0..n {
        if motion.inverse_masses[i] == 0.0 {
            continue;
        }
        for axis in 0..3 {
            let k = axis * n + i;
            // What was not changed keeps its bits, which a difference and a sum might not.
            let unchanged = motion.moves[i][axis] == x[k] - y0[k];
            if !unchanged {
                x[k] = y0[k] + motion.moves[i][axis];
            }
            v[k] = motion.v[i][axis];
        }
    }
}

/// Friction of pairs that the contact force keeps apart at the end of the step. Returns whether
/// there was any.
fn rub(
    surface: &Surface,
    h: f64,
    candidates: &mut Candidates,
    motion: &mut Motion,
    guarded: &mut Guarded,
) -> bool {
    if !surface.is_rough() {
        return false;
    }
    let find = |candidate: &Candidate| {
        let law = surface.law(candidate.kind, &candidate.points);
        if law.skin.friction == 0.0 {
            return None;
        }
        let (x0, moves) = (candidate.of(&motion.x0), candidate.of(&motion.moves));
        let pair = Pair {
            kind: candidate.kind,
            law,
            x: std::array::from_fn(|k| x0[k] + moves[k]),
            v: candidate.of(&motion.v),
        };
        let (force, weights, normal) = pair.force()?;
        let contact = Contact::new(candidate.points, weights, normal, motion);
        (contact.inverse_mass > 0.0).then_some((contact, law.skin.friction * force * h))
    };
    let mut pressed = vec![];
    candidates.each(0.0, find, |found| pressed.push(found));
    if pressed.is_empty() {
        return false;
    }
    for _ in 0..FRICTION_PASSES {
        for (contact, left) in &mut pressed {
            let Motion {
                moves,
                v,
                inverse_masses,
                ..
            } = motion;
            let across = |a: Vector3<f64>| a - contact.normal * a.dot(&contact.normal);
            let slip = across(contact.relative(v));
            let most = *left * contact.inverse_mass;
            let held = hold(slip, most);
            contact.apply(-held, inverse_masses, v);
            let impulse = held.norm() / contact.inverse_mass;
            *left = (*left - impulse).max(0.0);
            guarded.impulse += impulse;
            let displaced = across(contact.relative(moves));
            let back = if held == slip {
                hold(displaced, most * h)
            } else {
                held * (0.5 * h)
            };
            contact.apply(-back, inverse_masses, moves);
        }
    }
    motion.cover(surface, candidates);
    true
}

/// The pairs that come too near, with the share of the step at which they do: all, or those of
/// which a vertex has moved.
fn find(
    surface: &Surface,
    candidates: &Candidates,
    motion: &Motion,
    moved: Option<&[bool]>,
) -> Vec<(Candidate, f64)> {
    let has_moved =
        |pair: &Candidate| moved.is_none_or(|moved| pair.points.iter().any(|i| moved[*i as usize]));
    let hit = |pair: &Candidate| {
        let time = has_moved(pair).then(|| motion.impact(surface, pair))?;
        Some((*pair, time?))
    };
    let mut hits = vec![];
    candidates.each(surface.nearest(), hit, |hit| hits.push(hit));
    hits
}

/// Impulse of a pair that touches at that share of the step.
fn push(
    surface: &Surface,
    candidate: &Candidate,
    time: f64,
    h: f64,
    motion: &mut Motion,
    guarded: &mut Guarded,
    moved: &mut [bool],
) {
    let (x0, moves) = (candidate.of(&motion.x0), candidate.of(&motion.moves));
    let at = std::array::from_fn(|k| x0[k] + moves[k] * time);
    let touching = closest(candidate.kind, &at);
    let distance = touching.offset.norm();
    if distance == 0.0 {
        return;
    }
    let normal = touching.offset / distance;
    let contact = Contact::new(candidate.points, touching.weights, normal, motion);
    if contact.inverse_mass == 0.0 {
        return;
    }
    let friction = surface.law(candidate.kind, &candidate.points).skin.friction;
    let Motion {
        moves,
        v,
        inverse_masses,
        ..
    } = motion;
    let by_move = contact.stop(friction, inverse_masses, moves);
    let by_speed = contact.stop(friction, inverse_masses, v);
    if by_move > 0.0 {
        guarded.impulses += 1;
        guarded.impulse += by_speed.max(by_move / h) / contact.inverse_mass;
        for i in candidate.points {
            moved[i as usize] |= inverse_masses[i as usize] > 0.0;
        }
    }
}
