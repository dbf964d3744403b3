//! Contacts of pairs in the collision safeguard: impulses along the normal, and Coulomb friction.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::candidates::{Candidates, Linear};
use super::listing::Candidate;
use super::motion::{Guarded, Motion};
use super::repulsion::Pair;
use super::skin::Law;
use super::solids::{Arm, Field, Masses, SAME_TOLERANCE, Solid};
use super::surface::Surface;
use crate::geometry::{PairKind, weighted};

/// Largest number of passes of friction between surfaces that the contact force keeps apart.
const MAX_PASSES: usize = 20;

/// Share of the largest change of velocity by friction below which a slip counts as zero, so that
/// passes may end early. Only its displacement is undone: the velocity stays, and grows if a slide
/// begins.
const STUCK_TOLERANCE: f64 = 1e-4;

/// Share of the largest displacement that friction can undo below which a displacement counts as
/// zero.
const STILL_TOLERANCE: f64 = 1e-10;

/// Fraction of the missing separation of rigid bodies that is restored in a step.
const RESTORED_SHARE: f64 = 0.1;

/// Number of most recent contacts of two bodies among which one at the same point is searched for.
const SEARCHED_CONTACTS: usize = 32;

/// Contact of a pair: the weights of its closest points, the normal from the second primitive to
/// the first, and the sum of the weighted inverse masses (1/kg).
pub(super) struct ContactPair {
    pub points: [u32; 4],
    pub weights: [f64; 4],
    normal: Vector3<f64>,
    /// Change of the relative velocity along the normal by an impulse along it (1/kg).
    pub inverse_mass: f64,
    /// Displacement (m) by which the primitives should separate in the step.
    pub wanted: f64,
    /// In a box, so that the contacts of cloth, which have none, are small.
    rigid: Option<Box<RigidContact>>,
}

