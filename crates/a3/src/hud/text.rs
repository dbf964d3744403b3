//! What is written over the picture: egui, without winit and wgpu, so that a test can read it.

use a3_core::{BlowUp, Cause, Control, Simulation, integrators};
use egui::{Align2, Area, Color32, Context, Frame, Id, Margin, RichText, Ui};

use super::{panes, timeline};
use crate::session::{KEYS, MOUSE, Pane, Readings};
use crate::show;

pub const TEXT: Color32 = Color32::from_rgb(24, 28, 40);
pub const FAINT: Color32 = Color32::from_rgb(92, 98, 114);
pub const PAPER: Color32 = Color32::from_rgba_premultiplied(216, 216, 214, 222);
const SAFE: Color32 = Color32::from_rgb(12, 106, 52);
const WARNING: Color32 = Color32::from_rgb(158, 84, 0);
const ALARM: Color32 = Color32::from_rgb(170, 22, 30);
/// So many springs are listed at most.
const LISTED: usize = 12;
/// From the edge of the window (points).
const MARGIN: f32 = 12.0;

/// Sheets of paper below one another, that no click sees.
fn column(
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
            ui.spacing_mut().item_spacing = egui::vec2(8.0, 6.0);
            ui.set_max_width((ctx.content_rect().width() - 2.0 * MARGIN).clamp(60.0, 760.0));
            contents(ui);
        });
}

pub fn sheet(ui: &mut Ui, contents: impl FnOnce(&mut Ui)) {
    Frame::new()
        .fill(PAPER)
        .corner_radius(7)
        .inner_margin(Margin::symmetric(12, 9))
        .show(ui, |ui| {
            ui.spacing_mut().item_spacing = egui::vec2(8.0, 3.0);
            contents(ui);
        });
}

pub fn title(words: impl Into<String>) -> RichText {
    RichText::new(words).color(TEXT).size(17.0).strong()
}

pub fn text(words: impl Into<String>) -> RichText {
    RichText::new(words).color(TEXT).size(13.5)
}

pub fn faint(words: impl Into<String>) -> RichText {
    RichText::new(words).color(FAINT).size(12.5)
}

/// Writes everything. Sheets stand below one another, and the help alone: nothing overlaps, however small the window.
pub fn show(ctx: &Context, panes: &[Pane], readings: &Readings) {
    match panes {
        [pane] if !readings.help => show_one(ctx, pane, readings),
        [_] => {}
        panes => panes::show(ctx, panes, readings),
    }
    if readings.help {
        column(ctx, "help", Align2::CENTER_CENTER, [0.0, 0.0], |ui| {
            sheet(ui, |ui| help(ui, panes.len() > 1));
        });
    } else if let Some(place) = &readings.place {
        timeline::show(ctx, place);
    }
}

fn show_one(ctx: &Context, pane: &Pane, readings: &Readings) {
    column(ctx, "run", Align2::LEFT_TOP, [MARGIN, MARGIN], |ui| {
        ui.set_max_width(ui.available_width().min(460.0));
        sheet(ui, |ui| run(ui, pane, readings));
        if let Some(lost) = pane.simulation.blow_up() {
            sheet(ui, |ui| {
                blow_up(ui, pane, &lost);
                ui.label(text(way_out()));
            });
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
    if ctx.content_rect().height() > 400.0 && readings.place.is_none() {
        column(ctx, "hint", Align2::LEFT_BOTTOM, [MARGIN, -MARGIN], |ui| {
            sheet(ui, |ui| {
                ui.label(faint("h  help"));
            });
        });
    }
}

fn run(ui: &mut Ui, pane: &Pane, readings: &Readings) {
    let simulation = &pane.simulation;
    ui.label(title(scene(simulation)));
    ui.label(text(method(simulation)));
    egui::Grid::new("readings")
        .num_columns(2)
        .spacing([14.0, 3.0])
        .show(ui, |ui| {
            let mut row = |name: &str, value: RichText| {
                ui.label(faint(name));
                ui.label(value);
                ui.end_row();
            };
            row("time", text(time(simulation)));
            row("speed", text(speed(readings)));
            if let Some(slow) = slow_motion(readings) {
                row("slow", text(slow));
            }
            if let Some(steps) = steps(simulation) {
                row("steps", text(steps));
            }
            if let Some((words, colour)) = limit(pane) {
                row("limit", text(words).color(colour));
            }
            let (name, value) = energy(pane);
            row(name, text(value));
            if let Some(stretch) = pane.stretch {
                row("stretch", text(format!("{stretch:.3} at most")));
            }
            row("frames", text(frames(readings)));
            row("each", text(each(readings)));
        });
    ui.label(states(simulation, readings));
}

/// The springs of a particle, and how far they are stretched now.
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
            for s in springs.iter().take(LISTED) {
                let other = s.i + s.j - i;
                let length = (simulation.position(i) - simulation.position(other)).norm();
                ui.label(text(show::kind(s.kind)));
                ui.label(text(other.to_string()));
                ui.label(text(panes::digits(s.law.stiffness)));
                ui.label(text(panes::digits(s.law.rest_length)));
                ui.label(match s.law.rest_length {
                    0.0 => text("-"),
                    rest => text(format!("{:.3}", length / rest)),
                });
                ui.end_row();
            }
        });
    if springs.len() > LISTED {
        ui.label(faint(format!("and {} more", springs.len() - LISTED)));
    }
}

