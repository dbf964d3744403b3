//! Surfaces that cross come apart: the collision safeguard in reverse.
//!
//! Each round finds all crossings exactly, and moves their surfaces by a share of their edges. The
//! curve along which two surfaces cross cuts a smaller piece off one of them, or at least passes
//! nearer to its border on one side. That piece moves to the other side (global intersection
//! analysis: Baraff, Witkin, Kass, *Untangling Cloth*, 2003). Where a curve cuts nothing off, or
//! where that does not help, the curve is made shorter (Volino, Magnenat-Thalmann, *Resolving
//! Surface Collisions through Intersection Contour Minimization*, 2006). Movements go on from round
//! to round, and links between particles keep their lengths, so that whole bodies follow.

mod points;
mod skeleton;
mod votes;

use super::check::meetings;
use super::layer::ContactLayer;
use points::EdgeHit;
pub(crate) use points::Freedom;
use points::Points;
use skeleton::Skeleton;
use votes::Pieces;
use votes::Votes;

/// Largest number of rounds.
const MAX_ROUNDS: usize = 400;
/// Largest number of edges in all rounds together.
const MAX_EDGES: usize = 4_000_000;
/// Least number of rounds.
const MIN_ROUNDS: usize = 20;
/// Number of rounds without fewer crossings after which the other way is tried.
const PATIENCE: usize = 40;

/// Moves particles at x (m), n x 3, at time t (s) until no surfaces cross. Returns whether that was
/// reached.
pub(crate) fn untangle(layer: &ContactLayer, freedom: &Freedom, t: f64, x: &mut [f64]) -> bool {
    let n = x.len() / 3;
    let skeleton = Skeleton::of(layer.surface());
    let mut all = Points::new(layer, freedom, t, x);
    let rounds = (MAX_EDGES / skeleton.edges.len().max(1)).clamp(MIN_ROUNDS, MAX_ROUNDS);
    let (mut fewest, mut since) = (usize::MAX, 0);
    for round in 0..rounds {
        let (crossings, inside) = layer
            .scratch
            .lend(|buffers| meetings(layer, buffers, t, x, &skeleton.edges, &skeleton.triangles));
        let count = crossings.len() + inside.len();
        if count == 0 {
            return true;
        }
        if count < fewest {
            (fewest, since) = (count, round);
        }
        let hits: Vec<_> =
            crossings.iter().map(|crossing| EdgeHit::new(&skeleton, *crossing, &all.at)).collect();
        let pieces = Pieces::cut(&skeleton, &hits, &all.at);
        let votes = Votes::count(&skeleton, &pieces, &hits);
        let shortens = (round - since) / PATIENCE % 2 == 1;
        let mut pushes = points::pushes(layer.surface(), &inside, &all.at);
        for (k, hit) in hits.iter().enumerate() {
            let by = if shortens || votes.is_undecided(k) {
                points::step(&skeleton, hit, &all.at)
            } else {
                votes.step(k)
            };
            pushes.extend(by.map(|by| hit.push(by)));
        }
        all.advance(&pushes, |i| if shortens { None } else { votes.of_piece(pieces.of[i]) });
        for (i, at) in all.at.iter().take(n).enumerate() {
            for axis in 0..3 {
                x[axis * n + i] = at[axis];
            }
        }
    }
    false
}
