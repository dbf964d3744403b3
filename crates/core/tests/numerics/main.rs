//! Methods against mathematics: orders, growth factors, limits, reference states, charts of accuracy.

#[path = "../common/mod.rs"]
mod common;

mod accuracy;
mod adaptive;
mod foreign;
mod implicit;
mod limits;
mod order;
mod reference;
mod stability;
mod views;