/// Its name, and its grid if it has one.
pub fn scene(simulation: &Simulation) -> String {
    let scene = simulation.scene();
    let grid = scene.grid.map_or(String::new(), |grid| {
        format!("  {} × {}", grid.rows(), grid.cols())
    });
    format!("{}{grid}", scene.name)
}

fn method(simulation: &Simulation) -> String {
    format!("{},  {}", simulation.method().title, simulation.control())
}

/// What an adaptive method does with its tolerance.
pub fn steps(simulation: &Simulation) -> Option<String> {
    let step = simulation.step_size()?;
    let rejections = simulation.work().rejections;
    simulation
        .control()
        .tolerance()
        .map(|_| format!("{} ms, {rejections} rejected", panes::digits(1e3 * step)))
}

/// The step as a share of the largest stable one: green while there is room, amber near it, red past it.
pub fn limit(pane: &Pane) -> Option<(String, Color32)> {
    let limit = pane.watch.limit()?;
    if limit.step.is_infinite() {
        return Some(("none: every step is stable".into(), SAFE));
    }
    let share = pane.simulation.step_size()? / limit.step;
    let colour = match share {
        past if past > 1.0 => ALARM,
        near if near > 0.8 => WARNING,
        _ => SAFE,
    };
    let largest = panes::digits(1e3 * limit.step);
    Some((
        format!("{largest} ms (step at {:.0} %)", 100.0 * share),
        colour,
    ))
}

/// With as many digits as tell one step from the next.
pub fn time(simulation: &Simulation) -> String {
    let step = simulation.control().step().unwrap_or(1e-3);
    let digits = (-step.log10()).ceil().clamp(2.0, 7.0) as usize;
    format!("{:.digits$} s", simulation.time())
}

/// What tells best whether the run holds: its energy, or the radius of the circle.
pub fn energy(pane: &Pane) -> (&'static str, String) {
    match pane.energy {
        Some(energy) => ("energy", format!("{energy:.3} J")),
        None => (
            "radius",
            format!("{:.6} m", pane.simulation.position(0).norm()),
        ),
    }
}

pub fn frames(readings: &Readings) -> String {
    format!("{:.0} per second", readings.rate)
}

pub fn each(readings: &Readings) -> String {
    let (simulating, drawing) = (readings.simulating, readings.drawing);
    format!("{simulating:.1} ms steps + {drawing:.1} ms drawing")
}

/// What is on.
pub fn states(simulation: &Simulation, readings: &Readings) -> RichText {
    let states = [
        (readings.paused, "paused"),
        (simulation.windy(), "wind"),
        (simulation.swinging(), "swing"),
        (
            simulation.grabbed().is_some() || simulation.grabbed_sphere().is_some(),
            "pulling",
        ),
    ];
    let on: Vec<_> = states
        .iter()
        .filter(|(on, _)| *on)
        .map(|(_, name)| *name)
        .collect();
    if on.is_empty() {
        faint("no wind, no swing")
    } else {
        text(on.join("   ")).strong()
    }
}

/// Simulated time in real time.
pub fn speed(readings: &Readings) -> String {
    match readings.factor {
        _ if readings.paused => "paused".into(),
        0.0 => "-".into(),
        slow if slow < 0.01 => format!("{slow:.1e} × real time"),
        factor => format!("{factor:.2} × real time"),
    }
}

/// What is asked for, if not real time.
pub fn slow_motion(readings: &Readings) -> Option<String> {
    let slowness = Some(readings.slowness).filter(|slowness| *slowness > 0)?;
    Some(format!("1/{} of real time", 1 << slowness))
}

