//! Plots of the last seconds of a run.

use a3_plot::Axis;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2};

use super::super::style::{FAINT, TEXT};
use crate::session::{SPAN, Sample, Samples};

/// Least height of a plot (points).
const LEAST: f32 = 56.0;
/// Largest height of a plot (points).
const MOST: f32 = 110.0;
/// Height of the line with the title (points).
const HEAD: f32 = 17.0;
/// Height of the numbers below the last plot (points).
const FOOT: f32 = 15.0;
/// Width of the numbers on the left (points).
const NUMBERS: f32 = 40.0;
/// Size of the numbers (points).
const SMALL: f32 = 10.5;

const TEAL: Color32 = Color32::from_rgb(0, 122, 128);
const AMBER: Color32 = Color32::from_rgb(190, 106, 0);
const VIOLET: Color32 = Color32::from_rgb(112, 62, 158);
const GRID: Color32 = Color32::from_rgb(196, 197, 200);

/// A curve of a plot.
struct Curve {
    name: &'static str,
    colour: Color32,
    of: fn(&Sample) -> Option<f64>,
}

/// A plot, whose title has the unit.
struct Plot {
    title: &'static str,
    curves: &'static [Curve],
}

const fn curve(name: &'static str, colour: Color32, of: fn(&Sample) -> Option<f64>) -> Curve {
    Curve { name, colour, of }
}

static PLOTS: &[Plot] = &[
    Plot {
        title: "energy (J)",
        curves: &[
            curve("kinetic", TEAL, |s| Some(s.energy?.kinetic)),
            curve("elastic", AMBER, |s| Some(s.energy?.elastic)),
            curve("gravity", VIOLET, |s| Some(s.energy?.gravitational)),
            curve("total", TEXT, |s| Some(s.energy?.total())),
        ],
    },
    Plot {
        title: "largest stretch",
        curves: &[curve("", AMBER, |s| s.stretch)],
    },
    Plot {
        title: "computing (ms per simulated s)",
        curves: &[curve("", TEAL, |s| Some(s.cost?[1]))],
    },
    Plot {
        title: "evaluations per simulated s",
        curves: &[curve("", VIOLET, |s| Some(s.cost?[0]))],
    },
];

/// Draws the plots that have something to show, as many as there is room for.
pub fn draw(painter: &Painter, room: Rect, samples: &Samples) {
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
    let high = room.height() - FOOT;
    let count = shown.len().min((high / LEAST).max(0.0) as usize);
    if count == 0 {
        return;
    }
    let height = (high / count as f32).min(MOST);
    for (k, plot) in shown[..count].iter().enumerate() {
        let top = room.top() + k as f32 * height;
        let rect = Rect::from_min_max(pos2(room.left(), top), pos2(room.right(), top + height));
        plot.draw(painter, rect, samples, time, k + 1 == count);
    }
}

impl Plot {
    fn draw(&self, painter: &Painter, rect: Rect, samples: &Samples, time: [f64; 2], last: bool) {
        let words = |at: Pos2, anchor, words: &str, size, colour| {
            painter.text(at, anchor, words, FontId::proportional(size), colour)
        };
        words(rect.left_top(), Align2::LEFT_TOP, self.title, 11.5, FAINT);
        let mut right = rect.right();
        for curve in self
            .curves
            .iter()
            .rev()
            .filter(|curve| !curve.name.is_empty())
        {
            let at = pos2(right, rect.top());
            right = words(at, Align2::RIGHT_TOP, curve.name, 11.5, curve.colour).left() - 7.0;
        }
        let area = Rect::from_min_max(
            rect.left_top() + egui::vec2(NUMBERS, HEAD),
            rect.right_bottom() - egui::vec2(2.0, 5.0),
        );
        let values = || {
            let each = self.curves.iter();
            each.flat_map(|curve| samples.iter().filter_map(curve.of))
        };
        let [low, high] = ends(values());
        let x = Axis::linear(time).between(area.left().into(), area.right().into());
        let y = Axis::linear([low, high]).between(area.bottom().into(), area.top().into());
        let rule = Stroke::new(0.7, GRID);
        for tick in y.ticks(18.0) {
            let at = y.at(tick.value) as f32;
            painter.hline(area.x_range(), at, rule);
            let place = pos2(area.left() - 5.0, at);
            let label = label(tick.value, tick.label);
            words(place, Align2::RIGHT_CENTER, &label, SMALL, FAINT);
        }
        for tick in x.ticks(44.0) {
            let at = x.at(tick.value) as f32;
            painter.vline(at, area.y_range(), rule);
            if last {
                let unit = if at > area.right() - 30.0 { " s" } else { "" };
                let (place, anchor) = if unit.is_empty() {
                    (pos2(at, area.bottom() + 2.0), Align2::CENTER_TOP)
                } else {
                    (
                        pos2(area.right() + 2.0, area.bottom() + 2.0),
                        Align2::RIGHT_TOP,
                    )
                };
                let label = format!("{}{unit}", tick.label);
                words(place, anchor, &label, SMALL, FAINT);
            }
        }
        for curve in self.curves {
            let points = samples.iter().filter_map(|sample| {
                let value = (curve.of)(sample)?;
                Some(pos2(x.at(sample.time) as f32, y.at(value) as f32))
            });
            let stroke = Stroke::new(1.4, curve.colour);
            painter.add(Shape::line(points.collect(), stroke));
        }
    }
}

/// The ends of an axis around all values, with some room.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    });
    if low > high {
        return [0.0, 1.0];
    }
    // A value that hardly changes is shown as a level line, not as a magnified rounding error.
    let gap = (0.08 * (high - low))
        .max(0.02 * high.abs().max(low.abs()))
        .max(1e-9);
    [low - gap, high + gap]
}

/// The label of a tick, short enough to stand beside a plot.
fn label(value: f64, label: String) -> String {
    if label.chars().count() > 6 {
        format!("{value:.1e}")
    } else {
        label
    }
}
