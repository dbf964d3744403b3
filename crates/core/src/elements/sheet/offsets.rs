//! The six directions of a sheet's springs.

use crate::spring::SpringKind;

/// Purpose of the springs of each direction, and their offset in rows down and columns to the
/// right.
pub(super) const OFFSETS: [(SpringKind, usize, isize); 6] = [
    (SpringKind::Structural, 0, 1),
    (SpringKind::Structural, 1, 0),
    (SpringKind::Shear, 1, 1),
    (SpringKind::Shear, 1, -1),
    (SpringKind::Bend, 0, 2),
    (SpringKind::Bend, 2, 0),
];
