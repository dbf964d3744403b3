//! Contact of surfaces as a force: primitives nearer than their thickness repel each other.

use crate::contact::ContactLayer;
use crate::coupling::{AxialCoupling, BlockCoupling, Coupling};
use crate::elements::force::{At, Force};
use crate::energy::Energy;

impl Force for ContactLayer {
    fn name(&self) -> &'static str {
        "contact"
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        self.add_repulsion(at.t, at.x, at.v, f);
    }

    fn add_differential(&self, at: &At, d: [&[f64]; 2], df: &mut [f64]) {
        self.add_repulsion_differential(at.t, [at.x, at.v], d, df);
    }

    /// Visits couplings along the normals alone: the part from the rotation of a normal is left
    /// out, as if clamped. The weights w of a pair sum to zero, so its stiffness k w wT couples its
    /// points i and j by -k wi wj. Points of obstacles are places.
    fn couplings(&self, t: f64, x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        let n = x.len() / 3;
        self.stiffnesses(t, x, |points, pair| {
            for k in 0..4 {
                for l in k + 1..4 {
                    let weight = -pair.weights[k] * pair.weights[l];
                    let [i, j] = [points[k], points[l]].map(|i| i as usize);
                    if weight == 0.0 || i >= n && j >= n {
                        continue;
                    }
                    let [x, y, z]: [f64; 3] = pair.normal.into();
                    let (along, damping) = (weight * pair.stiffness, weight * pair.damping);
                    visit(if i < n && j < n {
                        Coupling::Axial(AxialCoupling {
                            i,
                            j,
                            direction: [x, y, z],
                            along,
                            across: 0.0,
                            damping,
                        })
                    } else {
                        let block = [x * x, y * y, z * z, x * y, x * z, y * z];
                        Coupling::Block(BlockCoupling {
                            i: i.min(j),
                            j: i.min(j),
                            stiffness: block.map(|b| b * along),
                            damping: block.map(|b| b * damping),
                        })
                    });
                }
            }
        });
    }

    fn energy(&self, at: &At) -> Energy {
        Energy {
            contact: self.repulsion_energy(at.t, at.x, at.v),
            ..Energy::default()
        }
    }

    fn reads_velocity(&self) -> bool {
        self.is_damped()
    }
}
