//! Contacts of pairs as the guard changes them: impulses along the normal, and Coulomb friction.

use std::collections::BTreeMap;

use nalgebra::{Matrix3, Vector3};

use super::candidates::Candidates;
use super::listing::Candidate;
use super::motion::{Guarded, Motion};
use super::repulsion::Pair;
use super::solids::{Arm, Field, SAME, Solid};
use super::surface::{Law, Surface};
use crate::geometry::{PairKind, weighted};

/// The most passes of friction between surfaces that the contact force keeps apart.
const FRICTION_PASSES: usize = 20;

/// Share of the most that friction takes of a velocity below which a slip counts as none, so that
/// passes may end before they converge. Only its displacement is taken back: the velocity stays,
/// and grows if it is the beginning of a slide.
const STUCK: f64 = 1e-4;

/// Share of the most that friction takes of a displacement below which it counts as none.
const STILL: f64 = 1e-10;

/// Fraction of the missing separation of rigid bodies that is restored in a step.
const RESTORED: f64 = 0.1;

/// Number of contacts of two bodies, the last ones, among which one at the same point is sought.
const LAST: usize = 32;

/// What impulses move.
#[derive(Clone, Copy)]
pub(super) struct Masses<'a> {
    /// Inverse mass of each vertex (1/kg).
    pub inverse: &'a [f64],
    /// Rigid bodies.
    pub solids: &'a [Solid],
}

/// Direction of a pair's contact: the weights of its closest points, the normal from the second
/// primitive to the first, and the sum of the weighted inverse masses (1/kg).
pub(super) struct Contact {
    pub points: [u32; 4],
    pub weights: [f64; 4],
    normal: Vector3<f64>,
    /// The change of their relative velocity along the normal by an impulse along it (1/kg).
    pub inverse_mass: f64,
    /// Displacement (m) by which the primitives should part in the step.
    pub wanted: f64,
    rigid: Option<RigidContact>,
}

/// Contact of which a side is a rigid body, whose mobility depends on the direction.
struct RigidContact {
    arms: [Option<Arm>; 2],
    /// Change of the relative velocity of the closest points by an impulse (1/kg), and the inverse.
    mobility: Matrix3<f64>,
    inverse: Matrix3<f64>,
}

impl Contact {
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

    /// Lets rigid bodies part by a tenth of what they lack of the distance that they should keep.
    /// Nothing else would give them back what they lose, step by step, where they are pressed.
    pub fn want(&mut self, law: Law, distance: f64) {
        if self.rigid.is_some() {
            self.wanted = RESTORED * (law.most_kept() - distance).max(0.0);
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
        // What cannot move along the normal gets no impulse.
        let inverse = mobility.try_inverse().unwrap_or_default();
        self.rigid = Some(RigidContact {
            arms,
            mobility,
            inverse,
        });
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

    /// Whether impulses at this contact do the same to two rigid bodies as those at another of
    /// theirs.
    fn is_at(&self, other: &Self) -> bool {
        let arms = self.both_arms().zip(other.both_arms());
        arms.is_some_and(|(own, others)| {
            let mut both = own.iter().zip(&others);
            (self.normal - other.normal).norm() < SAME && both.all(|(a, b)| a.is_at(b))
        })
    }

    /// The part across the normal of the relative vector of the closest points.
    fn slip(&self, field: &Field) -> Vector3<f64> {
        let relative = self.relative(field);
        relative - self.normal * relative.dot(&self.normal)
    }

    /// The change of the relative velocity along a direction by an impulse along it (1/kg).
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
    /// rigid bodies have to be settled.
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

    /// Stops an approach, so that the primitives part by as much as is wanted, and by friction at
    /// most mu times as much of a slip. Returns the impulse on the first primitive (N s).
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
        let held = hold(slip, friction * approach);
        let impulse = (self.normal * approach - held) / self.inverse_mass;
        self.push(impulse, masses, field);
        impulse
    }

    /// The impulse that stops the approach and the slip, or, where that takes more friction than
    /// there is, the approach alone (Guendelman, Bridson, Fedkiw, *Nonconvex rigid bodies with
    /// stacking*, 2003).
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
        // Where friction would make the bodies approach, there is none.
        let direction = if stopped > 0.1 * self.inverse_mass {
            direction
        } else {
            normal
        };
        direction * (-relative.dot(&normal) / normal.dot(&(rigid.mobility * direction)))
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
        let (x0, moves) = (candidate.of(&motion.x0), candidate.of(&motion.moves));
        let x = std::array::from_fn(|k| x0[k] + moves[k]);
        if law.skin.friction == 0.0 || surface.is_beside(candidate, &x) {
            return None;
        }
        let (kind, v) = (candidate.kind, candidate.of(&motion.v));
        let pair = Pair { kind, law, x, v };
        let (force, weights, normal) = pair.force()?;
        let contact = Contact::new(surface, candidate, weights, normal, motion);
        (contact.inverse_mass > 0.0).then_some((contact, law.skin.friction * force * h))
    };
    let mut pressed = Pressed::default();
    candidates.each(0.0, find, |(contact, most)| pressed.add(contact, most));
    if pressed.contacts.is_empty() {
        return false;
    }
    hold_pressed(&pressed.contacts, h, motion, guarded);
    motion.cover(surface, candidates);
    true
}

