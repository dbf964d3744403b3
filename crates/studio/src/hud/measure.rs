//! The pane of questions about the scene (key q): a button for each, what it is asked about, and
//! its answer: a work-precision diagram with the values of the run under the pointer, and a table
//! as rows or as cards to choose from.

use a3_files::report::Report;
use a3_plot::{Figure, WorkPrecision};
use egui::{
    Align2, Color32, CursorIcon, FontId, Id, Label, Pos2, Rect, Response, ScrollArea, Sense,
    Stroke, Ui, UiBuilder, pos2, vec2,
};

use super::charts::{GROUND, Sheet, colour};
use super::dock::Pane;
use super::style::{FAINT, INK, PAPER, TEXT, WARNING, faint, text, title};
use super::widgets::{Asks, LEFT, MIDDLE, button, chip, columns, write};
use super::words::digits;
use crate::session::{Answer, Diagram, MeasureRequest, MethodSetting};
use crate::session::{Progress, Question, RunAction, Session};

/// The pane.
pub const PANE: Pane = Pane {
    title: "Measure",
    action: RunAction::Measure,
    key: "q",
    margins: [16.0, 17.5],
    contents: show,
    width: (420.0, 860.0, 0.46),
    min_width_beside: 700.0,
    share_below: 0.62,
    narrow: None,
};

/// Height of the title, of a row of buttons, and distance between rows (points).
const HEIGHTS: [f32; 3] = [38.0, 28.0, 7.0];
/// Width of the pane above which the questions are in one row (points).
const ONE_ROW_WIDTH: f32 = 640.0;
/// Width of all settings (points).
const SETTINGS_WIDTH: f32 = 322.0;
/// Smallest and largest width of the button that measures (points).
const BUTTON_WIDTHS: [f32; 2] = [92.0, 108.0];
/// Colour of the track of a progress.
const PROGRESS_TRACK: Color32 = Color32::from_rgb(200, 202, 207);

/// Draws all rows from the top of a room.
fn show(ui: &mut Ui, room: Rect, session: &Session) {
    let [heading, row, gap] = HEIGHTS;
    let mut top = room.top() + heading;
    let mut next = |height: f32| {
        let place = Rect::from_min_size(pos2(room.left(), top), vec2(room.width(), height));
        top += height + gap;
        place
    };
    let count = if room.width() > ONE_ROW_WIDTH { 4 } else { 2 };
    for questions in Question::ALL.chunks(count) {
        for (place, question) in columns(next(row), count, 6.0).zip(questions) {
            let chosen = session.measuring.question == *question;
            chip(ui, place, question.words(), chosen).asks(MeasureRequest::Ask(*question));
        }
    }
    settings(ui, next(row), session);
    let measuring = &session.measuring;
    let going = measuring.progress();
    if let Some((question, progress, stopping)) = &going {
        bar(ui, next(row), *question, progress, *stopping);
    }
    let known = measuring.known();
    if let Some(known) = known {
        let line = next(14.0);
        let painter = ui.painter().with_clip_rect(line.expand(4.0));
        write(&painter, line.left_center(), LEFT, &known.of, 12.5, FAINT);
    }
    let below = pos2(room.right(), room.bottom() - 10.0);
    let room = Rect::from_min_max(pos2(room.left(), top), below);
    match known.map(|known| &known.answer) {
        Some(Ok(found)) => {
            let panes = session.runs.panes.iter().map(|pane| &pane.simulation);
            let shown: Vec<_> = panes.map(|run| (run.method(), run.control())).collect();
            answer(ui, room, found, &shown);
        }
        Some(Err(why)) => say(ui, room, why),
        None => say(ui, room, measuring.question.about()),
    }
}

