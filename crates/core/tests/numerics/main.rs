//! Tests of the methods' numerics: orders, growth factors, stability limits, reference states,
//! accuracy.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod adaptive;
mod bdf;
mod callbacks;
mod compliant;
mod damping;
mod dense;
mod ends;
mod foreign;
mod horizon;
mod implicit;
mod limits;
mod mass;
mod mixed;
mod nystrom;
mod observed;
mod order;
mod own;
mod plain;
mod problems;
mod radau;
mod reference;
mod resting;
mod scales;
mod sparse;
mod stability;
mod views;
