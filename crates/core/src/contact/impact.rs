//! Impacts at one time: of a particle on an obstacle, and of pairs of surfaces at their time within
//! a step.
//!
//! What touches gets an impulse along the normal, after which it separates at least at the speed of
//! restitution, and Coulomb friction, by projected Gauss-Seidel iteration over all impacts of the
//! time (Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, 1988).

use nalgebra::Vector3;

use super::contact_pair::{ContactPair, LeastSpeed};
use super::impulse::{across, rebound_speed, restored};
use super::listing::Candidate;
use super::motion::{Hit, Motion};
use super::response::{JoinedBodies, Joints, Tie};
use super::skin::Law;
use super::solids::{Arm, Field, Solid};
use super::surface::Surface;
use crate::geometry::{Closest, closest, weighted};

/// Accuracy of the solution, as a share of the speed of an impact.
const TOLERANCE: f64 = 1e-13;

/// Largest number of passes over the impacts of one time.
const MAX_SWEEPS: usize = 200;

/// Share of its approach by which a pair that does not rebound stays farther apart than where it
/// touched, so that rounding does not make it a hit again.
const MARGIN_SHARE: f64 = 1e-6;

/// Impulse at a contact.
pub(super) struct Blow {
    pub contact: ContactPair,
    /// Relative velocity before the impact, and the least speed at which the sides separate.
    pub least: LeastSpeed,
    /// Whether the sides move on freely afterwards: with a speed of restitution, or into the range
    /// of their repulsion.
    pub is_free: bool,
    /// Velocity (m/s) of the side whose motion is prescribed, or 0. The work on the other side is
    /// that at the relative velocity plus the product of the impulse with this velocity.
    carried: Vector3<f64>,
    /// Impulse on the first side (N s).
    pub impulse: Vector3<f64>,
}

impl Blow {
    /// Creates a blow without an impulse yet.
    pub fn new(
        contact: ContactPair,
        least: LeastSpeed,
        is_free: bool,
        carried: Vector3<f64>,
    ) -> Self {
        Self { contact, least, is_free, carried, impulse: Vector3::zeros() }
    }

    /// Changes the impulse so that the sides separate as fast as they have to, with friction.
    /// Returns whether it was right.
    fn press(&mut self, changes: &mut Field, inverse_masses: &[f64]) -> bool {
        if self.contact.inverse_mass <= 0.0 {
            return true;
        }
        let (so_far, least) = (self.impulse, &self.least);
        let change = self.contact.press(so_far, least, inverse_masses, changes);
        self.impulse += change;
        self.contact.change(change).norm() <= TOLERANCE * self.least.size()
    }

    /// Tells constraints of the impulse, if they pass it on.
    pub fn note(&self, changes: &Field, joints: &dyn Joints) {
        if self.contact.is_joined() {
            let work = self.work(changes) + self.impulse.dot(&self.carried);
            joints.note(self.impulse.norm(), work);
        }
    }

    /// Returns the difference between the change of velocity by friction (m/s), which is along the
    /// mean of the slips at both ends of the step, and that along the slip at its end.
    pub fn turned(&self, changes: &Field) -> Vector3<f64> {
        let slip = across(self.least.before + self.contact.relative(changes), self.contact.normal);
        let ways = [self.least.begun, slip].map(|slip| slip.try_normalize(0.0));
        let [Some(begun), Some(ended)] = ways else {
            return Vector3::zeros();
        };
        let change = across(self.contact.change(self.impulse), self.contact.normal);
        (ended - begun) * (0.5 * change.norm())
    }

    /// Returns the work of the impulse (J) at the relative velocity, with the changes of velocities
    /// by all of them.
    fn work(&self, changes: &Field) -> f64 {
        let sum = self.least.before * 2.0 + self.contact.relative(changes);
        0.5 * self.impulse.dot(&sum)
    }
}

/// Number of bisections of the share of restitution with which impacts gain no energy.
const BISECTIONS: usize = 20;

/// Energy that impacts gain over the size of their work, up to which it is a rounding error.
const ROUNDING: f64 = 1e-9;

