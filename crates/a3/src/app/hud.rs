//! What is written over the picture: egui, without winit and wgpu, so that a test can read it.

use a3_core::Simulation;
use egui::{Align2, Area, Color32, Context, Frame, Id, Margin, RichText, Ui};

use super::keys::{KEYS, MOUSE};

/// What the text says beside the run itself.
#[derive(Clone, Debug, Default)]
pub struct Readings {
    pub paused: bool,
    pub help: bool,
    /// Simulated over real time.
    pub factor: f32,
    /// Frames per second.
    pub rate: f32,
    /// Time a frame spends on the simulation, and on drawing [ms].
    pub simulating: f32,
    pub drawing: f32,
    /// What just happened, for a few seconds.
    pub message: Option<String>,
}

const TEXT: Color32 = Color32::from_rgb(24, 28, 40);
const FAINT: Color32 = Color32::from_rgb(92, 98, 114);
const PAPER: Color32 = Color32::from_rgba_premultiplied(216, 216, 214, 222);
const ALARM: Color32 = Color32::from_rgb(170, 22, 30);

/// A sheet of paper that no click sees.
fn sheet(
    ctx: &Context,
    name: &str,
    anchor: Align2,
    offset: [f32; 2],
    contents: impl FnOnce(&mut Ui),
) {
    Area::new(Id::unique(name))
        .anchor(anchor, offset)
        .interactable(false)
        .show(ctx, |ui| {
            Frame::new()
                .fill(PAPER)
                .corner_radius(7)
                .inner_margin(Margin::symmetric(12, 9))
                .show(ui, |ui| {
                    ui.style_mut().wrap_mode = Some(egui::TextWrapMode::Extend);
                    ui.spacing_mut().item_spacing = egui::vec2(8.0, 3.0);
                    contents(ui);
                });
        });
}

fn text(words: impl Into<String>) -> RichText {
    RichText::new(words).color(TEXT).size(13.5)
}

fn faint(words: impl Into<String>) -> RichText {
    RichText::new(words).color(FAINT).size(12.5)
}

/// Writes everything.
pub fn show(ctx: &Context, simulation: &Simulation, readings: &Readings) {
    sheet(ctx, "run", Align2::LEFT_TOP, [12.0, 12.0], |ui| {
        run(ui, simulation, readings);
    });
    if readings.help {
        sheet(ctx, "help", Align2::CENTER_CENTER, [0.0, 0.0], help);
    } else {
        sheet(ctx, "hint", Align2::LEFT_BOTTOM, [12.0, -12.0], |ui| {
            ui.label(faint("h  help"));
        });
    }
    if let Some(blow_up) = simulation.blow_up() {
        sheet(ctx, "blow-up", Align2::CENTER_TOP, [0.0, 12.0], |ui| {
            ui.label(
                RichText::new(format!("It {blow_up}."))
                    .color(ALARM)
                    .size(15.0)
                    .strong(),
            );
            let step = simulation.step_size();
            ui.label(text(format!(
                "The step of {step} s is too long for {} here.",
                simulation.method().title
            )));
            ui.label(faint(
                "-  shorter step      1-9  another solver      r  start again",
            ));
        });
    } else if let Some(message) = &readings.message {
        sheet(ctx, "message", Align2::CENTER_BOTTOM, [0.0, -12.0], |ui| {
            ui.label(text(message));
        });
    }
}

fn run(ui: &mut Ui, simulation: &Simulation, readings: &Readings) {
    let scene = simulation.scene();
    let grid = scene.grid.map_or(String::new(), |grid| {
        format!("  {} × {}", grid.rows(), grid.cols())
    });
    ui.label(
        RichText::new(format!("{}{grid}", scene.name))
            .color(TEXT)
            .size(17.0)
            .strong(),
    );
    ui.label(text(format!(
        "{},  step {} s",
        simulation.method().title,
        simulation.step_size()
    )));
    egui::Grid::new("readings")
        .num_columns(2)
        .spacing([14.0, 3.0])
        .show(ui, |ui| {
            let mut row = |name: &str, value: String| {
                ui.label(faint(name));
                ui.label(text(value));
                ui.end_row();
            };
            row(
                "time",
                format!(
                    "{:.2} s,  {:.2} × real time",
                    simulation.time(),
                    readings.factor
                ),
            );
            match simulation.energy() {
                Some(energy) => row("energy", format!("{:.3} J", energy.total())),
                None => row("radius", format!("{:.6} m", simulation.position(0).norm())),
            }
            if let Some(stretch) = simulation.largest_stretch() {
                row("stretch", format!("{stretch:.3} at most"));
            }
            row(
                "frame",
                format!(
                    "{:.0} /s:  {:.1} ms steps,  {:.1} ms drawing",
                    readings.rate, readings.simulating, readings.drawing
                ),
            );
        });
    let states = [
        (readings.paused, "paused"),
        (simulation.windy(), "wind"),
        (simulation.swinging(), "swing"),
        (simulation.grabbed().is_some(), "pulling"),
    ];
    let on: Vec<_> = states
        .iter()
        .filter(|(on, _)| *on)
        .map(|(_, name)| *name)
        .collect();
    ui.label(if on.is_empty() {
        faint("no wind, no swing")
    } else {
        text(on.join("   ")).strong()
    });
}

fn help(ui: &mut Ui) {
    ui.label(RichText::new("Keys").color(TEXT).size(17.0).strong());
    egui::Grid::new("keys")
        .num_columns(2)
        .spacing([22.0, 4.0])
        .show(ui, |ui| {
            for binding in KEYS {
                ui.label(text(binding.keys.join("  ")).strong());
                ui.label(text(binding.help));
                ui.end_row();
            }
            for (i, method) in a3_core::integrators::METHODS.iter().enumerate().take(9) {
                ui.label(text((i + 1).to_string()).strong());
                ui.label(text(method.title));
                ui.end_row();
            }
        });
    ui.add_space(6.0);
    ui.label(RichText::new("Mouse").color(TEXT).size(17.0).strong());
    egui::Grid::new("mouse")
        .num_columns(2)
        .spacing([22.0, 4.0])
        .show(ui, |ui| {
            for (what, does) in MOUSE {
                ui.label(text(*what).strong());
                ui.label(text(*does));
                ui.end_row();
            }
        });
}
