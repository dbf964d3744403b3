//! Plots of the last seconds of a run.

use a3_plot::Axis;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Stroke, pos2};

use super::super::axes::{Grid, line};
use super::super::style::{FAINT, TEXT};
use super::super::words::signed;
use crate::session::{Pane, SPAN, Sample, Samples};

/// Smallest height of a plot (points).
const MIN_HEIGHT: f32 = 56.0;
/// Largest height of a plot over its width.
const MAX_HEIGHT_PER_WIDTH: f32 = 0.6;
/// Height of the title line (points).
const TITLE_HEIGHT: f32 = 17.0;
/// Height of the numbers below the last plot (points).
const TICK_LABEL_HEIGHT: f32 = 15.0;
/// Width of the numbers on the left (points).
const TICK_LABEL_WIDTH: f32 = 40.0;
/// Length of the sample of a curve before its name (points).
const LEGEND_LINE_LENGTH: f32 = 14.0;

const TEAL: Color32 = Color32::from_rgb(0, 122, 128);
const AMBER: Color32 = Color32::from_rgb(190, 106, 0);
const VIOLET: Color32 = Color32::from_rgb(112, 62, 158);
/// The grid of the plots.
const GRID: Grid = Grid {
    colour: Color32::from_rgb(196, 197, 200),
    width: 0.7,
    gaps: [44.0, 18.0],
    size: 10.5,
};

/// A curve of a plot.
#[derive(Clone, Copy)]
struct Curve {
    name: &'static str,
    /// Name of the column in a file, with the unit.
    column: &'static str,
    colour: Color32,
    /// Lengths of dashes and gaps in turn (points); empty for a solid line.
    dashes: &'static [f32],
    /// Returns the value of a sample.
    of: fn(&Sample) -> Option<f64>,
}

/// A plot, whose title includes the unit.
struct Plot {
    title: &'static str,
    curves: &'static [Curve],
}

const fn curve(
    name: &'static str,
    column: &'static str,
    colour: Color32,
    of: fn(&Sample) -> Option<f64>,
) -> Curve {
    Curve {
        name,
        column,
        colour,
        dashes: &[],
        of,
    }
}

/// Makes a curve dashed, so that the curves of a plot differ not only in colour.
const fn dashed(dashes: &'static [f32], curve: Curve) -> Curve {
    Curve { dashes, ..curve }
}