/// What was lost, which limit was passed, and which step would have held.
pub fn blow_up(ui: &mut Ui, pane: &Pane, lost: &BlowUp) {
    ui.label(
        RichText::new(format!("It {lost}."))
            .color(ALARM)
            .size(14.5)
            .strong(),
    );
    let method = lost.method;
    let same = method == pane.simulation.method().title;
    let limit = pane.watch.limit().map(|limit| limit.step);
    let hold = limit.zip(pane.watch.would_hold());
    ui.label(text(match (lost.control, hold) {
        (Control::Tolerance(tolerance), _) if matches!(lost.cause, Cause::StepTooSmall { .. }) => {
            format!("{method} found no step to a tolerance of {tolerance:e}: a larger one may do.")
        }
        (Control::Tolerance(tolerance), _) => {
            format!("A tolerance of {tolerance:e} was too large for {method}.")
        }
        (Control::Step(step), Some((limit, would_hold))) if same => {
            let past = if step > limit {
                format!(": past its limit here of {} ms", panes::digits(1e3 * limit))
            } else {
                String::new()
            };
            format!("A step of {step} s was too long for {method}{past}. {would_hold} s would have held.")
        }
        (Control::Step(step), _) => format!("A step of {step} s was too long for {method}."),
    }));
}

/// Out of a blow-up.
fn way_out() -> String {
    "Press - for a shorter step, or a digit for another solver, then r.".into()
}

fn help(ui: &mut Ui, several: bool) {
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
        ui.vertical(|ui| {
            ui.horizontal_top(|ui| {
                rows(ui, "Keys", first);
                rows(ui, "More keys", second);
            });
            ui.add_space(10.0);
            rows(ui, "Mouse", &mouse);
        });
        ui.vertical(|ui| {
            let heading = if several {
                "Solvers, under the pointer"
            } else {
                "Solvers"
            };
            rows(ui, heading, &solvers);
        });
    });
}

#[cfg(test)]
pub mod tests {
    use super::*;
    use crate::session::Place;
    use crate::show::Show;

    /// All that is written, in a window of that size, and the rectangles of the sheets.
    pub fn read(panes: &[Pane], readings: &Readings, size: [f32; 2]) -> (String, Vec<egui::Rect>) {
        fn collect(shape: &egui::Shape, words: &mut String, sheets: &mut Vec<egui::Rect>) {
            match shape {
                egui::Shape::Text(text) => words.extend([text.galley.text(), "\n"]),
                egui::Shape::Rect(rect) if rect.fill == PAPER => sheets.push(rect.rect),
                egui::Shape::Vec(shapes) => shapes
                    .iter()
                    .for_each(|shape| collect(shape, words, sheets)),
                _ => {}
            }
        }
        let ctx = Context::default();
        let screen = egui::Rect::from_min_size(egui::Pos2::ZERO, size.into());
        let mut output = egui::FullOutput::default();
        // The first pass measures, the next ones draw.
        for pass in 0..3 {
            let input = egui::RawInput {
                screen_rect: Some(screen),
                time: Some(f64::from(pass)),
                ..Default::default()
            };
            output.textures_delta.set.clear();
            output.textures_delta.free.clear();
            output = ctx.run_ui(input, |ui| show(ui.ctx(), panes, readings));
        }
        let (mut words, mut sheets) = (String::new(), vec![]);
        for clipped in &output.shapes {
            let cut = clipped.clip_rect.intersect(screen).expand(1.0);
            if let egui::Shape::Text(text) = &clipped.shape {
                let rect = text.visual_bounding_rect();
                assert!(
                    cut.contains_rect(rect),
                    "{:?} is cut off in {size:?}",
                    text.galley.text()
                );
            }
            collect(&clipped.shape, &mut words, &mut sheets);
        }
        output.textures_delta.set.clear();
        output.textures_delta.free.clear();
        (words, sheets)
    }

    pub fn pane(scene: &str, method: &str, step: f64) -> Pane {
        let scene = a3_scenes::find(scene).unwrap().build(None).unwrap();
        let method = integrators::find(method).unwrap();
        let simulation = Simulation::new(scene, method, method.control(step)).unwrap();
        Pane::new(simulation, Show::new(false, None))
    }