/// Draws what the question depends on, and the button that measures or stops.
fn settings(ui: &Ui, rect: Rect, session: &Session) {
    let measuring = &session.measuring;
    let mut left = rect.left();
    // In a narrow pane, all is narrower.
    let fit = ((rect.width() - BUTTON_WIDTHS[0] - 6.0) / SETTINGS_WIDTH).min(1.0);
    let mut place = |width: f32| {
        let size = vec2(fit * width, rect.height());
        let place = Rect::from_min_size(pos2(left, rect.top()), size);
        left += size.x;
        place
    };
    for (words, on) in [("from now", false), ("the start", true)] {
        let chosen = measuring.from_start == on;
        let chip = chip(ui, place(78.0).shrink(1.0), words, chosen);
        chip.asks(MeasureRequest::FromStart(on));
    }
    place(10.0);
    match measuring.question {
        Question::Chart => {
            for (words, on) in [("work", false), ("time", true)] {
                let chip = chip(ui, place(54.0).shrink(1.0), words, measuring.timed == on);
                chip.asks(MeasureRequest::Timed(on));
            }
        }
        Question::Choose | Question::Simplify => {
            for (words, finer) in [("−", true), ("+", false)] {
                if finer {
                    let at = place(42.0).left_center() + vec2(2.0, 0.0);
                    write(ui.painter(), at, LEFT, "error", 13.0, FAINT);
                }
                let chip = chip(ui, place(26.0).shrink(1.0), words, false);
                chip.asks(MeasureRequest::Error { finer });
                if finer {
                    let words = format!("1e-{} m", measuring.digits);
                    let at = place(62.0).center();
                    write(ui.painter(), at, MIDDLE, words, 13.0, TEXT);
                }
            }
        }
        Question::Stability => {}
    }
    let [least, most] = BUTTON_WIDTHS;
    let width = (rect.right() - place(6.0).right()).clamp(least, most);
    let place = Rect::from_min_max(pos2(rect.right() - width, rect.top()), rect.max);
    let words = match (measuring.progress(), measuring.known()) {
        (Some(_), _) => "stop",
        (None, Some(_)) => "again",
        (None, None) => "measure",
    };
    button(ui, place, words, "Enter").asks(MeasureRequest::Toggle);
}

/// Draws the progress of a measurement.
fn bar(ui: &Ui, rect: Rect, question: Question, progress: &Progress, stopping: bool) {
    let painter = ui.painter();
    let track = Rect::from_min_max(pos2(rect.left(), rect.bottom() - 7.0), rect.max);
    painter.rect_filled(track, 3.5, PROGRESS_TRACK);
    let right = track.left() + progress.share() * track.width();
    painter.rect_filled(track.with_max_x(right), 3.5, INK);
    let stage = if stopping { "stopping" } else { &progress.stage };
    let (words, at) = (format!("{}  {stage}", question.words()), rect.left_top());
    write(painter, at, Align2::LEFT_TOP, words, 12.5, TEXT);
    let percent = format!("{:.0} %", 100.0 * progress.share());
    let at = rect.right_top();
    write(painter, at, Align2::RIGHT_TOP, percent, 12.5, FAINT);
}

/// Share of the height of the room that a diagram takes, the height that it takes at least if there
/// is room (points), and its largest height over its width.
const DIAGRAM: (f32, f32, f32) = (0.66, 340.0, 0.85);
/// Distance between columns, and least width of a last column of words (points).
const COLUMN_GAP: f32 = 14.0;
const MIN_LAST_WIDTH: f32 = 110.0;

