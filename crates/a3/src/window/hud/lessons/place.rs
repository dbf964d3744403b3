//! The place of the lessons in the window.

use egui::{Context, Rect, pos2};

use crate::window::session::Session;

/// Smallest and largest width of the pane beside the picture (points), and its share of the
/// window's width between them.
const WIDTH: (f32, f32, f32) = (330.0, 470.0, 0.3);
/// Smallest width of a window with the pane beside the picture (points). In a narrower one, it is
/// below the picture.
const MIN_WIDTH_BESIDE: f32 = 600.0;
/// Share of the height of a narrow window.
const SHARE_BELOW: f32 = 0.47;

/// Returns whether the lessons are visible: they are open, and the help does not hide them.
pub fn is_shown(session: &Session) -> bool {
    session.panel.lessons.open && !session.readings.help
}

/// Returns the width on the right and the height below the picture that the lessons take, in a
/// window of a size (points).
pub fn taken(session: &Session, [width, height]: [f32; 2]) -> [f32; 2] {
    let (least, most, share) = WIDTH;
    if !is_shown(session) {
        [0.0, 0.0]
    } else if width < MIN_WIDTH_BESIDE {
        [0.0, (SHARE_BELOW * height).round()]
    } else {
        [(share * width).round().clamp(least, most), 0.0]
    }
}

/// Returns the rectangle of the lessons: the whole right side, or the room between the picture
/// and the bar.
pub fn rect(ctx: &Context, session: &Session) -> Rect {
    let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
    match taken(session, [window.width(), window.height()]) {
        [0.0, below] => Rect::from_min_max(
            pos2(window.left(), picture.bottom()),
            pos2(window.right(), picture.bottom() + below),
        ),
        [right, _] => Rect::from_min_max(
            pos2(window.right() - right, window.top()),
            window.right_bottom(),
        ),
    }
}
