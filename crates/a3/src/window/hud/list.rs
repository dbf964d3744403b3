//! The open list, drawn over the picture.

use egui::{
    Align, Align2, Area, Context, CornerRadius, FontId, Frame, Id, Margin, Order, ScrollArea,
    Sense, Ui, vec2,
};

use super::panel::PanelRequest;
use super::style::{FAINT, MARGIN, PAPER, TEXT, faint, text, title};
use crate::window::session::{Entry, Session, Topic};

/// Largest width of the list (points).
const MAX_WIDTH: f32 = 560.0;
/// Height of an entry (points).
const ENTRY_HEIGHT: f32 = 22.0;
/// Smallest width of the names (points).
const NAME_WIDTH: f32 = 136.0;

/// Draws the open list, and returns the request of the mouse.
pub fn show(ctx: &Context, session: &Session) -> Option<PanelRequest> {
    let list = session.list.as_ref()?;
    let window = ctx.content_rect().shrink(MARGIN);
    let mut request = None;
    let heading = match list.topic {
        Topic::Scenes => "Scenes",
        Topic::Solvers { .. } => "Solvers",
    };
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
                ui.set_width(MAX_WIDTH.min(window.width() - 24.0));
                ui.horizontal(|ui| {
                    ui.label(title(heading));
                    ui.with_layout(egui::Layout::right_to_left(Align::Center), |ui| {
                        ui.label(faint("Esc"));
                    });
                });
                let typed = if list.filter.is_empty() {
                    faint("type to search; choose by arrows and Enter, or by a click")
                } else {
                    text(format!("{}_", list.filter))
                };
                ui.label(typed);
                ui.add_space(4.0);
                ui.spacing_mut().item_spacing.y = 0.0;
                let room = (window.height() - 90.0).max(ENTRY_HEIGHT);
                ScrollArea::vertical()
                    .max_height(room)
                    .min_scrolled_height(room.min(ENTRY_HEIGHT * list.entries().count() as f32))
                    .show(ui, |ui| {
                        let mut count = 0;
                        for (k, entry) in list.entries().enumerate() {
                            count += 1;
                            if row(ui, entry, k == list.chosen) {
                                request = Some(PanelRequest::TakeEntry(entry.number));
                            }
                        }
                        if count == 0 {
                            ui.label(faint("no entry has these words"));
                        }
                    });
            });
        });
    let outside = |ctx: &Context| ctx.input(|input| input.pointer.any_pressed());
    if request.is_none() && outside(ctx) && !area.response.contains_pointer() {
        request = Some(PanelRequest::CloseList);
    }
    request
}

/// Draws an entry, and returns whether it was clicked.
fn row(ui: &mut Ui, entry: &Entry, chosen: bool) -> bool {
    let (rect, response) =
        ui.allocate_exact_size(vec2(ui.available_width(), ENTRY_HEIGHT), Sense::click());
    // Scroll to the chosen entry only when it changes, so that the wheel can scroll.
    let was = Id::unique("chosen entry");
    if chosen && ui.data(|data| data.get_temp(was)) != Some(entry.number) {
        ui.data_mut(|data| data.insert_temp(was, entry.number));
        response.scroll_to_me(None);
    }
    let ink = TEXT;
    if chosen || response.hovered() {
        let alpha = if chosen { 0.16 } else { 0.07 };
        let colour = TEXT.gamma_multiply(alpha);
        ui.painter()
            .rect_filled(rect, CornerRadius::same(4), colour);
    }
    if entry.current {
        let at = rect.left_center() + vec2(12.0, 0.0);
        ui.painter().circle_filled(at, 3.5, TEXT);
    }
    let mark = if entry.current { "" } else { &entry.key };
    let write = |x: f32, words: &str, size, colour| {
        let room = rect.with_min_x(rect.left() + x);
        let at = room.left_center();
        let font = FontId::proportional(size);
        let painter = ui.painter().with_clip_rect(room.intersect(ui.clip_rect()));
        painter.text(at, Align2::LEFT_CENTER, words, font, colour)
    };
    write(8.0, mark, 11.0, FAINT);
    let name = write(26.0, &entry.name, 13.5, ink);
    let about = (name.right() - rect.left() + 14.0).max(26.0 + NAME_WIDTH);
    write(about, &entry.about, 12.5, FAINT);
    response.clicked()
}

#[cfg(test)]
mod tests {
    use egui::{Event, Modifiers, PointerButton, Pos2, RawInput, Rect};

    use super::*;
    use crate::window::hud::panel;
    use crate::window::session::{RunAction, session};

    /// Draws the list, with the pointer at a position, and a button pressed or released there.
    fn draw(
        ctx: &Context,
        session: &Session,
        at: Pos2,
        pressed: Option<bool>,
    ) -> Option<PanelRequest> {
        let mut events = vec![Event::PointerMoved(at)];
        events.extend(pressed.map(|pressed| Event::PointerButton {
            pos: at,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::default(),
        }));
        let input = RawInput {
            screen_rect: Some(Rect::from_min_size(Pos2::ZERO, vec2(640.0, 360.0))),
            events,
            ..RawInput::default()
        };
        let mut request = None;
        let mut output = ctx.run_ui(input, |ui| request = show(ui.ctx(), session).or(request));
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        request
    }

    #[test]
    fn a_click_takes_an_entry_and_a_click_elsewhere_closes_the_list() {
        let mut session = session(&["v", "0.005"]);
        session.act(RunAction::Scenes, 0);
        let ctx = crate::window::hud::style::context();
        let middle = Pos2::new(320.0, 180.0);
        for _ in 0..3 {
            assert_eq!(draw(&ctx, &session, middle, None), None);
        }
        draw(&ctx, &session, middle, Some(true));
        let request = draw(&ctx, &session, middle, Some(false));
        let Some(PanelRequest::TakeEntry(number)) = request else {
            panic!("{request:?}");
        };
        assert!(panel::apply(&mut session, PanelRequest::TakeEntry(number)));
        let name = a3_scenes::SCENES[number].name;
        assert_eq!(session.runs.first().scene().name, name);
        session.act(RunAction::Scenes, 0);
        let corner = Pos2::new(4.0, 4.0);
        for _ in 0..2 {
            assert_eq!(draw(&ctx, &session, corner, None), None);
        }
        let request = draw(&ctx, &session, corner, Some(true));
        assert_eq!(request, Some(PanelRequest::CloseList));
        assert!(!panel::apply(&mut session, PanelRequest::CloseList) && session.list.is_none());
    }
}
