//! Sheets at the edges of the window, beside the picture or below it.

use egui::{
    Align2, Area, Color32, Context, CursorIcon, FontId, Id, Rect, Sense, Stroke, Ui, pos2,
    style::ScrollAnimation, vec2,
};

use super::style::{FAINT, TEXT};

/// Colour of the sheets.
pub const SHEET: Color32 = Color32::from_rgb(226, 226, 224);
/// Colour of their edges.
pub const EDGE: Color32 = Color32::from_rgb(188, 189, 192);

/// Draws a sheet at an edge of the window, with lines where it meets the picture, and its contents
/// on it.
pub fn docked<R>(ctx: &Context, name: &str, rect: Rect, contents: impl FnOnce(&mut Ui) -> R) -> R {
    let window = ctx.viewport_rect();
    Area::new(Id::unique(name))
        .fixed_pos(rect.min)
        // An area that was moved would grow to reach from there to its sheet, for good.
        .constrain_to(window)
        .constrain(false)
        .fade_in(false)
        .show(ctx, |ui| {
            ui.allocate_rect(rect, Sense::click());
            ui.style_mut().interaction.selectable_labels = false;
            let (painter, edge) = (ui.painter(), Stroke::new(1.0, EDGE));
            painter.rect_filled(rect, 0.0, SHEET);
            if rect.left() > window.left() {
                painter.vline(rect.left(), rect.y_range(), edge);
            }
            if rect.top() > window.top() {
                painter.hline(rect.x_range(), rect.top(), edge);
            }
            contents(ui)
        })
        .inner
}

/// Smallest width of a heading that names its key (points).
const MIN_KEY_WIDTH: f32 = 220.0;

/// Draws the button that closes a sheet at the right end of its heading, and the key that does so.
/// Returns whether it was clicked.
pub fn close(ui: &Ui, heading: Rect, key: &str) -> bool {
    let place = Rect::from_center_size(heading.right_center() - vec2(8.0, 0.0), vec2(32.0, 32.0));
    let response = ui.interact(place, Id::unique(("close", key)), Sense::click());
    let colour = if response.hovered() { TEXT } else { FAINT };
    let write = |at, align, words: &str, size, colour| {
        let font = FontId::proportional(size);
        ui.painter().text(at, align, words, font, colour);
    };
    write(place.center(), Align2::CENTER_CENTER, "✖", 14.0, colour);
    if heading.width() > MIN_KEY_WIDTH {
        write(place.left_center(), Align2::RIGHT_CENTER, key, 12.5, FAINT);
    }
    response.on_hover_cursor(CursorIcon::PointingHand).clicked()
}

/// Scrolls to the row that is chosen in a list when another one is chosen, so that the wheel can
/// scroll.
pub fn keep_in_sight(ui: &Ui, list: &str, row: Rect, chosen: usize) {
    let was = Id::unique(("chosen in", list));
    if ui.data(|data| data.get_temp(was)) != Some(chosen) {
        ui.data_mut(|data| data.insert_temp(was, chosen));
        ui.scroll_to_rect_animation(row, None, ScrollAnimation::none());
    }
}

/// The place of a sheet: beside the picture, below it in a narrow window, or over it in a small
/// one.
pub struct Place {
    /// Smallest and largest width beside the picture (points), and its share of the window's width
    /// between them.
    pub width: (f32, f32, f32),
    /// Smallest width of a window with the sheet beside the picture (points).
    pub min_width_beside: f32,
    /// Share of the height of a narrow window that is higher than wide.
    pub share_below: f32,
    /// Width beside the picture in another narrow window (points); `None` if the sheet covers the
    /// picture there.
    pub narrow: Option<f32>,
}

/// Smallest width of a picture beside a sheet (points).
const MIN_PICTURE_WIDTH: f32 = 150.0;

impl Place {
    /// Returns the width on the right and the height below the picture that the sheet takes, in a
    /// window of a size (points). One that covers the picture takes nothing.
    pub fn taken(&self, [width, height]: [f32; 2]) -> [f32; 2] {
        let (least, most, share) = self.width;
        if !self.is_narrow(width) {
            [(share * width).round().clamp(least, most), 0.0]
        } else if height > width {
            [0.0, (self.share_below * height).round()]
        } else {
            let narrow = self.narrow.filter(|it| it + MIN_PICTURE_WIDTH <= width);
            [narrow.unwrap_or(0.0), 0.0]
        }
    }

    /// Returns whether a window of a width (points) is so narrow that the sheet is above the bar.
    pub fn is_narrow(&self, width: f32) -> bool {
        width < self.min_width_beside
    }

    /// Returns whether the sheet covers the picture in a window of a size (points).
    pub fn covers(&self, window: [f32; 2]) -> bool {
        self.taken(window) == [0.0, 0.0]
    }

    /// Returns the rectangle of the sheet: the right side, the room between the picture and the
    /// bar, or all above the bar.
    pub fn rect(&self, ctx: &Context) -> Rect {
        let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
        match self.taken([window.width(), window.height()]) {
            [0.0, 0.0] => picture,
            [0.0, below] => Rect::from_min_max(
                pos2(window.left(), picture.bottom()),
                pos2(window.right(), picture.bottom() + below),
            ),
            [right, _] => {
                let is_above = self.is_narrow(window.width());
                let bottom = if is_above { picture } else { window }.bottom();
                Rect::from_min_max(
                    pos2(window.right() - right, window.top()),
                    pos2(window.right(), bottom),
                )
            }
        }
    }
}
