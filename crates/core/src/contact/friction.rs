//! Friction of the pairs that the contact force keeps apart in a step, by passes over the
//! velocities of contacts. Constraints pass it on, as they do impulses of impacts.
//!
//! Each contact changes velocities that the next ones read, so a processor would wait for the end
//! of one computation before it begins the next. Therefore contacts of particles are in the order
//! of a greedy colouring, in which those that move the same vertex have different colours:
//! most neighbours then do not interact.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::collections::BTreeMap;

use nalgebra::Vector3;
use pulp::{Simd, WithSimd};

use super::candidates::{Candidates, Linear};
use super::contact_pair::ContactPair;
use super::impulse::limited_to;
use super::listing::Candidate;
use super::motion::{Guarded, Motion};
use super::repulsion::Pair;
use super::response::{JoinedBodies, Tie};
use super::solids::{Field, Solid};
use super::surface::Surface;
use crate::error::Vertex;
use crate::geometry::weighted;
use crate::interval::Interval;
use crate::vectors::Arch;

/// Share of the largest displacement that friction can undo below which a displacement counts as
/// zero.
const STILL_TOLERANCE: f64 = 1e-10;

/// Number of most recent contacts of two bodies among which one at the same point is searched for.
const SEARCHED_CONTACTS: usize = 32;

/// Applies friction to the pairs that the contact force keeps apart at the end of a step of h (s).
/// Returns whether there were any.
pub(super) fn apply_friction(
    surface: &Surface,
    (h, joined): (f64, Option<JoinedBodies>),
    candidates: &mut Candidates,
    motion: &mut Motion,
    guarded: &mut Guarded,
) -> bool {
    if !surface.is_rough() {
        return false;
    }
    let find = |candidate: &Candidate, pair: &Pair| {
        let skin = pair.law.skin;
        if skin.friction == 0.0 && skin.rolling == 0.0 {
            return None;
        }
        let (force, weights, normal) = pair.force()?;
        let mut contact = ContactPair::new(surface, candidate, weights, normal, motion);
        contact.resist_turns(skin.rolling * force * h, surface, motion);
        let spin = |i: u32| match surface.vertex(i) {
            Vertex::Obstacle(k) => motion.spins[k],
            _ => Vector3::zeros(),
        };
        let [first, .., last] = candidate.points;
        let most = skin.friction * force * h;
        let spin = spin(first) + spin(last);
        (contact.inverse_mass > 0.0).then_some((contact, most, spin))
    };
    let mut pressed = Pressed::default();
    let ended = Linear { x: motion.ends(), moves: None, rounding: surface.rounding() };
    let found = |(contact, most, spin)| pressed.add(contact, most, spin);
    surface.each_bare(candidates, &ended, &motion.v, find, found);
    if pressed.contacts.is_empty() {
        return false;
    }
    let mut ties = vec![];
    if let Some(joined) = joined {
        let (masses, solids) = (&motion.inverse_masses, &motion.solids);
        let contacts = pressed.contacts.iter_mut().map(|(contact, _)| contact);
        let held = contacts.filter_map(|contact| {
            contact.join(joined, false, masses, solids);
            contact.is_joined().then_some(())
        });
        if held.count() > 0 {
            let [t, end] = motion.times;
            let step = Interval { t, h: end - t };
            ties = Tie::all(joined, solids, &motion.v, Some(step));
            ties.iter_mut().for_each(Tie::read_velocities);
        }
    }
    solve(&pressed, (h, &mut ties), motion, guarded);
    motion.cover(surface, candidates);
    true
}

/// Contacts, each with its largest impulse of friction (N s). Contacts of two rigid bodies at one
/// point are merged: where faces lie on one another, dozens of pairs meet at a corner.
#[derive(Default)]
struct Pressed {
    contacts: Vec<(ContactPair, f64)>,
    /// Angular velocity of the obstacle at each contact (rad/s); 0 where none turns.
    spins: Vec<Vector3<f64>>,
    /// Numbers of the contacts of two bodies.
    between: BTreeMap<[usize; 2], Vec<usize>>,
}

