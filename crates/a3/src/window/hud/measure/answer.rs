//! Drawing of an answer: its diagram, and its table as rows or as cards to choose from.

use egui::{
    Align, FontId, Label, Layout, Rect, RichText, ScrollArea, Sense, Ui, UiBuilder, pos2, vec2,
};

use super::super::panel::button;
use super::super::style::{FAINT, PAPER, TEXT, WARNING, faint, text, title};
use super::diagram;
use crate::base::report::Report;
use crate::window::session::{Answer, MeasureRequest, MethodSetting};

/// Share of the room that a diagram takes, and its largest height over its width.
const DIAGRAM: (f32, f32) = (0.66, 0.85);
/// Least height below a diagram for the table (points).
const MIN_TABLE: f32 = 90.0;

/// Draws an answer in a room. `shown` are the methods of the panes. Returns the request of the
/// mouse.
pub fn show(
    ui: &mut Ui,
    mut room: Rect,
    answer: &Answer,
    shown: &[MethodSetting],
) -> Option<MeasureRequest> {
    let mut request = None;
    if let Some(diagram) = &answer.diagram {
        let high = (DIAGRAM.0 * room.height()).min(DIAGRAM.1 * room.width());
        // In a low room the diagram takes all of it.
        let high = if room.height() - high < MIN_TABLE {
            room.height()
        } else {
            high
        };
        let place = room.with_max_y(room.top() + high);
        request = diagram::show(ui, place, diagram, shown);
        room.min.y = place.bottom() + 8.0;
    }
    if room.height() < 30.0 {
        return request;
    }
    ui.scope_builder(UiBuilder::new().max_rect(room), |ui| {
        ScrollArea::both()
            .auto_shrink(false)
            .max_height(room.height())
            .show(ui, |ui| {
                ui.spacing_mut().item_spacing = vec2(8.0, 4.0);
                if !answer.complete {
                    ui.label(WARNING.text("stopped: this is what was measured until then"));
                }
                let width = room.width() - 10.0;
                lines(ui, &answer.report.head, width);
                if answer.offers.is_empty() {
                    table(ui, &answer.report);
                } else {
                    request = cards(ui, &answer.report, width).or(request);
                }
                lines(ui, &answer.report.foot, width);
                for note in &answer.notes {
                    lines(ui, note, width);
                }
                if answer.lean.is_some() {
                    ui.add_space(4.0);
                    let pressed = press(ui, 250.0, "write the leanest scene and open it");
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

/// Writes the table, with its headings.
fn table(ui: &mut Ui, report: &Report) {
    let Some((headings, rows)) = report.rows.split_first() else {
        return;
    };
    let is_right = |c: usize| headings[c].starts_with(' ');
    let cell = |ui: &mut Ui, c: usize, words: RichText| {
        let label = Label::new(words).extend();
        if is_right(c) {
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| ui.add(label));
        } else {
            ui.add(label);
        }
    };
    egui::Grid::new("answer")
        .num_columns(headings.len())
        .spacing([14.0, 3.0])
        .striped(true)
        .show(ui, |ui| {
            for (c, heading) in headings.iter().enumerate() {
                cell(ui, c, faint(heading.trim()));
            }
            ui.end_row();
            for row in rows {
                for (c, words) in row.iter().enumerate() {
                    cell(ui, c, text(words.trim()).size(12.5));
                }
                ui.end_row();
            }
        });
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
pub fn press(ui: &mut Ui, width: f32, words: &str) -> bool {
    let (rect, response) = ui.allocate_exact_size(vec2(width, 26.0), Sense::click());
    button(ui, rect, &response, words, "");
    response.clicked()
}

/// Writes what is said where there is no answer, wrapped in a room.
pub fn say(ui: &Ui, room: Rect, words: &str) {
    let painter = ui.painter();
    let job =
        egui::text::LayoutJob::simple(words.into(), FontId::proportional(14.0), TEXT, room.width());
    let galley = painter.layout_job(job);
    painter.galley(pos2(room.left(), room.top()), galley, FAINT);
}
