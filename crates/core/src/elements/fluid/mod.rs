//! Fluid as smoothed particles. The density at a particle is the sum of the kernel over it and its
//! neighbours, and the energy is that of Tait's equation at these densities. The pressure forces
//! are its exact gradient, so that a symplectic method conserves the energy. Viscosity acts along
//! the line between two particles, in proportion to the rate at which they approach, and conserves
//! momentum and angular momentum. With `d = x_i - x_j`, `r = |d|` and `v = v_i - v_j`:
//!
//! ```text
//! rho_i = m sum W(r)         U = m sum e(rho_i)         e'(rho) = p / rho^2
//! F_i = -m^2 sum (p_i / rho_i^2 + p_j / rho_j^2 - k (v . d) / (r^2 + s^2)) grad W
//! ```
//!
//! After Monaghan, *Smoothed particle hydrodynamics*, 2005. Walls are pinned particles.

mod law;
mod neighbours;
mod triple;

use super::force::{At, Cost, Force, Matter, check_particle};
use crate::coupling::{AxialCoupling, Coupling};
use crate::energy::Energy;
use crate::error::Error;
use crate::scratch::Scratch;
use crate::threads::threads;
use law::{Kernel, each};
use neighbours::Neighbours;
use triple::{Triple, add_scaled, dot, minus};

pub use law::FluidLaw;
pub use neighbours::{Members, Outflow};

/// Work on a particle of fluid, over that on a particle of a sheet. Threads pay for fewer
/// particles.
const RELATIVE_WORK: usize = 16;
/// Length s that softens the viscous force, over the reach of the kernel: a tenth of half of it
/// (Monaghan).
const SOFTENING: f64 = 0.05;

/// Prices of the list of viscous couplings, and of an iteration of conjugate gradients with them,
/// in evaluations of the forces. They were measured on a column in a tank.
const ASSEMBLY: f64 = 1.2;
const ITERATION: f64 = 0.4;

/// Fluid of one law, in some particles of a network. Pinned ones among them are walls.
#[derive(Clone, Debug)]
pub struct Fluid {
    law: FluidLaw,
    kernel: Kernel,
    members: Members,
    scratch: Scratch<FluidBuffers>,
}

/// Neighbours of each particle of the fluid, and quantities of the particles.
#[derive(Default)]
struct FluidBuffers {
    neighbours: Neighbours,
    x: Vec<Triple>,
    v: Vec<Triple>,
    dx: Vec<Triple>,
    dv: Vec<Triple>,
    densities: Vec<f64>,
    /// p / rho^2 of each particle (m^5/(kg s^2)), or its differential.
    pushes: Vec<f64>,
    changes: Vec<f64>,
    out: Vec<Triple>,
}

impl Fluid {
    /// Creates a fluid of a law in particles of these numbers, each of [its mass](FluidLaw::mass).
    ///
    /// # Errors
    /// A number of the law is out of its range, or a particle is named twice.
    pub fn new(law: FluidLaw, particles: Vec<u32>) -> Result<Self, Error> {
        law.check()?;
        Ok(Self {
            kernel: law.kernel(),
            law,
            members: Members::new(particles)?,
            scratch: Scratch::default(),
        })
    }

    /// Sets the boxes in which particles leave the fluid; a new one has none.
    ///
    /// # Errors
    /// An edge is not a finite number above 0.
    pub fn with_outflows(mut self, outflows: Vec<Outflow>) -> Result<Self, Error> {
        self.members.set_outflows(outflows)?;
        Ok(self)
    }

    /// Sets which particles have left the fluid: these, given in order. All others flow.
    pub(crate) fn set_drained(&mut self, drained: &[u32]) {
        self.members.set_drained(drained);
    }

    /// Returns the particles of the fluid, and those that have left it.
    #[must_use]
    pub fn members(&self) -> &Members {
        &self.members
    }

    /// Returns the law of the fluid.
    #[must_use]
    pub fn law(&self) -> &FluidLaw {
        &self.law
    }

    /// Returns the numbers of the fluid's particles, without those that have left it, in order.
    #[must_use]
    pub fn particles(&self) -> &[u32] {
        self.members.flowing()
    }

    /// Returns the density (kg/m3) at each particle at x (m), n x 3.
    #[must_use]
    pub fn densities(&self, x: &[f64]) -> Vec<f64> {
        self.scratch.lend(|buffers| {
            self.weigh(x, buffers);
            buffers.densities.clone()
        })
    }

