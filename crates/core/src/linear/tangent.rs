//! The matrix of an implicit step, A = M + a (C + D) + a2 K, from the couplings between particles: gathered once, and
//! multiplied without square roots. Pinned particles are filtered: their rows are those of the identity, and no vector
//! that is solved for has anything there.

use crate::system::{Coupling, Matrix, Mechanics};

/// A, K and what of it is needed to solve with them.
pub(crate) struct Tangent {
    couplings: Vec<Coupling>,
    /// Of each coupling in A: over all directions, and along it in addition.
    weights: Vec<[f64; 2]>,
    /// Of each particle in A; 0 where it is pinned.
    masses: Vec<f64>,
    /// 0 where it is pinned, 1 elsewhere.
    free: Vec<f64>,
    /// Whether stiffness across compressed springs counts as none.
    clamped: bool,
    /// Where and for what step it was gathered.
    x: Vec<f64>,
    a: f64,
}

impl Tangent {
    /// With room for all that couples in the system.
    pub fn new(mechanics: &dyn Mechanics) -> Self {
        let n = mechanics.inverse_masses().len();
        let mut couplings = vec![];
        mechanics.couplings(&vec![0.0; 3 * n], &mut |coupling| couplings.push(coupling));
        Self {
            weights: vec![[0.0; 2]; couplings.len()],
            couplings,
            masses: vec![0.0; n],
            free: vec![0.0; n],
            clamped: false,
            x: vec![0.0; 3 * n],
            a: 0.0,
        }
    }

    pub fn particles(&self) -> usize {
        self.masses.len()
    }

    pub fn couplings(&self) -> &[Coupling] {
        &self.couplings
    }

    /// Gathers the couplings at x for steps of length a (s). With `clamped`, stiffness across a compressed spring, which
    /// is negative, counts as none, and A is positive definite (Choi, Ko, *Stable but responsive cloth*, 2002).
    pub fn gather(&mut self, mechanics: &dyn Mechanics, x: &[f64], a: f64, clamped: bool) {
        self.couplings.clear();
        let couplings = &mut self.couplings;
        mechanics.couplings(x, &mut |coupling| couplings.push(coupling));
        self.clamped = clamped;
        self.weights.clear();
        self.weights.extend(self.couplings.iter().map(|c| {
            let across = if clamped { c.across.max(0.0) } else { c.across };
            [a * a * across, a * a * (c.along - across) + a * c.damping]
        }));
        let drag = a * mechanics.drag_coefficient();
        let particles = self.masses.iter_mut().zip(&mut self.free);
        for ((m, free), w) in particles.zip(mechanics.inverse_masses()) {
            (*m, *free) = if *w == 0.0 {
                (0.0, 0.0)
            } else {
                (1.0 / w + drag, 1.0)
            };
        }
        self.x.copy_from_slice(x);
        self.a = a;
    }

    /// The mass of each particle in A; 0 where it is pinned.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// The 3 x 3 block of each coupling in A: xx, yy, zz, xy, xz, yz.
    pub fn blocks(&self) -> impl Iterator<Item = (usize, usize, [f64; 6])> {
        self.couplings.iter().zip(&self.weights).map(|(c, w)| {
            let [x, y, z] = c.direction;
            let [iso, along] = *w;
            let block = [
                iso + along * x * x,
                iso + along * y * y,
                iso + along * z * z,
                along * x * y,
                along * x * z,
                along * y * z,
            ];
            (c.i, c.j, block)
        })
    }

    /// A bound of the largest a2 w2 of the particles: what the step makes of the fastest motion, squared.
    pub fn stiffness(&self, scratch: &mut [f64]) -> f64 {
        let n = self.particles();
        let sums = &mut scratch[..n];
        sums.fill(0.0);
        for (c, [iso, along]) in self.couplings.iter().zip(&self.weights) {
            let k = (iso + along).max(*iso);
            sums[c.i] += k;
            sums[c.j] += k;
        }
        let ratios = sums.iter().zip(&self.masses);
        ratios
            .filter(|(_, m)| **m > 0.0)
            .fold(0.0, |most: f64, (sum, m)| most.max(2.0 * sum / m))
    }

    /// out = A p, for a p without pinned particles; nor has out any.
    pub fn product(&self, mechanics: &dyn Mechanics, p: &[f64], out: &mut [f64]) {
        let matrix = Matrix {
            x: &self.x,
            a: self.a,
            clamped: self.clamped,
            masses: &self.masses,
            free: &self.free,
        };
        if mechanics.multiply(&matrix, p, out) {
            return;
        }
        let n = self.particles();
        for (out, p) in out.chunks_exact_mut(n).zip(p.chunks_exact(n)) {
            for ((out, p), m) in out.iter_mut().zip(p).zip(&self.masses) {
                *out = m * p;
            }
        }
        for (c, [iso, along]) in self.couplings.iter().zip(&self.weights) {
            add(c, *iso, *along, p, out);
        }
        self.filter(out);
    }

    /// out -= a K d, d with pinned particles: by what moving by d changes the forces, times a.
    pub fn subtract_stiffness(&self, a: f64, d: &[f64], out: &mut [f64]) {
        for c in &self.couplings {
            let across = if self.clamped {
                c.across.max(0.0)
            } else {
                c.across
            };
            add(c, -a * across, -a * (c.along - across), d, out);
        }
    }

    /// Nothing where particles are pinned.
    pub fn filter(&self, a: &mut [f64]) {
        let n = self.particles();
        for column in a.chunks_exact_mut(n) {
            for (a, m) in column.iter_mut().zip(&self.masses) {
                if *m == 0.0 {
                    *a = 0.0;
                }
            }
        }
    }
}

/// Adds (iso + along u uT) d at the one end of the coupling, and takes it away at the other.
#[inline]
fn add(c: &Coupling, iso: f64, along: f64, p: &[f64], out: &mut [f64]) {
    let n = p.len() / 3;
    let (i, j, u) = (c.i, c.j, c.direction);
    let d = [
        p[i] - p[j],
        p[n + i] - p[n + j],
        p[2 * n + i] - p[2 * n + j],
    ];
    let share = along * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
    for axis in 0..3 {
        let force = iso * d[axis] + share * u[axis];
        out[axis * n + i] += force;
        out[axis * n + j] -= force;
    }
}