    #[test]
    fn everything_is_said() {
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
            "h  help",
        ] {
            assert!(words.contains(said), "{said} in\n{words}");
        }
        let readings = Readings {
            paused: true,
            ..readings
        };
        assert!(
            read(&panes, &readings, [1280.0, 720.0])
                .0
                .contains("paused   wind")
        );
        let circle = [super::tests::pane("simple", "e", 1e-7)];
        let slow = Readings {
            factor: 0.0005,
            ..Readings::default()
        };
        let (words, _) = read(&circle, &slow, [1280.0, 720.0]);
        for said in [
            "1.000000 m",
            "0.0000000 s",
            "5.0e-4 × real time",
            "no wind, no swing",
        ] {
            assert!(words.contains(said), "{said} in\n{words}");
        }
    }

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
            sheets[0].height() < 460.0 && sheets[0].width() < 780.0,
            "{sheets:?}"
        );
    }

    #[test]
    fn slow_motion_and_the_place_in_time_are_said() {
        let place = Place {
            share: 0.25,
            back: 1.5,
            span: 2.0,
        };
        let readings = Readings {
            factor: 0.12,
            slowness: 3,
            place: Some(place),
            ..Readings::default()
        };
        for size in [[1280.0, 720.0], [500.0, 400.0], [260.0, 860.0]] {
            let (words, sheets) = read(&[pane("chain", "r", 0.01)], &readings, size);
            for said in [
                "0.12 × real time",
                "1/8 of real time",
                "1.50 s back",
                "2.0 s kept",
            ] {
                assert!(words.contains(said), "{said} in {words}");
            }
            assert!(!sheets[0].intersects(sheets[1]), "{sheets:?}");
        }
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

    #[test]
    fn the_limit_is_said_in_its_colour() {
        let said = |scene: &str, method: &str, value: f64| {
            let mut pane = pane(scene, method, value);
            pane.simulation.take_steps(1).unwrap();
            pane.read_state();
            let colour = limit(&pane).unwrap().1;
            let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
            (words.replace('\n', " "), colour)
        };
        for (step, colour) in [(0.01, SAFE), (0.032, WARNING), (0.04, ALARM)] {
            let (words, found) = said("mit", "r", step);
            // Within 1 % of 34.9 ms.
            let share = format!("35.2 ms (step at {:.0} %)", step / 0.0352 * 100.0);
            assert!(words.contains(&share), "{share} in {words}");
            assert_eq!(found, colour);
        }
        assert!(
            said("mit", "i", 0.1)
                .0
                .contains("none: every step is stable")
        );
        let (words, _) = said("cloth", "a", 1e-4);
        assert!(words.contains("tolerance 1e-4"), "{words}");
        assert!(
            words.contains("rejected") && words.contains("limit"),
            "{words}"
        );
    }

    #[test]
    fn a_blow_up_says_which_limit_was_passed() {
        let mut pane = pane("mit", "r", 0.05);
        while pane.simulation.take_steps(1).is_ok() {}
        pane.read_state();
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let words = words.replace('\n', " ");
        for said in [
            "A step of 0.05 s was too long for classical Runge-Kutta: past its limit here of 3",
            "0.03 s would have held",
        ] {
            assert!(words.contains(said), "{said} in {words}");
        }
    }

    #[test]
    fn a_blow_up_names_what_failed_and_nothing_overlaps() {
        let mut pane = pane("mit", "e", 0.05);
        let run = &mut pane.simulation;
        while run.take_steps(1).is_ok() {}
        run.set_method(integrators::find("r").unwrap(), Control::Step(0.01))
            .unwrap();
        let panes = [pane];
        let readings = Readings {
            message: Some("There is no wind here.".into()),
            ..Readings::default()
        };
        for size in [
            [1280.0, 720.0],
            [800.0, 600.0],
            [500.0, 400.0],
            [260.0, 860.0],
        ] {
            let (words, sheets) = read(&panes, &readings, size);
            let words = words.replace('\n', " ");
            assert!(
                words.contains("blew up at step") && words.contains("no wind here"),
                "{words}"
            );
            assert!(
                words.contains("A step of 0.05 s was too long for explicit Euler."),
                "{words}"
            );
            assert!(sheets.len() >= 3);
            for (k, a) in sheets.iter().enumerate() {
                assert!(a.right() <= size[0] + 1.0, "{a:?} in {size:?}");
                assert!(
                    sheets[..k].iter().all(|b| !a.shrink(1.0).intersects(*b)),
                    "{sheets:?} in {size:?}"
                );
            }
        }
    }
}