impl Pressed {
    fn add(&mut self, contact: ContactPair, most: f64, spin: Vector3<f64>) {
        if let [Some(first), Some(second)] = contact.both_arms() {
            let bodies = [first.solid, second.solid];
            let known = self.between.entry(bodies).or_default();
            let is_same = |k: &&usize| self.contacts[**k].0.is_at(&contact);
            if let Some(k) = known.iter().rev().take(SEARCHED_CONTACTS).find(is_same) {
                let (known, of_known) = &mut self.contacts[*k];
                known.add_resistance(&contact);
                *of_known += most;
                return;
            }
            known.push(self.contacts.len());
        }
        self.contacts.push((contact, most));
        self.spins.push(spin);
    }
}

/// Finds the friction of contacts, each with its largest impulse (N s): of velocities first.
/// Displacements follow the velocities, and vanish where these do. Ropes and ends of joints pull.
fn solve(
    pressed: &Pressed,
    (h, ties): (f64, &mut [Tie]),
    motion: &mut Motion,
    guarded: &mut Guarded,
) {
    let (pressed, spins) = (&pressed.contacts, &pressed.spins);
    let Motion { x0, moves, v0, v, inverse_masses, solids, impulses, .. } = motion;
    // Displacement per change of velocity in the step: half of the step for most methods, all of it
    // for implicit Euler.
    let delay = |begun: Vector3<f64>, end: Vector3<f64>, way: Vector3<f64>| {
        let (change, way) = (end - begun, way - begun * h);
        let squared = change.norm_squared();
        if squared > 0.0 { (way.dot(&change) / squared).clamp(0.0, h) } else { 0.5 * h }
    };
    let turn = |contact: &ContactPair, field: &Field, span: f64| {
        let turning = contact.turning(field, span);
        turning.map_or_else(Vector3::zeros, |(impulse, _)| impulse)
    };
    let delays = |(contact, _): &(ContactPair, f64)| {
        let slips = [&*v0, v, moves].map(|field| contact.slip(field));
        let turns =
            [(&*v0, 1.0), (v, 1.0), (moves, h)].map(|(field, span)| turn(contact, field, span));
        [slips, turns].map(|[begun, end, way]| delay(begun, end, way))
    };
    let delays: Vec<[f64; 2]> = pressed.iter().map(delays).collect();
    let (all, turned) = hold(pressed, ties, (inverse_masses, solids), v);
    let latest = delays.iter().map(|[delay, _]| *delay).fold(0.0, f64::max);
    for tie in ties {
        tie.push(latest, moves);
    }
    for (k, (contact, _)) in pressed.iter().enumerate() {
        contact.push(all[k] * delays[k][0], inverse_masses, moves);
        contact.spin(turned[k] * delays[k][1], moves);
        impulses.share(contact.points, contact.weights, all[k]);
    }
    let limit = |contact: &ContactPair, most: f64, slip| most * contact.mobility(slip);
    let sticks = |(contact, most): &&(ContactPair, f64)| {
        let slip = contact.slip(v);
        slip.norm() <= STUCK_TOLERANCE * limit(contact, *most, slip)
    };
    let all_spins = pressed.iter().zip(spins);
    let stuck: Vec<_> = all_spins.clone().filter(|(it, _)| sticks(it)).collect();
    for (it, spin) in all_spins.filter(|(_, spin)| **spin != Vector3::zeros()) {
        let missed = if sticks(&it) {
            spin.norm() * lead(&it.0, *spin, moves, h).norm() * h / 6.0
        } else {
            missed_by_slide(it, [&*v0, v]) * h
        };
        guarded.missed = guarded.missed.max(missed);
    }
    let rests = |contact: &&ContactPair| {
        let turning = contact.turning(v, 1.0);
        turning.is_some_and(|(impulse, most)| impulse.norm() <= STUCK_TOLERANCE * most)
    };
    let resting: Vec<_> = pressed.iter().map(|(contact, _)| contact).filter(rests).collect();
    pass_until_still(|| {
        let mut still = true;
        for contact in &resting {
            let Some((impulse, most)) = contact.turning(moves, h) else {
                continue;
            };
            contact.spin(limited_to(impulse, h * most), moves);
            still &= impulse.norm() <= STILL_TOLERANCE * h * most;
        }
        for ((contact, most), spin) in &stuck {
            let displaced = contact.slip(moves) + lead(contact, **spin, moves, h);
            let most = h * limit(contact, *most, displaced);
            contact.apply(-limited_to(displaced, most), inverse_masses, moves);
            still &= displaced.norm() <= STILL_TOLERANCE * most;
        }
        still
    });
    for (k, solid) in solids.iter().enumerate() {
        solid.settle(k, v);
        if solid.settle(k, moves) {
            solid.rotate_points(k, x0, moves);
        }
    }
    guarded.impulse += all.iter().map(Vector3::norm).sum::<f64>();
}

