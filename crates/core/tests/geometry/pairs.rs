//! Random pairs of primitives in motion, many of them degenerate.

use super::random::Random;
use a3_core::Vector3;
use a3_core::contact::PairKind;

/// Points and their displacements in a step (m).
pub struct Pair {
    pub kind: PairKind,
    pub from: [Vector3<f64>; 4],
    pub moves: [Vector3<f64>; 4],
}

/// Families of pairs.
pub const FAMILIES: [&str; 8] =
    ["general", "aimed", "grazing", "parallel", "coplanar", "sliver", "lattice", "still"];

impl Pair {
    /// Pair of a family, with coordinates around 1 or, one time in eight, around 1000.
    pub fn random(family: &str, random: &mut Random) -> Self {
        let kind = [PairKind::VertexTriangle, PairKind::EdgeEdge][random.below(2)];
        let length = random.magnitude(-4.0, 0.5);
        let mut pair =
            Self { kind, from: random.points(), moves: random.points().map(|u| u * length) };
        match family {
            "aimed" => pair.aim(false, random),
            "grazing" => pair.aim(true, random),
            "parallel" => pair.align(random),
            "coplanar" => pair.flatten(random),
            "sliver" => pair.squeeze(random),
            "lattice" => {
                // Every degeneracy occurs among small integers.
                let whole =
                    |random: &mut Random| Vector3::from_fn(|_, _| random.below(3) as f64 - 1.0);
                pair.from = std::array::from_fn(|_| whole(random));
                pair.moves = std::array::from_fn(|_| whole(random));
            }
            "still" => {
                let rigid = pair.moves[0];
                let parts = random.below(3);
                for i in 0..4 {
                    if parts == 0 || (i < kind.first()) == (parts == 1) {
                        pair.moves[i] = if random.below(2) == 0 { rigid } else { Vector3::zeros() };
                    }
                }
            }
            _ => {}
        }
        if random.below(8) == 0 {
            let far = random.point() * 1e3;
            pair.from = pair.from.map(|x| x + far);
        }
        pair
    }

    /// Weights of a point of each primitive: inside it, on a side of the triangle, or at a corner.
    fn weights(&self, random: &mut Random) -> [f64; 4] {
        let mut share = || [0.0, 1.0, random.share(), random.share()][random.below(4)];
        let (u, v) = (share(), share());
        if self.kind == PairKind::EdgeEdge {
            [1.0 - u, u, v - 1.0, -v]
        } else {
            [1.0, u - 1.0, -u * (1.0 - v), -u * v]
        }
    }

    /// Makes two points of the primitives meet at a time of the step, or miss by a little. If they
    /// graze, the first also moves along the second at that time.
    fn aim(&mut self, graze: bool, random: &mut Random) {
        let weights = self.weights(random);
        let t = [0.0, 1.0, random.share(), random.share()][random.below(4)];
        let first = self.kind.first();
        if graze {
            let at: [_; 4] = std::array::from_fn(|i| self.from[i] + self.moves[i] * t);
            let normal = match self.kind {
                PairKind::EdgeEdge => (at[1] - at[0]).cross(&(at[3] - at[2])),
                _ => (at[2] - at[1]).cross(&(at[3] - at[1])),
            };
            let rate = sum(&weights, &self.moves);
            let along = normal * (rate.dot(&normal) / normal.norm_squared());
            for u in &mut self.moves[..first] {
                *u -= along;
            }
        }
        let offset = sum(&weights, &self.from) + sum(&weights, &self.moves) * t;
        let miss = if random.below(2) == 0 {
            Vector3::zeros()
        } else {
            random.point() * random.magnitude(-12.0, -2.0)
        };
        for x in &mut self.from[..first] {
            *x += miss - offset;
        }
    }

    /// Makes two edges parallel, or nearly so, and may let them meet.
    fn align(&mut self, random: &mut Random) {
        self.kind = PairKind::EdgeEdge;
        let noise = |random: &mut Random| match random.below(3) {
            0 => Vector3::zeros(),
            _ => random.point() * random.magnitude(-14.0, -4.0),
        };
        let along = (self.from[1] - self.from[0]) * random.signed();
        self.from[3] = self.from[2] + along + noise(random);
        if random.below(2) == 0 {
            self.moves[1] = self.moves[0];
            self.moves[3] = self.moves[2] + noise(random);
        }
        if random.below(2) == 0 {
            self.aim(false, random);
        }
    }

    /// Puts all points into a plane, in which some move, and which a few may leave.
    fn flatten(&mut self, random: &mut Random) {
        let axis = random.below(3);
        let height = [0.0, random.signed()][random.below(2)];
        let stay = random.below(2) == 0;
        for i in 0..4 {
            self.from[i][axis] = height;
            if stay || random.below(2) == 0 {
                self.moves[i][axis] = 0.0;
            }
        }
    }

    /// Makes the triangle, or an edge, thin, short or a point, and may let the primitives meet.
    fn squeeze(&mut self, random: &mut Random) {
        let last = match random.below(3) {
            0 => self.from[2],
            _ => self.from[1] + (self.from[2] - self.from[1]) * random.signed(),
        };
        self.from[3] = last
            + match random.below(3) {
                0 => Vector3::zeros(),
                _ => random.point() * random.magnitude(-14.0, -3.0),
            };
        if random.below(2) == 0 {
            self.moves[3] = self.moves[2];
        }
        if random.below(2) == 0 {
            self.aim(false, random);
        }
    }
}

fn sum(weights: &[f64; 4], vectors: &[Vector3<f64>; 4]) -> Vector3<f64> {
    a3_core::contact::weighted(weights, vectors)
}
