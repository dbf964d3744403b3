//! Parts of large charts: colours, styles of curves, and notes at the pointer.

use a3_plot::CurveStyle;
use egui::{Color32, FontId, Painter, Pos2, Rect, Stroke, StrokeKind, pos2, vec2};

use super::axes::Grid;
use super::style::TEXT;

/// Colour of the area between the axes of a chart.
pub const GROUND: Color32 = Color32::from_rgb(247, 247, 246);

/// The grid.
pub const GRID: Grid = Grid {
    colour: Color32::from_rgb(217, 217, 217),
    width: 1.0,
    gaps: [34.0, 20.0],
    size: 11.0,
};

/// Returns the colour of a style.
pub fn colour(style: CurveStyle) -> Color32 {
    Color32::from_hex(style.colour).unwrap_or(TEXT)
}

/// Returns the dashes and gaps in turn (points) of a line in a style.
pub fn dashes(style: CurveStyle, width: f32) -> Vec<f32> {
    style.dash.iter().map(|part| width * *part as f32).collect()
}

/// Writes lines, each with its size and colour, on a note with an edge beside a point, within a
/// room.
pub fn note(
    painter: &Painter,
    room: Rect,
    at: Pos2,
    edge: Color32,
    lines: Vec<(String, f32, Color32)>,
) {
    let lay = |(words, size, colour): (String, f32, Color32)| {
        painter.layout_no_wrap(words, FontId::proportional(size), colour)
    };
    let lines: Vec<_> = lines.into_iter().map(lay).collect();
    let width = lines.iter().map(|line| line.size().x).fold(0.0, f32::max);
    let height: f32 = lines.iter().map(|line| line.size().y + 1.0).sum();
    let size = vec2(width + 20.0, height + 12.0);
    let x = if at.x + 14.0 + size.x < room.right() {
        at.x + 14.0
    } else {
        (at.x - 14.0 - size.x).max(room.left())
    };
    let y = (at.y - 0.5 * size.y).clamp(room.top(), (room.bottom() - size.y).max(room.top()));
    let rect = Rect::from_min_size(pos2(x, y), size);
    let stroke = Stroke::new(1.2, edge);
    painter.rect(rect, 6.0, Color32::WHITE, stroke, StrokeKind::Inside);
    let mut place = rect.min + vec2(10.0, 6.0);
    for line in lines {
        let step = line.size().y + 1.0;
        painter.galley(place, line, TEXT);
        place.y += step;
    }
}
