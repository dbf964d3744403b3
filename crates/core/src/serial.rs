//! Serialisation of vectors as arrays of three numbers.

use nalgebra::Vector3;
use serde::{Deserialize, Deserializer, Serialize, Serializer};

/// Writes a vector as an array of three numbers.
pub fn serialize<S: Serializer>(vector: &Vector3<f64>, to: S) -> Result<S::Ok, S::Error> {
    <[f64; 3]>::from(*vector).serialize(to)
}

/// Reads a vector from an array of three numbers.
pub fn deserialize<'a, D: Deserializer<'a>>(from: D) -> Result<Vector3<f64>, D::Error> {
    <[f64; 3]>::deserialize(from).map(Into::into)
}
