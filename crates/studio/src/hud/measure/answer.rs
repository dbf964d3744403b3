//! Drawing of an answer: its diagram, and its table as rows or as cards to choose from.

use a3_files::report::Report;
use egui::{FontId, Label, Rect, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2};

use super::super::style::{FAINT, PAPER, TEXT, WARNING, faint, text, title};
use super::chip::chip;
use super::diagram;
use crate::session::{Answer, MeasureRequest, MethodSetting};

/// Share of the height of the room that a diagram takes, the height that it takes at least if there
/// is room (points), and its largest height over its width.
const DIAGRAM: (f32, f32, f32) = (0.66, 340.0, 0.85);
/// Distance between columns, and least width of a last column of words (points).
const COLUMN_GAP: f32 = 14.0;
const MIN_LAST_WIDTH: f32 = 110.0;

/// Draws an answer in a room, in which it scrolls. `shown` are the methods of the panes. Returns
/// the request of the mouse.
pub fn show(
    ui: &mut Ui,
    room: Rect,
    answer: &Answer,
    shown: &[MethodSetting],
) -> Option<MeasureRequest> {
    let mut request = None;
    let width = room.width() - 10.0;
    ui.scope_builder(UiBuilder::new().max_rect(room), |ui| {
        ScrollArea::both()
            .auto_shrink(false)
            .max_height(room.height())
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
                if !answer.complete {
                    ui.label(WARNING.text("stopped: this is what was measured until then"));
                }
                if let Some(diagram) = &answer.diagram {
                    let (share, least, ratio) = DIAGRAM;
                    let high = (share * room.height()).max(least.min(room.height()));
                    let size = vec2(width, high.min(ratio * width));
                    let (place, _) = ui.allocate_exact_size(size, Sense::hover());
                    request = diagram::show(ui, place, diagram, shown);
                    ui.add_space(4.0);
                }
                lines(ui, &answer.report.head, width);
                if answer.offers.is_empty() {
                    table(ui, &answer.report, width);
                } else {
                    request = cards(ui, &answer.report, width).or(request);
                }
                lines(ui, &answer.report.foot, width);
                for note in &answer.notes {
                    lines(ui, note, width);
                }
                if answer.lean.is_some() {
                    ui.add_space(4.0);
                    let pressed = press(ui, 270.0, "write the leanest scene and open it");
                    request = pressed.then_some(MeasureRequest::OpenLean).or(request);
                }
            });
    });
    request
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
        let cells = report
            .rows
            .iter()
            .map(|row| lay(ui, &row[c], TEXT, f32::INFINITY));
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
        let cells: Vec<_> = cells
            .map(|(words, width)| lay(ui, words, colour, width + 0.5))
            .collect();
        let height = cells.iter().map(|cell| cell.size().y).fold(0.0, f32::max);
        let size = vec2(all.max(width), height + 5.0);
        let (rect, _) = ui.allocate_exact_size(size, Sense::hover());
        if r % 2 == 1 {
            let shade = TEXT.gamma_multiply(0.05);
            ui.painter().rect_filled(rect, 4.0, shade);
        }
        let mut left = rect.left() + 4.0;
        for (c, cell) in cells.into_iter().enumerate() {
            let slack = if is_right(c) {
                widths[c] - cell.size().x
            } else {
                0.0
            };
            let at = pos2(left + slack, rect.top() + 2.5);
            ui.painter().galley(at, cell, colour);
            left += widths[c] + COLUMN_GAP;
        }
    }
    ui.spacing_mut().item_spacing.y = spacing;
    ui.add_space(4.0);
}

/// Draws a card for each row of the table, with buttons to use it and to run it beside. Returns the
/// request of the mouse.
fn cards(ui: &mut Ui, report: &Report, width: f32) -> Option<MeasureRequest> {
    let (headings, rows) = report.rows.split_first()?;
    let mut request = None;
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
                    if press(ui, 84.0, "use it") {
                        request = Some(MeasureRequest::Use(k));
                    }
                    if press(ui, 120.0, "run it beside") {
                        request = Some(MeasureRequest::RowBeside(k));
                    }
                });
            });
    }
    ui.add_space(2.0);
    request
}

/// Draws a button of a width, and returns whether it was clicked.
fn press(ui: &mut Ui, width: f32, words: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(width, 26.0), Sense::click());
    chip(ui, rect, &response, words, false);
    response.clicked()
}

/// Writes a message in place of an answer, wrapped to the width of a rectangle.
pub fn say(ui: &Ui, room: Rect, words: &str) {
    let painter = ui.painter();
    let job =
        egui::text::LayoutJob::simple(words.into(), FontId::proportional(14.0), TEXT, room.width());
    let galley = painter.layout_job(job);
    painter.galley(pos2(room.left(), room.top()), galley, FAINT);
}
