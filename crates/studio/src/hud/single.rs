//! The text over a single pane: its readings, and sheets for a blow-up, a film, a message and
//! springs.

use a3_core::Simulation;
use a3_media::show;
use egui::{Align2, Context, RichText, Ui};

use super::blow_up::{advice, explain};
use super::layout;
use super::legend::legend;
use super::style::{MARGIN, SAFE, column, faint, sheet, text, title};
use super::words::{self, digits};
use crate::session::{Pane, Readings};

/// Width of the names of readings (points).
const NAME_WIDTH: f32 = 84.0;
/// Largest number of springs that are listed.
const MAX_LISTED_SPRINGS: usize = 12;

/// Draws all sheets.
pub fn show(ctx: &Context, pane: &Pane, readings: &Readings) {
    column(ctx, "run", Align2::LEFT_TOP, [MARGIN, MARGIN], |ui| {
        ui.set_max_width(ui.available_width().min(460.0));
        let size = layout::Text::of(1, ctx.content_rect().size().into());
        sheet(ui, |ui| match size {
            layout::Text::Whole => run(ui, pane, readings),
            layout::Text::Few => brief(ui, pane, readings),
            layout::Text::Name => least(ui, pane, readings),
        });
        if let Some(blow_up) = pane.simulation.blow_up() {
            sheet(ui, |ui| {
                explain(ui, pane, &blow_up);
                if size == layout::Text::Whole {
                    ui.label(text(advice(&blow_up)));
                }
            });
        }
        if let Some(film) = &readings.film {
            sheet(ui, |ui| words::film(ui, film));
        }
        if let Some(message) = &readings.message {
            sheet(ui, |ui| {
                ui.label(text(message));
            });
        }
        if let Some(i) = pane.show.springs_of {
            sheet(ui, |ui| springs(ui, &pane.simulation, i));
        }
    });
}

/// Writes the most important readings of the run, for a small window.
fn brief(ui: &mut Ui, pane: &Pane, readings: &Readings) {
    let simulation = &pane.simulation;
    ui.label(title(words::scene(simulation)).size(15.0));
    ui.label(text(words::method(simulation)));
    ui.label(text(time(simulation, readings)));
    if simulation.blow_up().is_some() {
        return;
    }
    let limit = words::limit(pane).filter(|(_, mark)| *mark != SAFE);
    let warnings = [
        limit.map(|(words, mark)| mark.text(&words)),
        words::gained(simulation),
        words::worst_constraint(simulation),
    ];
    for warning in warnings.into_iter().flatten() {
        ui.label(warning);
    }
    legend(ui, &pane.show);
}

/// Writes the name of the scene and the time, for a tiny window.
fn least(ui: &mut Ui, pane: &Pane, readings: &Readings) {
    let name = pane.simulation.scene().name.clone();
    ui.add(egui::Label::new(title(name).size(14.0)).truncate());
    ui.label(text(time(&pane.simulation, readings)));
}

/// Returns the time, and whether the run is paused.
fn time(simulation: &Simulation, readings: &Readings) -> String {
    let paused = if readings.paused { "   paused" } else { "" };
    format!("{}{paused}", words::time(simulation))
}

/// Writes the readings of the run.
fn run(ui: &mut Ui, pane: &Pane, readings: &Readings) {
    let simulation = &pane.simulation;
    ui.label(title(words::scene(simulation)));
    ui.label(text(words::method(simulation)));
    egui::Grid::new("readings")
        .num_columns(2)
        .spacing([14.0, 3.0])
        .max_col_width((ui.available_width() - NAME_WIDTH).max(60.0))
        .show(ui, |ui| {
            let mut row = |name: &str, value: RichText| {
                ui.label(faint(name));
                ui.label(value);
                ui.end_row();
            };
            row("time", text(words::time(simulation)));
            if let Some(speed) = words::speed(readings).filter(|_| !readings.paused) {
                row("speed", text(speed));
            }
            if let Some(slow) = words::slow_motion(readings) {
                row("slow", text(slow));
            }
            if let Some(steps) = words::steps(simulation) {
                row("steps", text(steps));
            }
            row("limit", words::limit_row(pane));
            let (name, value) = words::energy(pane);
            row(name, text(value));
            if let Some(gained) = words::gained(simulation) {
                row("gained", gained);
            }
            if let Some(broken) = words::worst_constraint(simulation) {
                row("constraint", broken);
            }
            if let Some(stretch) = pane.stretch {
                row("stretch", text(format!("{stretch:.3} at most")));
            }
            if let Some(contact) = words::contact(simulation) {
                row("contact", text(contact));
            }
            if let Some([frames, each]) = words::frames(readings) {
                row("frames", text(frames));
                row("each", text(each));
            }
        });
    if let Some(states) = words::states(simulation, readings) {
        ui.label(states);
    }
    if let Some(without) = words::without(readings) {
        ui.label(text(without));
    }
    legend(ui, &pane.show);
}

