//! The forces of a network, one file each, all implementing one trait.

mod air;
mod airflow;
mod attraction;
mod axial;
mod buckling;
mod cords;
mod drag;
mod finish;
mod flow;
mod fluid;
pub(crate) mod force;
mod gas;
mod gravity;
mod inverse_root;
mod own_force;
mod packed;
pub(crate) mod sheet;
mod solid;
mod springs;
mod wind;

pub use air::Air;
pub use airflow::Airflow;
pub use attraction::Attraction;
pub use buckling::{Buckling, BucklingSprings};
pub use cords::Cords;
pub use drag::Drag;
pub use fluid::{Fluid, FluidLaw, Members, Outflow};
pub use gas::{ATMOSPHERE, Gas, GasLaw};
pub use gravity::Gravity;
pub use own_force::OwnForce;
pub use sheet::Sheet;
pub use solid::{Hyperelastic, Material, Solid};
pub use springs::Springs;
pub(crate) use wind::Stream;
pub use wind::{Region, Wind};

pub(crate) use finish::Finish;
pub(crate) use flow::{Flow, flow_each};
