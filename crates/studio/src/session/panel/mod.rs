//! The panel: everything that can be tuned during a run, the parts of the scene, and the edits of
//! the scene, with undo and redo of all of these.

mod knobs;
mod parts;
mod request;
mod undo;
mod values;

pub use knobs::Knob;
pub use parts::{is_as_in_scene, is_in, measured, tune, tuned, turn as turn_part};
pub use request::{apply, request, type_key};
pub use request::{measuring_row, numbers, part_row, rows, shows_parts};
pub use undo::undo;
pub use undo::{edit, of_one_body};
pub use values::pane;

#[cfg(test)]
pub use knobs::{KNOBS, row_of};
#[cfg(test)]
pub use parts::set as set_part;
