//! The same fluids on finer or coarser lattices.

use a3_core::Vector3;

use super::cells::{divided, gcd};
use super::places::Lattice;
use crate::assemble::fluid_points;
use crate::description::Fluid;

/// Largest number of particles of a fluid, with its tank, on another lattice.
const MAX_PARTICLES: f64 = 1e6;

/// Positions of particles (m), by their numbers.
type Points = Vec<Vector3<f64>>;

/// Puts fluids on lattices whose spacing is about `factor` times shorter, and which fill the same
/// boxes. Returns the particles of each fluid and of each tank, by their positions (m), with the
/// other lattice of each.
///
/// # Errors
/// A fluid makes no sense, or would have too many particles.
pub fn regrid_fluids(
    own: &[Fluid],
    other: &mut [Fluid],
    factor: f64,
) -> Result<Vec<(Points, Lattice)>, String> {
    if own.iter().any(|fluid| fluid.inflow.is_some()) {
        return Err("a fluid that flows in has no other lattice".into());
    }
    // All fluids of a scene have the same spacing, so that all edges are multiples of the other.
    let edges = own.iter().flat_map(|fluid| {
        let tank = fluid.tank.iter().flat_map(|tank| tank.size);
        let edges = fluid.size.into_iter().chain(tank);
        edges.map(|edge| (edge / fluid.spacing).round() as usize)
    });
    let cells = edges.fold(0, gcd);
    let ratio = cells as f64 / divided(cells, factor) as f64;
    let mut lattices = vec![];
    for (own, other) in own.iter().zip(other) {
        other.spacing = own.spacing * ratio;
        let points = |fluid: &Fluid| fluid_points(fluid).map_err(|fault| fault.to_string());
        let own = points(own)?;
        let dimensions = other.dimensions;
        let count = own.iter().map(Vec::len).sum::<usize>() as f64;
        if count * ratio.powi(-i32::from(dimensions)) > MAX_PARTICLES {
            return Err("a finer fluid has too many particles".into());
        }
        for (own, points) in own.into_iter().zip(points(other)?) {
            let lattice = Lattice::new(&points, other.spacing, dimensions.into());
            lattices.push((own, lattice));
        }
    }
    Ok(lattices)
}
