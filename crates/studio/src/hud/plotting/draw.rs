//! Drawing of the chart on the screen, with the values at the pointer.

use a3_plot::{Axis, LinePanel};
use egui::epaint::Mesh;
use egui::{
    Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, StrokeKind, Ui, pos2, vec2,
};

use super::super::axes;
use super::super::charts::{GRID, GROUND, colour, dashes, note};
use super::super::style::{FAINT, TEXT};
use super::super::words::signed;
use super::chart::{Plotted, place, plotted, rows};
use crate::session::{Mode, Row, Session, Variable};

/// Number of parts of the time in which a curve has a point.
const DETAIL: usize = 500;
/// Room for the numbers on the left of the axes, for the title above, and for numbers and label
/// below the last panel (points).
const ROOM: [f32; 3] = [46.0, 19.0, 34.0];
/// Smallest height of a panel (points).
const MIN_HEIGHT: f32 = 62.0;
/// Side of a dot of a section (points), where there are few or many, and how many are many.
const DOTS: ([f32; 2], usize) = ([4.6, 2.8], 400);
/// Largest distance of the pointer from the point that it shows (points).
const REACH: f32 = 24.0;

/// A panel on the screen.
struct Panel<'a> {
    data: &'a LinePanel,
    /// The area between the axes.
    area: Rect,
    axes: [Axis; 2],
    variables: [Option<Variable>; 2],
    sources: &'a [[usize; 2]],
}

impl Panel<'_> {
    /// Returns the place of a point on the screen.
    fn at(&self, [x, y]: [f64; 2]) -> Pos2 {
        pos2(self.axes[0].at(x) as f32, self.axes[1].at(y) as f32)
    }

    /// Draws the title, the axes and the curves.
    fn draw(&self, painter: &Painter, is_last: bool, title: &str) {
        let area = self.area;
        painter.rect_filled(area, 0.0, GROUND);
        GRID.draw(painter, area, self.axes, is_last.then_some(""));
        let frame = Stroke::new(1.0, FAINT.gamma_multiply(0.6));
        painter.rect_stroke(area, 0.0, frame, StrokeKind::Middle);
        let say = |at, align, words: &str| {
            painter.text(at, align, words, FontId::proportional(12.0), FAINT);
        };
        let above = pos2(area.left() - ROOM[0] + 2.0, area.top() - 3.0);
        say(above, Align2::LEFT_BOTTOM, &self.data.y_label);
        say(pos2(area.right(), above.y), Align2::RIGHT_BOTTOM, title);
        if is_last {
            let below = pos2(area.right(), area.bottom() + 17.0);
            say(below, Align2::RIGHT_TOP, &self.data.x_label);
        }
        let inside = painter.with_clip_rect(area.expand(1.0).intersect(painter.clip_rect()));
        for line in &self.data.lines {
            let ink = colour(line.style);
            if line.dots {
                let ([few, many], limit) = DOTS;
                let side = if line.points().count() < limit {
                    few
                } else {
                    many
                };
                let mut mesh = Mesh::default();
                for point in line.points() {
                    let dot = Rect::from_center_size(self.at(*point), vec2(side, side));
                    mesh.add_colored_rect(dot, ink);
                }
                inside.add(Shape::mesh(mesh));
                continue;
            }
            for piece in &line.pieces {
                let points = piece.iter().map(|point| self.at(*point)).collect();
                let stroke = Stroke::new(1.5, ink);
                axes::line(&inside, points, stroke, &dashes(line.style, 1.5));
            }
        }
    }

    /// Draws a vertical line at a time (s), if this is a plot over time.
    fn mark_time(&self, painter: &Painter, time: f64, stroke: Stroke) {
        if self.variables[0].is_none() && self.axes[0].is_inside(time) {
            painter.vline(self.axes[0].at(time) as f32, self.area.y_range(), stroke);
        }
    }
}

/// Draws the chart in a room.
pub fn show(ui: &Ui, room: Rect, session: &Session) {
    let plotted = plotted(session, DETAIL);
    let panels = panels(room, &plotted);
    let painter = ui.painter();
    if panels.is_empty() {
        let words = if plotted.chart.panels.is_empty() {
            "Choose what to show."
        } else {
            "There is no room for the plots: make the window higher."
        };
        let font = FontId::proportional(13.0);
        painter.text(room.left_top(), Align2::LEFT_TOP, words, font, FAINT);
        return;
    }
    let pointer = ui.ctx().pointer_latest_pos();
    let pointer = pointer.filter(|at| ui.ctx().layer_id_at(*at) == Some(ui.layer_id()));
    let over = pointer.and_then(|at| panels.iter().position(|it| it.area.contains(at)));
    let now = session.runs.first().time();
    for (k, panel) in panels.iter().enumerate() {
        let drawn: usize = panel.data.lines.iter().map(|it| it.points().count()).sum();
        let title = match session.panel.plotting.mode {
            Mode::Section if drawn == 1 => "1 point".into(),
            Mode::Section => format!("{drawn} points"),
            _ => String::new(),
        };
        panel.draw(painter, k + 1 == panels.len(), &title);
        if session.readings.rewound() {
            panel.mark_time(painter, now, Stroke::new(1.4, TEXT));
        }
    }
    let (Some(at), Some(over)) = (pointer, over) else {
        return;
    };
    if session.panel.plotting.mode == Mode::Time {
        show_time(painter, room, session, &panels, over, at);
    } else {
        show_point(painter, room, session, &panels[over], at);
    }
}

