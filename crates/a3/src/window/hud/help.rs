//! The help: keys, mouse and solvers.

use a3_core::integrators;
use egui::{Align2, Area, Context, Id, ScrollArea, Ui, vec2};

use super::style::{MARGIN, sheet, text, title};
use crate::window::session::{KEYS, MOUSE};

/// Width of a window above which the help has three columns (points).
const THREE_COLUMN_WIDTH: f32 = 800.0;

/// Shows the help, for one pane or `several`. In a small window it scrolls by the wheel.
pub fn help(ctx: &Context, several: bool) {
    let window = ctx.content_rect().shrink(MARGIN);
    Area::new(Id::unique("help"))
        .anchor(Align2::CENTER_CENTER, [0.0, 0.0])
        .show(ctx, |ui| {
            ui.style_mut().interaction.selectable_labels = false;
            sheet(ui, |ui| {
                // The window less the margins of the sheet.
                let room = window.size() - vec2(24.0, 18.0);
                ScrollArea::vertical()
                    .max_width(room.x)
                    .max_height(room.y.max(40.0))
                    .min_scrolled_height(room.y.max(40.0))
                    .show(ui, |ui| {
                        columns(ui, several, window.width() > THREE_COLUMN_WIDTH);
                    });
            });
        });
}

/// Writes keys, solvers and mouse side by side, or below one another in a narrow window.
fn columns(ui: &mut Ui, several: bool, wide: bool) {
    let rows = |ui: &mut Ui, heading: &str, rows: &[(String, &str)]| {
        ui.vertical(|ui| {
            ui.label(title(heading));
            egui::Grid::new(heading)
                .num_columns(2)
                .spacing([16.0, 4.0])
                .show(ui, |ui| {
                    for (key, does) in rows {
                        ui.label(text(key).strong());
                        ui.label(text(*does));
                        ui.end_row();
                    }
                });
        });
    };
    let keys: Vec<_> = KEYS
        .iter()
        .map(|binding| (binding.keys.join("  "), binding.help))
        .collect();
    let solvers = integrators::METHODS.iter().enumerate();
    let solvers: Vec<_> = solvers
        .map(|(i, method)| (((i + 1) % 10).to_string(), method.title))
        .take(10)
        .collect();
    let mouse: Vec<_> = MOUSE
        .iter()
        .map(|(what, does)| ((*what).to_owned(), *does))
        .collect();
    let heading = if several {
        "Solvers, under the pointer"
    } else {
        "Solvers"
    };
    if !wide {
        rows(ui, "Keys", &keys);
        ui.add_space(10.0);
        rows(ui, "Mouse", &mouse);
        ui.add_space(10.0);
        return rows(ui, heading, &solvers);
    }
    let (first, second) = keys.split_at(keys.len().div_ceil(2));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 28.0;
        rows(ui, "Keys", first);
        rows(ui, "More keys", second);
        ui.vertical(|ui| {
            rows(ui, heading, &solvers);
            ui.add_space(10.0);
            rows(ui, "Mouse", &mouse);
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::hud::{pane, read};
    use crate::window::session::Readings;

    #[test]
    fn the_help_lists_every_key() {
        let readings = Readings {
            help: true,
            ..Readings::default()
        };
        let (words, sheets) = read(&[pane("chain", "r", 0.01)], &readings, [1280.0, 720.0]);
        for binding in KEYS {
            assert!(
                words.contains(binding.help) && words.contains(&binding.keys.join("  ")),
                "{words}"
            );
        }
        for method in &integrators::METHODS[..10] {
            assert!(words.contains(method.title));
        }
        assert!(
            sheets[0].height() < 690.0 && sheets[0].width() < 900.0,
            "{sheets:?}"
        );
    }

    /// In a small window the help has one column, stays within the window, and scrolls.
    #[test]
    fn the_help_fits_into_small_windows() {
        for size in [[320.0, 240.0], [640.0, 360.0], [1000.0, 300.0]] {
            let ctx = crate::window::hud::style::context();
            let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
            let seen = |scroll: f32| {
                let mut words = String::new();
                for _ in 0..3 {
                    let mut events = vec![egui::Event::PointerMoved(screen.center())];
                    events.push(egui::Event::MouseWheel {
                        unit: egui::MouseWheelUnit::Point,
                        delta: vec2(0.0, scroll),
                        phase: egui::TouchPhase::Move,
                        source: egui::MouseWheelSource::Wheel,
                        modifiers: egui::Modifiers::default(),
                    });
                    let input = egui::RawInput {
                        screen_rect: Some(screen),
                        events,
                        ..Default::default()
                    };
                    let mut output = ctx.run_ui(input, |ui| help(ui.ctx(), false));
                    output.textures_delta.set.clear();
                    output.textures_delta.free.clear();
                    words.clear();
                    for clipped in &output.shapes {
                        let egui::Shape::Text(text) = &clipped.shape else {
                            continue;
                        };
                        let rect = text.visual_bounding_rect();
                        assert!(screen.x_range().contains(rect.right()), "{size:?}");
                        if clipped.clip_rect.contains_rect(rect) {
                            words.extend([text.galley.text(), "\n"]);
                        }
                    }
                }
                words
            };
            let last = if size[0] > THREE_COLUMN_WIDTH {
                KEYS[KEYS.len() - 1].help
            } else {
                integrators::METHODS[9].title
            };
            let first = "next scene";
            let above = seen(0.0);
            assert!(
                above.contains(first) && !above.contains(last),
                "{size:?} {above}"
            );
            for _ in 0..60 {
                seen(-200.0);
            }
            let below = seen(0.0);
            assert!(
                below.contains(last) && !below.contains(first),
                "{size:?} {below}"
            );
        }
    }
}