/// Draws an answer in a room, in which it scrolls. `shown` are the methods of the panes.
fn answer(ui: &mut Ui, room: Rect, answer: &Answer, shown: &[MethodSetting]) {
    let width = room.width() - 10.0;
    ui.scope_builder(UiBuilder::new().max_rect(room), |ui| {
        ScrollArea::both().auto_shrink(false).max_height(room.height()).show(ui, |ui| {
            ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
            if !answer.complete {
                ui.label(WARNING.text("stopped: this is what was measured until then"));
            }
            if let Some(diagram) = &answer.diagram {
                let (share, least, ratio) = DIAGRAM;
                let high = (share * room.height()).max(least.min(room.height()));
                let size = vec2(width, high.min(ratio * width));
                let (place, _) = ui.allocate_exact_size(size, Sense::hover());
                draw(ui, place, diagram, shown);
                ui.add_space(4.0);
            }
            lines(ui, &answer.report.head, width);
            if answer.offers.is_empty() {
                table(ui, &answer.report, width);
            } else {
                cards(ui, &answer.report, width);
            }
            lines(ui, &answer.report.foot, width);
            for note in &answer.notes {
                lines(ui, note, width);
            }
            if answer.lean.is_some() {
                ui.add_space(4.0);
                let words = "write the leanest scene and open it";
                press(ui, 270.0, words).asks(MeasureRequest::OpenLean);
            }
        });
    });
}

/// Writes lines, wrapped to a width.
fn lines(ui: &mut Ui, words: &str, width: f32) {
    for line in words.lines().filter(|line| !line.trim().is_empty()) {
        ui.scope(|ui| {
            ui.set_max_width(width);
            ui.add(Label::new(text(line.trim())).wrap());
        });
    }
}

/// Writes the table, with its headings. A last column of words wraps at a width.
fn table(ui: &mut Ui, report: &Report, width: f32) {
    let Some(headings) = report.rows.first() else {
        return;
    };
    let lay = |ui: &Ui, words: &str, colour, wrap| {
        let font = FontId::proportional(12.5);
        ui.painter().layout(words.trim().into(), font, colour, wrap)
    };
    let natural = |c: usize| {
        let rows = report.rows.iter();
        let cells = rows.map(|row| lay(ui, &row[c], TEXT, f32::INFINITY));
        cells.map(|cell| cell.size().x).fold(0.0, f32::max)
    };
    let mut widths: Vec<_> = (0..headings.len()).map(natural).collect();
    let is_right = |c: usize| headings[c].starts_with(' ');
    let last = widths.len() - 1;
    if !is_right(last) {
        let others: f32 = widths[..last].iter().map(|width| width + COLUMN_GAP).sum();
        widths[last] = widths[last].min((width - others).max(MIN_LAST_WIDTH));
    }
    let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
    let all = widths.iter().sum::<f32>() + last as f32 * COLUMN_GAP;
    for (r, row) in report.rows.iter().enumerate() {
        let colour = if r == 0 { FAINT } else { TEXT };
        let cells = row.iter().zip(&widths);
        let cells: Vec<_> =
            cells.map(|(words, width)| lay(ui, words, colour, width + 0.5)).collect();
        let height = cells.iter().map(|cell| cell.size().y).fold(0.0, f32::max);
        let size = vec2(all.max(width), height + 5.0);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        if r % 2 == 1 {
            let shade = TEXT.gamma_multiply(0.05);
            ui.painter().rect_filled(rect, 4.0, shade);
        }
        let mut left = rect.left() + 4.0;
        for (c, cell) in cells.into_iter().enumerate() {
            let slack = if is_right(c) { widths[c] - cell.size().x } else { 0.0 };
            let at = pos2(left + slack, rect.top() + 2.5);
            ui.painter().galley(at, cell, colour);
            left += widths[c] + COLUMN_GAP;
        }
    }
    ui.spacing_mut().item_spacing.y = spacing;
    ui.add_space(4.0);
}

