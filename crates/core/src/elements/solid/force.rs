//! Forces of solids, in SIMD vectors. The forces of a tetrahedron on its corners are the same for
//! any length of the vectors, and are added in one order.

#![expect(
    clippy::inline_always,
    reason = "what is inlined into pulp's dispatch is compiled for the vectors that it found, and nothing else"
)]

use pulp::{Simd, WithSimd};

use super::body::Solid;
use super::material::Material;
use super::number::{Dual, Matrix, Number, dot, scaled, three};
use super::tetrahedra::{Block, Corners, Deformed, LANES, deformation};
use crate::coupling::Coupling;
use crate::elements::force::{At, Cost, Force, Matter, check_particle};
use crate::energy::Energy;
use crate::error::Error;
use crate::lanes::Lanes;
use crate::vectors::Arch;

/// Prices of a tetrahedron's forces, without viscosity and with it, and of the assembly of its
/// couplings, in evaluations of one single spring.
const PRICES: [f64; 2] = [3.7, 5.2];
const ASSEMBLY: f64 = 270.0;

impl Force for Solid {
    fn name(&self) -> &'static str {
        "solid"
    }

    fn damping_name(&self) -> &'static str {
        "viscosity"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Elastic)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        let mut corners = self.tetrahedra().flatten();
        corners.try_for_each(|i| check_particle(i as usize, particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        Arch::new().dispatch(SolidForces { solid: self, values: [at.x, at.v], changes: None, f });
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        Arch::new().dispatch(SolidForces {
            solid: self,
            values: [at.x, at.v],
            changes: Some(d),
            f: df,
        });
    }

    fn couplings(&self, _t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        self.pairs.visit_couplings(&self.material, self.deformed(x), clamped, visit);
    }

    fn energy(&self, at: &At) -> Energy {
        let of_one = |t: Deformed| t.volume * self.material.energy(&t.deformation);
        Energy { elastic: self.deformed(at.x).map(of_one).sum(), ..Energy::default() }
    }

    fn reads_velocity(&self) -> bool {
        self.material.damping > 0.0
    }

    fn cost(&self) -> Cost {
        Cost {
            couplings: self.pairs.len() as f64,
            price: PRICES[usize::from(self.reads_velocity())] * self.count as f64,
        }
    }

    fn assembly(&self) -> f64 {
        ASSEMBLY * self.count as f64
    }

    fn scale(&mut self, stiffness: f64, damping: f64) {
        self.material.young *= stiffness;
        self.material.damping *= damping / stiffness;
    }
}

/// Task that adds the forces of a solid to f, or their differential.
struct SolidForces<'a> {
    solid: &'a Solid,
    /// Positions (m) and velocities (m/s).
    values: [&'a [f64]; 2],
    /// Changes of these, for a differential.
    changes: Option<[&'a [f64]; 2]>,
    f: &'a mut [f64],
}

impl WithSimd for SolidForces<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let (material, count) = (&self.solid.material, self.solid.count);
        let damped = material.damping > 0.0;
        let [x, v] = self.values;
        for (k, block) in self.solid.blocks.iter().enumerate() {
            let none = [[[0.0; LANES]; 3]; 4];
            let x = gather(block, x);
            let v = if damped { gather(block, v) } else { none };
            let [dx, dv] = match self.changes {
                Some([dx, dv]) => {
                    [gather(block, dx), if damped { gather(block, dv) } else { none }]
                }
                None => [none; 2],
            };
            let mut forces = none;
            for part in 0..LANES / S::F64_LANES {
                let rest = RestShape::new(simd, block, part);
                let (at, moving) = (corners(simd, &x, part), corners(simd, &v, part));
                let own = if self.changes.is_none() {
                    rest.forces(material, &at, if damped { Some(&moving) } else { None })
                } else {
                    let at = dual(&at, &corners(simd, &dx, part));
                    let moving = dual(&moving, &corners(simd, &dv, part));
                    let moving = if damped { Some(&moving) } else { None };
                    let [a, b, c, d] = rest.dual().forces(material, &at, moving);
                    [changes(&a), changes(&b), changes(&c), changes(&d)]
                };
                for (all, own) in forces.iter_mut().zip(&own) {
                    for (all, own) in all.iter_mut().zip(own) {
                        S::as_mut_simd_f64s(all).0[part] = own.value;
                    }
                }
            }
            scatter(block, LANES.min(count - k * LANES), &forces, self.f);
        }
    }
}

