//! Solids of linear tetrahedra. With the edges D = [x1 - x0, x2 - x0, x3 - x0] of a tetrahedron,
//! those at rest R and its volume at rest V, the deformation gradient is F = D R^-1, and the force
//! on corner k is -V P(F) `g_k`, where P is the stress and `g_k` row k of R^-1, the gradient of the
//! corner's shape function; corner 0 has minus the sum of the others.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

mod force;
mod material;
mod matrix;
mod number;
mod principal;
mod tangent;

use std::array::from_fn;

use nalgebra::{Matrix3, Vector3};

use crate::error::Error;
use matrix::{Matrix, product, three};
use number::Number;
use tangent::Pairs;

pub use material::{Hyperelastic, Material};

/// Volume over that of a cube on the longest edge below which a tetrahedron counts as flat.
const FLAT: f64 = 1e-9;

/// Number of tetrahedra in a block: as many as the longest vectors of a processor hold, or more.
const LANES: usize = 8;

/// Tetrahedra of one material.
#[derive(Clone, Debug)]
pub struct Solid {
    material: Material,
    /// Number of tetrahedra.
    count: usize,
    blocks: Vec<Block>,
    pairs: Pairs,
}

/// Tetrahedra beside one another. The last block repeats its last one.
#[derive(Clone, Debug, Default)]
struct Block {
    corners: [[u32; LANES]; 4],
    /// Gradients (1/m) of the shape functions of corners 1 to 3.
    gradients: [[[f64; LANES]; 3]; 3],
    /// Volume at rest (m3).
    volume: [f64; LANES],
}

/// Vectors at the corners of tetrahedra.
type Corners<N> = [[N; 3]; 4];

impl Solid {
    /// Tetrahedra between particles that are numbered from `first` on, with their positions (m) at
    /// rest. Corners 1, 2 and 3 of each turn counterclockwise as seen from corner 0 through them.
    ///
    /// # Errors
    /// There is no such material; a corner does not exist, or a tetrahedron is flat or inside out
    /// at rest.
    pub fn new(
        first: usize,
        tetrahedra: &[[u32; 4]],
        rest: &[Vector3<f64>],
        material: Material,
    ) -> Result<Self, Error> {
        material.check()?;
        let shapes = tetrahedra.iter().enumerate().map(|(k, corners)| {
            shape(corners, rest).map_err(|why| Error::Invalid(format!("tetrahedron {k} {why}")))
        });
        let shapes = shapes.collect::<Result<Vec<_>, Error>>()?;
        let mut blocks = vec![Block::default(); tetrahedra.len().div_ceil(LANES)];
        let most = tetrahedra.len().saturating_sub(1);
        for (k, lane) in (0..blocks.len() * LANES).map(|k| (k.min(most), k)) {
            let (block, lane) = (&mut blocks[lane / LANES], lane % LANES);
            let (gradients, volume) = &shapes[k];
            for (corner, i) in block.corners.iter_mut().zip(tetrahedra[k]) {
                corner[lane] = first as u32 + i;
            }
            for (row, own) in block.gradients.iter_mut().zip(gradients) {
                for (number, own) in row.iter_mut().zip(own) {
                    number[lane] = *own;
                }
            }
            block.volume[lane] = *volume;
        }
        let mut solid = Self {
            material,
            count: tetrahedra.len(),
            blocks,
            pairs: Pairs::default(),
        };
        solid.pairs = Pairs::new(solid.tetrahedra());
        Ok(solid)
    }

    /// Material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Corners of the tetrahedra.
    pub fn tetrahedra(&self) -> impl Iterator<Item = [u32; 4]> {
        (0..self.count).map(|k| {
            self.blocks[k / LANES]
                .corners
                .map(|corner| corner[k % LANES])
        })
    }

    /// Volume at rest of each tetrahedron (m3).
    pub fn volumes(&self) -> impl Iterator<Item = f64> {
        (0..self.count).map(|k| self.blocks[k / LANES].volume[k % LANES])
    }

    /// Corners of each tetrahedron, and its strain at x: the most by which a principal stretch
    /// differs from 1.
    pub(crate) fn strains(&self, x: &[f64]) -> impl Iterator<Item = ([u32; 4], f64)> {
        self.stretches(x).map(|(corners, stretches)| {
            let strain = stretches.iter().map(|stretch| (stretch - 1.0).abs());
            (corners, strain.fold(0.0, f64::max))
        })
    }

