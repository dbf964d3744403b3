//! Contacts of pairs as the guard changes them: impulses along the normal, and Coulomb friction.

use nalgebra::Vector3;

use super::candidates::Candidates;
use super::closest::weighted;
use super::listing::Candidate;
use super::motion::{Guarded, Motion};
use super::repulsion::Pair;
use super::surface::Surface;

/// Passes of friction between surfaces that the contact force keeps apart.
const FRICTION_PASSES: usize = 4;

/// Share of the most that friction takes of a velocity below which a slip counts as none.
const STUCK: f64 = 1e-9;

/// Direction of a pair's contact: the weights of its closest points, the normal from the second
/// primitive to the first, and the sum of the weighted inverse masses (1/kg).
pub(super) struct Contact {
    points: [u32; 4],
    weights: [f64; 4],
    normal: Vector3<f64>,
    pub inverse_mass: f64,
}

impl Contact {
    pub fn new(points: [u32; 4], weights: [f64; 4], normal: Vector3<f64>, motion: &Motion) -> Self {
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

    /// The part across the normal of the relative vector of the closest points.
    fn slip(&self, all: &[Vector3<f64>]) -> Vector3<f64> {
        let relative = self.relative(all);
        relative - self.normal * relative.dot(&self.normal)
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

    /// Whether the closest points do not approach.
    pub fn parts(&self, all: &[Vector3<f64>]) -> bool {
        self.relative(all).dot(&self.normal) >= 0.0
    }

    /// Stops an approach, and by friction at most mu times as much of a slip. Returns the impulse's
    /// magnitude over the effective mass, 0 if there was no approach.
    pub fn stop(&self, friction: f64, inverse_masses: &[f64], all: &mut [Vector3<f64>]) -> f64 {
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

/// Friction of pairs that the contact force keeps apart at the end of the step. Returns whether
/// there was any.
pub(super) fn rub(
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
    hold_pressed(&pressed, h, motion, guarded);
    motion.cover(surface, candidates);
    !pressed.is_empty()
}

/// Friction of contacts with the most impulse (N s) that each has: of velocities, and of
/// displacements, which vanish where the velocities do, and follow them elsewhere.
fn hold_pressed(pressed: &[(Contact, f64)], h: f64, motion: &mut Motion, guarded: &mut Guarded) {
    let Motion {
        moves,
        v0,
        v,
        inverse_masses,
        ..
    } = motion;
    // Displacement per change of velocity in the step: half of it for most methods, all of it for
    // implicit Euler.
    let delay = |contact: &Contact| {
        let begun = contact.slip(v0);
        let (change, way) = (contact.slip(v) - begun, contact.slip(moves) - begun * h);
        let squared = change.norm_squared();
        if squared > 0.0 {
            (way.dot(&change) / squared).clamp(0.0, h)
        } else {
            0.5 * h
        }
    };
    let delays: Vec<f64> = pressed.iter().map(|(contact, _)| delay(contact)).collect();
    let mut used = vec![0.0; pressed.len()];
    for _ in 0..FRICTION_PASSES {
        for (((contact, most), used), delay) in pressed.iter().zip(&mut used).zip(&delays) {
            let slip = contact.slip(v);
            let left = (most - *used).max(0.0) * contact.inverse_mass;
            let taken = hold(slip, left);
            contact.apply(-taken, inverse_masses, v);
            *used += taken.norm() / contact.inverse_mass;
            let limit = most * contact.inverse_mass;
            let displaced = contact.slip(moves);
            let back = if (slip - taken).norm() <= STUCK * limit {
                hold(displaced, limit * h)
            } else {
                taken * *delay
            };
            contact.apply(-back, inverse_masses, moves);
        }
    }
    guarded.impulse += used.iter().sum::<f64>();
}
