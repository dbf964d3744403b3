//! Balls, lines and triangles that show the particles, springs and obstacles of a run.

mod arrows;
mod bodies;
mod coil;
mod colouring;
mod colours;
mod creases;
mod ground;
mod liquid;
mod manner;
mod obstacles;
mod parts;
mod picture;
mod pull;
mod quantity;
mod springs;
mod tanks;
mod trail;
mod vectors;
mod view;
mod wires;

pub use colouring::DECADES;
pub use manner::{Manner, Target};
pub use obstacles::drawn_radius;
pub use picture::Show;
pub use quantity::{Arrows, Quantity};
pub use springs::{has_springs, kind_look, kind_name, list_springs_of, springs_of};
pub use vectors::to_f32;
pub use view::camera;
