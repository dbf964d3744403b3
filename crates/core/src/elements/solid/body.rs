//! A solid: tetrahedra of one material, with their stretches and the neighbours of each particle.

use std::array::from_fn;

use nalgebra::{Matrix3, Vector3};

use super::material::Material;
use super::number::Matrix;
use super::tangent::Pairs;
use super::tetrahedra::{Block, Deformed, LANES, deformation, shape};
use crate::error::Error;

/// Tetrahedra of one material.
#[derive(Clone, Debug)]
pub struct Solid {
    pub(super) material: Material,
    /// Number of tetrahedra.
    pub(super) count: usize,
    pub(super) blocks: Vec<Block>,
    pub(super) pairs: Pairs,
}

impl Solid {
    /// Creates a solid between particles that are numbered from `first` on, with their positions
    /// (m) at rest. Corners 1, 2 and 3 of each turn counterclockwise as seen from corner 0 through
    /// them.
    ///
    /// # Errors
    /// A number of the material is out of its range; a corner does not exist, or a tetrahedron is
    /// flat or inside out at rest.
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
        let mut solid = Self { material, count: tetrahedra.len(), blocks, pairs: Pairs::default() };
        solid.pairs = Pairs::new(solid.tetrahedra());
        Ok(solid)
    }

    /// Returns the material.
    #[must_use]
    pub fn material(&self) -> &Material {
        &self.material
    }

    /// Returns the corners of the tetrahedra.
    pub fn tetrahedra(&self) -> impl Iterator<Item = [u32; 4]> {
        (0..self.count).map(|k| self.blocks[k / LANES].corners.map(|corner| corner[k % LANES]))
    }

    /// Returns the volume at rest of each tetrahedron (m3).
    pub fn volumes(&self) -> impl Iterator<Item = f64> {
        (0..self.count).map(|k| self.blocks[k / LANES].volume[k % LANES])
    }

    /// Returns the corners of each tetrahedron, and its strain at x: the largest difference of a
    /// principal stretch from 1.
    pub(crate) fn strains(&self, x: &[f64]) -> impl Iterator<Item = ([u32; 4], f64)> {
        self.stretches(x).map(|(corners, stretches)| {
            let strain = stretches.iter().map(|stretch| (stretch - 1.0).abs());
            (corners, strain.fold(0.0, f64::max))
        })
    }

    /// Returns the corners of each tetrahedron, and its principal stretches at x.
    pub(crate) fn stretches(&self, x: &[f64]) -> impl Iterator<Item = ([u32; 4], Vector3<f64>)> {
        self.deformed(x).map(|tetrahedron| {
            let f = Matrix3::from_fn(|row, column| tetrahedron.deformation[row][column]);
            (tetrahedron.corners, f.singular_values())
        })
    }

    /// Returns the stress (Pa) in each tetrahedron at positions x (m) and velocities v (m/s), as
    /// the deformed body has it, after Cauchy: P F^T / det F, with the first Piola-Kirchhoff stress
    /// P.
    pub fn stresses(&self, x: &[f64], v: &[f64]) -> impl Iterator<Item = Matrix3<f64>> {
        self.deformed(x).zip(self.deformed(v)).map(|(body, rate)| {
            let rate = (self.material.damping > 0.0).then_some(&rate.deformation);
            let stress = self.material.stress(&body.deformation, rate);
            let of = |rows: &Matrix<f64>| Matrix3::from_fn(|row, column| rows[row][column]);
            let f = of(&body.deformation);
            of(&stress) * f.transpose() / f.determinant()
        })
    }

    /// Returns the neighbours of particle i in tetrahedra, with their distances at rest (m).
    pub(crate) fn neighbours(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        let each = self.tetrahedra().enumerate().filter_map(move |(k, corners)| {
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

    /// Returns the gradients (1/m) of the shape functions of corners 1 to 3 of a tetrahedron.
    pub(super) fn gradients(&self, k: usize) -> Matrix<f64> {
        let gradients = &self.blocks[k / LANES].gradients;
        gradients.map(|row| row.map(|number| number[k % LANES]))
    }

    /// Returns each tetrahedron: its corners, gradients, volume at rest, and deformation gradient
    /// at x.
    pub(super) fn deformed(&self, x: &[f64]) -> impl Iterator<Item = Deformed> {
        let each = self.tetrahedra().zip(self.volumes()).enumerate();
        each.map(move |(k, (corners, volume))| {
            let gradients = self.gradients(k);
            let n = x.len() / 3;
            let places = corners.map(|i| from_fn(|axis| x[axis * n + i as usize]));
            Deformed { corners, volume, deformation: deformation(&gradients, &places), gradients }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::Hyperelastic;
    use super::*;

    /// A small stretch by e that narrows by Poisson's ratio needs the stress E e, whichever way the
    /// body is turned; a rate of stretching adds the damping's share.
    #[test]
    fn a_pulled_body_has_the_stress_of_hookes_law() {
        const E: f64 = 1e-6;
        let rest = [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
        let rest = rest.map(Vector3::from);
        for model in [Hyperelastic::NeoHookean, Hyperelastic::StVenantKirchhoff] {
            let material = Material { model, young: 2e5, poisson: 0.3, damping: 0.5 };
            let solid = Solid::new(0, &[[0, 1, 2, 3]], &rest, material).unwrap();
            let turn = nalgebra::Rotation3::from_euler_angles(0.3, -0.7, 1.1);
            let columns = |place: &dyn Fn(&Vector3<f64>) -> Vector3<f64>| -> Vec<f64> {
                let places = rest.map(|x| turn * place(&x));
                (0..12).map(|k| places[k % 4][k / 4]).collect()
            };
            let strain = Vector3::new(E, -0.3 * E, -0.3 * E);
            let x = columns(&|x| x + x.component_mul(&strain));
            let v = columns(&|x| 3.0 * x.component_mul(&strain));
            let still = solid.stresses(&x, &[0.0; 12]).next().unwrap();
            let moving = solid.stresses(&x, &v).next().unwrap();
            for (stress, value) in [(still, 2e5 * E), (moving, 2e5 * E * (1.0 + 0.5 * 3.0))] {
                let own = turn.inverse() * stress * turn;
                let mut expected = Matrix3::zeros();
                expected[(0, 0)] = value;
                assert!((own - expected).norm() < 1e-5 * value, "{own} {value}");
            }
        }
    }
}
