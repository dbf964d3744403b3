//! Stiffness and damping of solids between pairs of particles. In the frame of the principal
//! stretches, the second derivative of an isotropic energy is a 3 x 3 block between the stretches
//! and, for each pair of axes, one eigenvalue where they shear alike (flip) and one where they turn
//! (twist): Smith, de Goes, Kim, *Analytic Eigensystems for Isotropic Distortion Energies*, 2019.
//!
//! Principal stretches: F = U diag(s) VT with two rotations U and V. The last stretch is the
//! smallest, and is negative for an inverted tetrahedron.

use std::array::from_fn;

use super::material::{Hyperelastic, Material};
use super::number::{Matrix, cofactors, column, dot};
use super::tetrahedra::Deformed;
use crate::coupling::{Coupling, GeneralCoupling};
use crate::scratch::Scratch;

/// Pairs of corners of a tetrahedron.
const CORNERS: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// Stiffness (N/m) and damping (N s/m) of a pair of particles.
type PairSums = [[f64; 9]; 2];

/// Pairs of particles that are in one tetrahedron.
#[derive(Clone, Debug, Default)]
pub(super) struct Pairs {
    /// Particles of each pair, the lower number first, in order.
    ends: Vec<[u32; 2]>,
    /// Index of the pair of each two corners of each tetrahedron.
    places: Vec<[u32; 6]>,
    /// Sums over tetrahedra.
    sums: Scratch<Vec<PairSums>>,
}

impl Pairs {
    pub fn new(tetrahedra: impl Iterator<Item = [u32; 4]>) -> Self {
        let pairs = |t: [u32; 4]| CORNERS.map(|[k, l]| [t[k].min(t[l]), t[k].max(t[l])]);
        let all: Vec<_> = tetrahedra.map(pairs).collect();
        let mut ends = all.concat();
        ends.sort_unstable();
        ends.dedup();
        let place = |pair: [u32; 2]| ends.partition_point(|other| *other < pair) as u32;
        Self {
            places: all.into_iter().map(|pairs| pairs.map(place)).collect(),
            sums: Scratch::default(),
            ends,
        }
    }

    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// Visits the couplings of all pairs, in order, for tetrahedra of a material.
    pub(super) fn visit_couplings(
        &self,
        material: &Material,
        tetrahedra: impl Iterator<Item = Deformed>,
        clamped: bool,
        visit: &mut dyn FnMut(Coupling),
    ) {
        self.sums.lend(|all| {
            all.clear();
            all.resize(self.ends.len(), PairSums::default());
            for (tetrahedron, places) in tetrahedra.zip(&self.places) {
                let hessian = Hessian::new(material, &tetrahedron, clamped);
                for ([k, l], place) in CORNERS.into_iter().zip(places) {
                    // The pair has the lower number first.
                    let swapped = tetrahedron.corners[k] > tetrahedron.corners[l];
                    let pair = if swapped { [l, k] } else { [k, l] };
                    hessian.add(material, &tetrahedron, pair, &mut all[*place as usize]);
                }
            }
            for ([i, j], [stiffness, damping]) in self.ends.iter().zip(all) {
                visit(Coupling::General(GeneralCoupling {
                    i: *i as usize,
                    j: *j as usize,
                    stiffness: *stiffness,
                    damping: *damping,
                }));
            }
        });
    }
}

/// Second derivative of a tetrahedron's energy with respect to its deformation gradient, in the
/// principal frame.
struct Hessian {
    frame: Principal,
    /// Block between the stretches (Pa).
    stretch: Matrix<f64>,
    /// Eigenvalues of shear and of turn in the plane across each axis (Pa).
    flip: [f64; 3],
    twist: [f64; 3],
    /// Gradients (1/m) of the shape functions of all corners, in the world and in the frame.
    gradients: [[f64; 3]; 4],
    framed: [[f64; 3]; 4],
}

impl Hessian {
    /// Computes the second derivative. With `clamped`, negative eigenvalues are taken as zero.
    fn new(material: &Material, tetrahedron: &Deformed, clamped: bool) -> Self {
        let frame = Principal::new(&tetrahedron.deformation);
        let (mut stretch, mut flip, mut twist) = eigensystem(material, frame.stretches);
        if clamped {
            (flip, twist) = (flip.map(|e| e.max(0.0)), twist.map(|e| e.max(0.0)));
            if !is_definite(&stretch) {
                stretch = positive_part(stretch);
            }
        }
        let [a, b, c] = tetrahedron.gradients;
        let gradients = [from_fn(|k| -(a[k] + b[k] + c[k])), a, b, c];
        Self {
            stretch,
            flip,
            twist,
            framed: gradients.map(|g| frame.v.map(|v| dot(v, g))),
            gradients,
            frame,
        }
    }