    /// Returns the pressure (Pa) at each particle at x (m), n x 3: the mean of the normal stresses
    /// of its pressure forces, `p_i = sum F_ij . (x_i - x_j) / (2 dimensions V_i)`, in a volume of
    /// at most that at rest. It carries the weight of the fluid above. Tait's pressure does so less
    /// exactly, because the sum of the kernel is too small at surfaces.
    #[must_use]
    pub fn pressures(&self, x: &[f64]) -> Vec<f64> {
        self.scratch.lend(|buffers| {
            self.weigh(x, buffers);
            let FluidBuffers { neighbours, x, densities, pushes, .. } = buffers;
            pushes.clear();
            pushes.extend(densities.iter().map(|density| self.law.push(*density)));
            let kernel = self.kernel;
            let share = -0.5 * self.law.mass() / f64::from(self.law.dimensions);
            let mut pressures = vec![0.0; x.len()];
            neighbours.map(&mut pressures, self.is_shared(), |i, near| {
                let mut sum = 0.0;
                each(kernel, x, i, near, |j, _, r| {
                    sum += (pushes[i] + pushes[j]) * kernel.slope(r) * (r * r);
                });
                share * densities[i].max(self.law.density) * sum
            });
            pressures
        })
    }

    /// Returns the two particles that are nearest to each other at x (m), n x 3, and their distance
    /// (m); `None` if no two are within the kernel's reach.
    #[must_use]
    pub fn nearest_pair(&self, x: &[f64]) -> Option<([u32; 2], f64)> {
        self.scratch.lend(|buffers| {
            self.place(x, &mut buffers.x);
            let x = &buffers.x;
            buffers.neighbours.cover(x, self.kernel.reach, self.is_shared());
            let ([i, j], distance) = buffers.neighbours.nearest(x, self.is_shared())?;
            Some(([i, j].map(|i| self.particles()[i]), distance))
        })
    }

    /// Returns whether threads share the work.
    fn is_shared(&self) -> bool {
        threads(RELATIVE_WORK * self.particles().len()) > 1
    }

    /// Copies the rows of the fluid's particles from an n x 3 matrix. In two dimensions z is 0.
    fn place(&self, from: &[f64], to: &mut Vec<Triple>) {
        let n = from.len() / 3;
        let depth = if self.law.dimensions == 3 { 1.0 } else { 0.0 };
        to.clear();
        to.extend(self.particles().iter().map(|i| {
            let i = *i as usize;
            [from[i], from[n + i], depth * from[2 * n + i]]
        }));
    }

    /// Adds the rows of the fluid's particles to an n x 3 matrix.
    fn add(&self, rows: &[Triple], to: &mut [f64]) {
        let n = to.len() / 3;
        for (i, row) in self.particles().iter().zip(rows) {
            for (axis, part) in row.iter().enumerate() {
                to[axis * n + *i as usize] += part;
            }
        }
    }

    /// Finds the neighbours and the densities at x (m), n x 3.
    fn weigh(&self, x: &[f64], buffers: &mut FluidBuffers) {
        let FluidBuffers { neighbours, x: places, densities, .. } = buffers;
        self.place(x, places);
        let (kernel, mass, shared) = (self.kernel, self.law.mass(), self.is_shared());
        neighbours.cover(places, kernel.reach, shared);
        densities.resize(places.len(), 0.0);
        neighbours.map(densities, shared, |i, near| {
            let mut sum = kernel.value(0.0);
            each(kernel, places, i, near, |_, _, r| sum += kernel.value(r));
            mass * sum
        });
    }
}

