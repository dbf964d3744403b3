//! Collision safeguard after a step: no two primitives pass through one another.
//!
//! Vertices move in straight lines from the state at the beginning of the step to that at its end.
//! Friction acts on pairs that the contact force keeps apart. Rigid and elastic bodies have
//! [impacts](super::strike). Then pairs that would still come too near get inelastic impulses with
//! Coulomb friction, in canonical order and in several passes (Bridson, Fedkiw, Anderson, *Robust
//! treatment of collisions, contact and friction for cloth animation*, 2002). The displacements
//! that these leave too long are [cut](super::cut).

use nalgebra::Vector3;

use super::candidates::Candidates;
use super::contact_pair::ContactPair;
use super::cut::Pinched;
use super::friction::apply_friction;
use super::impulse::Impulses;
use super::layer::{Buffers, ContactLayer};
use super::listing::Candidate;
use super::motion::{Guarded, Hit, Motion};
use super::response::{JoinedBodies, Joints};
use super::strike::{find, strike};
use super::surface::Surface;
use crate::geometry::closest;
use crate::interval::Interval;
use crate::rigid::ROTATION;

/// Largest number of passes of impulses before displacements are cut.
const MAX_PASSES: usize = 12;

/// Largest number of repetitions of these passes, if cuts fail because kinematic vertices leave no
/// room.
const MAX_ROUNDS: usize = 20;

/// Bodies on which impulses act: the inverse mass of each particle (1/kg), the joints of rigid
/// bodies, if there are any, whether the end of the step has impulses in it already, and whether
/// velocities may lag behind the course.
#[derive(Clone, Copy)]
pub(crate) struct Bodies<'a> {
    pub inverse_masses: &'a [f64],
    pub joints: Option<&'a dyn Joints>,
    pub are_struck: bool,
    pub may_lag: bool,
}

/// Applies the safeguard to the step of h (s) from the state y0 at time t (s) to y1. Changes y1
/// where surfaces would pass through one another or friction acts, and records the impulses.
///
/// # Errors
/// Kinematic vertices leave no room.
pub(crate) fn guard(
    layer: &ContactLayer,
    bodies: Bodies,
    Interval { t, h }: Interval,
    y0: &[f64],
    y1: &mut [f64],
    impulses: &mut Impulses,
) -> Result<Guarded, Pinched> {
    if !bodies.are_struck {
        impulses.clear();
    }
    layer.scratch.lend(|buffers| {
        std::mem::swap(impulses, &mut buffers.motion.impulses);
        let guarded = guard_with(layer, buffers, bodies, Interval { t, h }, y0, y1);
        std::mem::swap(impulses, &mut buffers.motion.impulses);
        guarded
    })
}

fn guard_with(
    layer: &ContactLayer,
    buffers: &mut Buffers,
    bodies: Bodies,
    Interval { t, h }: Interval,
    y0: &[f64],
    y1: &mut [f64],
) -> Result<Guarded, Pinched> {
    let surface = layer.surface();
    let half = 3 * surface.particles();
    let Buffers { candidates, motion, cuts, .. } = buffers;
    motion.times = [t, t + h];
    surface.place(layer.obstacles(), t, &y0[..half], &mut motion.x0);
    surface.place(layer.obstacles(), t + h, &y1[..half], &mut motion.moves.points);
    for (end, start) in motion.moves.points.iter_mut().zip(&motion.x0) {
        *end -= start;
    }
    surface.speeds(layer.obstacles(), t + h, &y1[half..2 * half], &mut motion.v.points);
    if surface.is_rough() || surface.is_rigid_or_elastic() {
        surface.speeds(layer.obstacles(), t, &y0[half..2 * half], &mut motion.v0.points);
    }
    motion.inverse_masses.clear();
    motion.inverse_masses.extend_from_slice(bodies.inverse_masses);
    motion.inverse_masses.resize(motion.x0.len(), 0.0);
    motion.read_solids(surface, [y0, y1]);
    motion.spins.clear();
    let turns = layer.obstacles().iter().map(|obstacle| obstacle.turn);
    let spins =
        turns.map(|turn| turn.map_or_else(Vector3::zeros, |turn| turn.orientation(t + h).spin));
    motion.spins.extend(spins);
    motion.take_planes();
    let mut guarded = Guarded::default();
    motion.cover(surface, candidates);
    let joined = bodies.joints.map(|joints| JoinedBodies { joints, y: y1 });
    // Friction acts in the first turn of contact and constraints: each further turn would add as
    // much friction again.
    let mut changed = !bodies.are_struck
        && apply_friction(surface, (h, joined), candidates, motion, &mut guarded);
    if surface.is_rigid_or_elastic() {
        let Motion { flight, v0, v, moves, .. } = motion;
        flight.read(h, bodies.may_lag, [v0, v, moves]);
        if bodies.are_struck {
            flight.straighten();
        }
        changed |= strike(surface, (h, joined), candidates, motion, &mut guarded);
    }
    let mut rounds = 0;
    while !push_apart(surface, h, candidates, motion, &mut guarded, &mut changed) {
        match cuts.cut(surface, candidates, motion) {
            Ok(cut) => {
                (guarded.cuts, guarded.lost) = cut;
                break;
            }
            // More impulses may move other vertices out of the way of kinematic ones.
            Err(_) if rounds < MAX_ROUNDS => rounds += 1,
            Err(pinched) => return Err(pinched),
        }
    }
    if changed {
        write_back(motion, surface.particles(), y0, y1);
        let rotations = y1[2 * half..].chunks_exact_mut(ROTATION);
        for (k, (solid, numbers)) in motion.solids.iter().zip(rotations).enumerate() {
            let end = solid.end(motion.moves.turns[k], motion.v.turns[k]);
            end.write(numbers);
        }
    }
    guarded.planes = motion.take_planes();
    Ok(guarded)
}