/// Contact with a rigid body on at least one side, whose mobility depends on the direction.
struct RigidContact {
    arms: [Option<Arm>; 2],
    /// Change of the relative velocity of the closest points by an impulse (1/kg), and the inverse.
    mobility: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl ContactPair {
    pub fn new(
        surface: &Surface,
        candidate: &Candidate,
        weights: [f64; 4],
        normal: Vector3<f64>,
        motion: &Motion,
    ) -> Self {
        let points = candidate.points;
        let inverse_masses = points.map(|i| motion.inverse_masses[i as usize]);
        let terms = weights.iter().zip(inverse_masses).map(|(w, m)| w * w * m);
        let mut contact = Self {
            points,
            weights,
            normal,
            inverse_mass: terms.sum(),
            wanted: 0.0,
            rigid: None,
        };
        if !motion.solids.is_empty() {
            contact.find_arms(surface, candidate.kind, motion);
        }
        contact
    }

    /// Lets rigid bodies separate by a tenth of the distance that they lack. Nothing else would
    /// restore what they lose in each step under pressure.
    pub fn restore_separation(&mut self, law: Law, distance: f64) {
        if self.rigid.is_some() {
            self.wanted = RESTORED_SHARE * (law.max_kept() - distance).max(0.0);
        }
    }

    fn find_arms(&mut self, surface: &Surface, kind: PairKind, motion: &Motion) {
        let first = kind.first();
        let side = |from: usize, to: usize, sign: f64| {
            let side = (&self.points[from..to], &self.weights[from..to]);
            Solid::arm(surface, &motion.solids, side, self.normal, sign)
        };
        let last = if kind == PairKind::VertexFloor { 2 } else { 4 };
        let arms = [side(0, first, 1.0), side(first, last, -1.0)];
        if arms.iter().all(Option::is_none) {
            return;
        }
        let mut mobility = Matrix3::identity() * self.inverse_mass;
        for arm in arms.iter().flatten() {
            mobility += motion.solids[arm.solid].mobility(arm);
        }
        self.inverse_mass = self.normal.dot(&(mobility * self.normal));
        // Sides that cannot move along the normal get no impulse.
        let inverse = mobility.try_inverse().unwrap_or_default();
        self.rigid = Some(Box::new(RigidContact {
            arms,
            mobility,
            inverse,
        }));
    }

    /// The relative vector of the closest points.
    fn relative(&self, field: &Field) -> Vector3<f64> {
        let relative = weighted(&self.weights, &self.points.map(|i| field[i as usize]));
        self.arms()
            .fold(relative, |sum, arm| sum + arm.beyond_points(field))
    }

    /// The arms at rigid bodies.
    fn arms(&self) -> impl Iterator<Item = &Arm> {
        let arms = self.rigid.as_ref().map(|rigid| rigid.arms.iter());
        arms.into_iter().flatten().flatten()
    }

    /// Numbers of the rigid bodies that touch.
    pub fn solids(&self) -> impl Iterator<Item = usize> {
        self.arms().map(|arm| arm.solid)
    }

    /// The arms, if both sides are rigid bodies.
    fn both_arms(&self) -> Option<[Arm; 2]> {
        let [first, second] = self.rigid.as_ref()?.arms;
        Some([first?, second?])
    }

    /// Whether impulses at this contact have the same effect on two rigid bodies as those at
    /// another.
    fn is_at(&self, other: &Self) -> bool {
        let arms = self.both_arms().zip(other.both_arms());
        arms.is_some_and(|(own, others)| {
            let mut both = own.iter().zip(&others);
            (self.normal - other.normal).norm() < SAME_TOLERANCE && both.all(|(a, b)| a.is_at(b))
        })
    }

    /// Component, perpendicular to the normal, of the relative vector of the closest points.
    fn slip(&self, field: &Field) -> Vector3<f64> {
        let relative = self.relative(field);
        relative - self.normal * relative.dot(&self.normal)
    }

    /// Change of the relative velocity along a direction by an impulse along it (1/kg).
    fn mobility(&self, direction: Vector3<f64>) -> f64 {
        let squared = direction.norm_squared();
        match &self.rigid {
            Some(rigid) if squared > 0.0 => direction.dot(&(rigid.mobility * direction)) / squared,
            _ => self.inverse_mass,
        }
    }

    /// Changes the relative vector of the closest points by `change`, along it.
    fn apply(&self, change: Vector3<f64>, masses: Masses, field: &mut Field) {
        self.push(change / self.mobility(change), masses, field);
    }

    /// Gives the first primitive an impulse (N s), and the opposite to the second. The points of
    /// rigid bodies must be settled afterwards.
    fn push(&self, impulse: Vector3<f64>, masses: Masses, field: &mut Field) {
        for (i, weight) in self.points.iter().zip(self.weights) {
            let i = *i as usize;
            if masses.inverse[i] > 0.0 && weight != 0.0 {
                field[i] += impulse * (weight * masses.inverse[i]);
            }
        }
        for arm in self.arms() {
            masses.solids[arm.solid].push(arm, impulse, field);
        }
    }

    /// Whether the closest points do not approach.
    pub fn parts(&self, field: &Field) -> bool {
        self.relative(field).dot(&self.normal) >= 0.0
    }

    /// Stops an approach, so that the primitives separate by `wanted`, and slip by friction, at
    /// most mu times as much. Returns the impulse on the first primitive (N s).
    pub fn stop(
        &self,
        friction: f64,
        wanted: f64,
        masses: Masses,
        field: &mut Field,
    ) -> Vector3<f64> {
        let relative = self.relative(field) - self.normal * wanted;
        let approach = -relative.dot(&self.normal);
        if approach <= 0.0 {
            return Vector3::zeros();
        }
        if let Some(rigid) = &self.rigid {
            let impulse = self.rigid_impulse(rigid, friction, relative);
            self.push(impulse, masses, field);
            for arm in self.arms() {
                masses.solids[arm.solid].settle(arm.solid, field);
            }
            return impulse;
        }
        let slip = relative + self.normal * approach;
        let held = limited_to(slip, friction * approach);
        let impulse = (self.normal * approach - held) / self.inverse_mass;
        self.push(impulse, masses, field);
        impulse
    }

    /// The impulse that stops approach and slip or, if friction is not large enough for that, the
    /// approach alone (Guendelman, Bridson, Fedkiw, *Nonconvex rigid bodies with stacking*, 2003).
    fn rigid_impulse(
        &self,
        rigid: &RigidContact,
        friction: f64,
        relative: Vector3<f64>,
    ) -> Vector3<f64> {
        let normal = self.normal;
        let sticking = -(rigid.inverse * relative);
        let pressed = sticking.dot(&normal);
        let across = sticking - normal * pressed;
        if pressed > 0.0 && across.norm() <= friction * pressed {
            return sticking;
        }
        let slip = relative - normal * relative.dot(&normal);
        let along = slip.try_normalize(0.0).unwrap_or_default();
        let direction = normal - along * friction;
        let stopped = normal.dot(&(rigid.mobility * direction));
        // Friction that would make the bodies approach is left out.
        let direction = if stopped > 0.1 * self.inverse_mass {
            direction
        } else {
            normal
        };
        direction * (-relative.dot(&normal) / normal.dot(&(rigid.mobility * direction)))
    }
}

/// A slip, limited to the length `most`.
fn limited_to(slip: Vector3<f64>, most: f64) -> Vector3<f64> {
    let length = slip.norm();
    if length > most {
        slip * (most / length)
    } else {
        slip
    }
}

/// Applies friction to the pairs that the contact force keeps apart at the end of the step. Returns
/// whether there were any.
pub(super) fn apply_friction(
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
        let (x0, moves) = (candidate.of(&motion.x0), candidate.of(&motion.moves));
        let x = std::array::from_fn(|k| x0[k] + moves[k]);
        if law.skin.friction == 0.0 || surface.is_beside(candidate, &x) {
            return None;
        }
        let (kind, v) = (candidate.kind, candidate.of(&motion.v));
        let pair = Pair { kind, law, x, v };
        let (force, weights, normal) = pair.force()?;
        let contact = ContactPair::new(surface, candidate, weights, normal, motion);
        (contact.inverse_mass > 0.0).then_some((contact, law.skin.friction * force * h))
    };
    let mut pressed = Pressed::default();
    let ended = Linear {
        x: motion.ends(),
        moves: None,
        rounding: surface.rounding(),
    };
    let reach = |pair: &Candidate| Some(surface.reach(pair.kind, &pair.points));
    candidates.each(0.0, &ended, reach, find, |(contact, most)| {
        pressed.add(contact, most);
    });
    if pressed.contacts.is_empty() {
        return false;
    }
    solve(&pressed.contacts, h, motion, guarded);
    motion.cover(surface, candidates);
    true
}