/// Returns the displacement along the surface (m) that an obstacle, which turns at the rate `spin`
/// (rad/s), gives its point at a contact in a step of h (s), beyond what it gives the contact
/// itself, which moves over the obstacle: a ball that rolls is carried along by one point after the
/// other.
fn lead(contact: &ContactPair, spin: Vector3<f64>, moves: &Field, h: f64) -> Vector3<f64> {
    if spin == Vector3::zeros() {
        return spin;
    }
    let way = weighted(&contact.weights, &contact.points.map(|i| moves[i as usize]));
    let lead = spin.cross(&way) * (0.5 * h);
    lead - contact.normal * lead.dot(&contact.normal)
}

/// Returns the error of the change of velocity (m/s) of a contact that slides, by the turn of its
/// slip between the velocities at both ends of the step: friction acts as at its end.
fn missed_by_slide((contact, most): &(ContactPair, f64), fields: [&Field; 2]) -> f64 {
    let [begun, ended] = fields.map(|field| contact.slip(field));
    match begun.try_normalize(0.0).zip(ended.try_normalize(0.0)) {
        Some((begun, along)) => {
            let change = most * contact.mobility(ended);
            0.25 * change * (along - begun).norm()
        }
        None => 0.0,
    }
}

/// Largest number of passes of friction between surfaces that the contact force keeps apart.
const MAX_PASSES: usize = 20;

/// Share of the largest change of velocity by friction below which a slip counts as zero, so that
/// passes may end early. Only its displacement is undone: the velocity stays, and grows if a slide
/// begins.
const STUCK_TOLERANCE: f64 = 1e-4;

/// Largest number of colours. Contacts that would need more have the last one.
const COLOURS: u32 = 64;

/// Repeats a pass until it changes nothing, or the number of passes reaches a limit.
fn pass_until_still(mut pass: impl FnMut() -> bool) {
    for _ in 0..MAX_PASSES {
        if pass() {
            break;
        }
    }
}

/// Lets friction stop the slip of contacts, each with its largest impulse (N s), by changes of the
/// velocities v (m/s), and the turns of those that resist them. Returns the impulse (N s) and the
/// angular impulse (N m s) of each. The points of rigid bodies must be settled afterwards.
fn hold(
    contacts: &[(ContactPair, f64)],
    ties: &mut [Tie],
    (inverse_masses, solids): (&[f64], &[Solid]),
    v: &mut Field,
) -> (Vec<Vector3<f64>>, Vec<Vector3<f64>>) {
    // Impulses of each contact so far, which a later pass may reduce.
    let mut all = vec![Vector3::zeros(); contacts.len()];
    let mut turned = all.clone();
    let numbers = in_order(contacts, inverse_masses);
    let mut soft: Vec<_> =
        numbers.iter().map(|number| Soft::new(&contacts[*number], inverse_masses)).collect();
    let directed: Vec<_> = (0..contacts.len()).filter(|k| contacts[*k].0.is_directed()).collect();
    let fastest = contacts.iter().map(|(contact, most)| most * contact.inverse_mass);
    let fastest = fastest.fold(0.0, f64::max);
    pass_until_still(|| {
        let points = &mut v.points;

        let mut still = Arch::new().dispatch(FrictionPass { contacts: &mut soft, v: points });
        for k in &directed {
            let (contact, most) = &contacts[*k];
            let slip = contact.slip(v);
            let held = contact.held(all[*k], slip, *most);
            let change = held - all[*k];
            contact.push(change, inverse_masses, v);
            all[*k] = held;
            still &= change.norm() <= STUCK_TOLERANCE * most;
            if let Some((stopping, most)) = contact.turning(v, 1.0) {
                let held = limited_to(turned[*k] + stopping, most);
                let change = held - turned[*k];
                contact.spin(change, v);
                turned[*k] = held;
                still &= change.norm() <= STUCK_TOLERANCE * most;
            }
        }
        for tie in &mut *ties {
            still &= tie.press(v, solids) <= STUCK_TOLERANCE * fastest;
        }
        still
    });
    for (number, contact) in numbers.iter().zip(&soft) {
        all[*number] = contact.held;
    }
    (all, turned)
}

