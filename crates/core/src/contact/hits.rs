//! Which of the hits in a step come first.

use std::collections::BTreeMap;

use super::listing::Candidate;
use super::motion::Motion;
use super::surface::Surface;
use crate::geometry::{closest, weighted};

/// What of a pair can move: particles, and the centres of rigid bodies.
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

/// The hits, with the shares of the step, that are the first of all that move in them. Those at
/// nearly the same time get one time. The points of the others are marked as moved.
pub(super) fn first_hits(
    surface: &Surface,
    motion: &Motion,
    mut hits: Vec<(Candidate, f64)>,
    moved: &mut [bool],
) -> Vec<(Candidate, f64)> {
    hits.sort_by(|(_, a), (_, b)| a.total_cmp(b));
    // The time of the first hit of each party; none if another one has to come first.
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
                && approach.norm() * (time - at) <= law.most_kept() - law.radius
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
