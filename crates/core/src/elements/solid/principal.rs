//! Principal stretches: F = U diag(s) VT with two rotations U and V. The last stretch is the
//! smallest, and is negative for an inverted tetrahedron.

use std::array::from_fn;

use super::matrix::{Matrix, column, dot};

/// Largest number of sweeps of rotations. Four are enough for all digits.
const SWEEPS: usize = 8;

/// Rotations U and V by their columns, and the stretches.
pub(super) struct Principal {
    pub u: [[f64; 3]; 3],
    pub stretches: [f64; 3],
    pub v: [[f64; 3]; 3],
}

impl Principal {
    pub fn new(f: &Matrix<f64>) -> Self {
        let columns: [[f64; 3]; 3] = from_fn(|k| column(f, k));
        let squares: Matrix<f64> = from_fn(|i| from_fn(|j| dot(columns[i], columns[j])));
        let (values, vectors) = eigen(squares);
        let mut order = [0, 1, 2];
        for (i, j) in [(0, 1), (1, 2), (0, 1)] {
            if values[order[i]] < values[order[j]] {
                order.swap(i, j);
            }
        }
        let [a, b, _] = order.map(|k| vectors[k]);
        let v = [a, b, cross(a, b)];
        let image = |v: [f64; 3]| f.map(|row| dot(row, v));
        let first = unit(image(a)).unwrap_or([1.0, 0.0, 0.0]);
        let second = image(b);
        let share = dot(second, first);
        let second = unit(from_fn(|k| second[k] - share * first[k]));
        let second = second.unwrap_or_else(|| perpendicular(first));
        let u = [first, second, cross(first, second)];
        Self {
            stretches: from_fn(|k| dot(u[k], image(v[k]))),
            u,
            v,
        }
    }
}

/// Returns the eigenvalues and eigenvectors of a symmetric matrix, by Jacobi's rotations.
pub(super) fn eigen(mut a: Matrix<f64>) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for _ in 0..SWEEPS {
        let size = a[0][0].abs() + a[1][1].abs() + a[2][2].abs();
        if a[0][1].abs() + a[0][2].abs() + a[1][2].abs() <= f64::EPSILON * 0.01 * size {
            break;
        }
        for [p, q] in [[0, 1], [0, 2], [1, 2]] {
            if a[p][q] == 0.0 {
                continue;
            }
            let slope = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
            let t = slope.signum() / (slope.abs() + (slope * slope + 1.0).sqrt());
            let c = 1.0 / (t * t + 1.0).sqrt();
            let s = t * c;
            for row in &mut a {
                let (x, y) = (row[p], row[q]);
                (row[p], row[q]) = (c * x - s * y, s * x + c * y);
            }
            for k in 0..3 {
                let (x, y) = (a[p][k], a[q][k]);
                (a[p][k], a[q][k]) = (c * x - s * y, s * x + c * y);
                let (x, y) = (vectors[p][k], vectors[q][k]);
                (vectors[p][k], vectors[q][k]) = (c * x - s * y, s * x + c * y);
            }
        }
    }
    ([a[0][0], a[1][1], a[2][2]], vectors)
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    from_fn(|k| {
        let (l, m) = ((k + 1) % 3, (k + 2) % 3);
        a[l] * b[m] - a[m] * b[l]
    })
}

/// Returns the vector scaled to length 1, if it is not 0.
fn unit(a: [f64; 3]) -> Option<[f64; 3]> {
    let length = dot(a, a).sqrt();
    (length > f64::MIN_POSITIVE).then(|| a.map(|x| x / length))
}

/// Returns a vector of length 1 perpendicular to one of length 1.
fn perpendicular(a: [f64; 3]) -> [f64; 3] {
    let axis = if a[0].abs() < 0.6 {
        [1.0, 0.0, 0.0]
    } else {
        [0.0, 1.0, 0.0]
    };
    unit(cross(a, axis)).unwrap_or(axis)
}