/// Contacts with the most impulse of friction (N s) that each has. Those of two rigid bodies at one
/// point act as one: where faces lie on one another, dozens of pairs meet at a corner.
#[derive(Default)]
struct Pressed {
    contacts: Vec<(Contact, f64)>,
    /// Numbers of the contacts of two bodies.
    between: BTreeMap<[usize; 2], Vec<usize>>,
}

impl Pressed {
    fn add(&mut self, contact: Contact, most: f64) {
        if let Some(arms) = contact.both_arms() {
            let known = self.between.entry(arms.map(|arm| arm.solid)).or_default();
            let is_same = |k: &&usize| self.contacts[**k].0.is_at(&contact);
            if let Some(k) = known.iter().rev().take(LAST).find(is_same) {
                self.contacts[*k].1 += most;
                return;
            }
            known.push(self.contacts.len());
        }
        self.contacts.push((contact, most));
    }
}

/// Goes over the contacts until a whole pass leaves each as it is, at most so often.
fn pass_until_still<T>(contacts: &[T], mut leaves: impl FnMut(usize, &T) -> bool) {
    for _ in 0..FRICTION_PASSES {
        let mut still = true;
        for (k, contact) in contacts.iter().enumerate() {
            still &= leaves(k, contact);
        }
        if still {
            break;
        }
    }
}

/// Friction of contacts with the most impulse (N s) that each has: of velocities, and of
/// displacements, which vanish where the velocities do, and follow them elsewhere.
fn hold_pressed(pressed: &[(Contact, f64)], h: f64, motion: &mut Motion, guarded: &mut Guarded) {
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
    // Impulse of friction of each contact so far: a later pass may take of it again.
    let mut all = vec![Vector3::zeros(); pressed.len()];
    pass_until_still(pressed, |k, (contact, most)| {
        let slip = contact.slip(v);
        let held = hold(all[k] - slip / contact.mobility(slip), *most);
        let change = held - all[k];
        contact.push(change, masses, v);
        all[k] = held;
        change.norm() <= STUCK * most
    });
    for ((contact, _), (impulse, delay)) in pressed.iter().zip(all.iter().zip(&delays)) {
        contact.push(impulse * *delay, masses, moves);
        impulses.share(contact.points, contact.weights, *impulse);
    }
    let limit = |contact: &Contact, most: f64, slip| most * contact.mobility(slip);
    let sticks = |(contact, most): &&(Contact, f64)| {
        let slip = contact.slip(v);
        slip.norm() <= STUCK * limit(contact, *most, slip)
    };
    let stuck: Vec<_> = pressed.iter().filter(sticks).collect();
    pass_until_still(&stuck, |_, (contact, most)| {
        let displaced = contact.slip(moves);
        let most = h * limit(contact, *most, displaced);
        contact.apply(-hold(displaced, most), masses, moves);
        displaced.norm() <= STILL * most
    });
    for (k, solid) in solids.iter().enumerate() {
        solid.settle(k, v);
        if solid.settle(k, moves) {
            solid.bend(k, x0, moves);
        }
    }
    guarded.impulse += all.iter().map(Vector3::norm).sum::<f64>();
}