/// Runs passes of impulses. Returns whether no pair comes too near any more.
fn push_apart(
    surface: &Surface,
    h: f64,
    candidates: &mut Candidates,
    motion: &mut Motion,
    guarded: &mut Guarded,
    changed: &mut bool,
) -> bool {
    let mut moved = vec![];
    for pass in 0..MAX_PASSES {
        let again = (pass > 0).then_some(&moved[..]);
        let hits = find(surface, candidates, motion, again, None);
        if hits.is_empty() {
            return true;
        }
        *changed = true;
        moved.clear();
        moved.resize(motion.x0.len(), false);
        for (candidate, Hit { share, .. }) in hits {
            guarded.first = guarded.first.min(share);
            push(surface, &candidate, share, h, motion, guarded, &mut moved);
        }
        motion.cover(surface, candidates);
    }
    false
}

/// Writes the changed states of n particles to y1 = [x | v].
fn write_back(motion: &Motion, n: usize, y0: &[f64], y1: &mut [f64]) {
    let (x, v) = y1.split_at_mut(3 * n);
    for i in 0..n {
        if motion.inverse_masses[i] == 0.0 {
            continue;
        }
        for axis in 0..3 {
            let k = axis * n + i;
            // Unchanged particles keep their exact bits: a difference and a sum might not restore
            // them.
            let unchanged = motion.moves[i][axis] == x[k] - y0[k];
            if !unchanged {
                x[k] = y0[k] + motion.moves[i][axis];
            }
            v[k] = motion.v[i][axis];
        }
    }
}

/// Applies the impulse of a pair that touches at that share of the step or, if it separates there,
/// when it touches next. If it gets none although it touches, it is checked again in the next pass.
fn push(
    surface: &Surface,
    candidate: &Candidate,
    time: f64,
    h: f64,
    motion: &mut Motion,
    guarded: &mut Guarded,
    moved: &mut [bool],
) {
    let law = surface.law(candidate.kind, &candidate.points);
    let mut time = time;
    if law.skin.restitution > 0.0 {
        // Its time is that on its course, which may already be past the other side on a line.
        let Some(on_line) = motion.impact_after(surface, candidate, 0.0) else {
            return;
        };
        time = on_line;
    }
    let mut touch = contact_at(surface, candidate, time, motion);
    if touch.as_ref().is_some_and(|contact| contact.parts(&motion.moves)) {
        let Some(next) = motion.impact_after(surface, candidate, time) else {
            return;
        };
        touch = contact_at(surface, candidate, next, motion);
    }
    let contact =
        touch.filter(|contact| contact.inverse_mass > 0.0 && !contact.parts(&motion.moves));
    let Some(contact) = contact else {
        for i in candidate.points {
            moved[i as usize] = true;
        }
        return;
    };
    let friction = law.skin.friction;
    let turning = motion.turning(surface, candidate);
    let Motion { moves, v, inverse_masses, solids, impulses, .. } = motion;
    let by_move = contact.stop(friction, contact.wanted, inverse_masses, moves);
    let by_speed = contact.stop(friction, 0.0, inverse_masses, v);
    for k in contact.solids() {
        solids[k].settle(k, moves);
        solids[k].settle(k, v);
    }
    impulses.share(contact.points, contact.weights, by_speed);
    guarded.impulses += 1;
    guarded.impulse += by_speed.norm().max(by_move.norm() / h);
    for i in candidate.points {
        moved[i as usize] |= inverse_masses[i as usize] > 0.0;
    }
    // Displacements and velocities are stopped separately: the spins of both bodies compensate the
    // resulting change of angular momentum.
    if let Some(before) = turning
        && let Some(after) = motion.turning(surface, candidate)
    {
        let count = contact.solids().count() as f64;
        for k in contact.solids() {
            let change = motion.solids[k].spun((before - after) / count);
            motion.v.turns[k] += change;
            motion.solids[k].spin_points(change, &mut motion.v);
        }
    }
    for k in contact.solids() {
        motion.rotate_points(k);
        moved[motion.solids[k].points.clone()].fill(true);
    }
}

/// Returns the contact of a pair at a share of the step, unless its closest points coincide then.
fn contact_at(
    surface: &Surface,
    candidate: &Candidate,
    time: f64,
    motion: &Motion,
) -> Option<ContactPair> {
    let (x0, moves) = (candidate.of(&motion.x0), candidate.of(&motion.moves));
    let at = std::array::from_fn(|k| x0[k] + moves[k] * time);
    let nearest = closest(candidate.kind, &at);
    let (distance, normal) = nearest.apart(candidate.kind)?;
    let mut contact = ContactPair::new(surface, candidate, nearest.weights, normal, motion);
    contact.restore_separation(surface.law(candidate.kind, &candidate.points), distance);
    Some(contact)
}
