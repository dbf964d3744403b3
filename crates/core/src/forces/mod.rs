//! One file a force. Each adds to the forces f (N), the sheet, which is the first, sets them; positions x, velocities v and f are n x 3, column-major.

pub(crate) mod drag;
pub(crate) mod gravity;
mod inverse_root;
pub(crate) mod sheet;
pub(crate) mod springs;
pub(crate) mod wind;

pub use wind::Wind;
