//! Own systems from functions: of first order, and of second order.

mod first_order;
mod second_order;

pub use first_order::Ode;
pub use second_order::SecondOrder;
