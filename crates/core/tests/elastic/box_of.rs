//! A box of six tetrahedra per cell, with its particles as one array.

use a3_core::elements::{Hyperelastic, Material, Solid};
use a3_core::{Mechanics, Network, Vector3};

pub const MODELS: [Hyperelastic; 2] = [Hyperelastic::NeoHookean, Hyperelastic::StVenantKirchhoff];

/// Rubber, without viscosity.
pub fn rubber(model: Hyperelastic) -> Material {
    Material { model, young: 1e5, poisson: 0.3, damping: 0.0 }
}

/// Density of the boxes (kg/m3).
pub const DENSITY: f64 = 1000.0;

pub struct Bar {
    pub network: Network,
    pub rest: Vec<Vector3<f64>>,
    pub tetrahedra: Vec<[u32; 4]>,
    pub material: Material,
}

impl Bar {
    /// A box with these numbers of cells along its edges.
    pub fn new(cells: [usize; 3], size: [f64; 3], material: Material) -> Self {
        let points = cells.map(|n| n + 1);
        let at = |[i, j, k]: [usize; 3]| (k * points[1] + j) * points[0] + i;
        let mut rest = vec![];
        let mut tetrahedra = vec![];
        for k in 0..points[2] {
            for j in 0..points[1] {
                for i in 0..points[0] {
                    let here = [i, j, k];
                    rest.push(Vector3::from_fn(|a, _| here[a] as f64 / cells[a] as f64 * size[a]));
                    if (0..3).all(|a| here[a] < cells[a]) {
                        tetrahedra.extend(paths().map(|path| {
                            path.map(|offset| at([0, 1, 2].map(|a| here[a] + offset[a])) as u32)
                        }));
                    }
                }
            }
        }
        let solid = Solid::new(0, &tetrahedra, &rest, material).unwrap();
        let mut masses = vec![0.0; rest.len()];
        for (corners, volume) in solid.tetrahedra().zip(solid.volumes()) {
            for i in corners {
                masses[i as usize] += 0.25 * DENSITY * volume;
            }
        }
        let mut network = Network::new(masses).unwrap();
        network.add(solid).unwrap();
        Self { network, rest, tetrahedra, material }
    }

    /// Positions n x 3, each mapped by `by`.
    pub fn moved(&self, by: impl Fn(Vector3<f64>) -> Vector3<f64>) -> Vec<f64> {
        let places: Vec<_> = self.rest.iter().map(|p| by(*p)).collect();
        (0..3).flat_map(|axis| places.iter().map(move |p| p[axis])).collect()
    }

    /// Forces (N) on the particles.
    pub fn forces(&self, x: &[f64], v: &[f64]) -> Vec<Vector3<f64>> {
        let n = self.rest.len();
        let mut f = vec![0.0; 3 * n];
        self.network.forces(0.0, x, v, &mut f);
        (0..n).map(|i| Vector3::new(f[i], f[n + i], f[2 * n + i])).collect()
    }
}

/// The six tetrahedra of a cell: the ways along its edges from one corner to the opposite one, each
/// turned so that its volume is positive.
fn paths() -> impl Iterator<Item = [[usize; 3]; 4]> {
    let ways = [[0, 1, 2], [1, 2, 0], [2, 0, 1], [0, 2, 1], [2, 1, 0], [1, 0, 2]];
    ways.into_iter().enumerate().map(|(way, axes)| {
        let mut path = [[0; 3]; 4];
        for (step, axis) in axes.into_iter().enumerate() {
            path[step + 1] = path[step];
            path[step + 1][axis] = 1;
        }
        if way >= 3 {
            path.swap(1, 2);
        }
        path
    })
}

/// Repeatable numbers between -1 and 1.
pub fn noise(count: usize, seed: u64) -> Vec<f64> {
    let mut state = seed;
    let mut next = || {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    };
    (0..count).map(|_| next()).collect()
}

/// The state x, with each number changed by up to `by`.
pub fn shaken(x: &[f64], by: f64, seed: u64) -> Vec<f64> {
    x.iter().zip(noise(x.len(), seed)).map(|(x, noise)| x + by * noise).collect()
}
