//! A row of measured data.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Row of measured data. The names of its fields are the keys of the file.
pub trait Row: Clone + Serialize + DeserializeOwned {
    /// Returns whether both rows are of the same measurement, so that the later one replaces the
    /// other.
    fn is_same(&self, other: &Self) -> bool;

    /// Returns the checksum of the file up to this row, as it was read.
    fn check(&mut self) -> &mut String;
}
