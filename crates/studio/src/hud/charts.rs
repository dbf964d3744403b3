//! Charts on the screen: a painter of figures, which also write themselves to files, and notes at
//! the pointer.

use std::f32::consts::FRAC_PI_2;

use a3_plot::{Figure, Look, Pen, Shape as Drawn, pieces};
use egui::epaint::{Mesh, TextShape};
use egui::text::{LayoutJob, TextFormat};
use egui::{Align, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, vec2};

use super::style::TEXT;

/// Colour of the sheet of a chart.
pub const GROUND: Color32 = Color32::from_rgb(247, 247, 246);
/// Share of its opacity that a curve keeps while another one is under the pointer.
const FADED: f32 = 0.22;
/// Size of a superscript over that of the text.
const RAISED: f32 = 0.7;

/// Returns the colour of a code.
pub fn colour(code: &str) -> Color32 {
    Color32::from_hex(code).unwrap_or(TEXT)
}

/// A figure in its room on the screen.
pub struct Sheet<'a> {
    pub painter: &'a Painter,
    pub room: Rect,
    pub figure: &'a Figure,
}

impl<'a> Sheet<'a> {
    pub fn new(painter: &'a Painter, room: Rect, figure: &'a Figure) -> Self {
        Self { painter, room, figure }
    }

    /// Returns the place of a point of the sheet.
    pub fn place(&self, [x, y]: [f64; 2]) -> Pos2 {
        self.room.min + vec2(x as f32, y as f32)
    }

    /// Returns the place of a point with these values in a panel.
    pub fn at(&self, panel: usize, [x, y]: [f64; 2]) -> Pos2 {
        let (_, axes) = &self.figure.panels[panel];
        self.place([axes[0].at(x), axes[1].at(y)])
    }

    fn area(&self, room: a3_plot::Rect) -> Rect {
        let [min, max] = [[room.x0, room.y0], [room.x1, room.y1]];
        Rect::from_min_max(self.place(min), self.place(max))
    }

    /// Returns the panel under the pointer, and the share of its width on the left of the pointer.
    pub fn under(&self, pointer: Pos2) -> Option<(usize, f64)> {
        let areas = self.figure.panels.iter().map(|it| self.area(it.0));
        let (k, area) = areas.enumerate().find(|(_, area)| area.contains(pointer))?;
        Some((k, ((pointer.x - area.left()) / area.width()).into()))
    }

    /// Draws a vertical line at a value in all panels.
    pub fn mark(&self, value: f64, stroke: Stroke) {
        let panels = self.figure.panels.iter();
        for (room, [x, _]) in panels.filter(|it| it.1[0].is_inside(value)) {
            let ends = [room.y0, room.y1].map(|y| self.place([x.at(value), y]));
            self.painter.line_segment(ends, stroke);
        }
    }

    /// Draws the figure. If a curve is chosen, the others fade.
    pub fn draw(&self, chosen: Option<usize>) {
        for (room, _) in &self.figure.panels {
            self.painter.rect_filled(self.area(*room), 0.0, GROUND);
        }
        for (k, shape) in self.figure.shapes.iter().enumerate() {
            let is_other = |curve: usize| chosen.is_some_and(|chosen| chosen != curve);
            let mut parts = self.figure.parts.iter();
            let mut painter = self.painter.clone();
            if parts.any(|(places, curve)| is_other(*curve) && places.contains(&k)) {
                painter.multiply_opacity(FADED);
            }
            self.paint(&painter, shape);
        }
    }

