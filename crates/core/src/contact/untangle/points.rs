//! Points that pushes move, while links between them keep their lengths.

use nalgebra::Vector3;

use crate::contact::layer::ContactLayer;

/// Share of the movement of a round that goes on in the next.
const INERTIA: f64 = 0.9;
/// Number of passes over the links in a round.
const PASSES: usize = 8;
/// Share of the error of its length by which a pass corrects a link.
const STIFFNESS: f64 = 0.5;

/// What may move to bring surfaces apart.
pub(crate) struct Freedom<'a> {
    /// Pairs of particles whose distances are kept, as far as possible.
    pub links: &'a [[u32; 2]],
    /// Inverse mass of each particle (1/kg), 0 if it stays where it is. All points of a rigid body
    /// have that of the body.
    pub weights: &'a [f64],
}

/// Displacement of one side of a crossing relative to the other.
pub(super) struct Push {
    /// Points on both sides.
    pub points: [u32; 5],
    /// Shares of the points, which are negative on the other side and sum to 0.
    pub shares: [f64; 5],
    /// The displacement (m).
    pub by: Vector3<f64>,
}

/// Points in motion.
pub(super) struct Points<'a> {
    /// Positions (m), those of obstacles last.
    pub at: Vec<Vector3<f64>>,
    /// Their displacements in the last round (m).
    moved: Vec<Vector3<f64>>,
    /// Their inverse masses (1/kg).
    weights: Vec<f64>,
    /// The rigid body of each particle.
    solids: Vec<Option<usize>>,
    links: &'a [[u32; 2]],
    /// Lengths of the links at the beginning (m).
    lengths: Vec<f64>,
}

impl<'a> Points<'a> {
    pub fn new(layer: &ContactLayer, freedom: &Freedom<'a>, t: f64, x: &[f64]) -> Self {
        let surface = layer.surface();
        let mut at = vec![];
        surface.place(layer.obstacles(), t, x, &mut at);
        let mut weights = freedom.weights.to_vec();
        weights.resize(at.len(), 0.0);
        let mut solids = vec![None; at.len()];
        for (k, body) in surface.rigid().iter().enumerate() {
            for i in body.points().chain([body.center()]) {
                solids[i] = Some(k);
            }
        }
        let length = |[a, b]: &[u32; 2]| (at[*a as usize] - at[*b as usize]).norm();
        Self {
            moved: vec![Vector3::zeros(); at.len()],
            weights,
            solids,
            links: freedom.links,
            lengths: freedom.links.iter().map(length).collect(),
            at,
        }
    }

    /// Moves all points: by the mean of the pushes on them, or else by what `of_piece` says for
    /// them, with a share of their last movement; then so that links have their lengths again.
    pub fn advance(&mut self, pushes: &[Push], of_piece: impl Fn(usize) -> Option<Vector3<f64>>) {
        let mut sums = vec![(Vector3::zeros(), 0.0); self.at.len()];
        for Push { points, shares, by } in pushes {
            let pairs = || points.iter().map(|i| *i as usize).zip(shares);
            let least = pairs().map(|(i, share)| self.weights[i] * share * share);
            let least: f64 = least.sum();
            if least == 0.0 {
                continue;
            }
            for (i, share) in pairs().filter(|(i, share)| self.weights[*i] * **share != 0.0) {
                sums[i].0 += by * (self.weights[i] * share / least);
                sums[i].1 += 1.0;
            }
        }
        self.share_in_solids(&mut sums);
        let before = self.at.clone();
        for (i, (sum, count)) in sums.into_iter().enumerate() {
            let pushed = match count {
                _ if self.weights[i] == 0.0 => continue,
                0.0 if self.solids[i].is_some() => sum,
                0.0 => of_piece(i).unwrap_or_default(),
                count => sum / count,
            };
            self.at[i] += self.moved[i] * INERTIA + pushed;
        }
        for _ in 0..PASSES {
            self.correct_links();
        }
        for (moved, (at, before)) in self.moved.iter_mut().zip(self.at.iter().zip(before)) {
            *moved = at - before;
        }
    }

    /// Adds up the pushes on each rigid body, so that its points move alike.
    fn share_in_solids(&self, sums: &mut [(Vector3<f64>, f64)]) {
        let count = self
            .solids
            .iter()
            .flatten()
            .max()
            .map_or(0, |most| most + 1);
        let mut of_bodies = vec![(Vector3::zeros(), 0.0); count];
        for (solid, (sum, count)) in self.solids.iter().zip(sums.iter()) {
            if let Some(k) = solid {
                of_bodies[*k].0 += sum;
                of_bodies[*k].1 += count;
            }
        }
        for (solid, sum) in self.solids.iter().zip(sums) {
            if let Some(k) = solid {
                *sum = of_bodies[*k];
            }
        }
    }

    /// Moves the ends of each link towards its length.
    fn correct_links(&mut self) {
        let free = |i: usize| {
            if self.solids[i].is_some() {
                0.0
            } else {
                self.weights[i]
            }
        };
        for (link, length) in self.links.iter().zip(&self.lengths) {
            let [i, j] = link.map(|i| i as usize);
            let (a, b) = (free(i), free(j));
            let apart = self.at[j] - self.at[i];
            let now = apart.norm();
            if a + b > 0.0 && now > 0.0 {
                let by = apart * (STIFFNESS * (now - length) / now / (a + b));
                self.at[i] += by * a;
                self.at[j] -= by * b;
            }
        }
    }
}