/// Contacts, each with its largest impulse of friction (N s). Contacts of two rigid bodies at one
/// point are merged: where faces lie on one another, dozens of pairs meet at a corner.
#[derive(Default)]
struct Pressed {
    contacts: Vec<(ContactPair, f64)>,
    /// Numbers of the contacts of two bodies.
    between: BTreeMap<[usize; 2], Vec<usize>>,
}

impl Pressed {
    fn add(&mut self, contact: ContactPair, most: f64) {
        if let Some(arms) = contact.both_arms() {
            let known = self.between.entry(arms.map(|arm| arm.solid)).or_default();
            let is_same = |k: &&usize| self.contacts[**k].0.is_at(&contact);
            if let Some(k) = known.iter().rev().take(SEARCHED_CONTACTS).find(is_same) {
                self.contacts[*k].1 += most;
                return;
            }
            known.push(self.contacts.len());
        }
        self.contacts.push((contact, most));
    }
}

/// Repeats passes over the contacts until a pass changes nothing, or their number reaches a limit.
fn pass_until_still<T>(contacts: &[T], mut leaves: impl FnMut(usize, &T) -> bool) {
    for _ in 0..MAX_PASSES {
        let mut still = true;
        for (k, contact) in contacts.iter().enumerate() {
            still &= leaves(k, contact);
        }
        if still {
            break;
        }
    }
}

/// Finds the friction of contacts, each with its largest impulse (N s): of velocities first.
/// Displacements follow the velocities, and vanish where these do.
fn solve(pressed: &[(ContactPair, f64)], h: f64, motion: &mut Motion, guarded: &mut Guarded) {
    let Motion {
        x0,
        moves,
        v0,
        v,
        inverse_masses,
        solids,
        impulses,
        ..
    } = motion;
    let masses = Masses {
        inverse: inverse_masses,
        solids,
    };
    // Displacement per change of velocity in the step: half of the step for most methods, all of it
    // for implicit Euler.
    let delay = |contact: &ContactPair| {
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
    // Impulse of friction of each contact so far, which a later pass may reduce.
    let mut all = vec![Vector3::zeros(); pressed.len()];
    pass_until_still(pressed, |k, (contact, most)| {
        let slip = contact.slip(v);
        let held = limited_to(all[k] - slip / contact.mobility(slip), *most);
        let change = held - all[k];
        contact.push(change, masses, v);
        all[k] = held;
        change.norm() <= STUCK_TOLERANCE * most
    });
    for ((contact, _), (impulse, delay)) in pressed.iter().zip(all.iter().zip(&delays)) {
        contact.push(impulse * *delay, masses, moves);
        impulses.share(contact.points, contact.weights, *impulse);
    }
    let limit = |contact: &ContactPair, most: f64, slip| most * contact.mobility(slip);
    let sticks = |(contact, most): &&(ContactPair, f64)| {
        let slip = contact.slip(v);
        slip.norm() <= STUCK_TOLERANCE * limit(contact, *most, slip)
    };
    let stuck: Vec<_> = pressed.iter().filter(sticks).collect();
    pass_until_still(&stuck, |_, (contact, most)| {
        let displaced = contact.slip(moves);
        let most = h * limit(contact, *most, displaced);
        contact.apply(-limited_to(displaced, most), masses, moves);
        displaced.norm() <= STILL_TOLERANCE * most
    });
    for (k, solid) in solids.iter().enumerate() {
        solid.settle(k, v);
        if solid.settle(k, moves) {
            solid.rotate_points(k, x0, moves);
        }
    }
    guarded.impulse += all.iter().map(Vector3::norm).sum::<f64>();
}