    /// Paints a shape. All of an area is seen from its middle.
    fn paint(&self, painter: &Painter, shape: &Drawn) {
        let all = |points: &[[f64; 2]]| points.iter().map(|at| self.place(*at)).collect();
        match shape {
            Drawn::Line(points, pen) => line(painter, all(points), pen),
            Drawn::Area(outlines, paint) => {
                let pen = paint.pen.as_ref().map_or(Stroke::NONE, stroke);
                let fill = paint.fill.map_or(Color32::TRANSPARENT, colour);
                let fill = fill.gamma_multiply(paint.opacity as f32);
                for corners in outlines.iter().map(|points| all(points)) {
                    let edge = |pen| painter.add(Shape::closed_line(corners.clone(), pen));
                    // A white edge is around its area, so that small markers keep their size.
                    let halo = pen.color == Color32::WHITE;
                    if halo {
                        edge(Stroke::new(2.0 * pen.width, pen.color));
                    }
                    painter.add(filled(&corners, fill));
                    let rim = if halo { Stroke::new(1.0, fill) } else { pen };
                    if !rim.is_empty() {
                        edge(rim);
                    }
                }
            }
            Drawn::Text(at, words, look) => label(painter, self.place(*at), words, look),
            Drawn::Clipped(window, shapes) => {
                let window = self.area(*window).expand(1.0);
                let inside = painter.with_clip_rect(window.intersect(painter.clip_rect()));
                for shape in shapes {
                    self.paint(&inside, shape);
                }
            }
        }
    }

    /// Writes lines, each with its size and colour, on a note with an edge beside a point.
    pub fn note(&self, at: Pos2, edge: Color32, lines: Vec<(String, f32, Color32)>) {
        let (painter, room) = (self.painter, self.room);
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
        let rect = Rect::from_min_size(Pos2::new(x, y), size);
        let stroke = Stroke::new(1.2, edge);
        painter.rect(rect, 6.0, Color32::WHITE, stroke, egui::StrokeKind::Inside);
        let mut place = rect.min + vec2(10.0, 6.0);
        for line in lines {
            let step = line.size().y + 1.0;
            painter.galley(place, line, TEXT);
            place.y += step;
        }
    }
}

fn stroke(pen: &Pen) -> Stroke {
    Stroke::new(pen.width as f32, colour(pen.colour))
}

/// Draws a line through points.
pub fn line(painter: &Painter, points: Vec<Pos2>, pen: &Pen) {
    let each = (pen.dash.chunks(2)).map(|dash| (dash[0] as f32, dash[dash.len() - 1] as f32));
    let (dashes, gaps): (Vec<_>, Vec<_>) = each.unzip();
    let stroke = stroke(pen);
    if !dashes.is_empty() {
        let all = Shape::dashed_line_with_offset(&points, stroke, &dashes, &gaps, 0.0);
        painter.extend(all);
    } else if let [from, to] = points[..] {
        // Lines of a grid are on whole pixels.
        painter.line_segment([from, to], stroke);
    } else {
        painter.add(Shape::line(points, stroke));
    }
}

/// Returns an area in a colour.
fn filled(corners: &[Pos2], colour: Color32) -> Mesh {
    let mut mesh = Mesh::default();
    let count = corners.len() as u32;
    mesh.colored_vertex(Rect::from_points(corners).center(), colour);
    for (k, corner) in (0..count).zip(corners) {
        mesh.colored_vertex(*corner, colour);
        mesh.add_triangle(0, 1 + k, 1 + (k + 1) % count);
    }
    mesh
}

/// Writes a label.
fn label(painter: &Painter, at: Pos2, words: &str, look: &Look) {
    let ink = colour(look.colour);
    let mut job = LayoutJob::default();
    for (piece, raised) in pieces(words).filter(|(piece, _)| !piece.is_empty()) {
        let size = look.size as f32 * if raised { RAISED } else { 1.0 };
        let mut format = TextFormat::simple(FontId::proportional(size), ink);
        if raised {
            format.valign = Align::TOP;
        }
        job.append(piece, 0.0, format);
    }
    let galley = painter.layout_job(job);
    let first = galley.rows.first();
    let glyph = first.and_then(|row| Some(row.pos.y + row.glyphs.first()?.pos.y));
    let along = look.anchor.part() as f32 * galley.size().x;
    let way = vec2(along, glyph.unwrap_or(0.0));
    let (way, angle) = if look.turned { (vec2(way.y, -way.x), -FRAC_PI_2) } else { (way, 0.0) };
    let text = TextShape::new(at - way, galley, ink).with_angle(angle);
    // The font has no bold letters: written twice, they are darker.
    if look.bold {
        painter.add(text.clone());
    }
    painter.add(text);
}
