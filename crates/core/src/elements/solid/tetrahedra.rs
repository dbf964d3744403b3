//! Tetrahedra at rest, in blocks for SIMD vectors, and single ones in a state.

use std::array::from_fn;

use nalgebra::{Matrix3, Vector3};

use super::number::{Matrix, Number, product, three};

/// Smallest volume of a tetrahedron that is not flat, over that of a cube on its longest edge.
const MIN_VOLUME: f64 = 1e-9;

/// Number of tetrahedra in a block: at least as many as the longest SIMD vector holds.
pub(super) const LANES: usize = 8;

/// Block of tetrahedra at rest. The last block repeats its last tetrahedron.
#[derive(Clone, Debug, Default)]
pub(super) struct Block {
    pub(super) corners: [[u32; LANES]; 4],
    /// Gradients (1/m) of the shape functions of corners 1 to 3.
    pub(super) gradients: [[[f64; LANES]; 3]; 3],
    /// Volume at rest (m3).
    pub(super) volume: [f64; LANES],
}

/// Vectors at the corners of tetrahedra.
pub(super) type Corners<N> = [[N; 3]; 4];

/// Tetrahedron in a state.
pub(super) struct Deformed {
    pub(super) corners: [u32; 4],
    /// Volume at rest (m3).
    pub(super) volume: f64,
    /// Gradients (1/m) of the shape functions of corners 1 to 3.
    pub(super) gradients: Matrix<f64>,
    /// Deformation gradient F.
    pub(super) deformation: Matrix<f64>,
}

/// Returns the derivative of a linear function, from its values at the corners.
#[inline(always)]
pub(super) fn deformation<N: Number>(gradients: &Matrix<N>, a: &Corners<N>) -> Matrix<N> {
    let edges: Matrix<N> = three!(axis => three!(k => a[k + 1][axis] - a[0][axis]));
    product(&edges, gradients)
}

/// Returns the gradients (1/m) of the shape functions of corners 1 to 3 and the volume (m3), or the
/// reason why there are none.
pub(super) fn shape(
    corners: &[u32; 4],
    rest: &[Vector3<f64>],
) -> Result<(Matrix<f64>, f64), String> {
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
    if six.is_nan() || six.abs() <= MIN_VOLUME * longest.powi(3) {
        return Err(format!("is flat: its corners {i}, {j}, {k} and {l} lie in a plane"));
    }
    if six < 0.0 {
        return Err(format!(
            "is inside out: its corners {i}, {j}, {k} and {l} span minus its volume; with two of \
             them exchanged it is right"
        ));
    }
    let inverse = edges.try_inverse().filter(|m| m.iter().all(|g| g.is_finite()));
    let inverse = inverse.ok_or_else(|| "is too small for numbers to describe".to_string())?;
    Ok((from_fn(|i| from_fn(|j| inverse[(i, j)])), six / 6.0))
}
