//! The help: all that a user can do, by its purpose. A click on a row does it.

use a3_core::integrators;
use egui::{Align2, Area, Context, CursorIcon, Id, ScrollArea, Sense, Ui, pos2, vec2};

use super::list::pressed_at;
use super::style::{INK, MARGIN, TEXT, sheet, title};
use super::widgets::{Asks, LEFT, ask, write};
use crate::session::{
    Action, Binding, FINGERS, GROUPS, Group, MOUSE, RunAction, WindowAction, is_here,
};

/// Width of a window above which the help has three columns (points).
const THREE_COLUMN_WIDTH: f32 = 900.0;
/// Height of a row (points).
const ROW_HEIGHT: f32 = 21.0;
/// Widths of a key, of a gesture of the mouse, and of what follows (points).
const WIDTHS: [f32; 3] = [58.0, 128.0, 190.0];

/// Shows the help, for one pane or `several`. In a small window it scrolls by the wheel.
pub fn help(ctx: &Context, several: bool, touch: bool) {
    let window = ctx.content_rect().shrink(MARGIN);
    let area =
        Area::new(Id::unique("help")).anchor(Align2::CENTER_CENTER, [0.0, 0.0]).show(ctx, |ui| {
            ui.style_mut().interaction.selectable_labels = false;
            sheet(ui, |ui| {
                // The window less the margins of the sheet.
                let room = window.size() - vec2(24.0, 18.0);
                ScrollArea::vertical()
                    .max_width(room.x)
                    .max_height(room.y.max(40.0))
                    .min_scrolled_height(room.y.max(40.0))
                    .show(ui, |ui| {
                        columns(ui, several, touch, window.width() > THREE_COLUMN_WIDTH);
                    });
            });
        });
    // A click beside the help closes it, except on the bar.
    let pressed = pressed_at(ctx).is_some_and(|at| ctx.content_rect().contains(at));
    if pressed && !area.response.contains_pointer() {
        ask(ctx, RunAction::Help);
    }
}

/// Writes all groups in three columns, or below one another in a narrow window.
fn columns(ui: &mut Ui, several: bool, touch: bool, wide: bool) {
    let [running, choose, change, show, look, measure, keep, window] = &GROUPS;
    let column = |ui: &mut Ui, groups: &[&Group], mouse: bool, numbered: bool| {
        ui.vertical(|ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            if mouse {
                gestures(ui, touch);
            }
            for group in groups {
                bindings(ui, group);
            }
            if numbered {
                solvers(ui, several);
            }
        });
    };
    if !wide {
        let all: Vec<_> = GROUPS.iter().collect();
        return column(ui, &all, true, true);
    }
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 26.0;
        column(ui, &[change, choose, show], true, false);
        column(ui, &[running, look, measure, window], false, false);
        column(ui, &[keep], false, true);
    });
}

/// Writes a heading.
fn heading(ui: &mut Ui, words: &str) {
    ui.add_space(4.0);
    ui.label(title(words).size(15.0));
    ui.add_space(2.0);
}

/// Writes what the mouse does, or fingers if they are used.
fn gestures(ui: &mut Ui, touch: bool) {
    let (by, gestures) = if touch { ("Fingers", FINGERS) } else { ("Mouse", MOUSE) };
    heading(ui, by);
    for (gesture, does) in gestures {
        row(ui, [gesture, does], WIDTHS[1], None);
    }
}

/// Writes the keys of a purpose.
fn bindings(ui: &mut Ui, group: &Group) {
    heading(ui, group.purpose);
    let here = group.bindings.iter().filter(|it| is_here(it.action));
    for Binding { keys, action, help } in here {
        // A click cannot point at a particle too.
        let clicked = Some(*action).filter(|it| *it != Action::Window(WindowAction::Follow));
        row(ui, [&keys.join("  "), help], WIDTHS[0], clicked);
    }
}

/// Writes the solvers that digits choose.
fn solvers(ui: &mut Ui, several: bool) {
    let under = if several { ", under the pointer" } else { "" };
    heading(ui, &format!("Solvers{under}"));
    for (i, method) in integrators::METHODS.iter().enumerate().take(10) {
        let key = ((i + 1) % 10).to_string();
        let action = Action::Run(RunAction::Solver(i));
        row(ui, [&key, method.title], WIDTHS[0], Some(action));
    }
}

/// Writes a key and its effect. A click asks for its action.
fn row(ui: &mut Ui, words: [&str; 2], width: f32, action: Option<Action>) {
    let sense = if action.is_some() { Sense::click() } else { Sense::hover() };
    let size = vec2(width + WIDTHS[2], ROW_HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, sense);
    if action.is_some() && response.hovered() {
        let place = rect.expand2(vec2(6.0, 0.0));
        ui.painter().rect_filled(place, 4.0, TEXT.gamma_multiply(0.1));
        ui.set_cursor_icon(CursorIcon::PointingHand);
    }
    let y = rect.center().y;
    for (words, x, colour) in [(words[0], 0.0, INK), (words[1], width, TEXT)] {
        let at = pos2(rect.left() + x, y);
        write(ui.painter(), at, LEFT, words, 13.0, colour);
    }
    if let Some(action) = action {
        response.asks(action);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::window::Window;
    use crate::hud::{pane, read};
    use crate::session::{Readings, bindings};

    #[test]
    fn the_help_lists_every_key() {
        let readings = Readings { help: true, ..Readings::default() };
        let (words, sheets) = read(&[pane("chain", "r", 0.01)], &readings, [1280.0, 720.0]);
        for binding in bindings() {
            assert!(
                words.contains(binding.help) && words.contains(&binding.keys.join("  ")),
                "{words}"
            );
        }
        for method in &integrators::METHODS[..10] {
            assert!(words.contains(method.title));
        }
        assert!(sheets[0].height() < 690.0 && sheets[0].width() < 900.0, "{sheets:?}");
    }

    /// In a small window the help has one column, stays within the window, and scrolls.
    #[test]
    fn the_help_fits_into_small_windows() {
        for size in [[320.0, 240.0], [640.0, 360.0], [1000.0, 300.0]] {
            let mut window = Window::new(size);
            let mut seen = |scroll: f32| {
                let wheel = egui::Event::MouseWheel {
                    unit: egui::MouseWheelUnit::Point,
                    delta: vec2(0.0, scroll),
                    phase: egui::TouchPhase::Move,
                    source: egui::MouseWheelSource::Wheel,
                    modifiers: egui::Modifiers::default(),
                };
                let events = [egui::Event::PointerMoved(window.place.center()), wheel];
                for _ in 0..3 {
                    window.frame([0.0; 2], events.to_vec(), |ctx| help(ctx, false, false));
                }
                let mut words = String::new();
                for (said, rect, seen) in window.written() {
                    assert!(window.place.x_range().contains(rect.right()), "{size:?}");
                    if seen.contains_rect(rect) {
                        words.extend([&*said, "\n"]);
                    }
                }
                words
            };
            let last = integrators::METHODS[9].title;
            let first = "pull or push";
            let above = seen(0.0);
            assert!(above.contains(first) && !above.contains(last), "{size:?} {above}");
            for _ in 0..60 {
                seen(-200.0);
            }
            let below = seen(0.0);
            assert!(below.contains(last) && !below.contains(first), "{size:?} {below}");
        }
    }
}
