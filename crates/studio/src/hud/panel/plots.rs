//! Plots of the last seconds of a run.

use a3_plot::{CurveStyle, Line, LineChart, LinePanel, Marker};
use egui::{Painter, Pos2, Rect, Stroke};

use super::super::charts::{Sheet, colour};
use super::super::style::FAINT;
use super::super::words::signed;
use crate::session::{Pane, SPAN, Sample, Samples};

/// Largest height of a plot over its width.
const MAX_HEIGHT_PER_WIDTH: f32 = 0.6;
/// Size of text (points).
const SIZE: f64 = 11.0;

const TEAL: &str = "#007a80";
const AMBER: &str = "#be6a00";
const VIOLET: &str = "#703e9e";

/// A curve of a plot.
struct Curve {
    name: &'static str,
    /// Name of the column in a file, with the unit.
    column: &'static str,
    style: CurveStyle,
    /// Returns the value of a sample.
    of: fn(&Sample) -> Option<f64>,
}

/// A plot, whose title includes the unit.
struct Plot {
    title: &'static str,
    curves: &'static [Curve],
}

/// Creates a curve. Those of a plot differ not only in colour, but also in dashes.
const fn curve(
    name: &'static str,
    column: &'static str,
    (colour, dash): (&'static str, &'static [f64]),
    of: fn(&Sample) -> Option<f64>,
) -> Curve {
    let marker = Marker::Cross(0.0);
    Curve { name, column, style: CurveStyle { colour, dash, marker }, of }
}

static PLOTS: &[Plot] = &[
    Plot {
        title: "energy (J)",
        curves: &[
            curve("kinetic", "kinetic energy (J)", (TEAL, &[5.0, 2.1]), |s| {
                Some(s.values.energy?.kinetic)
            }),
            curve("elastic", "elastic energy (J)", (AMBER, &[1.1, 1.7]), |s| {
                Some(s.values.energy?.elastic)
            }),
            curve("gravity", "gravitational energy (J)", (VIOLET, &[5.0, 1.7, 1.1, 1.7]), |s| {
                Some(s.values.energy?.gravitational)
            }),
            curve("total", "total energy (J)", ("#181c28", &[]), |s| {
                Some(s.values.energy?.total())
            }),
        ],
    },
    Plot {
        title: "largest stretch",
        curves: &[curve("", "largest stretch", (AMBER, &[]), |s| s.values.stretch)],
    },
    Plot {
        title: "computing (ms per simulated s)",
        curves: &[curve("", "computing (ms per simulated s)", (TEAL, &[]), |s| {
            Some(s.values.cost?[1])
        })],
    },
    Plot {
        title: "evaluations per simulated s",
        curves: &[curve("", "evaluations per simulated s", (VIOLET, &[]), |s| {
            Some(s.values.cost?[0])
        })],
    },
];

/// Returns the samples of all panes as CSV, a row per sample. Fails if the CSV cannot be encoded.
pub fn csv(panes: &[Pane]) -> Result<Vec<u8>, csv::Error> {
    let curves = || PLOTS.iter().flat_map(|plot| plot.curves);
    let mut writer = csv::Writer::from_writer(vec![]);
    let names = curves().map(|curve| curve.column);
    writer.write_record(["solver", "time (s)"].into_iter().chain(names))?;
    for pane in panes {
        for sample in pane.samples.iter() {
            let values = curves().map(|curve| (curve.of)(sample));
            let values = values.map(|value| value.map_or(String::new(), |v| v.to_string()));
            let solver = pane.simulation.method().name.to_owned();
            let first = [solver, sample.time.to_string()];
            writer.write_record(first.into_iter().chain(values))?;
        }
    }
    writer.into_inner().map_err(|e| e.into_error().into())
}