/// Lists the numbers of the contacts whose mobility does not depend on the direction, in the order
/// of their colours.
fn in_order(contacts: &[(ContactPair, f64)], inverse_masses: &[f64]) -> Vec<usize> {
    let mut used = vec![0_u64; inverse_masses.len()];
    let mut keys = vec![];
    for (number, (contact, _)) in contacts.iter().enumerate() {
        if contact.is_directed() {
            continue;
        }
        let points = contact.points.map(|i| i as usize);
        let moved = || points.iter().filter(|i| inverse_masses[**i] > 0.0);
        let taken = moved().fold(0, |all, i| all | used[*i]);
        let colour = taken.trailing_ones().min(COLOURS - 1);
        for i in moved() {
            used[*i] |= 1 << colour;
        }
        keys.push((colour, number));
    }
    keys.sort_unstable();
    keys.into_iter().map(|(_, number)| number).collect()
}

/// Contact whose mobility does not depend on the direction: without rigid bodies or constraints.
struct Soft {
    weights: [f64; 4],
    /// Weights times inverse masses (1/kg).
    mobilities: [f64; 4],
    normal: Vector3<f64>,
    /// Impulse so far (N s).
    held: Vector3<f64>,
    points: [u32; 4],
    /// Effective mass (kg), and the largest impulse of friction (N s).
    mass: f64,
    most: f64,
}

impl Soft {
    fn new((contact, most): &(ContactPair, f64), inverse_masses: &[f64]) -> Self {
        let inverse = contact.points.map(|i| inverse_masses[i as usize]);
        Self {
            weights: contact.weights,
            mobilities: std::array::from_fn(|k| contact.weights[k] * inverse[k]),
            normal: contact.normal,
            held: Vector3::zeros(),
            points: contact.points,
            mass: 1.0 / contact.inverse_mass,
            most: *most,
        }
    }
}

/// Pass of friction over such contacts.
struct FrictionPass<'a> {
    contacts: &'a mut [Soft],
    v: &'a mut [Vector3<f64>],
}

impl WithSimd for FrictionPass<'_> {
    /// Whether no impulse changed by more than a tolerance.
    type Output = bool;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> bool {
        let Self { contacts, v } = self;
        let mut still = true;
        for contact in contacts {
            let (points, weights) = (contact.points.map(|i| i as usize), contact.weights);
            let relative = v[points[0]] * weights[0]
                + v[points[1]] * weights[1]
                + v[points[2]] * weights[2]
                + v[points[3]] * weights[3];
            let slip = relative - contact.normal * relative.dot(&contact.normal);
            let wanted = contact.held - slip * contact.mass;
            let most = contact.most;
            let squared = wanted.norm_squared();
            let held =
                if squared > most * most { wanted * (most / squared.sqrt()) } else { wanted };
            let change = held - contact.held;
            contact.held = held;
            let least = STUCK_TOLERANCE * most;
            still &= change.norm_squared() <= least * least;
            for k in 0..4 {
                let mobility = contact.mobilities[k];
                if mobility != 0.0 {
                    v[points[k]] += change * mobility;
                }
            }
        }
        still
    }
}
