//! A lambda = b with A = J W J^T, from the rows of J and without A, by conjugate residuals:
//! conjugate gradients' sister, which takes the same products with A, and makes |b - A lambda|
//! least at each step. Where rows depend on one another A is singular, and it finds one of the
//! solutions; where they contradict one another there is none, and it finds what comes nearest,
//! while conjugate gradients would go to infinity. Rows are scaled so that the diagonal of A is 1.

use nalgebra::Vector3;

/// Residual at which the iteration ends, relative to b: rounding leaves as much.
const TOLERANCE: f64 = 1e-15;
/// Largest number of iterations per row: one would be enough without rounding.
const MOST: usize = 4;

/// A row of J, with its component of each vector of the iteration.
#[derive(Debug)]
pub(super) struct Row {
    /// Places of its particles: the second one's part of the row is the opposite of the first
    /// one's.
    ends: [usize; 2],
    gradient: Vector3<f64>,
    /// Multiplier lambda.
    pub multiplier: f64,
    /// Residual r = b - A lambda.
    residual: f64,
    /// Direction p, and its image A p.
    direction: f64,
    image: f64,
}

impl Row {
    /// A row, scaled. `weight` is the sum of the inverse masses of both ends (1/kg): with 0, no
    /// force can do what is wanted, and the row is left out.
    pub fn new(ends: [usize; 2], gradient: Vector3<f64>, weight: f64, wanted: f64) -> Self {
        let diagonal = weight * gradient.norm_squared();
        let scale = if diagonal > 0.0 {
            1.0 / diagonal.sqrt()
        } else {
            0.0
        };
        Self {
            ends,
            gradient: gradient * scale,
            multiplier: 0.0,
            residual: wanted * scale,
            direction: 0.0,
            image: 0.0,
        }
    }
}

/// Scratch of an evaluation: inverse masses (1/kg) and vectors of the particles that are held, and
/// the rows.
#[derive(Debug, Default)]
pub(super) struct Scratch {
    pub weights: Vec<f64>,
    pub vectors: Vec<Vector3<f64>>,
    pub rows: Vec<Row>,
}

impl Scratch {
    /// Makes room for so many rows and particles.
    pub fn reserve(&mut self, rows: usize, particles: usize) {
        self.weights.clear();
        self.vectors.clear();
        self.rows.clear();
        self.weights.reserve(particles);
        self.vectors.reserve(particles);
        self.rows.reserve(rows);
    }
}

/// Writes J^T to out, times the vector whose numbers `of` reads off the rows.
pub(super) fn transpose(rows: &[Row], of: impl Fn(&Row) -> f64, out: &mut [Vector3<f64>]) {
    out.fill(Vector3::zeros());
    for row in rows {
        let [i, j] = row.ends;
        let part = row.gradient * of(row);
        out[i] += part;
        out[j] -= part;
    }
}

/// Finds the multipliers, beginning with zero. `u` is scratch.
pub(super) fn solve(rows: &mut [Row], weights: &[f64], u: &mut [Vector3<f64>]) {
    let all: f64 = rows.iter().map(|row| row.residual * row.residual).sum();
    let mut last = f64::INFINITY;
    for _ in 0..MOST * rows.len() {
        // u = W J^T r, and r . A r from it: never below zero.
        transpose(rows, |row| row.residual, u);
        let mut rest = 0.0;
        for (u, w) in u.iter_mut().zip(weights) {
            rest += w * u.norm_squared();
            *u *= *w;
        }
        let turn = rest / last;
        last = rest;
        let mut square = 0.0;
        for row in &mut *rows {
            let [i, j] = row.ends;
            row.direction = row.residual + turn * row.direction;
            row.image = row.gradient.dot(&(u[i] - u[j])) + turn * row.image;
            square += row.image * row.image;
        }
        // Written so that NaN ends it.
        if !(rest > TOLERANCE * TOLERANCE * all && square > 0.0) {
            return;
        }
        let step = rest / square;
        for row in &mut *rows {
            row.multiplier += step * row.direction;
            row.residual -= step * row.image;
        }
    }
}