/// Finds the impulses of all impacts of one time, and the changes of velocities.
///
/// Where friction reverses a slip during an impact, speeds of restitution can ask for more energy
/// than there is (Kane, *A dynamics puzzle*, 1984). All of them are then reduced by one share, with
/// which the impacts gain none.
pub(super) fn solve<'a>(
    blows: impl Iterator<Item = &'a mut Blow>,
    ties: &mut [Tie],
    changes: &mut Field,
    (inverse_masses, solids): (&[f64], &[Solid]),
) {
    let mut blows: Vec<_> = blows.collect();
    let speeds: Vec<_> = blows.iter().map(|blow| blow.least.speed).collect();
    let none = changes.clone();
    let mut gains = |share: f64, changes: &mut Field| {
        changes.clone_from(&none);
        for (blow, speed) in blows.iter_mut().zip(&speeds) {
            let kept = if blow.is_free { share } else { 1.0 };
            (blow.least.speed, blow.impulse) = (speed * kept, Vector3::zeros());
        }
        ties.iter_mut().for_each(Tie::slacken);
        sweep((&mut blows, ties), changes, (inverse_masses, solids));
        let works = blows.iter().map(|blow| blow.work(changes));
        let (sum, size) =
            works.fold((0.0, 0.0), |(sum, size), work: f64| (sum + work, size + work.abs()));
        let may_gain = blows.iter().any(|blow| blow.is_free);
        may_gain && sum > ROUNDING * size
    };
    if !gains(1.0, changes) {
        return;
    }
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..BISECTIONS {
        let middle = 0.5 * (low + high);
        *(if gains(middle, changes) { &mut high } else { &mut low }) = middle;
    }
    gains(low, changes);
}

/// Passes over impacts until all impulses are right.
fn sweep(
    (blows, ties): (&mut [&mut Blow], &mut [Tie]),
    changes: &mut Field,
    (inverse_masses, solids): (&[f64], &[Solid]),
) {
    let sizes = blows.iter().map(|blow| blow.least.size());
    let fastest = sizes.fold(0.0, f64::max);
    for _ in 0..MAX_SWEEPS {
        let mut solved = true;
        for blow in &mut *blows {
            solved &= blow.press(changes, inverse_masses);
        }
        for tie in &mut *ties {
            solved &= tie.press(changes, solids) <= TOLERANCE * fastest;
        }
        if solved {
            break;
        }
    }
}

/// Pair that touches.
pub(super) struct Impact {
    pub candidate: Candidate,
    /// Blow at the time of the impact. The contact separates by `wanted`, besides, where it does
    /// not rebound: that cancels the approach after the touch, and restores missing separation.
    pub blow: Blow,
    /// Time from the impact to the end of the step (s).
    pub left: f64,
}

impl Impact {
    /// Returns the impact of a pair that touches in a step of h (s).
    pub fn new(
        surface: &Surface,
        pair: &Candidate,
        (hit, h): (Hit, f64),
        motion: &Motion,
    ) -> Option<Self> {
        let law: Law = surface.law(pair.kind, &pair.points);
        let (at, time) = (motion.places(pair, &law, hit), hit.share);
        let nearest = closest(pair.kind, &at);
        let (distance, normal) = nearest.apart(pair.kind)?;
        let begun = closest(pair.kind, &pair.of(&motion.x0)).apart(pair.kind);
        if begun.is_some_and(|(_, begun)| begun.dot(&normal) < 0.0) {
            // Its course leads past the other side: the safeguard stops it before that.
            return None;
        }
        let Closest { weights, offset } = nearest;
        let first = pair.kind.first();
        // The middle between the two surfaces. A floor has no point below the vertex.
        let [radius, other] = [0, first].map(|k| surface.radius(pair.points[k]));
        let on_axis: Vector3<f64> = (0..first).map(|k| at[k] * weights[k]).sum();
        let point = on_axis - (offset + normal * (radius - other)) * 0.5;
        let left = (1.0 - time) * h;
        let (mut before, mut arms) = (Vector3::zeros(), [None, None]);
        let mut carried = Vector3::zeros();
        // Relative velocities at the beginning and the end of the step, without other impacts.
        let mut ends = [Vector3::zeros(); 2];
        for ((number, side), sign) in pair.kind.sides().into_iter().enumerate().zip([1.0, -1.0]) {
            let Some(k) = surface.solid(pair.points[side.start]) else {
                for k in side {
                    let (i, weight) = (pair.points[k] as usize, weights[k]);
                    let own = [motion.v[i] - motion.flight.gain(i), motion.v[i]];
                    before += motion.velocity(i, time) * weight;
                    if motion.inverse_masses[i] == 0.0 {
                        carried -= motion.velocity(i, time) * weight;
                    }
                    ends = [0, 1].map(|e| ends[e] + own[e] * weight);
                }
                continue;
            };
            let solid = &motion.solids[k];
            let center = solid.center;
            let v = motion.v[center];
            let lever = point - (motion.x0[center] + motion.moves[center] - v * left);
            let turn = motion.v.turns[k];
            let [gain, lag] = motion.flight.turn(k);
            let (spin, inverse_inertia) = solid.before([turn, lag], 1.0 - time, left);
            let spins = [turn - gain, turn];
            let speeds = [v - motion.flight.gain(center), v];
            ends = [0, 1].map(|e| ends[e] + (speeds[e] + spins[e].cross(&lever)) * sign);
            before += (motion.velocity(center, time) + spin.cross(&lever)) * sign;
            if motion.inverse_masses[center] == 0.0 {
                carried -= motion.velocity(center, time) * sign;
            }
            arms[number] = Some(Arm {
                solid: k,
                lever,
                round: Vector3::zeros(),
                sign,
                inverse_mass: motion.inverse_masses[center],
                inverse_inertia,
            });
        }
        let points = (pair.points, weights);
        let mut contact = ContactPair::with_arms(points, normal, &motion.inverse_masses, &arms);
        let [start, end] = ends.map(|v| v.dot(&normal));
        let along = before.dot(&normal);
        let press = (start - end) / h;
        let mut speed = rebound_speed(law.restitution, -along, press, h);
        let is_free = hit.enters || speed > 0.0;
        if hit.enters {
            // What parts them before the end of the step has acted inside the range.
            speed += (along - end).min(0.0);
        } else if !is_free {
            // A contact that lasts stops the approach and the slip at the end of the step.
            speed = (along - end).max(0.0);
            before = normal * along + across(ends[1], normal);
            let approach = weighted(&weights, &pair.of(&motion.moves)).dot(&normal);
            contact.wanted =
                restored(&law, distance) - (1.0 - time) * approach + MARGIN_SHARE * approach.abs();
        }
        let least = LeastSpeed::of_impact(before, speed, law.skin.friction);
        Some(Self { candidate: *pair, blow: Blow::new(contact, least, is_free, carried), left })
    }