    /// Adds the stiffness and the damping between two corners.
    fn add(
        &self,
        material: &Material,
        tetrahedron: &Deformed,
        [k, l]: [usize; 2],
        [stiffness, damping]: &mut PairSums,
    ) {
        let (a, b) = (self.framed[k], self.framed[l]);
        // The derivative of the force along axis i of the frame for a motion along axis j.
        let framed: Matrix<f64> = from_fn(|i| {
            from_fn(|j| {
                let stretch = self.stretch[i][j] * a[i] * b[j];
                let across = |m: usize| 0.5 * (self.flip[m] + self.twist[m]);
                if i == j {
                    let [m, o] = [(i + 1) % 3, (i + 2) % 3];
                    stretch + across(o) * a[m] * b[m] + across(m) * a[o] * b[o]
                } else {
                    let m = 3 - i - j;
                    stretch + 0.5 * (self.flip[m] - self.twist[m]) * a[j] * b[i]
                }
            })
        });
        let u = &self.frame.u;
        let half: Matrix<f64> = from_fn(|i| {
            from_fn(|axis| {
                framed[i][0] * u[0][axis] + framed[i][1] * u[1][axis] + framed[i][2] * u[2][axis]
            })
        });
        let volume = tetrahedron.volume;
        for (part, sum) in stiffness.iter_mut().enumerate() {
            let (row, column) = (part / 3, part % 3);
            let whole = u[0][row] * half[0][column]
                + u[1][row] * half[1][column]
                + u[2][row] * half[2][column];
            *sum -= volume * whole;
        }
        if material.damping > 0.0 {
            let [lambda, mu] = material.lame();
            let scale = volume * material.damping;
            let f = &tetrahedron.deformation;
            let (g, h) = (self.gradients[k], self.gradients[l]);
            let (fg, fh) = (f.map(|row| dot(row, g)), f.map(|row| dot(row, h)));
            for (part, sum) in damping.iter_mut().enumerate() {
                let (row, column) = (part / 3, part % 3);
                let shear = dot(g, h) * dot(f[row], f[column]) + fh[row] * fg[column];
                *sum -= scale * (lambda * fg[row] * fh[column] + mu * shear);
            }
        }
    }
}

/// Returns whether a symmetric matrix is positive definite.
fn is_definite(a: &Matrix<f64>) -> bool {
    let cofactors = cofactors(a);
    a[0][0] > 0.0 && cofactors[2][2] > 0.0 && dot(a[0], cofactors[0]) > 0.0
}

/// Returns a symmetric matrix with its negative eigenvalues taken as zero.
fn positive_part(a: Matrix<f64>) -> Matrix<f64> {
    let (values, vectors) = eigen(a);
    let of = |i: usize, j: usize, k: usize| values[k].max(0.0) * vectors[k][i] * vectors[k][j];
    from_fn(|i| from_fn(|j| of(i, j, 0) + of(i, j, 1) + of(i, j, 2)))
}

/// Returns the second derivatives of the energy per volume with respect to the stretches s (Pa),
/// and, in the plane across each axis, (`e_i` - `e_j`) / (`s_i` - `s_j`) and (`e_i` + `e_j`) /
/// (`s_i` + `s_j`) of its first derivatives e.
fn eigensystem(material: &Material, s: [f64; 3]) -> (Matrix<f64>, [f64; 3], [f64; 3]) {
    let others = |k: usize| [s[(k + 1) % 3], s[(k + 2) % 3]];
    match material.model {
        Hyperelastic::NeoHookean => {
            let [m, l, rest] = material.neo_hookean();
            let size = dot(s, s) + 1.0;
            let (along, log) = (m - m / size, 2.0 * m / (size * size));
            let pressure = l * (s[0] * s[1] * s[2] - rest);
            let area = |k: usize| others(k)[0] * others(k)[1];
            let stretch = from_fn(|i| {
                from_fn(|j| {
                    let both = log * s[i] * s[j] + l * area(i) * area(j);
                    both + if i == j { along } else { pressure * s[3 - i - j] }
                })
            });
            let (flip, twist) = (s.map(|s| along - pressure * s), s.map(|s| along + pressure * s));
            (stretch, flip, twist)
        }
        Hyperelastic::StVenantKirchhoff => {
            let [lambda, mu] = material.lame();
            let pressure = 0.5 * lambda * (dot(s, s) - 3.0);
            let stretch = from_fn(|i| {
                from_fn(|j| {
                    let own = pressure + mu * (3.0 * s[i] * s[i] - 1.0);
                    lambda * s[i] * s[j] + if i == j { own } else { 0.0 }
                })
            });
            let shear = |sign: f64| {
                from_fn(|k| {
                    let [a, b] = others(k);
                    pressure + mu * (a * a + sign * a * b + b * b - 1.0)
                })
            };
            (stretch, shear(1.0), shear(-1.0))
        }
    }
}

/// Largest number of sweeps of rotations. Four are enough for all digits.
const SWEEPS: usize = 8;

/// Rotations U and V by their columns, and the stretches.
struct Principal {
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
        Self { stretches: from_fn(|k| dot(u[k], image(v[k]))), u, v }
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
    let axis = if a[0].abs() < 0.6 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    unit(cross(a, axis)).unwrap_or(axis)
}
