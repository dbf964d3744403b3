//! Drawing of a work-precision diagram, and of the values of the run under the pointer.

use a3_plot::{Curve, CurveStyle, WorkPrecision};
use egui::epaint::{Mesh, PathStroke, Vertex, WHITE_UV};
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Painter, Pos2, Rect, Sense, Shape, Stroke, StrokeKind,
    Ui, pos2, vec2,
};

use super::super::axes;
use super::super::charts::{self, GRID, GROUND, colour, dashes};
use super::super::style::{FAINT, TEXT};
use super::super::words::digits;
use super::plot::{Plot, Point};
use crate::window::session::{Diagram, MeasureRequest, MethodSetting};

/// Colours of errors that the reference cannot tell from 0, and of the front.
const SHADE: Color32 = Color32::from_rgb(226, 231, 239);
const FRONT: Color32 = Color32::from_rgb(248, 221, 134);
/// Radius of a marker (points).
const MARKER: f32 = 4.2;
/// Height of a line of the legend (points).
const LEGEND_LINE: f32 = 18.0;
/// Share of its opacity that a curve keeps while another one is under the pointer.
const FADED: f32 = 0.22;

/// Draws a diagram with its legend in a room. Runs of the panes have rings. Returns the request of
/// the mouse.
pub fn show(
    ui: &Ui,
    room: Rect,
    diagram: &Diagram,
    shown: &[MethodSetting],
) -> Option<MeasureRequest> {
    let response = ui.interact(room, Id::unique("diagram"), Sense::click());
    let painter = ui.painter();
    let entries = entries(painter, &diagram.chart, room.width());
    let lines = entries
        .last()
        .map_or(0.0, |(at, ..)| at.y + 2.0 * LEGEND_LINE);
    let legend = Rect::from_min_max(pos2(room.left(), room.bottom() - lines), room.max);
    let plot = Plot::new(&diagram.chart, room.with_max_y(legend.top() - 6.0))?;
    let pointer = response.hover_pos();
    let named = |at: Pos2| {
        let under = |(place, size, _): &&(Pos2, egui::Vec2, usize)| {
            Rect::from_min_size(legend.min + place.to_vec2(), *size).contains(at)
        };
        entries.iter().find(under).map(|(.., curve)| *curve)
    };
    let point = pointer.and_then(|at| plot.point_under(at)).copied();
    let curve = pointer.and_then(|at| plot.curve_under(at).or_else(|| named(at)));
    ground(painter, &plot, &diagram.chart);
    let order = (0..plot.problem.curves.len()).filter(|k| Some(*k) != curve);
    for k in order.chain(curve) {
        let faded = curve.is_some_and(|curve| curve != k);
        draw_curve(painter, &plot, k, if faded { FADED } else { 1.0 });
    }
    for (place, _, k) in &entries {
        let faded = curve.is_some_and(|curve| curve != *k);
        let of = &plot.problem.curves[*k];
        entry(
            painter,
            legend.min + place.to_vec2(),
            of,
            if faded { FADED } else { 1.0 },
        );
    }
    signs(painter, &plot, legend);
    for place in &plot.points {
        let (method, control) = diagram.runs[place.curve][place.run];
        let is_shown = |(m, c): &MethodSetting| {
            m.name == method.name && (c.value() / control.value() - 1.0).abs() < 0.02
        };
        if shown.iter().any(is_shown) {
            painter.circle_stroke(place.at, 8.5, Stroke::new(1.8, TEXT));
        }
    }
    let pointed = point?;
    ui.set_cursor_icon(CursorIcon::PointingHand);
    painter.circle_stroke(
        pointed.at,
        8.0,
        Stroke::new(1.5, colour(plot.problem.curves[pointed.curve].style)),
    );
    note_run(painter, room, &plot, &pointed, &diagram.chart);
    let Point { curve, run, .. } = pointed;
    response
        .clicked()
        .then_some(MeasureRequest::RunBeside { curve, run })
}