/// Draws the plots that have at least two values, as many as fit. At the pointer, they show the
/// time and the values.
pub fn draw(painter: &Painter, room: Rect, samples: &Samples, pointer: Option<Pos2>) {
    let Some(last) = samples.iter().last() else {
        return;
    };
    let from = last.time.max(SPAN) - SPAN;
    let shown = PLOTS.iter().filter(|plot| {
        let of = |s: &Sample| (plot.curves[0].of)(s);
        samples.iter().filter_map(of).count() > 1
    });
    // Values at the pointer replace the titles and the names of the curves.
    let draw = |pointed: Option<&Sample>| {
        let panels = shown.clone().map(|it| it.panel(samples, from, pointed));
        let panels: Vec<_> = panels.collect();
        let highest = MAX_HEIGHT_PER_WIDTH * room.width() * panels.len() as f32;
        let sheet = [room.width(), room.height().min(highest)].map(f64::from);
        let chart = LineChart { panels, ..LineChart::default() };
        chart.draw_compact(sheet, SIZE, true)
    };
    let mut figure = draw(None);
    let under = pointer.and_then(|pointer| Sheet::new(painter, room, &figure).under(pointer));
    let pointed = under.and_then(|(_, share)| samples.nearest(from + share * SPAN));
    if pointed.is_some() {
        figure = draw(pointed);
    }
    let sheet = Sheet::new(painter, room, &figure);
    sheet.draw(None);
    let Some(sample) = pointed else {
        return;
    };
    sheet.mark(sample.time, Stroke::new(1.0, FAINT));
    for (k, plot) in shown.enumerate().take(figure.panels.len()) {
        for curve in plot.curves {
            if let Some(value) = (curve.of)(sample) {
                let at = sheet.at(k, [sample.time, value]);
                painter.circle_filled(at, 2.6, colour(curve.style.colour));
            }
        }
    }
}

impl Plot {
    fn panel(&self, samples: &Samples, from: f64, pointed: Option<&Sample>) -> LinePanel {
        let line = |curve: &Curve| {
            let value = pointed.and_then(curve.of).map(signed);
            let points = samples.iter();
            let points = points.filter_map(|sample| Some([sample.time, (curve.of)(sample)?]));
            Line {
                name: value.unwrap_or_else(|| curve.name.into()),
                style: curve.style,
                pieces: vec![points.collect()],
                dots: false,
            }
        };
        LinePanel {
            x_label: "s".into(),
            y_label: pointed.map_or(self.title.into(), |it| format!("at {:.2} s", it.time)),
            ends: Some([from, from + SPAN]),
            lines: self.curves.iter().map(line).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::session::{compared, session};

    #[test]
    fn a_file_has_the_samples_of_all_panes() {
        let mut session = compared(&["e:0.01", "r:0.01", "--scene", "chain"], 0.0);
        for k in 1..=5 {
            session.run_to(0.1 * f64::from(k));
        }
        let text = String::from_utf8(super::csv(&session.runs.panes).unwrap()).unwrap();
        let mut lines = text.lines();
        let heading = lines.next().unwrap();
        assert!(heading.starts_with("solver,time (s),kinetic energy (J),"), "{heading}");
        let rows: Vec<Vec<_>> = lines.map(|line| line.split(',').collect()).collect();
        let samples: Vec<_> =
            session.runs.panes.iter().map(|pane| pane.samples.iter().count()).collect();
        assert_eq!(rows.len(), samples.iter().sum::<usize>());
        assert!(rows.iter().all(|row| row.len() == heading.split(',').count()));
        let last = session.runs.panes[1].samples.iter().last().unwrap();
        let row = rows.last().unwrap();
        assert_eq!((row[0], row[1]), ("rk4", &*last.time.to_string()));
        assert_eq!(row[5].parse(), Ok(last.values.energy.unwrap().total()));
    }

    #[test]
    fn the_sample_nearest_to_the_pointer_is_found() {
        let mut session = session(&["r", "0.01", "--scene", "chain"]);
        for k in 1..=20 {
            session.run_to(0.1 * f64::from(k));
        }
        let samples = &session.runs.panes[0].samples;
        assert!((samples.nearest(1.04).unwrap().time - 1.0).abs() < 1e-9);
        assert!((samples.nearest(2.2).unwrap().time - 2.0).abs() < 1e-9);
        assert!(samples.nearest(7.0).is_none());
    }
}
