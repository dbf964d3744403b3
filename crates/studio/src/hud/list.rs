//! The open list, drawn over the picture.

use std::collections::HashMap;

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align, Align2, Area, Color32, Context, CornerRadius, FontId, Frame, Id, Margin, Order, Pos2,
    Rect, ScrollArea, Sense, TextureId, Ui, pos2, vec2,
};

use super::style::{FAINT, MARGIN, PAPER, TEXT, faint, text, title};
use super::widgets::{Asks, LEFT, ask, keep_in_sight, write};
use crate::session::{Entry, PanelRequest, Session, Topic};

/// Largest width of the list (points).
const MAX_WIDTH: f32 = 560.0;
/// Largest width of the list of scenes (points), which has two columns if it is wide.
const MAX_SCENES_WIDTH: f32 = 780.0;
/// Width above which the list of scenes has two columns (points).
const TWO_COLUMN_WIDTH: f32 = 560.0;
/// Heights of an entry, and of one with a picture (points).
const ENTRY_HEIGHTS: [f32; 2] = [22.0, 62.0];
/// Width and height of a picture (points).
const PICTURE_SIZE: [f32; 2] = [88.0, 55.0];
/// Smallest width of the names (points).
const NAME_WIDTH: f32 = 136.0;

/// Draws the open list, if there is one, with `pictures` of scenes by their names.
pub fn show(ctx: &Context, session: &Session, pictures: &HashMap<String, TextureId>) {
    let Some(list) = &session.list else {
        return;
    };
    let window = ctx.content_rect().shrink(MARGIN);
    let (heading, scenes) = match list.topic {
        Topic::Scenes => ("Scenes", true),
        Topic::Solvers { .. } => ("Solvers", false),
        Topic::Beside { .. } => ("Compare with", false),
    };
    let largest = if scenes { MAX_SCENES_WIDTH } else { MAX_WIDTH };
    let width = largest.min(window.width() - 24.0);
    let columns = 1 + usize::from(scenes && width > TWO_COLUMN_WIDTH);
    let dark = session.runs.panes[0].show.dark;
    let area = Area::new(Id::unique("list"))
        .order(Order::Foreground)
        .anchor(Align2::CENTER_CENTER, vec2(0.0, 0.0))
        .show(ctx, |ui| {
            let sheet = Frame::new()
                .fill(PAPER.to_opaque())
                .corner_radius(7)
                .inner_margin(Margin::symmetric(12, 10));
            ui.style_mut().interaction.selectable_labels = false;
            sheet.show(ui, |ui| {
                ui.set_width(width);
                ui.horizontal(|ui| {
                    ui.label(title(heading));
                    ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                        if !session.readings.touch {
                            ui.label(faint("Esc"));
                        }
                    });
                });
                let typed = match &*list.filter {
                    "" if session.readings.touch => faint("tap one"),
                    "" => faint("type to search; choose by arrows and Enter, or by a click"),
                    typed => text(format!("{typed}_")),
                };
                ui.label(typed);
                ui.add_space(4.0);
                ui.spacing_mut().item_spacing = vec2(8.0, 0.0);
                let entries: Vec<_> = list.entries().enumerate().collect();
                let rows = entries.len().div_ceil(columns).max(1);
                let row_height = ENTRY_HEIGHTS[usize::from(scenes)];
                let room = (window.height() - 90.0).max(row_height);
                ScrollArea::vertical()
                    .max_height(room)
                    .min_scrolled_height(room.min(row_height * rows as f32))
                    .show(ui, |ui| {
                        if entries.is_empty() {
                            ui.label(faint("no entry has these words"));
                        }
                        let side =
                            (ui.available_width() - 8.0 * (columns - 1) as f32) / columns as f32;
                        ui.horizontal_top(|ui| {
                            for column in entries.chunks(rows) {
                                ui.vertical(|ui| {
                                    ui.set_width(side);
                                    for (k, entry) in column {
                                        let picture = pictures.get(&entry.name).copied();
                                        let picture = scenes.then_some((picture, dark));
                                        row(ui, entry, *k == list.chosen, picture);
                                    }
                                });
                            }
                        });
                    });
            });
        });
    // A click beside the list closes it, except on the bar, which may open another.
    let outside = pressed_at(ctx).is_some_and(|at| ctx.content_rect().contains(at));
    if outside && !area.response.contains_pointer() {
        ask(ctx, PanelRequest::CloseList);
    }
}

/// Returns the place of the pointer, if a button was pressed just now.
pub fn pressed_at(ctx: &Context) -> Option<Pos2> {
    ctx.input(|input| {
        let pressed = input.pointer.any_pressed();
        input.pointer.latest_pos().filter(|_| pressed)
    })
}