/// Draws the axes, the shade and the front.
fn ground(painter: &Painter, plot: &Plot, chart: &WorkPrecision) {
    let (area, [x, y]) = (plot.area, plot.axes);
    painter.rect_filled(area, 0.0, GROUND);
    let trusted = plot.problem.trusted();
    if x.is_inside(trusted) {
        painter.rect_filled(area.with_max_x(x.at(trusted) as f32), 0.0, SHADE);
    }
    GRID.draw(painter, area, [x, y], Some(""));
    let frame = Stroke::new(1.0, FAINT.gamma_multiply(0.6));
    painter.rect_stroke(area, 0.0, frame, StrokeKind::Middle);
    let say = |at, align, words: &str| {
        painter.text(at, align, words, FontId::proportional(11.5), FAINT);
    };
    let above = pos2(area.left() - 34.0, area.top() - 4.0);
    say(above, Align2::LEFT_BOTTOM, &chart.y_label);
    let below = pos2(area.right(), area.bottom() + 18.0);
    say(below, Align2::RIGHT_TOP, &chart.x_label);
    let left = pos2(area.left() - 20.0, area.bottom() + 18.0);
    say(left, Align2::LEFT_TOP, "more accurate");
    let tip = left + vec2(-3.0, 7.5);
    painter.arrow(tip, vec2(-13.0, 0.0), Stroke::new(1.0, FAINT));
    if let Some(lost) = plot.points.iter().find(|point| point.lost) {
        let top = pos2(lost.at.x, area.top() - 4.0);
        say(top, Align2::CENTER_BOTTOM, "blew up");
        let stroke = Stroke::new(0.5, GRID.colour);
        painter.vline(area.right() + 5.0, area.y_range(), stroke);
    }
    let front: Vec<_> = plot.problem.front().into_iter().collect();
    let places = front.iter().map(|[curve, run]| {
        let run = &plot.problem.curves[*curve].runs[*run];
        plot.at(run)
    });
    painter.add(Shape::line(places.collect(), Stroke::new(9.0, FRONT)));
}

/// Draws the line and the markers of a curve.
fn draw_curve(painter: &Painter, plot: &Plot, k: usize, opacity: f32) {
    let style = plot.problem.curves[k].style;
    line(painter, plot.line(k), style, opacity);
    for point in plot.points.iter().filter(|point| point.curve == k) {
        let held = plot.problem.curves[k].runs[point.run].held;
        marker(painter, point.at, style, opacity, !point.lost && !held);
    }
}

/// Draws a line in a style.
fn line(painter: &Painter, places: Vec<Pos2>, style: CurveStyle, opacity: f32) {
    let stroke = Stroke::new(1.6, colour(style).gamma_multiply(opacity));
    axes::line(painter, places, stroke, &dashes(style, 1.6));
}

/// Draws a marker, filled or open.
fn marker(painter: &Painter, at: Pos2, style: CurveStyle, opacity: f32, filled: bool) {
    let colour = colour(style).gamma_multiply(opacity);
    let outline = style.outline([at.x.into(), at.y.into()], MARKER.into());
    let corners: Vec<_> = outline
        .iter()
        .map(|[x, y]| pos2(*x as f32, *y as f32))
        .collect();
    // All of a marker is seen from its centre, so triangles from there fill it.
    let fill = if filled { colour } else { GROUND };
    let vertex = |pos| Vertex {
        pos,
        uv: WHITE_UV,
        color: fill,
    };
    let mut mesh = Mesh::default();
    mesh.vertices.push(vertex(at));
    mesh.vertices.extend(corners.iter().copied().map(vertex));
    let count = corners.len() as u32;
    for k in 0..count {
        mesh.add_triangle(0, 1 + k, 1 + (k + 1) % count);
    }
    painter.add(Shape::mesh(mesh));
    let edge = PathStroke::new(1.0, colour);
    painter.add(Shape::closed_line(corners, edge));
}

