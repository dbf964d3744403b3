//! Balls, lines and triangles that show the particles, springs and obstacles of a run.

mod arrows;
mod colouring;
mod colours;
mod framing;
mod ground;
mod manner;
mod obstacles;
mod parts;
mod picture;
mod quantity;
mod springs;
mod vectors;
mod wires;

pub use colouring::DECADES;
pub use framing::{see_all, see_motion};
pub use manner::{Manner, check_drawing, check_particle, style};
pub use obstacles::drawn_radius;
pub use picture::Show;
pub use picture::Target;
pub use picture::camera;
pub use quantity::{Arrows, Quantity};
pub use springs::{has_springs, kind_look, kind_name, list_springs_of, springs_of};
pub use vectors::to_f32;