impl Force for Fluid {
    fn name(&self) -> &'static str {
        "fluid"
    }

    fn matter(&self) -> Option<Matter> {
        Some(Matter::Fluid)
    }

    fn check(&self, particles: usize) -> Result<(), Error> {
        let mut all = self.particles().iter();
        all.try_for_each(|i| check_particle(*i as usize, particles))
    }

    fn add_forces(&self, at: &At, f: &mut [f64]) {
        self.scratch.lend(|buffers| {
            self.weigh(at.x, buffers);
            let FluidBuffers { neighbours, x, v, densities, pushes, out, .. } = buffers;
            self.place(at.v, v);
            pushes.clear();
            pushes.extend(densities.iter().map(|density| self.law.push(*density)));
            let (kernel, square) = (self.kernel, self.law.mass().powi(2));
            let viscous = self.law.viscous_factor();
            let soft = (SOFTENING * kernel.reach).powi(2);
            out.resize(x.len(), [0.0; 3]);
            neighbours.map(out, self.is_shared(), |i, near| {
                let mut sum = [0.0; 3];
                each(kernel, x, i, near, |j, d, r| {
                    let mut push = pushes[i] + pushes[j];
                    if viscous > 0.0 {
                        push -= viscous * dot(minus(v[i], v[j]), d) / (r * r + soft);
                    }
                    if push != 0.0 {
                        add_scaled(&mut sum, -square * push * kernel.slope(r), d);
                    }
                });
                sum
            });
            self.add(out, f);
        });
    }

    /// Adds the differential of the forces: with s the factor of d = `x_i` - `x_j` in the force of
    /// a pair, dF = ds d + s dd.
    fn add_differential(&self, at: &At, [dx, dv]: [&[f64]; 2], df: &mut [f64]) {
        self.scratch.lend(|buffers| {
            self.weigh(at.x, buffers);
            let FluidBuffers {
                neighbours,
                x,
                v,
                dx: dplaces,
                dv: dspeeds,
                densities,
                pushes,
                changes,
                out,
            } = buffers;
            for (from, to) in [(at.v, &mut *v), (dx, &mut *dplaces), (dv, &mut *dspeeds)] {
                self.place(from, to);
            }
            pushes.clear();
            pushes.extend(densities.iter().map(|density| self.law.push(*density)));
            let (kernel, mass, shared) = (self.kernel, self.law.mass(), self.is_shared());
            changes.resize(x.len(), 0.0);
            neighbours.map(changes, shared, |i, near| {
                let mut sum = 0.0;
                each(kernel, x, i, near, |j, d, r| {
                    sum += kernel.slope(r) * dot(d, minus(dplaces[i], dplaces[j]));
                });
                self.law.push_slope(densities[i]) * mass * sum
            });
            let square = mass * mass;
            let viscous = self.law.viscous_factor();
            let soft = (SOFTENING * kernel.reach).powi(2);
            out.resize(x.len(), [0.0; 3]);
            neighbours.map(out, shared, |i, near| {
                let mut sum = [0.0; 3];
                each(kernel, x, i, near, |j, d, r| {
                    let dd = minus(dplaces[i], dplaces[j]);
                    // The differential of r, taken as 0 for two particles at the same place.
                    let dr = if r > 0.0 { dot(d, dd) / r } else { 0.0 };
                    let (mut push, mut dpush) = (pushes[i] + pushes[j], changes[i] + changes[j]);
                    if viscous > 0.0 {
                        let w = minus(v[i], v[j]);
                        let dw = minus(dspeeds[i], dspeeds[j]);
                        let room = r * r + soft;
                        let rate = dot(w, d) / room;
                        push -= viscous * rate;
                        dpush -= viscous * (dot(dw, d) + dot(w, dd) - 2.0 * rate * r * dr) / room;
                    }
                    let slope = kernel.slope(r);
                    let change = dpush * slope + push * kernel.bend(r) * dr;
                    add_scaled(&mut sum, -square * change, d);
                    add_scaled(&mut sum, -square * push * slope, dd);
                });
                sum
            });
            self.add(out, df);
        });
    }

    /// Visits the viscous couplings alone.
    fn couplings(&self, _t: f64, x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        let viscous = self.law.viscous_factor() * self.law.mass().powi(2);
        if viscous == 0.0 {
            return;
        }
        self.scratch.lend(|buffers| {
            let (kernel, places) = (self.kernel, &mut buffers.x);
            self.place(x, places);
            let neighbours = &mut buffers.neighbours;
            neighbours.cover(places, kernel.reach, self.is_shared());
            let soft = (SOFTENING * kernel.reach).powi(2);
            neighbours.visit(|i, near| {
                let later = near.partition_point(|j| *j as usize <= i);
                each(kernel, places, i, &near[later..], |j, d, r| {
                    if r == 0.0 {
                        return;
                    }
                    let damping = -viscous * kernel.slope(r) * r * r / (r * r + soft);
                    visit(Coupling::Axial(AxialCoupling {
                        i: self.particles()[i] as usize,
                        j: self.particles()[j] as usize,
                        direction: d.map(|d| d / r),
                        along: 0.0,
                        across: 0.0,
                        damping,
                    }));
                });
            });
        });
    }

    /// Returns false, because each particle acts on the neighbours of its neighbours, too, by
    /// pressure.
    fn lists_all_couplings(&self) -> bool {
        false
    }

    fn energy(&self, at: &At) -> Energy {
        let densities = self.densities(at.x);
        let sum: f64 = densities.iter().map(|d| self.law.energy(*d)).sum();
        Energy { elastic: self.law.mass() * sum, ..Energy::default() }
    }

    fn reads_velocity(&self) -> bool {
        self.law.viscosity > 0.0
    }

    fn cost(&self) -> Cost {
        let particles = self.particles().len() as f64;
        Cost { couplings: particles, price: particles }
    }

    fn assembly(&self) -> f64 {
        ASSEMBLY * self.cost().price
    }

    fn iteration(&self) -> f64 {
        ITERATION
    }

    /// Scales the stiffness, which is that of the volume, rho0 c^2, and the damping.
    fn scale(&mut self, stiffness: f64, damping: f64) {
        self.law.sound *= stiffness.sqrt();
        self.law.viscosity *= damping;
    }
}
