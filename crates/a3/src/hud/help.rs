//! The help: keys, mouse and solvers.

use a3_core::integrators;
use egui::Ui;

use super::style::{text, title};
use crate::session::{KEYS, MOUSE};

/// Writes the help, for one pane or `several`.
pub fn help(ui: &mut Ui, several: bool) {
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
    let (first, second) = keys.split_at(keys.len().div_ceil(2));
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = 28.0;
        rows(ui, "Keys", first);
        rows(ui, "More keys", second);
        ui.vertical(|ui| {
            let heading = if several {
                "Solvers, under the pointer"
            } else {
                "Solvers"
            };
            rows(ui, heading, &solvers);
            ui.add_space(10.0);
            rows(ui, "Mouse", &mouse);
        });
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::{pane, read};
    use crate::session::Readings;

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
            sheets[0].height() < 510.0 && sheets[0].width() < 780.0,
            "{sheets:?}"
        );
    }
}