/// Draws an entry. One of the scenes has room for its picture, which may be missing, and which is
/// dark or light.
fn row(ui: &mut Ui, entry: &Entry, chosen: bool, picture: Option<(Option<TextureId>, bool)>) {
    let height = ENTRY_HEIGHTS[usize::from(picture.is_some())];
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::click());
    if chosen {
        keep_in_sight(ui, "entries", rect, entry.number);
    }
    if chosen || response.hovered() {
        let alpha = if chosen { 0.16 } else { 0.07 };
        let colour = TEXT.gamma_multiply(alpha);
        ui.painter().rect_filled(rect, CornerRadius::same(5), colour);
    }
    match picture {
        Some((picture, dark)) => card(ui, rect, entry, picture, dark),
        None => line(ui, rect, entry),
    }
    response.asks(PanelRequest::TakeEntry(entry.number));
}

/// Draws an entry of one line.
fn line(ui: &Ui, rect: Rect, entry: &Entry) {
    if entry.current {
        let at = rect.left_center() + vec2(12.0, 0.0);
        ui.painter().circle_filled(at, 3.5, TEXT);
    }
    let mark = if entry.current { "" } else { &entry.key };
    let say = |x: f32, words: &str, size, colour| {
        let room = rect.with_min_x(rect.left() + x);
        let painter = ui.painter().with_clip_rect(room.intersect(ui.clip_rect()));
        write(&painter, room.left_center(), LEFT, words, size, colour)
    };
    say(8.0, mark, 11.0, FAINT);
    let name = say(26.0, &entry.name, 13.5, TEXT);
    let about = (name.right() - rect.left() + 14.0).max(26.0 + NAME_WIDTH);
    let font = FontId::proportional(12.5);
    let mut words = LayoutJob::simple_singleline(entry.about.clone(), font, FAINT);
    words.wrap = TextWrapping::truncate_at_width(rect.width() - about);
    let words = ui.painter().layout_job(words);
    let at = pos2(rect.left() + about, rect.center().y - 0.5 * words.size().y);
    ui.painter().galley(at, words, FAINT);
}

/// Draws an entry with its picture, and its description below its name.
fn card(ui: &Ui, rect: Rect, entry: &Entry, picture: Option<TextureId>, dark: bool) {
    let [width, height] = PICTURE_SIZE;
    let place = Rect::from_min_size(rect.min + vec2(4.0, 3.5), vec2(width, height));
    let painter = ui.painter().with_clip_rect(rect.intersect(ui.clip_rect()));
    match picture {
        Some(id) => {
            // The dark theme inverts every colour, but the picture is dark already.
            let tint = if dark { Color32::BLACK } else { Color32::WHITE };
            let whole = Rect::from_min_max(Pos2::ZERO, Pos2::new(1.0, 1.0));
            painter.image(id, place, whole, tint);
        }
        None => {
            painter.rect_filled(place, 4.0, TEXT.gamma_multiply(0.06));
        }
    }
    let at = place.right_top() + vec2(10.0, 3.0);
    let name = write(&painter, at, Align2::LEFT_TOP, &entry.name, 14.0, TEXT);
    if entry.current {
        let at = name.right_center() + vec2(10.0, 1.0);
        painter.circle_filled(at, 3.5, TEXT);
    }
    let font = FontId::proportional(12.0);
    let room = rect.right() - at.x - 6.0;
    let about = LayoutJob::simple(entry.about.clone(), font, FAINT, room);
    let about = painter.layout_job(about);
    painter.galley(Pos2::new(at.x, name.bottom() + 1.0), about, FAINT);
}

#[cfg(test)]
mod tests {
    use egui::Event;

    use super::*;
    use crate::hud::window::{Window, button};
    use crate::session::{Action, RunAction, apply, session};

    /// Draws the list, with the pointer at a position, and a button pressed or released there.
    fn draw(
        window: &mut Window,
        session: &Session,
        at: Pos2,
        press: Option<bool>,
    ) -> Option<Action> {
        let press = press.map(|pressed| button(at, pressed));
        let events = [Event::PointerMoved(at)].into_iter().chain(press).collect();
        window.frame([0.0; 2], events, |ctx| show(ctx, session, &HashMap::new()))
    }

    #[test]
    fn a_click_takes_an_entry_and_a_click_elsewhere_closes_the_list() {
        let mut session = session(&["v", "0.005"]);
        session.act(RunAction::Scenes, 0);
        let mut window = Window::new([640.0, 360.0]);
        let middle = Pos2::new(200.0, 180.0);
        for _ in 0..3 {
            assert_eq!(draw(&mut window, &session, middle, None), None);
        }
        draw(&mut window, &session, middle, Some(true));
        let action = draw(&mut window, &session, middle, Some(false));
        let Some(Action::Panel(PanelRequest::TakeEntry(number))) = action else {
            panic!("{action:?}");
        };
        assert!(apply(&mut session, PanelRequest::TakeEntry(number), 0));
        let name = a3_scenes::SCENES[number].name;
        assert_eq!(session.runs.first().scene().name, name);
        session.act(RunAction::Scenes, 0);
        let corner = Pos2::new(4.0, 4.0);
        for _ in 0..2 {
            assert_eq!(draw(&mut window, &session, corner, None), None);
        }
        let action = draw(&mut window, &session, corner, Some(true));
        assert_eq!(action, Some(PanelRequest::CloseList.into()));
        assert!(!apply(&mut session, PanelRequest::CloseList, 0) && session.list.is_none());
    }
}
