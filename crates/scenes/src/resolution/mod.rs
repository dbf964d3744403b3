//! The same scene on finer or coarser grids.

mod cells;
mod places;
mod regrid;

pub use regrid::{Regridded, regridded};
