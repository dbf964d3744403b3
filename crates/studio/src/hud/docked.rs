//! Sheets at the edges of the window, beside the picture or below it.

use egui::{Area, Color32, Context, Id, Rect, Sense, Stroke, Ui, pos2};

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

/// The place of a sheet that is beside the picture, or below it in a narrow window.
pub struct Place {
    /// Smallest and largest width beside the picture (points), and its share of the window's width
    /// between them.
    pub width: (f32, f32, f32),
    /// Smallest width of a window with the sheet beside the picture (points).
    pub min_width_beside: f32,
    /// Share of the height of a narrow window.
    pub share_below: f32,
}

impl Place {
    /// Returns the width on the right and the height below the picture that the sheet takes, in a
    /// window of a size (points).
    pub fn taken(&self, [width, height]: [f32; 2]) -> [f32; 2] {
        let (least, most, share) = self.width;
        if width < self.min_width_beside {
            [0.0, (self.share_below * height).round()]
        } else {
            [(share * width).round().clamp(least, most), 0.0]
        }
    }

    /// Returns the rectangle of the sheet: the whole right side, or the room between the picture
    /// and the bar.
    pub fn rect(&self, ctx: &Context) -> Rect {
        let (window, picture) = (ctx.viewport_rect(), ctx.content_rect());
        match self.taken([window.width(), window.height()]) {
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
}
