//! The look of a run: from particles, springs and obstacles to balls, lines and triangles.

mod bodies;
mod coil;
mod colours;
mod liquid;
mod obstacles;
mod parts;
mod picture;
mod springs;
mod trail;
mod vectors;
mod view;
mod wires;

pub use bodies::parts as body_parts;
pub use liquid::Liquid;
pub use obstacles::drawn_radius;
pub use parts::whole_triangles;
pub use picture::Show;
pub use springs::{kind_name, list_springs_of, springs_of};
pub use view::camera;