    /// Lets constraints pass impulses on, if they hold something that is struck.
    pub fn join(&mut self, joined: JoinedBodies, motion: &Motion) {
        let is_smooth = self.blow.least.friction == 0.0;
        let (masses, solids) = (&motion.inverse_masses, &motion.solids);
        self.blow.contact.join(joined, is_smooth, masses, solids);
    }

    /// Returns whether impulses of this impact have the same effect as those of another one between
    /// the same bodies.
    pub fn is_same_as(&self, other: &Self, surface: &Surface) -> bool {
        let bodies = |impact: &Self| {
            let pair = &impact.candidate;
            [pair.points[0], pair.points[pair.kind.first()]].map(|i| surface.vertex(i))
        };
        let [own, others] = [self, other].map(|impact| &impact.blow.contact);
        own.is_rigid() && bodies(self) == bodies(other) && own.is_at(others)
    }

    /// Changes the motion by the impulse. Returns the time (s) for which it changes displacements.
    pub fn apply(&self, changes: &Field, h: f64, motion: &mut Motion) -> f64 {
        let Blow { contact, impulse, .. } = &self.blow;
        let changed = contact.relative(changes).dot(&contact.normal);
        // A pair that does not rebound stays where it touched; for others, the course from there on
        // is new.
        let span =
            if self.blow.is_free { self.left } else { (contact.wanted / changed).clamp(0.0, h) };
        let impulse = *impulse;
        let (points, weights) = (contact.points, contact.weights);
        motion.impulses.share(points, weights, impulse);
        let masses = &motion.inverse_masses;
        let late;
        let contact = if contact.is_joined() {
            contact
        } else {
            let arms = self.late_arms(span - self.left, motion);
            late = ContactPair::with_arms((points, weights), contact.normal, masses, &arms);
            &late
        };
        contact.push(impulse, masses, &mut motion.v);
        contact.push(impulse * span, masses, &mut motion.moves);
        span
    }

    /// Returns the arms at the end of the step, if both sides then are as far apart as `delay` (s)
    /// after the impact.
    fn late_arms(&self, delay: f64, motion: &Motion) -> [Option<Arm>; 2] {
        let velocity = |arm: &Arm| motion.v[motion.solids[arm.solid].center];
        let arms = self.blow.contact.both_arms();
        let own = arms.each_ref().map(|arm| arm.as_ref().map(velocity));
        let mean = match own {
            [Some(a), Some(b)] => (a + b) * 0.5,
            [one, other] => one.or(other).unwrap_or_default(),
        };
        let late = |arm: Arm| Arm {
            lever: arm.lever + (velocity(&arm) - mean) * delay,
            inverse_inertia: motion.solids[arm.solid].inverse_inertia(),
            ..arm
        };
        arms.map(|arm| arm.map(late))
    }
}