/// Returns the panels, as many as fit.
fn panels(room: Rect, plotted: &Plotted) -> Vec<Panel<'_>> {
    let high = room.height() - ROOM[2];
    let all = &plotted.chart.panels;
    let count = all.len().min((high / MIN_HEIGHT).max(0.0) as usize);
    let height = high / count.max(1) as f32;
    let each = all.iter().take(count).enumerate().map(|(k, panel)| {
        let top = room.top() + k as f32 * height;
        let area = Rect::from_min_max(
            pos2(room.left() + ROOM[0], top + ROOM[1]),
            pos2(room.right(), top + height - 4.0),
        );
        let [x, y] = panel.axes();
        Panel {
            data: panel,
            area,
            axes: [
                x.between(area.left().into(), area.right().into()),
                y.between(area.bottom().into(), area.top().into()),
            ],
            variables: plotted.variables[k],
            sources: &plotted.sources[k],
        }
    });
    each.collect()
}

/// Shows the values at the time under the pointer: dots on all curves, and the numbers of the panel
/// at the pointer.
fn show_time(
    painter: &Painter,
    room: Rect,
    session: &Session,
    panels: &[Panel],
    over: usize,
    at: Pos2,
) {
    let share = (at.x - panels[over].area.left()) / panels[over].area.width();
    let [from, to] = panels[over].data.ends.unwrap_or_default();
    let time = from + f64::from(share) * (to - from);
    let mut lines = vec![];
    let mut shown = None;
    for (k, panel) in panels.iter().enumerate() {
        for ([pane, pick], line) in panel.sources.iter().zip(&panel.data.lines) {
            let (_, series) = &session.runs.panes[*pane].traces.iter().as_slice()[*pick];
            let Some(row) = series.nearest(time).filter(|row| row.time >= from) else {
                continue;
            };
            let point = place(panel.variables, row);
            if !point[1].is_finite() {
                continue;
            }
            let ink = colour(line.style);
            painter.circle_filled(panel.at(point), 3.0, ink);
            shown = shown.or(Some(row.time));
            if k == over {
                let words = format!("{}  {}", line.name, value(panel.variables[1], row));
                lines.push((words, 12.5, ink));
            }
        }
    }
    let Some(shown) = shown else {
        return;
    };
    for panel in panels {
        panel.mark_time(painter, shown, Stroke::new(1.0, FAINT));
    }
    lines.insert(0, (format!("at {shown:.3} s"), 12.5, TEXT));
    note(painter, room, at, FAINT, lines);
}

/// Shows the point nearest to the pointer, and its values.
fn show_point(painter: &Painter, room: Rect, session: &Session, panel: &Panel, at: Pos2) {
    let mut nearest: Option<(f32, &Row, usize)> = None;
    let mut all = vec![];
    for (k, source) in panel.sources.iter().enumerate() {
        all.extend(rows(session, *source).into_iter().map(|row| (row, k)));
    }
    for (row, k) in all {
        let distance = panel.at(place(panel.variables, row)).distance(at);
        if distance < REACH && nearest.is_none_or(|(least, ..)| distance < least) {
            nearest = Some((distance, row, k));
        }
    }
    let Some((_, row, k)) = nearest else {
        return;
    };
    let line = &panel.data.lines[k];
    let ink = colour(line.style);
    let point = panel.at(place(panel.variables, row));
    painter.circle(point, 4.0, Color32::WHITE, Stroke::new(1.8, ink));
    let mut lines = vec![
        (line.name.clone(), 12.5, ink),
        (format!("at {:.3} s", row.time), 12.5, TEXT),
    ];
    for variable in panel.variables {
        let name = variable.map_or("", Variable::name);
        lines.push((format!("{name}  {}", value(variable, row)), 12.5, TEXT));
    }
    note(painter, room, point, ink, lines);
}

/// Returns the value of a variable with its unit.
fn value(variable: Option<Variable>, row: &Row) -> String {
    variable.map_or(String::new(), |it| {
        format!("{} {}", signed(it.of(row)), it.unit())
    })
}
