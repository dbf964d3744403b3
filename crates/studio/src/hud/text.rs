//! The text over the picture: the readings of one pane or of several, and the help.

use a3_core::{Simulation, StepLength};
use a3_media::show;
use egui::{Align2, Area, Context, Frame, Grid, Id, Label, Margin, Rect, Ui, vec2};

use super::help::help;
use super::legend::legend;
use super::style::{ALARM, MARGIN, PAPER, SAFE, column, faint, sheet, text, title};
use super::words::{self, advice, digits, energy, explain, frames, scene, speed, states, time};
use super::{layout, marks};
use crate::session::{Pane, Readings};

/// Draws all text over the picture. Sheets are below one another, and the help hides them, so that
/// nothing overlaps even in a small window.
pub fn show_text(ctx: &Context, panes: &[Pane], readings: &Readings) {
    match panes {
        [pane] if !readings.help => single(ctx, pane, readings),
        [_] => {}
        panes => several(ctx, panes, readings),
    }
    if let Some(selection) = &readings.selection {
        marks::selection(ctx, selection);
    }
    if readings.help {
        help(ctx, panes.len() > 1, readings.touch);
    }
}

/// Width of the names of readings (points).
const NAME_WIDTH: f32 = 84.0;
/// Largest number of springs that are listed.
const MAX_LISTED_SPRINGS: usize = 12;

/// Draws the text over a single pane: its readings, and sheets for a blow-up, a film, a message and
/// springs.
fn single(ctx: &Context, pane: &Pane, readings: &Readings) {
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
    ui.label(text(time_or_pause(simulation, readings)));
    radius(ui, pane);
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
    ui.add(Label::new(title(name).size(14.0)).truncate());
    ui.label(text(time_or_pause(&pane.simulation, readings)));
    radius(ui, pane);
}

/// Writes the radius of the circle, which lessons ask for, where a run has no energy.
fn radius(ui: &mut Ui, pane: &Pane) {
    let (name, value) = words::energy(pane);
    if pane.energy.is_none() {
        ui.label(text(format!("{name} {value}")));
    }
}

/// Returns the time, and whether the run is paused.
fn time_or_pause(simulation: &Simulation, readings: &Readings) -> String {
    let paused = if readings.paused { "   paused" } else { "" };
    format!("{}{paused}", words::time(simulation))
}

