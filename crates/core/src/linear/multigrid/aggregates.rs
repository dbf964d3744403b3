//! Aggregates of particles. An aggregate is a particle with all its neighbours by strong couplings,
//! as far as these are in no other one; particles that are left join aggregates nearby (Vaněk,
//! Mandel, Brezina, *Algebraic multigrid by smoothed aggregation for second and fourth order
//! elliptic problems*, 1996).

use super::lists::Lists;

/// Least strength of a strong coupling, over the strongest coupling of its particle.
const MIN_STRENGTH: f64 = 0.25;
/// Weight of the neighbours in the smoothed motion of a particle: two thirds, as in the damped
/// Jacobi iteration that smooths the motion of aggregates.
const NEIGHBOUR_WEIGHT: f64 = 2.0 / 3.0;
/// No aggregate.
pub(super) const NONE: u32 = u32::MAX;

/// Graph of particles and couplings, by which aggregates are chosen.
pub(super) struct Graph {
    /// Number of particles.
    pub particles: usize,
    /// Ends of each coupling.
    pub ends: Vec<[u32; 2]>,
    /// Strength of each coupling: the number of couplings between particles that it combines.
    pub strengths: Vec<f64>,
}

/// Aggregates of the particles of a graph.
pub(super) struct Aggregates {
    pub count: usize,
    /// Aggregate of each particle; `NONE` for a particle that is pinned or has no neighbour.
    pub of: Vec<u32>,
    /// Weights of aggregates in the motion of each particle: of its own and those of its
    /// neighbours.
    pub shares: Lists<(u32, f32)>,
}

impl Aggregates {
    pub fn new(graph: &Graph, is_free: impl Fn(u32) -> bool) -> Self {
        let n = graph.particles;
        let joined = |ends: &[u32; 2]| ends[0] != ends[1] && ends.iter().all(|i| is_free(*i));
        let couplings = graph.ends.iter().zip(&graph.strengths);
        let couplings = couplings.filter(|(ends, strength)| joined(ends) && **strength > 0.0);
        let mut strongest = vec![0.0_f64; n];
        for (ends, strength) in couplings.clone() {
            for i in ends {
                strongest[*i as usize] = strongest[*i as usize].max(*strength);
            }
        }
        let both_ways = couplings.flat_map(|([i, j], s)| [(*i, (*j, *s)), (*j, (*i, *s))]);
        let strong = both_ways.filter(|(i, (_, s))| *s >= MIN_STRENGTH * strongest[*i as usize]);
        let neighbours = Lists::new(n, strong);
        let (of, count) = choose(&neighbours, n);
        let shares = (0..n).flat_map(|i| shares(i, &neighbours, &of));
        Self { count, shares: Lists::new(n, shares), of }
    }
}

/// Returns the aggregate of each particle, and the number of aggregates.
fn choose(neighbours: &Lists<(u32, f64)>, n: usize) -> (Vec<u32>, usize) {
    let (mut of, mut count) = (vec![NONE; n], 0);
    let is_alone = |i: usize| neighbours.of(i).is_empty();
    for i in 0..n {
        let mut reached = neighbours.of(i).iter().map(|(j, _)| *j as usize).chain([i]);
        if is_alone(i) || reached.clone().any(|j| of[j] != NONE) {
            continue;
        }
        reached.by_ref().for_each(|j| of[j] = count);
        count += 1;
    }
    let seeds = of.clone();
    for i in (0..n).filter(|i| seeds[*i] == NONE) {
        let near = neighbours.of(i).iter().map(|(j, s)| (seeds[*j as usize], *s));
        let near = near.filter(|(aggregate, _)| *aggregate != NONE);
        // The first of equally strong ones.
        if let Some((aggregate, _)) = near.reduce(|a, b| if b.1 > a.1 { b } else { a }) {
            of[i] = aggregate;
        }
    }
    for i in 0..n {
        if of[i] != NONE || is_alone(i) {
            continue;
        }
        let reached = neighbours.of(i).iter().map(|(j, _)| *j as usize).chain([i]);
        for j in reached {
            if of[j] == NONE {
                of[j] = count;
            }
        }
        count += 1;
    }
    (of, count as usize)
}

/// Returns the aggregates that a particle moves with, and their weights.
fn shares(i: usize, neighbours: &Lists<(u32, f64)>, of: &[u32]) -> Vec<(u32, (u32, f32))> {
    if of[i] == NONE {
        return vec![];
    }
    let all: f64 = neighbours.of(i).iter().map(|(_, s)| s).sum();
    let mut shares = vec![(i as u32, (of[i], 1.0 - NEIGHBOUR_WEIGHT as f32))];
    for (j, strength) in neighbours.of(i) {
        let (aggregate, share) = (of[*j as usize], (NEIGHBOUR_WEIGHT * strength / all) as f32);
        match shares.iter_mut().find(|(_, (a, _))| *a == aggregate) {
            Some((_, (_, sum))) => *sum += share,
            None => shares.push((i as u32, (aggregate, share))),
        }
    }
    shares
}