/// Returns the places of the entries of the legend below one another in a width, their sizes, and
/// the indices of their curves.
fn entries(painter: &Painter, chart: &WorkPrecision, width: f32) -> Vec<(Pos2, egui::Vec2, usize)> {
    let mut at = Pos2::ZERO;
    let curves = chart.problems.iter().take(1).flat_map(|it| &it.curves);
    let drawn = curves
        .enumerate()
        .filter(|(_, curve)| curve.runs.iter().any(a3_plot::Measurement::is_drawn));
    let mut all = vec![];
    for (k, curve) in drawn {
        let font = FontId::proportional(12.0);
        let words = painter.layout_no_wrap(curve.name.clone(), font, TEXT);
        let size = vec2(words.size().x + 34.0, LEGEND_LINE);
        if at.x > 0.0 && at.x + size.x > width {
            at = pos2(0.0, at.y + LEGEND_LINE);
        }
        all.push((at, size, k));
        at.x += size.x + 14.0;
    }
    all
}

/// Draws the meaning of the front and of the shade on the last line of the legend.
fn signs(painter: &Painter, plot: &Plot, legend: Rect) {
    let y = legend.bottom() - 0.5 * LEGEND_LINE;
    let is_shaded = plot.axes[0].is_inside(plot.problem.trusted());
    let mut left = legend.left() + 2.0;
    for (words, colour, high, there) in [
        ("fastest for its error", FRONT, 8.0, true),
        ("finer than the reference", SHADE, 12.0, is_shaded),
    ] {
        if there {
            let sample = Rect::from_center_size(pos2(left + 12.0, y), vec2(24.0, high));
            painter.rect_filled(sample, 0.0, colour);
            let at = pos2(left + 30.0, y);
            let font = FontId::proportional(12.0);
            let said = painter.text(at, Align2::LEFT_CENTER, words, font, TEXT);
            left = said.right() + 16.0;
        }
    }
}

/// Draws an entry of the legend.
fn entry(painter: &Painter, at: Pos2, curve: &Curve, opacity: f32) {
    let y = at.y + 0.5 * LEGEND_LINE;
    let ends = [pos2(at.x + 2.0, y), pos2(at.x + 26.0, y)];
    line(painter, ends.into(), curve.style, opacity);
    marker(painter, pos2(at.x + 14.0, y), curve.style, opacity, true);
    let place = pos2(at.x + 32.0, y);
    let font = FontId::proportional(12.0);
    let colour = TEXT.gamma_multiply(opacity.max(0.5));
    painter.text(place, Align2::LEFT_CENTER, &curve.name, font, colour);
}

/// Writes the method, the step, the error and the cost of a run beside its point, within a room.
fn note_run(painter: &Painter, room: Rect, plot: &Plot, point: &Point, chart: &WorkPrecision) {
    let curve = &plot.problem.curves[point.curve];
    let run = &curve.runs[point.run];
    let error = if point.lost {
        "it blew up".into()
    } else {
        // The unit is between the last brackets of the label.
        let unit = chart.x_label.rsplit_once('(').map_or("", |(_, unit)| unit);
        format!("error {} {}", digits(run.error), unit.trim_end_matches(')'))
    };
    let is_timed = chart.y_label.starts_with("computing");
    let cost = if is_timed {
        format!("{} ms per simulated second", digits(1e3 * run.work))
    } else {
        format!("{} evaluations per simulated second", digits(run.work))
    };
    let setting = run.label.clone().unwrap_or_default();
    let lines = [
        (curve.name.clone(), 13.0, TEXT),
        (setting, 12.5, TEXT),
        (error, 12.5, TEXT),
        (cost, 12.5, TEXT),
        ("click: run it beside".into(), 11.5, FAINT),
    ];
    charts::note(painter, room, point.at, colour(curve.style), lines.into());
}
