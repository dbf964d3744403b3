//! Measured data in files, from which a later command continues: CSV, or JSON, with checksums.

mod row;
mod store;
pub mod text;

pub use row::Row;
pub use store::Rows;
