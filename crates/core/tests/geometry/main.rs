//! Tests of exact decisions of contact: times of impact, and edges that cross triangles.

mod crossings;
mod impact;
mod inclusion;
mod pairs;
mod random;
