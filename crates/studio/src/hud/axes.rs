//! Axes of plots, with a grid and numbers, and the lines of curves.

use a3_plot::Axis;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};

use super::style::FAINT;

/// The look of a grid.
pub struct Grid {
    pub colour: Color32,
    /// Width of its lines (points); those without numbers are half as wide.
    pub width: f32,
    /// Smallest distances of the numbers at the horizontal and at the vertical axis (points).
    pub gaps: [f64; 2],
    /// Size of the numbers (points).
    pub size: f32,
}

impl Grid {
    /// Draws the grid of an area between axes, with numbers on its left. Numbers below it, where
    /// `below` is given, have this unit after the last one.
    pub fn draw(&self, painter: &Painter, area: Rect, [x, y]: [Axis; 2], below: Option<&str>) {
        for named in [false, true] {
            let stroke = Stroke::new(if named { 1.0 } else { 0.5 } * self.width, self.colour);
            let ticks = |axis: &Axis, gap| {
                let ticks = axis.ticks(gap).into_iter();
                ticks.filter(move |tick| tick.label.is_empty() != named)
            };
            for tick in ticks(&x, self.gaps[0]) {
                let at = x.at(tick.value) as f32;
                painter.vline(at, area.y_range(), stroke);
                let Some(unit) = below else {
                    continue;
                };
                let place = pos2(at, area.bottom() + 3.0);
                // The last number is moved to the left, to have room for the unit.
                if !unit.is_empty() && at > area.right() - 30.0 {
                    let place = pos2(area.right() + 2.0, place.y);
                    let label = format!("{}{unit}", tick.label);
                    number(painter, place, Align2::RIGHT_TOP, &label, self.size);
                } else {
                    number(painter, place, Align2::CENTER_TOP, &tick.label, self.size);
                }
            }
            for tick in ticks(&y, self.gaps[1]) {
                let at = y.at(tick.value) as f32;
                painter.hline(area.x_range(), at, stroke);
                let place = pos2(area.left() - 5.0, at);
                let label = short(tick.value, tick.label);
                number(painter, place, Align2::RIGHT_CENTER, &label, self.size);
            }
        }
    }
}

/// Writes the label of a tick, whose exponent is between braces.
fn number(painter: &Painter, at: Pos2, align: Align2, label: &str, size: f32) {
    let (base, power) = label.split_once("^{").unwrap_or((label, ""));
    let power = power.trim_end_matches('}');
    let lay =
        |words: &str, size| painter.layout_no_wrap(words.into(), FontId::proportional(size), FAINT);
    let (base, power) = (lay(base, size), lay(power, 0.75 * size));
    let size = base.size() + vec2(power.size().x, 0.0);
    let rect = align.anchor_size(at, size);
    let raised = rect.min + vec2(base.size().x, -2.0);
    painter.galley(rect.min, base, FAINT);
    if !power.text().is_empty() {
        painter.galley(raised, power, FAINT);
    }
}

/// Returns the label of a tick, in exponential notation if it is too long for the margin.
fn short(value: f64, label: String) -> String {
    if label.chars().count() > 6 && !label.contains('^') {
        format!("{value:.1e}")
    } else {
        label
    }
}

/// Draws a line through points. Lengths of dashes and gaps in turn (points) make it dashed.
pub fn line(painter: &Painter, points: Vec<Pos2>, stroke: Stroke, dashes: &[f32]) {
    if dashes.is_empty() {
        painter.add(Shape::line(points, stroke));
        return;
    }
    let each = dashes.chunks(2).map(|dash| (dash[0], dash[dash.len() - 1]));
    let (lengths, gaps): (Vec<_>, Vec<_>) = each.unzip();
    painter.extend(Shape::dashed_line_with_offset(
        &points, stroke, &lengths, &gaps, 0.0,
    ));
}
