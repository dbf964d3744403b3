//! Impacts of rigid and of elastic bodies, at the time within the step at which they touch.
//!
//! Pairs that touch at one time get [impulses](super::impact); hard ones with little restitution do
//! where they enter the range of their repulsion, unless they [slide on](Surface::slides_on). An
//! impulse J acts at one point p of both bodies, a time s before the end of the step. A free body
//! ends the step at x + s J / m with the angular momentum L + (p - x + s v) x J: as if it had moved
//! from x - s v with the momentum m v + J. Its momentum and its angular momentum about any point
//! change by J and p x J, so that both totals are conserved to rounding.

use std::collections::BTreeMap;

use nalgebra::Vector3;

use super::candidates::{Candidates, Linear};
use super::impact::{Impact, solve};
use super::listing::Candidate;
use super::motion::{Guarded, Hit, Motion};
use super::response::{JoinedBodies, Response, Tie};
use super::solids::Field;
use super::surface::Surface;
use crate::geometry::{closest, weighted};

/// Largest number of times in a step at which a body has impacts.
const MAX_TIMES: usize = 12;

/// Applies impulses to the pairs that touch in a step of h (s), one time after another, as long as
/// there are pairs with a rigid side or with restitution. Joints follow impacts that rebound.
pub(super) fn strike(
    surface: &Surface,
    (h, joined): (f64, Option<JoinedBodies>),
    candidates: &mut Candidates,
    motion: &mut Motion,
    guarded: &mut Guarded,
) -> bool {
    let mut changed = false;
    let (mut moved, mut entered) = (vec![], vec![]);
    for time in 0..MAX_TIMES {
        let again = (time > 0).then_some(&moved[..]);
        let mut hits = find(surface, candidates, motion, again, Some(&entered));
        hits.retain(|(pair, _)| surface.is_rigid_or_elastic_pair(pair.kind, &pair.points));
        moved.clear();
        moved.resize(motion.x0.len(), false);
        let hits = first_hits(surface, motion, hits, &mut moved);
        let mut impacts: Vec<Impact> = vec![];
        let known = entered.len();
        for (pair, hit) in hits {
            if hit.enters {
                entered.push(pair);
                pair.points.iter().for_each(|i| moved[*i as usize] = true);
                if surface.slides_on(candidates, motion, &pair, hit) {
                    continue;
                }
            }
            let Some(mut impact) = Impact::new(surface, &pair, (hit, h), motion) else {
                continue;
            };
            if let Some(joined) = joined {
                impact.join(joined, motion);
            }
            if !impacts.iter().any(|other| impact.is_same_as(other, surface)) {
                impacts.push(impact);
            }
        }
        let mut changes = Field::still(motion.x0.len(), motion.solids.len());
        let is_held = |impact: &Impact| impact.blow.contact.is_joined();
        let held = joined.filter(|_| impacts.iter().any(is_held));
        let ties = held.map(|joined| Tie::all(joined, &motion.solids, &motion.v, None));
        let mut ties = ties.unwrap_or_default();
        let blows = impacts.iter_mut().map(|impact| &mut impact.blow);
        let moving = (&motion.inverse_masses[..], &motion.solids[..]);
        solve(blows, &mut ties, &mut changes, moving);
        impacts.retain(|impact| impact.blow.impulse != Vector3::zeros());
        if impacts.is_empty() && entered.len() == known {
            break;
        }
        changed |= !impacts.is_empty();
        // Sum of the impulses (N s), and of their products with the times (s) for which they change
        // displacements.
        let mut spans = [0.0; 2];
        for impact in &impacts {
            guarded.first = guarded.first.min(1.0 - impact.left / h);
            let span = impact.apply(&changes, h, motion);
            let size = impact.blow.impulse.norm();
            spans = [spans[0] + size, spans[1] + size * span];
            if let Some(JoinedBodies { joints, .. }) = joined.filter(|_| impact.blow.is_free) {
                impact.blow.note(&changes, joints);
            }
            guarded.impulses += 1;
            guarded.impulse += impact.blow.impulse.norm();
            let passed = impact.blow.contact.responses();
            let passed = passed.iter().flat_map(Response::points);
            let struck = parties(surface, motion, &impact.candidate).chain(passed);
            let struck: Vec<_> = struck.collect();
            for i in struck {
                moved[i as usize] = true;
                motion.flight.since[i as usize] = 1.0 - impact.left / h;
            }
        }
        let left = impacts.iter().map(|impact| impact.left).fold(0.0, f64::max);
        let span = if spans[0] > 0.0 { spans[1] / spans[0] } else { left };
        for tie in &ties {
            tie.push(1.0, &mut motion.v);
            tie.push(span, &mut motion.moves);
            for i in tie.points() {
                moved[i as usize] = true;
                motion.flight.since[i as usize] = 1.0 - left / h;
            }
        }
        for k in 0..motion.solids.len() {
            motion.solids[k].settle(k, &mut motion.v);
            if motion.solids[k].settle(k, &mut motion.moves) {
                motion.rotate_points(k);
                let (center, points) = (motion.solids[k].center, motion.solids[k].points.clone());
                moved[points.clone()].fill(true);
                let since = motion.flight.since[center];
                motion.flight.since[points].fill(since);
            }
        }
        motion.cover(surface, candidates);
    }
    changed
}

