//! Buttons and words side by side, in as many lines as they need.

use egui::{FontId, Pos2, Rect, Ui, pos2, vec2};

use super::super::style::TEXT;

/// Height of a line, and distance between its parts and between lines (points).
pub const HEIGHT: f32 = 24.0;
const GAP: f32 = 4.0;

/// Places from the left to the right of a room, line by line.
pub struct Flow {
    room: Rect,
    next: Pos2,
}

impl Flow {
    /// Begins at the top of a room.
    pub fn new(room: Rect) -> Self {
        Self {
            room,
            next: room.min,
        }
    }

    /// Returns the place of a part of a width (points).
    pub fn place(&mut self, width: f32) -> Rect {
        let is_full = self.next.x + width > self.room.right() && self.next.x > self.room.left();
        if is_full {
            self.next = pos2(self.room.left(), self.next.y + HEIGHT + GAP);
        }
        let place = Rect::from_min_size(self.next, vec2(width, HEIGHT));
        self.next.x += width + GAP;
        place
    }

    /// Returns the place of words with a margin (points) on either side.
    pub fn words(&mut self, ui: &Ui, words: &str, margin: f32) -> Rect {
        let font = FontId::proportional(13.0);
        let galley = ui.painter().layout_no_wrap(words.into(), font, TEXT);
        self.place(galley.size().x + 2.0 * margin)
    }

    /// Returns the height (points) below the last line.
    pub fn bottom(&self) -> f32 {
        self.next.y + HEIGHT + GAP
    }
}