/// Returns SIMD vectors number `part` of the numbers of a block.
#[inline(always)]
fn corners<S: Simd>(simd: S, a: &Corners<[f64; LANES]>, part: usize) -> Corners<Lanes<S>> {
    let [first, ends @ ..] = a;
    let [a, b, c] = matrix(simd, ends, part);
    [three!(axis => vector(simd, &first[axis], part)), a, b, c]
}

#[inline(always)]
fn matrix<S: Simd>(simd: S, a: &Matrix<[f64; LANES]>, part: usize) -> Matrix<Lanes<S>> {
    three!(i => three!(j => vector(simd, &a[i][j], part)))
}

#[inline(always)]
fn vector<S: Simd>(simd: S, numbers: &[f64; LANES], part: usize) -> Lanes<S> {
    let value = S::as_simd_f64s(numbers).0[part];
    Lanes { simd, value }
}

#[inline(always)]
fn dual<N: Number>(values: &Corners<N>, changes: &Corners<N>) -> Corners<Dual<N>> {
    let [a, b, c, d] = values;
    let [da, db, dc, dd] = changes;
    [pair(a, da), pair(b, db), pair(c, dc), pair(d, dd)]
}

#[inline(always)]
fn pair<N: Number>(values: &[N; 3], changes: &[N; 3]) -> [Dual<N>; 3] {
    three!(axis => Dual { value: values[axis], change: changes[axis] })
}

#[inline(always)]
fn changes<N: Number>(a: &[Dual<N>; 3]) -> [N; 3] {
    three!(axis => a[axis].change)
}

/// Shape of tetrahedra at rest.
struct RestShape<N> {
    gradients: Matrix<N>,
    volume: N,
}

impl<S: Simd> RestShape<Lanes<S>> {
    #[inline(always)]
    fn new(simd: S, block: &Block, part: usize) -> Self {
        Self {
            gradients: matrix(simd, &block.gradients, part),
            volume: vector(simd, &block.volume, part),
        }
    }
}

impl<N: Number> RestShape<N> {
    /// Returns the same shape in dual numbers, whose differentials are 0.
    #[inline(always)]
    fn dual(&self) -> RestShape<Dual<N>> {
        let Self { gradients, volume } = self;
        let zero = volume.constant(0.0);
        RestShape {
            gradients: three!(i => pair(&gradients[i], &[zero; 3])),
            volume: Dual { value: *volume, change: zero },
        }
    }

    /// Returns the forces (N) on the corners.
    #[inline(always)]
    fn forces(&self, material: &Material, x: &Corners<N>, v: Option<&Corners<N>>) -> Corners<N> {
        let Self { gradients, volume } = self;
        let rate = match v {
            Some(v) => Some(deformation(gradients, v)),
            None => None,
        };
        let stress = material.stress(&deformation(gradients, x), rate.as_ref());
        let zero = volume.constant(0.0);
        let stress = scaled(zero - *volume, &stress);
        let [a, b, c]: Matrix<N> = three!(k => three!(axis => dot(stress[axis], gradients[k])));
        let first = three!(axis => zero - (a[axis] + b[axis] + c[axis]));
        [first, a, b, c]
    }
}

/// Returns the vectors at the corners, from an n x 3 matrix.
#[inline(always)]
fn gather(block: &Block, a: &[f64]) -> Corners<[f64; LANES]> {
    let n = a.len() / 3;
    let columns = [&a[..n], &a[n..2 * n], &a[2 * n..]];
    let mut all = [[[0.0; LANES]; 3]; 4];
    for (all, corner) in all.iter_mut().zip(&block.corners) {
        for (all, column) in all.iter_mut().zip(columns) {
            for (number, i) in all.iter_mut().zip(corner) {
                *number = column[*i as usize];
            }
        }
    }
    all
}

/// Adds vectors at the corners of the first `count` tetrahedra to an n x 3 matrix.
#[inline(always)]
fn scatter(block: &Block, count: usize, vectors: &Corners<[f64; LANES]>, f: &mut [f64]) {
    let n = f.len() / 3;
    let (fx, f) = f.split_at_mut(n);
    let (fy, fz) = f.split_at_mut(n);
    for (corner, [x, y, z]) in block.corners.iter().zip(vectors) {
        for lane in 0..count {
            let i = corner[lane] as usize;
            fx[i] += x[lane];
            fy[i] += y[lane];
            fz[i] += z[lane];
        }
    }
}