/// Returns the movable parts of a pair: particles, and the centres of rigid bodies.
fn parties(surface: &Surface, motion: &Motion, pair: &Candidate) -> impl Iterator<Item = u32> {
    let party = |i: u32| match surface.solid(i) {
        Some(k) => Some(motion.solids[k].center as u32),
        None => (motion.inverse_masses[i as usize] > 0.0).then_some(i),
    };
    pair.points.map(party).into_iter().flatten()
}

/// Selects the hits, with their shares of the step, that are the first of all their movable parts.
/// Hits at nearly the same time get the same time. The points of other pairs are marked as moved.
fn first_hits(
    surface: &Surface,
    motion: &Motion,
    mut hits: Vec<(Candidate, Hit)>,
    moved: &mut [bool],
) -> Vec<(Candidate, Hit)> {
    hits.sort_by(|(_, a), (_, b)| a.share.total_cmp(&b.share));
    // Time of the first hit of each part; `None` if another pair has to come first.
    let mut times: BTreeMap<u32, Option<f64>> = BTreeMap::new();
    let mut first = vec![];
    for (pair, hit) in hits {
        let time = hit.share;
        let known: Vec<_> =
            parties(surface, motion, &pair).filter_map(|i| times.get(&i).copied()).collect();
        let at = known.first().copied().unwrap_or(Some(time));
        let law = surface.law(pair.kind, &pair.points);
        let is_one = at.is_some_and(|at| {
            let approach = weighted(
                &closest(pair.kind, &pair.of(&motion.x0)).weights,
                &pair.of(&motion.moves),
            );
            known.iter().all(|other| *other == Some(at))
                && approach.norm() * (time - at) <= law.max_kept() - law.radius
        });
        for i in parties(surface, motion, &pair) {
            times.entry(i).or_insert(at.filter(|_| is_one));
        }
        if let Some(share) = at.filter(|_| is_one) {
            first.push((pair, Hit { share, ..hit }));
        } else {
            pair.points.iter().for_each(|i| moved[*i as usize] = true);
        }
    }
    first
}

/// Finds the pairs that come too near, with the time at which they do: all of them, or those with a
/// vertex that has moved. Dull pairs come too near where they enter the range of their repulsion,
/// except those that have `entered` it, or, without that list, all.
pub(super) fn find(
    surface: &Surface,
    candidates: &Candidates,
    motion: &Motion,
    moved: Option<&[bool]>,
    entered: Option<&[Candidate]>,
) -> Vec<(Candidate, Hit)> {
    let whole =
        Linear { x: &motion.x0, moves: Some(&motion.moves.points), rounding: surface.rounding() };
    let has_moved =
        |pair: &Candidate| moved.is_none_or(|moved| pair.points.iter().any(|i| moved[*i as usize]));
    let entered = entered.filter(|_| !surface.rigid().is_empty());
    let distance = |pair: &Candidate| {
        has_moved(pair).then(|| {
            let law = surface.law(pair.kind, &pair.points);
            let may_enter = entered.is_some() && law.is_dull;
            let nearest = if may_enter { law.range() } else { 0.0 };
            nearest.max(2.0 * law.max_kept())
        })
    };
    let hit = |pair: &Candidate| {
        let entered = entered.filter(|entered| !entered.contains(pair));
        let entry = entered.and_then(|_| motion.entry(surface, pair));
        Some((*pair, entry.or_else(|| motion.impact(surface, pair))?))
    };
    let mut hits = vec![];
    let gap = entered.map_or_else(|| surface.nearest(), |_| 0.0);
    candidates.each(gap, &whole, distance, hit, |hit| hits.push(hit));
    hits
}
