//! Plots of the last seconds of a run.

use a3_plot::Axis;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2};

use super::super::text::{FAINT, TEXT};
use crate::session::{History, SPAN, Sample};

/// The least height of a plot (points).
const LEAST: f32 = 56.0;
/// The largest.
const MOST: f32 = 110.0;
/// Of the line with its name, and of the numbers below the last.
const HEAD: f32 = 17.0;
const FOOT: f32 = 15.0;
/// Left of it, for numbers.
const NUMBERS: f32 = 40.0;
const SMALL: f32 = 10.5;

const TEAL: Color32 = Color32::from_rgb(0, 122, 128);
const AMBER: Color32 = Color32::from_rgb(190, 106, 0);
const VIOLET: Color32 = Color32::from_rgb(112, 62, 158);
const GRID: Color32 = Color32::from_rgb(196, 197, 200);

/// A line of a plot.
struct Line {
    name: &'static str,
    colour: Color32,
    of: fn(&Sample) -> Option<f64>,
}

/// Its title has the unit.
struct Plot {
    title: &'static str,
    lines: &'static [Line],
}

const fn line(name: &'static str, colour: Color32, of: fn(&Sample) -> Option<f64>) -> Line {
    Line { name, colour, of }
}

static PLOTS: &[Plot] = &[
    Plot {
        title: "energy (J)",
        lines: &[
            line("kinetic", TEAL, |s| Some(s.energy?.kinetic)),
            line("elastic", AMBER, |s| Some(s.energy?.elastic)),
            line("gravity", VIOLET, |s| Some(s.energy?.gravitational)),
            line("total", TEXT, |s| Some(s.energy?.total())),
        ],
    },
    Plot {
        title: "largest stretch",
        lines: &[line("", AMBER, |s| s.stretch)],
    },
    Plot {
        title: "computing (ms per simulated s)",
        lines: &[line("", TEAL, |s| Some(s.cost?[1]))],
    },
    Plot {
        title: "evaluations per simulated s",
        lines: &[line("", VIOLET, |s| Some(s.cost?[0]))],
    },
];

/// Draws as many plots as there is room for, those that have something to show.
pub fn draw(painter: &Painter, room: Rect, history: &History) {
    let Some(last) = history.samples().last() else {
        return;
    };
    let to = last.time.max(SPAN);
    let time = [to - SPAN, to];
    let shown = PLOTS.iter().filter(|plot| {
        let of = |s: &Sample| (plot.lines[0].of)(s);
        history.samples().filter_map(of).count() > 1
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
        plot.draw(painter, rect, history, time, k + 1 == count);
    }
}

impl Plot {
    fn draw(&self, painter: &Painter, rect: Rect, history: &History, time: [f64; 2], last: bool) {
        let words = |at: Pos2, anchor, words: &str, size, colour| {
            painter.text(at, anchor, words, FontId::proportional(size), colour)
        };
        words(rect.left_top(), Align2::LEFT_TOP, self.title, 11.5, FAINT);
        let mut right = rect.right();
        for line in self.lines.iter().rev().filter(|line| !line.name.is_empty()) {
            let at = pos2(right, rect.top());
            right = words(at, Align2::RIGHT_TOP, line.name, 11.5, line.colour).left() - 7.0;
        }
        let area = Rect::from_min_max(
            rect.left_top() + egui::vec2(NUMBERS, HEAD),
            rect.right_bottom() - egui::vec2(2.0, 5.0),
        );
        let values = || {
            let each = self.lines.iter();
            each.flat_map(|line| history.samples().filter_map(line.of))
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
        for line in self.lines {
            let points = history.samples().filter_map(|sample| {
                let value = (line.of)(sample)?;
                Some(pos2(x.at(sample.time) as f32, y.at(value) as f32))
            });
            let stroke = Stroke::new(1.4, line.colour);
            painter.add(Shape::line(points.collect(), stroke));
        }
    }
}

/// Around all of them, with some room.
fn ends(values: impl Iterator<Item = f64>) -> [f64; 2] {
    let finite = values.filter(|v| v.is_finite());
    let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
        [low.min(v), high.max(v)]
    });
    if low > high {
        return [0.0, 1.0];
    }
    // What hardly changes is a level line, not a magnified rounding error.
    let gap = (0.08 * (high - low))
        .max(0.02 * high.abs().max(low.abs()))
        .max(1e-9);
    [low - gap, high + gap]
}

/// A number that fits beside a plot.
fn label(value: f64, label: String) -> String {
    if label.chars().count() > 6 {
        format!("{value:.1e}")
    } else {
        label
    }
}