/// Writes the readings of the run.
fn run(ui: &mut Ui, pane: &Pane, readings: &Readings) {
    let simulation = &pane.simulation;
    ui.label(title(words::scene(simulation)));
    ui.label(text(words::method(simulation)));
    Grid::new("readings")
        .num_columns(2)
        .spacing([14.0, 3.0])
        .max_col_width((ui.available_width() - NAME_WIDTH).max(60.0))
        .show(ui, |ui| {
            let (name, value) = words::energy(pane);
            let speed = words::speed(readings).filter(|_| !readings.paused);
            let stretch = pane.stretch.map(|it| format!("{it:.3} at most"));
            let [frames, each] = words::frames(readings).map_or([None, None], |it| it.map(Some));
            let rows = [
                ("time", Some(text(words::time(simulation)))),
                ("speed", speed.map(text)),
                ("slow", words::slow_motion(readings).map(text)),
                ("steps", words::steps(simulation).map(text)),
                ("limit", Some(words::limit_row(pane))),
                (name, Some(text(value))),
                ("gained", words::gained(simulation)),
                ("constraint", words::worst_constraint(simulation)),
                ("stretch", stretch.map(text)),
                ("contact", words::contact(simulation).map(text)),
                ("frames", frames.map(text)),
                ("each", each.map(text)),
            ];
            for (name, value) in rows.into_iter().filter_map(|(name, it)| Some((name, it?))) {
                ui.label(faint(name));
                ui.label(value);
                ui.end_row();
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
    Grid::new("springs").num_columns(5).spacing([12.0, 1.0]).show(ui, |ui| {
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
        ui.label(faint(format!("and {} more", springs.len() - MAX_LISTED_SPRINGS)));
    }
}

/// Distance of a sheet from the edge of its pane (points).
const PANE_MARGIN: f32 = 8.0;

/// Draws the text over several panes: a bar with their common readings, and a sheet in each pane
/// unless the help is shown.
fn several(ctx: &Context, panes: &[Pane], readings: &Readings) {
    let (window, tiles) = (ctx.content_rect(), layout::tiles_in(ctx, panes.len()));
    let above = window.with_max_y(tiles[0].1.top());
    within(ctx, "bar", above, |ui| bar(ui, panes, readings));
    if readings.help {
        return;
    }
    for (k, (pane, (_, rect))) in panes.iter().zip(tiles).enumerate() {
        within(ctx, &format!("pane {k}"), rect, |ui| {
            let size = layout::Text::of(panes.len(), rect.size().into());
            let low = size != layout::Text::Whole;
            // A narrow sheet hides little of the picture, but in a low pane the text needs a wide
            // one.
            let narrow = layout::caption_width(rect.width());
            ui.set_max_width(if low { rect.width() } else { narrow });
            Frame::new()
                .outer_margin(PANE_MARGIN)
                .show(ui, |ui| sheet(ui, |ui| caption(ui, pane, readings, size)));
        });
    }
}

/// Draws `contents` clipped to a rectangle, without taking clicks.
fn within(ctx: &Context, name: &str, rect: Rect, contents: impl FnOnce(&mut Ui)) {
    Area::new(Id::unique(name)).fixed_pos(rect.min).constrain(false).interactable(false).show(
        ctx,
        |ui| {
            ui.shrink_clip_rect(rect);
            ui.set_max_width(rect.width());
            contents(ui);
        },
    );
}

/// Draws the bar: scene and message, or the common readings of all panes.
fn bar(ui: &mut Ui, panes: &[Pane], readings: &Readings) {
    let run = &panes[0].simulation;
    let (rect, width) = (ui.clip_rect(), ui.max_rect().width());
    ui.painter().rect_filled(rect, 0.0, PAPER);
    // In a small window, the help is over the bar.
    if readings.help {
        return;
    }
    Frame::new().inner_margin(Margin::symmetric(12, 5)).show(ui, |ui| {
        ui.set_width(width - 24.0);
        ui.horizontal_wrapped(|ui| {
            ui.spacing_mut().item_spacing = vec2(14.0, 1.0);
            if let Some(film) = &readings.film {
                words::film(ui, film);
            }
            // Wrap between readings, not within them.
            let mut say = |words| ui.add(Label::new(words).extend());
            say(title(scene(run)).size(15.0));
            if let Some(message) = &readings.message {
                ui.label(text(message));
                return;
            }
            // The latest time: some runs may have diverged.
            let runs = panes.iter().map(|pane| &pane.simulation);
            let latest = runs.max_by(|a, b| a.time().total_cmp(&b.time()));
            say(text(time(latest.unwrap_or(run))));
            // In a wide bar, the states below include the pause.
            let stands = readings.paused && width > 600.0;
            if let Some(speed) = speed(readings).filter(|_| !stands) {
                say(text(speed));
            }
            if let Some(slow) = words::slow_motion(readings) {
                say(faint(format!("slow  {slow}")));
            }
            if let Some([frames, each]) = frames(readings).filter(|_| width > 900.0) {
                say(text(format!("{frames},  {each}")));
            }
            if width > 600.0 {
                states(run, readings).map(&mut say);
            }
            if let Some(without) = words::without(readings) {
                say(text(without));
            }
            if readings.in_window && !readings.touch {
                say(faint("h  help"));
            }
        });
    });
}

/// Writes the readings of a pane, a line for each. In a small pane, writes only the most important
/// ones, some of them side by side, or the method alone.
fn caption(ui: &mut Ui, pane: &Pane, readings: &Readings, size: layout::Text) {
    let run = &pane.simulation;
    if size == layout::Text::Name {
        let name = format!("{}  {}", run.method().name, run.control());
        let name = title(name).size(13.0);
        let name = match run.blow_up() {
            Some(_) => name.color(ALARM.colour),
            None => name,
        };
        ui.add(Label::new(name).truncate());
        return;
    }
    let low = size == layout::Text::Few;
    ui.label(title(run.method().title).size(14.0));
    if let Some(blow_up) = run.blow_up() {
        return explain(ui, pane, &blow_up);
    }
    let cost = pane.cost.map_or("-".into(), |cost| {
        format!(
            "{:.0} evaluations, {} ms per simulated s",
            cost.evaluations,
            digits(cost.computing)
        )
    });
    let step = match words::steps(run) {
        Some(steps) => ("steps", text(format!("{},  {steps}", run.control()))),
        None => ("step", text(StepLength(run.control().value()).to_string())),
    };
    let time = ("time", text(time(run)));
    let error = ("error", text(error(pane, readings)));
    let cost = ("cost", text(cost));
    let lines = if low {
        vec![vec![step, time], vec![error], vec![cost]]
    } else {
        let (name, value) = energy(pane);
        let rare = [
            ("gained", words::gained(run)),
            ("constraint", words::worst_constraint(run)),
            ("contact", words::contact(run).map(text)),
        ];
        let rare = rare.into_iter().filter_map(|(name, it)| Some((name, it?)));
        let limit = ("limit", words::limit_row(pane));
        let first = [step, limit, time, error, (name, text(value))];
        let all = first.into_iter().chain(rare).chain([cost]);
        all.map(|line| vec![line]).collect()
    };
    for line in lines {
        let mut job = egui::text::LayoutJob::default();
        for (k, (name, value)) in line.iter().enumerate() {
            let gap = if k > 0 { "    " } else { "" };
            for words in [faint(format!("{gap}{name}  ")), value.clone()] {
                words.append_to(
                    &mut job,
                    ui.style(),
                    egui::FontSelection::Default,
                    egui::Align::BOTTOM,
                );
            }
        }
        ui.label(job);
    }
    if !low {
        legend(ui, &pane.show);
    }
}

/// Returns the distance from the reference, or the reason why it is unknown.
fn error(pane: &Pane, readings: &Readings) -> String {
    let time = pane.simulation.time();
    let past = readings.predictable.filter(|until| time > *until);
    match (pane.error, readings.no_error) {
        (Some(error), _) => {
            let past = past.map(|until| format!("  (past {} s it says little)", digits(until)));
            format!("{} m{}", digits(error), past.unwrap_or_default())
        }
        (None, Some(why)) => format!("-  ({why})"),
        (None, None) => "-".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hud::{pane, read};
    use crate::session::{Cost, Rates};

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
            rates: Rates { factor: 0.98, rate: 59.6, simulating: 0.2, drawing: 3.4 },
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
        let readings = Readings { paused: true, ..readings };
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
        let slow =
            Readings { rates: Rates { factor: 0.0005, ..Rates::default() }, ..Readings::default() };
        let (words, _) = read(&circle, &slow, [1280.0, 720.0]);
        for said in ["1.000000 m", "0.0000000 s", "5.0e-4 × real time"] {
            assert!(words.contains(said), "{said} in\n{words}");
        }
        // There is no wind on a circle to be off.
        assert!(!words.contains("wind") && !words.contains("swing"), "{words}");
        let (words, _) = read(&[crate::hud::pane("cloth", "t", 0.01)], &slow, [1280.0, 720.0]);
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

    const SIZES: [[f32; 2]; 7] = [
        [1280.0, 720.0],
        [800.0, 600.0],
        [640.0, 480.0],
        [500.0, 400.0],
        [400.0, 500.0],
        [260.0, 860.0],
        [720.0, 1280.0],
    ];

    fn panes(count: usize) -> Vec<Pane> {
        let methods = [("t", 0.0025), ("e", 0.0002), ("s", 0.00125), ("v", 0.005)];
        let mut panes: Vec<_> = methods[..count]
            .iter()
            .map(|(method, step)| pane("mit-sphere", method, *step))
            .collect();
        for pane in &mut panes {
            pane.simulation.take_steps(10).unwrap();
            (pane.energy, pane.error) = (Some(-12345.6789), Some(0.000_123_4));
            pane.cost = Some(Cost { evaluations: 10000.0, computing: 123.4 });
        }
        panes
    }

    fn check(panes: &[Pane], readings: &Readings) -> Vec<String> {
        SIZES
            .map(|size| {
                let (words, sheets) = read(panes, readings, size);
                let tiles = layout::tiles(panes.len(), (size[0] as u32, size[1] as u32), 1.0);
                assert_eq!(sheets.len(), 1 + panes.len(), "a bar and a sheet each");
                for (k, a) in sheets.iter().enumerate() {
                    assert!(a.right() <= size[0] && a.bottom() <= size[1], "{a:?} in {size:?}");
                    assert!(
                        sheets[..k].iter().all(|b| !a.intersects(*b)),
                        "{sheets:?} in {size:?}"
                    );
                }
                for (tile, sheet) in tiles.iter().zip(&sheets[1..]) {
                    let end = ((tile.x + tile.width) as f32, (tile.y + tile.height) as f32);
                    assert!(
                        sheet.left() >= tile.x as f32
                            && sheet.top() >= tile.y as f32
                            && sheet.right() <= end.0
                            && sheet.bottom() <= end.1,
                        "{sheet:?} in {tile:?} of {size:?}"
                    );
                }
                words
            })
            .to_vec()
    }

    #[test]
    fn every_pane_shows_its_own_readings_and_nothing_overlaps() {
        let readings = Readings {
            rates: Rates { rate: 59.6, factor: 0.98, ..Rates::default() },
            in_window: true,
            ..Readings::default()
        };
        let (words, _) = read(&panes(4), &readings, SIZES[0]);
        assert!(words.contains("energy  -12345.679 J"), "{words}");
        for count in 2..=4 {
            for words in check(&panes(count), &readings) {
                let words = words.replace('\n', " ");
                for said in [
                    "mit-sphere  15 × 15",
                    "0.98 × real time",
                    "h  help",
                    "explicit trapezoid (Heun)",
                    "step  0.0025 s",
                    "h  help",
                    "explicit Euler",
                    "step  0.2 ms",
                    "time  0.025 s",
                    "time  0.0020 s",
                    "error  1.23e-4 m",
                    "cost  10000 evaluations, 123 ms per simulated s",
                ] {
                    assert!(words.contains(said), "{said} in {words}");
                }
            }
        }
    }

    #[test]
    fn an_error_past_the_horizon_has_a_warning() {
        let mut panes = panes(2);
        let until = panes[0].simulation.time();
        let later = &mut panes[1].simulation;
        later.advance_to(until + 0.1).unwrap();
        let readings = Readings { predictable: Some(until), ..Readings::default() };
        for words in check(&panes, &readings) {
            assert_eq!(words.matches("it says little").count(), 1, "{words}");
        }
    }

    #[test]
    fn a_pane_that_blew_up_says_so_and_the_others_are_unchanged() {
        let mut panes = panes(4);
        panes[1].simulation.set_control(a3_core::Control::Step(0.05)).unwrap();
        while panes[1].simulation.take_steps(1).is_ok() {}
        let readings = Readings {
            message: Some("There is nothing to swing here.".into()),
            no_error: Some("the reference is too slow"),
            ..Readings::default()
        };
        panes[0].error = None;
        for words in check(&panes, &readings) {
            let words = words.replace('\n', " ");
            for said in [
                "It blew up at step",
                "A step of 0.05 s was too long for explicit Euler",
                "nothing to swing",
                "error  -  (the reference is too slow)",
            ] {
                assert!(words.contains(said), "{said} in {words}");
            }
            assert_eq!(words.matches("cost").count(), 3);
        }
    }
}
