//! Tests of the methods' numerics: orders, growth factors, stability limits, reference states,
//! accuracy.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod adaptive;
mod compliant;
mod foreign;
mod implicit;
mod limits;
mod order;
mod reference;
mod stability;
mod views;
