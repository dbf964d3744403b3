//! Tests of what contact decides with certainty: times of impact, and edges through triangles.

mod crossings;
mod impact;
mod inclusion;
mod pairs;
mod random;