/// Lists the springs of a particle and their present stretch.
fn springs(ui: &mut Ui, simulation: &Simulation, i: usize) {
    let springs = show::springs_of(simulation, i);
    ui.label(title(format!("particle {i}: {} springs", springs.len())).size(14.0));
    egui::Grid::new("springs")
        .num_columns(5)
        .spacing([12.0, 1.0])
        .show(ui, |ui| {
            for name in ["kind", "to", "N/m", "rest, m", "stretch"] {
                ui.label(faint(name));
            }
            ui.end_row();
            for s in springs.iter().take(MAX_LISTED_SPRINGS) {
                let other = s.i + s.j - i;
                let length = (simulation.position(i) - simulation.position(other)).norm();
                ui.label(text(show::kind_name(s.kind)));
                ui.label(text(other.to_string()));
                ui.label(text(digits(s.law.stiffness)));
                ui.label(text(digits(s.law.rest_length)));
                ui.label(match s.law.rest_length {
                    0.0 => text("-"),
                    rest => text(format!("{:.3}", length / rest)),
                });
                ui.end_row();
            }
        });
    if springs.len() > MAX_LISTED_SPRINGS {
        ui.label(faint(format!(
            "and {} more",
            springs.len() - MAX_LISTED_SPRINGS
        )));
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::{pane, read};

    #[test]
    fn all_readings_are_shown() {
        let mut pane = pane("cloth", "t", 0.01);
        (pane.energy, pane.stretch) = (Some(12.3456), Some(1.25));
        let run = &mut pane.simulation;
        run.set_wind(true);
        run.set_swinging(true);
        run.grab(210).unwrap();
        run.take_steps(7).unwrap();
        let readings = Readings {
            factor: 0.98,
            rate: 59.6,
            simulating: 0.2,
            drawing: 3.4,
            message: Some("saved".into()),
            ..Readings::default()
        };
        let panes = [pane];
        let (words, _) = read(&panes, &readings, [1280.0, 720.0]);
        for said in [
            "cloth  20 × 20",
            "explicit trapezoid (Heun),  step 0.01 s",
            "0.07 s",
            "0.98 × real time",
            "12.346 J",
            "1.250 at most",
            "60 per second",
            "0.2 ms steps + 3.4 ms drawing",
            "wind   swing   pulling",
            "saved",
        ] {
            assert!(words.contains(said), "{said} in\n{words}");
        }
        let readings = Readings {
            paused: true,
            ..readings
        };
        let (words, _) = read(&panes, &readings, [1280.0, 720.0]);
        assert!(words.contains("paused   wind"), "{words}");
        // A paused run shows no rates.
        assert_eq!(words.matches("paused").count(), 1, "{words}");
        assert!(!words.contains("per second") && !words.contains("drawing"));
        let circle = [crate::hud::pane("simple", "e", 1e-7)];
        // Nothing is said of rates before they are measured.
        let (words, _) = read(&circle, &Readings::default(), [1280.0, 720.0]);
        for said in ["speed\n", "frames\n", "each\n"] {
            assert!(!words.contains(said), "{words}");
        }
        let slow = Readings {
            factor: 0.0005,
            ..Readings::default()
        };
        let (words, _) = read(&circle, &slow, [1280.0, 720.0]);
        for said in ["1.000000 m", "0.0000000 s", "5.0e-4 × real time"] {
            assert!(words.contains(said), "{said} in\n{words}");
        }
        // There is no wind on a circle to be off.
        assert!(
            !words.contains("wind") && !words.contains("swing"),
            "{words}"
        );
        let (words, _) = read(
            &[crate::hud::pane("cloth", "t", 0.01)],
            &slow,
            [1280.0, 720.0],
        );
        assert!(words.contains("no wind, no swing"), "{words}");
    }

    #[test]
    fn the_springs_of_a_particle_are_listed() {
        let mut pane = pane("cloth", "t", 0.01);
        pane.show.springs_of = Some(210);
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let springs: usize = words
            .split_once("particle 210: ")
            .and_then(|(_, rest)| rest.split_once(' ')?.0.parse().ok())
            .unwrap();
        assert_eq!(springs, 12);
        assert_eq!(words.matches("structural").count(), 4, "{words}");
        assert!(words.contains("shear\n") && words.contains("230\n") && !words.contains("more"));
    }
}