/// Draws a card for each row of the table, with buttons to use it and to run it beside.
fn cards(ui: &mut Ui, report: &Report, width: f32) {
    let Some((headings, rows)) = report.rows.split_first() else {
        return;
    };
    for (k, row) in rows.iter().enumerate() {
        egui::Frame::new()
            .fill(PAPER.to_opaque())
            .corner_radius(7)
            .inner_margin(egui::Margin::symmetric(12, 9))
            .show(ui, |ui| {
                ui.set_width(width - 24.0);
                ui.horizontal(|ui| {
                    ui.label(title(&row[1]).size(15.0));
                    ui.label(faint(&row[0]));
                });
                ui.horizontal_wrapped(|ui| {
                    ui.spacing_mut().item_spacing.x = 16.0;
                    for (heading, cell) in headings.iter().zip(row).skip(2) {
                        let words = format!("{}  {}", heading.trim(), cell.trim());
                        ui.add(Label::new(text(words.trim())).extend());
                    }
                });
                ui.add_space(4.0);
                ui.horizontal(|ui| {
                    press(ui, 84.0, "use it").asks(MeasureRequest::Use(k));
                    press(ui, 120.0, "run it beside").asks(MeasureRequest::RowBeside(k));
                });
            });
    }
    ui.add_space(2.0);
}

/// Draws a button of a width.
fn press(ui: &mut Ui, width: f32, words: &str) -> Response {
    let (rect, _) = ui.allocate_exact_size(vec2(width, 26.0), Sense::hover());
    chip(ui, rect, words, false)
}

/// Writes a message in place of an answer, wrapped to the width of a rectangle.
fn say(ui: &Ui, room: Rect, words: &str) {
    let font = FontId::proportional(14.0);
    let galley = ui.painter().layout(words.into(), font, TEXT, room.width());
    ui.painter().galley(room.min, galley, FAINT);
}

/// Smallest and largest size of text (points), and the width of a sheet over it between them.
const SIZE: (f64, f64, f64) = (9.0, 12.0, 42.0);
/// Largest distance of the pointer from the point that it shows (points).
const POINT_REACH: f64 = 12.0;
/// Largest distance of the pointer from the curve that it shows (points).
const CURVE_REACH: f64 = 7.0;

/// Draws a diagram with its legend in a room. Runs of the panes have rings.
fn draw(ui: &Ui, room: Rect, diagram: &Diagram, shown: &[MethodSetting]) {
    let response = ui.interact(room, Id::unique("diagram"), Sense::click());
    let painter = ui.painter();
    let sheet = [room.width(), room.height()].map(f64::from);
    let (least, most, share) = SIZE;
    let text = (sheet[0] / share).clamp(least, most);
    let Some(figure) = diagram.chart.draw_bare(sheet, text) else {
        return;
    };
    let pointer = response.hover_pos().map(|at| (at - room.min).into());
    let pointer = pointer.map(|at: [f32; 2]| at.map(f64::from));
    let pointed = pointer.and_then(|at| run_at(&figure, at));
    let curve = pointed.map(|([curve, _], _)| curve);
    let curve = curve.or_else(|| figure.curve_at(pointer?, CURVE_REACH));
    painter.rect_filled(room, 4.0, GROUND);
    let sheet = Sheet::new(painter, room, &figure);
    sheet.draw(curve);
    for ([curve, run], at) in &figure.runs {
        let (method, control) = diagram.runs[*curve][*run];
        let is_shown = |(m, c): &MethodSetting| {
            m.name == method.name && (c.value() / control.value() - 1.0).abs() < 0.02
        };
        if shown.iter().any(is_shown) {
            painter.circle_stroke(sheet.place(*at), 8.5, Stroke::new(1.8, TEXT));
        }
    }
    if let Some(([curve, run], at)) = pointed {
        ui.set_cursor_icon(CursorIcon::PointingHand);
        note_run(&sheet, &diagram.chart, [curve, run], sheet.place(at));
        response.asks(MeasureRequest::RunBeside { curve, run });
    }
}

/// Returns the run nearest to a point within reach, and its place.
fn run_at(figure: &Figure, at: [f64; 2]) -> Option<([usize; 2], [f64; 2])> {
    let distance = |[x, y]: [f64; 2]| (x - at[0]).hypot(y - at[1]);
    let near = figure.runs.iter().copied();
    let near = near.filter(|(_, place)| distance(*place) <= POINT_REACH);
    near.min_by(|a, b| distance(a.1).total_cmp(&distance(b.1)))
}