static PLOTS: &[Plot] = &[
    Plot {
        title: "energy (J)",
        curves: &[
            dashed(
                &[7.0, 3.0],
                curve("kinetic", "kinetic energy (J)", TEAL, |s| {
                    Some(s.energy?.kinetic)
                }),
            ),
            dashed(
                &[1.6, 2.4],
                curve("elastic", "elastic energy (J)", AMBER, |s| {
                    Some(s.energy?.elastic)
                }),
            ),
            dashed(
                &[7.0, 2.4, 1.6, 2.4],
                curve("gravity", "gravitational energy (J)", VIOLET, |s| {
                    Some(s.energy?.gravitational)
                }),
            ),
            curve("total", "total energy (J)", TEXT, |s| {
                Some(s.energy?.total())
            }),
        ],
    },
    Plot {
        title: "largest stretch",
        curves: &[curve("", "largest stretch", AMBER, |s| s.stretch)],
    },
    Plot {
        title: "computing (ms per simulated s)",
        curves: &[curve("", "computing (ms per simulated s)", TEAL, |s| {
            Some(s.cost?[1])
        })],
    },
    Plot {
        title: "evaluations per simulated s",
        curves: &[curve("", "evaluations per simulated s", VIOLET, |s| {
            Some(s.cost?[0])
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
    let to = last.time.max(SPAN);
    let time = [to - SPAN, to];
    let shown = PLOTS.iter().filter(|plot| {
        let of = |s: &Sample| (plot.curves[0].of)(s);
        samples.iter().filter_map(of).count() > 1
    });
    let shown: Vec<_> = shown.collect();
    let high = room.height() - TICK_LABEL_HEIGHT;
    let count = shown.len().min((high / MIN_HEIGHT).max(0.0) as usize);
    if count == 0 {
        return;
    }
    let plots = Rect::from_x_y_ranges(
        room.left() + TICK_LABEL_WIDTH..=room.right() - 2.0,
        room.y_range(),
    );
    let pointed = pointer
        .filter(|pointer| plots.contains(*pointer))
        .and_then(|pointer| {
            let share = (pointer.x - plots.left()) / plots.width();
            samples.nearest(time[0] + f64::from(share) * SPAN)
        });
    let height = (high / count as f32).min(MAX_HEIGHT_PER_WIDTH * room.width());
    for (k, plot) in shown[..count].iter().enumerate() {
        let top = room.top() + k as f32 * height;
        let rect = Rect::from_min_max(pos2(room.left(), top), pos2(room.right(), top + height));
        plot.draw(painter, rect, samples, time, k + 1 == count, pointed);
    }
}

impl Plot {
    fn draw(
        &self,
        painter: &Painter,
        rect: Rect,
        samples: &Samples,
        time: [f64; 2],
        last: bool,
        pointed: Option<&Sample>,
    ) {
        let words = |at: Pos2, anchor, words: &str, size, colour| {
            painter.text(at, anchor, words, FontId::proportional(size), colour)
        };
        // Values at the pointer replace the names of the curves.
        let title = match pointed {
            Some(sample) => format!("at {:.2} s", sample.time),
            None => self.title.into(),
        };
        words(rect.left_top(), Align2::LEFT_TOP, &title, 11.5, FAINT);
        let mut right = rect.right();
        for curve in self.curves.iter().rev() {
            let value = pointed.and_then(curve.of).map(signed);
            let Some(said) = value.or((!curve.name.is_empty()).then(|| curve.name.into())) else {
                continue;
            };
            let at = pos2(right, rect.top());
            right = words(at, Align2::RIGHT_TOP, &said, 11.5, curve.colour).left() - 7.0;
            if !curve.name.is_empty() {
                let ends = [right + 4.0 - LEGEND_LINE_LENGTH, right + 4.0];
                curve.draw(painter, ends.map(|x| pos2(x, rect.top() + 7.5)).into());
                right = ends[0] - 5.0;
            }
        }
        let area = Rect::from_min_max(
            rect.left_top() + egui::vec2(TICK_LABEL_WIDTH, TITLE_HEIGHT),
            rect.right_bottom() - egui::vec2(2.0, 5.0),
        );
        let values = || {
            let each = self.curves.iter();
            each.flat_map(|curve| samples.iter().filter_map(curve.of))
        };
        let x = Axis::linear(time).between(area.left().into(), area.right().into());
        let y = Axis::around(values()).between(area.bottom().into(), area.top().into());
        GRID.draw(painter, area, [x, y], last.then_some(" s"));
        if let Some(sample) = pointed {
            let at = x.at(sample.time) as f32;
            painter.vline(at, area.y_range(), Stroke::new(1.0, FAINT));
            for curve in self.curves {
                if let Some(value) = (curve.of)(sample) {
                    painter.circle_filled(pos2(at, y.at(value) as f32), 2.6, curve.colour);
                }
            }
        }
        for curve in self.curves {
            let points = samples.iter().filter_map(|sample| {
                let value = (curve.of)(sample)?;
                Some(pos2(x.at(sample.time) as f32, y.at(value) as f32))
            });
            curve.draw(painter, points.collect());
        }
    }
}

impl Curve {
    fn draw(&self, painter: &Painter, points: Vec<Pos2>) {
        line(painter, points, Stroke::new(1.4, self.colour), self.dashes);
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
        assert!(
            heading.starts_with("solver,time (s),kinetic energy (J),"),
            "{heading}"
        );
        let rows: Vec<Vec<_>> = lines.map(|line| line.split(',').collect()).collect();
        let samples: Vec<_> = session
            .runs
            .panes
            .iter()
            .map(|pane| pane.samples.iter().count())
            .collect();
        assert_eq!(rows.len(), samples.iter().sum::<usize>());
        assert!(
            rows.iter()
                .all(|row| row.len() == heading.split(',').count())
        );
        let last = session.runs.panes[1].samples.iter().last().unwrap();
        let row = rows.last().unwrap();
        assert_eq!((row[0], row[1]), ("rk4", &*last.time.to_string()));
        assert_eq!(row[5].parse(), Ok(last.energy.unwrap().total()));
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
