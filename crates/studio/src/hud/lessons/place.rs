//! The place of the lessons in the window.

use super::super::docked::Place;
use crate::session::Session;

/// The place of the pane.
pub const PLACE: Place = Place {
    width: (330.0, 470.0, 0.3),
    min_width_beside: 600.0,
    share_below: 0.47,
    narrow: Some(236.0),
};

/// Returns whether the lessons are visible: they are open, and the help does not hide them.
pub fn is_shown(session: &Session) -> bool {
    session.panel.lessons.open && !session.readings.help
}

/// Returns the place of the lessons, if they are visible.
pub fn place(session: &Session) -> Option<&'static Place> {
    is_shown(session).then_some(&PLACE)
}