/// Draws a ring around the point of a run, and writes the method, the step, the error and the cost
/// beside it.
fn note_run(sheet: &Sheet, chart: &WorkPrecision, [curve, run]: [usize; 2], at: Pos2) {
    let curve = &chart.problems[0].curves[curve];
    let run = &curve.runs[run];
    let ink = colour(curve.style.colour);
    sheet.painter.circle_stroke(at, 8.0, Stroke::new(1.5, ink));
    let error = if run.is_lost() {
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
    sheet.note(at, ink, lines.into());
}

#[cfg(test)]
mod tests {
    use a3_plot::{Curve, CurveStyle, Measurement, Problem};

    use super::*;

    /// Returns two curves: one of two runs, a decade apart in error and two in work; the other of
    /// one run, and one that blew up.
    fn chart() -> WorkPrecision {
        let run = |error, work, lost| Measurement { error, work, lost, ..Measurement::default() };
        let curve = |runs| Curve { style: CurveStyle::default(), name: "name".into(), runs };
        WorkPrecision {
            problems: vec![Problem {
                curves: vec![
                    curve(vec![run(1e-2, 1e3, false), run(1e-3, 1e5, false)]),
                    curve(vec![run(1e-1, 1e5, false), run(f64::INFINITY, 1e4, true)]),
                ],
                ..Problem::default()
            }],
            ..WorkPrecision::default()
        }
    }

    #[test]
    fn points_are_where_their_errors_and_their_work_are() {
        let figure = chart().draw_bare([500.0, 400.0], 12.0).unwrap();
        let (area, _) = figure.panels[0];
        let (indices, at): (Vec<_>, Vec<_>) = figure.runs.iter().copied().unzip();
        assert_eq!(indices, [[0, 0], [0, 1], [1, 0], [1, 1]]);
        // Equal factors are equal distances; accurate runs are on the left, fast ones below.
        let decade = at[2][0] - at[0][0];
        assert!(decade > 50.0 && (at[0][0] - at[1][0] - decade).abs() < 1e-3);
        assert!(at[0][1] > at[1][1] && (at[1][1] - at[2][1]).abs() < 1e-3);
        let middle = f64::midpoint(at[0][1], at[1][1]);
        assert!(at[3][0] > area.x1 && (at[3][1] - middle).abs() < 1e-3);
        assert!(chart().draw_bare([90.0, 90.0], 12.0).is_none());
        let nothing = WorkPrecision::default();
        assert!(nothing.draw_bare([500.0, 400.0], 12.0).is_none());
    }

    #[test]
    fn the_nearest_point_and_curve_are_under_the_pointer() {
        let figure = chart().draw_bare([500.0, 400.0], 12.0).unwrap();
        for (run, [x, y]) in figure.runs.iter().copied() {
            for [dx, dy] in [[0.0, 0.0], [8.0, 0.0], [-5.0, 8.0]] {
                let found = run_at(&figure, [x + dx, y + dy]);
                assert_eq!(found, Some((run, [x, y])));
            }
            assert_eq!(run_at(&figure, [x, y - 13.0]), None);
        }
        // On the line, and beside it.
        let [a, b] = [0, 1].map(|k| figure.runs[k].1);
        let way = egui::vec2((b[0] - a[0]) as f32, (b[1] - a[1]) as f32);
        for (distance, found) in [(0.0, true), (6.0, true), (-6.0, true), (9.0, false)] {
            let across = distance * way.rot90().normalized() + 0.5 * way;
            let at = [a[0] + f64::from(across.x), a[1] + f64::from(across.y)];
            assert_eq!(run_at(&figure, at), None);
            assert_eq!(figure.curve_at(at, CURVE_REACH), found.then_some(0));
        }
        // The name in the legend.
        let name = figure.parts[0].0.end - 1;
        let a3_plot::Shape::Text(at, ..) = figure.shapes[name] else {
            panic!("{:?}", figure.shapes);
        };
        assert_eq!(figure.curve_at(at, CURVE_REACH), Some(0));
    }
}
