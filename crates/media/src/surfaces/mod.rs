//! Surfaces of rigid bodies and liquids as triangles, for files and for pictures.

mod liquid;
pub mod tessellation;

use a3_core::Simulation;

pub use liquid::Liquid;

/// Returns the triangles of the surface that are not torn.
pub fn whole_triangles(simulation: &Simulation) -> impl Iterator<Item = [u32; 3]> {
    let network = simulation.model().network();
    network.into_iter().flat_map(|network| network.triangles().iter().copied())
}