    /// Corners of each tetrahedron, and its principal stretches at x.
    pub(crate) fn stretches(&self, x: &[f64]) -> impl Iterator<Item = ([u32; 4], Vector3<f64>)> {
        self.deformed(x).map(|tetrahedron| {
            let f = Matrix3::from_fn(|row, column| tetrahedron.deformation[row][column]);
            (tetrahedron.corners, f.singular_values())
        })
    }

    /// Each neighbour of particle i in a tetrahedron, with its distance at rest (m).
    pub(crate) fn neighbours(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let each = self
            .tetrahedra()
            .enumerate()
            .filter_map(move |(k, corners)| {
                let own = corners.iter().position(|corner| *corner as usize == i)?;
                let rows = self.gradients(k);
                let edges = Matrix3::from_fn(|row, column| rows[row][column]).try_inverse()?;
                let place = |corner: usize| match corner {
                    0 => Vector3::zeros(),
                    corner => edges.column(corner - 1).into_owned(),
                };
                let far = |corner: usize| (place(corner) - place(own)).norm();
                Some([0, 1, 2, 3].map(|corner| (corners[corner] as usize, far(corner))))
            });
        each.flatten().filter(move |(other, _)| *other != i)
    }

    /// Gradients (1/m) of the shape functions of corners 1 to 3 of a tetrahedron.
    fn gradients(&self, k: usize) -> Matrix<f64> {
        let gradients = &self.blocks[k / LANES].gradients;
        gradients.map(|row| row.map(|number| number[k % LANES]))
    }

    /// Each tetrahedron: its corners, gradients, volume at rest, and deformation gradient at x.
    fn deformed(&self, x: &[f64]) -> impl Iterator<Item = Deformed> {
        let each = self.tetrahedra().zip(self.volumes()).enumerate();
        each.map(move |(k, (corners, volume))| {
            let gradients = self.gradients(k);
            let n = x.len() / 3;
            let places = corners.map(|i| from_fn(|axis| x[axis * n + i as usize]));
            Deformed {
                corners,
                volume,
                deformation: deformation(&gradients, &places),
                gradients,
            }
        })
    }
}

/// Tetrahedron in a state.
struct Deformed {
    corners: [u32; 4],
    /// Volume at rest (m3).
    volume: f64,
    /// Gradients (1/m) of the shape functions of corners 1 to 3.
    gradients: Matrix<f64>,
    /// Deformation gradient F.
    deformation: Matrix<f64>,
}

/// Derivative of a linear function, by its values at the corners.
#[inline(always)]
fn deformation<N: Number>(gradients: &Matrix<N>, a: &Corners<N>) -> Matrix<N> {
    let edges: Matrix<N> = three!(axis => three!(k => a[k + 1][axis] - a[0][axis]));
    product(&edges, gradients)
}

/// Gradients (1/m) of the shape functions of corners 1 to 3, and the volume (m3), or why there are
/// none.
fn shape(corners: &[u32; 4], rest: &[Vector3<f64>]) -> Result<(Matrix<f64>, f64), String> {
    if let Some(i) = corners.iter().find(|i| **i as usize >= rest.len()) {
        return Err(format!(
            "has corner {i}, but the particles are numbered 0 to {}",
            rest.len() - 1
        ));
    }
    let [a, b, c, d] = corners.map(|i| rest[i as usize]);
    let edges = Matrix3::from_columns(&[b - a, c - a, d - a]);
    let six = edges.determinant();
    let longest = [b - a, c - a, d - a, c - b, d - b, d - c].map(|edge| edge.norm());
    let longest = longest.into_iter().fold(0.0, f64::max);
    let [i, j, k, l] = corners;
    if six.is_nan() || six.abs() <= FLAT * longest.powi(3) {
        return Err(format!(
            "is flat: its corners {i}, {j}, {k} and {l} lie in a plane"
        ));
    }
    if six < 0.0 {
        return Err(format!(
            "is inside out: its corners {i}, {j}, {k} and {l} span minus its volume; with two of \
             them exchanged it is right"
        ));
    }
    let inverse = edges
        .try_inverse()
        .filter(|m| m.iter().all(|g| g.is_finite()));
    let inverse = inverse.ok_or_else(|| "is too small for numbers to describe".to_string())?;
    Ok((from_fn(|i| from_fn(|j| inverse[(i, j)])), six / 6.0))
}
