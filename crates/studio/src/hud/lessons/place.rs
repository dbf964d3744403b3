//! The place of the lessons in the window.

use super::super::docked::Place;
use crate::session::Session;

/// The place of the pane.
pub const PLACE: Place = Place {
    width: (330.0, 470.0, 0.3),
    min_width_beside: 600.0,
    share_below: 0.47,
};

/// Returns whether the lessons are visible: they are open, and the help does not hide them.
pub fn is_shown(session: &Session) -> bool {
    session.panel.lessons.open && !session.readings.help
}

/// Returns the width on the right and the height below the picture that the lessons take, in a
/// window of a size (points).
pub fn taken(session: &Session, window: [f32; 2]) -> [f32; 2] {
    if is_shown(session) {
        PLACE.taken(window)
    } else {
        [0.0, 0.0]
    }
}
