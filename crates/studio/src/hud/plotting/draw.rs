//! Drawing of the chart on the screen, with the values at the pointer.

use egui::{Align2, Color32, FontId, Pos2, Rect, Stroke, Ui};

use super::super::charts::{Sheet, colour};
use super::super::style::{FAINT, TEXT};
use super::super::words::signed;
use super::chart::{Plotted, place, plotted, rows};
use crate::session::{Mode, Row, Session, Variable};

/// Number of parts of the time in which a curve has a point.
const DETAIL: usize = 500;
/// Size of text (points).
const SIZE: f64 = 11.5;
/// Largest distance of the pointer from the point that it shows (points).
const REACH: f32 = 24.0;

/// Draws the chart in a room.
pub fn show(ui: &Ui, room: Rect, session: &Session) {
    let mut plotted = plotted(session, DETAIL);
    let mode = session.panel.plotting.mode;
    if mode == Mode::Section {
        let panel = &mut plotted.chart.panels[0];
        let drawn: usize = panel.lines.iter().map(|it| it.points().count()).sum();
        let points = if drawn == 1 { "point" } else { "points" };
        panel.y_label = format!("{}   {drawn} {points}", panel.y_label);
    }
    let sheet = [room.width(), room.height()].map(f64::from);
    // The rows above the chart name the curves.
    let figure = plotted.chart.draw_compact(sheet, SIZE, false);
    let painter = ui.painter();
    if figure.panels.is_empty() {
        let words = if plotted.chart.panels.is_empty() {
            "Choose what to show."
        } else {
            "There is no room for the plots: make the window higher."
        };
        let font = FontId::proportional(13.0);
        painter.text(room.left_top(), Align2::LEFT_TOP, words, font, FAINT);
        return;
    }
    let sheet = Sheet::new(painter, room, &figure);
    sheet.draw(None);
    if session.readings.rewound() && mode == Mode::Time {
        sheet.mark(session.runs.first().time(), Stroke::new(1.4, TEXT));
    }
    let pointer = ui.ctx().pointer_latest_pos();
    let pointer = pointer.filter(|at| ui.ctx().layer_id_at(*at) == Some(ui.layer_id()));
    let under = pointer.and_then(|at| Some((at, sheet.under(at)?)));
    match under {
        Some((at, under)) if mode == Mode::Time => {
            show_time(&sheet, session, &plotted, under, at);
        }
        Some((at, (panel, _))) => show_point(&sheet, session, &plotted, panel, at),
        None => {}
    }
}

/// Shows the values at the time under the pointer, which is at a share of the width of a panel:
/// dots on all curves, and the numbers of that panel.
fn show_time(
    sheet: &Sheet,
    session: &Session,
    plotted: &Plotted,
    (over, share): (usize, f64),
    at: Pos2,
) {
    let [from, to] = plotted.chart.panels[over].ends.unwrap_or_default();
    let time = from + share * (to - from);
    let mut lines = vec![];
    let mut shown = None;
    for k in 0..sheet.figure.panels.len() {
        let variables = plotted.variables[k];
        let drawn = &plotted.chart.panels[k].lines;
        for ([pane, pick], line) in plotted.sources[k].iter().zip(drawn) {
            let (_, series) = &session.runs.panes[*pane].traces.iter().as_slice()[*pick];
            let Some(row) = series.nearest(time).filter(|row| row.time >= from) else {
                continue;
            };
            let point = place(variables, row);
            if !point[1].is_finite() {
                continue;
            }
            let ink = colour(line.style.colour);
            sheet.painter.circle_filled(sheet.at(k, point), 3.0, ink);
            shown = shown.or(Some(row.time));
            if k == over {
                let words = format!("{}  {}", line.name, value(variables[1], row));
                lines.push((words, 12.5, ink));
            }
        }
    }
    let Some(shown) = shown else {
        return;
    };
    sheet.mark(shown, Stroke::new(1.0, FAINT));
    lines.insert(0, (format!("at {shown:.3} s"), 12.5, TEXT));
    sheet.note(at, FAINT, lines);
}

/// Shows the point nearest to the pointer in a panel, and its values.
fn show_point(sheet: &Sheet, session: &Session, plotted: &Plotted, panel: usize, at: Pos2) {
    let variables = plotted.variables[panel];
    let sources = plotted.sources[panel].iter();
    let lines = sources.zip(&plotted.chart.panels[panel].lines);
    let all = lines.flat_map(|(source, line)| {
        let rows = rows(session, *source).into_iter();
        rows.map(move |row| (sheet.at(panel, place(variables, row)), row, line))
    });
    let near = all.filter(|(point, ..)| point.distance(at) < REACH);
    let nearest = near.min_by(|a, b| a.0.distance(at).total_cmp(&b.0.distance(at)));
    let Some((point, row, line)) = nearest else {
        return;
    };
    let ink = colour(line.style.colour);
    let edge = Stroke::new(1.8, ink);
    sheet.painter.circle(point, 4.0, Color32::WHITE, edge);
    let mut lines = vec![
        (line.name.clone(), 12.5, ink),
        (format!("at {:.3} s", row.time), 12.5, TEXT),
    ];
    for variable in variables {
        let name = variable.map_or("", Variable::name);
        lines.push((format!("{name}  {}", value(variable, row)), 12.5, TEXT));
    }
    sheet.note(point, ink, lines);
}

/// Returns the value of a variable with its unit.
fn value(variable: Option<Variable>, row: &Row) -> String {
    variable.map_or(String::new(), |it| {
        format!("{} {}", signed(it.of(row)), it.unit())
    })
}
