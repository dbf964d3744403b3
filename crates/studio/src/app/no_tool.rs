//! The tools at the pointer, in the page: there are none.

use a3_media::show::Target;

use super::pointer::Pointer;
use super::screen::Screen;
use crate::session::Session;

/// Does nothing.
pub fn release(_: &Pointer, _: Option<usize>, _: &mut Session, _: &Screen, _: usize) {}

/// Does nothing.
pub fn throw(_: &Pointer, _: bool, _: &mut Session, _: &Screen, _: usize) {}

/// Draws nothing.
pub fn drag(_: &Pointer, _: usize, _: &mut Session, _: &Screen, _: usize) {}

/// Returns nothing.
pub fn target(_: &Pointer, _: &Session, _: &Screen, _: usize) -> Option<Target> {
    None
}
