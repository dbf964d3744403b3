//! Forces of solids, eight tetrahedra at a time. What each adds to its corners is the same for any
//! vectors of the processor, and is added in the order of the tetrahedra.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use std::array::from_fn;

use pulp::Arch;

use super::material::Material;
use super::matrix::{Matrix, scaled};
use super::number::{Dual, LANES, Lanes, Number};
use super::{Block, Corners, Solid, deformation};
use crate::elements::force::{At, Cost, Force, check_particle};
use crate::energy::Energy;
use crate::error::Error;
use crate::system::Coupling;

/// Price of a tetrahedron, in single springs.
const PRICE: f64 = 3.0;

impl Force for Solid {
    fn name(&self) -> &'static str {
        "solid"
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        let mut corners = self.tetrahedra().flatten();
        corners.try_for_each(|i| check_particle(i as usize, particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        Arch::new().dispatch(|| {
            for (block, count) in self.counted() {
                let x = gather(block, at.x);
                let v = self.reads_velocity().then(|| gather(block, at.v));
                scatter(
                    block,
                    count,
                    &forces(&self.material, block, &x, v.as_ref()),
                    f,
                );
            }
        });
    }

    fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        Arch::new().dispatch(|| {
            for (block, count) in self.counted() {
                let x = gather_dual(block, at.x, dx);
                let v = self.reads_velocity().then(|| gather_dual(block, at.v, dv));
                let forces = forces(&self.material, block, &x, v.as_ref());
                let changes = forces.map(|force| force.map(|number| number.change));
                scatter(block, count, &changes, df);
            }
        });
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        self.visit_couplings(x, clamped, visit);
    }

    fn energy(&self, at: &At) -> Energy {
        let of_one = |t: super::Deformed| t.volume * self.material.energy(&t.deformation);
        Energy {
            elastic: self.deformed(at.x).map(of_one).sum(),
            ..Energy::default()
        }
    }

    fn reads_velocity(&self) -> bool {
        self.material.damping > 0.0
    }

    fn cost(&self) -> Cost {
        Cost {
            couplings: self.pairs.len() as f64,
            price: PRICE * self.count as f64,
        }
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        self.material.young *= stiffness;
        self.material.damping *= damping / stiffness;
    }
}

impl Solid {
    /// The blocks, and the number of tetrahedra in each.
    #[inline(always)]
    fn counted(&self) -> impl Iterator<Item = (&Block, usize)> {
        let blocks = self.blocks.iter().enumerate();
        blocks.map(|(k, block)| (block, LANES.min(self.count - k * LANES)))
    }
}

/// Forces (N) on the corners.
#[inline(always)]
fn forces<N: Number + From<Lanes>>(
    material: &Material,
    block: &Block,
    x: &Corners<N>,
    v: Option<&Corners<N>>,
) -> Corners<N> {
    let gradients: Matrix<N> = block.gradients.map(|row| row.map(N::from));
    let rate = v.map(|v| deformation(&gradients, v));
    let stress = material.stress(&deformation(&gradients, x), rate.as_ref());
    let stress = scaled(N::of(0.0) - N::from(block.volume), &stress);
    let ends: Matrix<N> = gradients.map(|g| stress.map(|row| super::dot(row, g)));
    let [a, b, c] = ends;
    [
        from_fn(|axis| N::of(0.0) - (a[axis] + b[axis] + c[axis])),
        a,
        b,
        c,
    ]
}

/// Vectors at the corners, out of an n x 3 matrix.
#[inline(always)]
fn gather(block: &Block, a: &[f64]) -> Corners<Lanes> {
    let n = a.len() / 3;
    let columns = [&a[..n], &a[n..2 * n], &a[2 * n..]];
    let of = |corner: [u32; LANES]| columns.map(|column| Lanes(corner.map(|i| column[i as usize])));
    block.corners.map(of)
}

#[inline(always)]
fn gather_dual(block: &Block, a: &[f64], da: &[f64]) -> Corners<Dual<Lanes>> {
    let (values, changes) = (gather(block, a), gather(block, da));
    from_fn(|corner| {
        from_fn(|axis| Dual {
            value: values[corner][axis],
            change: changes[corner][axis],
        })
    })
}

/// Adds vectors at the corners of so many tetrahedra to an n x 3 matrix.
#[inline(always)]
fn scatter(block: &Block, count: usize, vectors: &Corners<Lanes>, f: &mut [f64]) {
    let n = f.len() / 3;
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for (corner, [x, y, z]) in block.corners.iter().zip(vectors) {
        for lane in 0..count {
            let i = corner[lane] as usize;
            fx[i] += x.0[lane];
            fy[i] += y.0[lane];
            fz[i] += z.0[lane];
        }
    }
}
