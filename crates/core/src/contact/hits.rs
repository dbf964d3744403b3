//! Selection of the hits in a step that come first.

use std::collections::BTreeMap;

use super::candidates::{Candidates, Linear};
use super::listing::Candidate;
use super::motion::Motion;
use super::surface::Surface;
use crate::geometry::{closest, weighted};

/// Returns the movable parts of a pair: particles, and the centres of rigid bodies.
pub(super) fn parties(
    surface: &Surface,
    motion: &Motion,
    pair: &Candidate,
) -> impl Iterator<Item = u32> {
    let party = |i: u32| match surface.solid(i) {
        Some(k) => Some(motion.solids[k].center as u32),
        None => (motion.inverse_masses[i as usize] > 0.0).then_some(i),
    };
    pair.points.map(party).into_iter().flatten()
}

/// Selects the hits, with their shares of the step, that are the first of all their movable parts.
/// Hits at nearly the same time get the same time. The points of other pairs are marked as moved.
pub(super) fn first_hits(
    surface: &Surface,
    motion: &Motion,
    mut hits: Vec<(Candidate, f64)>,
    moved: &mut [bool],
) -> Vec<(Candidate, f64)> {
    hits.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    // Time of the first hit of each part; `None` if another pair has to come first.
    let mut times: BTreeMap<u32, Option<f64>> = BTreeMap::new();
    let mut first = vec![];
    for (pair, time) in hits {
        let known: Vec<_> = parties(surface, motion, &pair)
            .filter_map(|i| times.get(&i).copied())
            .collect();
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
        if let Some(at) = at.filter(|_| is_one) {
            first.push((pair, at));
        } else {
            pair.points.iter().for_each(|i| moved[*i as usize] = true);
        }
    }
    first
}

/// Finds the pairs that come too near, with the share of the step at which they do: all of them, or
/// those with a vertex that has moved.
pub(super) fn find(
    surface: &Surface,
    candidates: &Candidates,
    motion: &Motion,
    moved: Option<&[bool]>,
) -> Vec<(Candidate, f64)> {
    let whole = Linear {
        x: &motion.x0,
        moves: Some(&motion.moves.points),
        rounding: surface.rounding(),
    };
    let has_moved =
        |pair: &Candidate| moved.is_none_or(|moved| pair.points.iter().any(|i| moved[*i as usize]));
    let distance = |pair: &Candidate| {
        has_moved(pair).then(|| 2.0 * surface.law(pair.kind, &pair.points).max_kept())
    };
    let hit = |pair: &Candidate| Some((*pair, motion.impact(surface, pair)?));
    let mut hits = vec![];
    candidates.each(surface.nearest(), &whole, distance, hit, |hit| {
        hits.push(hit);
    });
    hits
}
