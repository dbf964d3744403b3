//! Axes: the map from numbers to the sheet, and ticks.

/// One direction of a chart, linear or logarithmic: a map from numbers to the sheet.
#[derive(Clone, Copy, Debug)]
pub struct Axis {
    pub(crate) log: bool,
    /// Whether numbers of more than six characters are written with exponents.
    pub(crate) short: bool,
    /// The least and the greatest number, or their decimal logarithms.
    ends: [f64; 2],
    /// The ends on the sheet.
    places: [f64; 2],
}

/// A line of the grid.
#[derive(Debug, PartialEq)]
pub struct Tick {
    /// The number of the tick.
    pub value: f64,
    /// The label of the number, such as `10^{−3}`; empty for a minor tick.
    pub label: String,
}

impl Axis {
    /// Creates a linear axis between two numbers.
    pub(crate) fn linear(ends: [f64; 2]) -> Self {
        Self { log: false, short: false, ends, places: [0.0, 1.0] }
    }

    /// Creates a linear axis around all finite values, with a margin. A nearly constant value is in
    /// its middle, and its rounding errors are not magnified.
    pub(crate) fn around(values: impl Iterator<Item = f64>) -> Self {
        let finite = values.filter(|value| value.is_finite());
        let [low, high] = finite.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], value| {
            [low.min(value), high.max(value)]
        });
        if low > high {
            return Self::linear([0.0, 1.0]);
        }
        let gap = (0.08 * (high - low)).max(0.02 * high.abs().max(low.abs())).max(1e-9);
        Self::linear([low - gap, high + gap])
    }

    /// Creates a logarithmic axis around two positive numbers, which ends at 1, 2 or 5 times powers
    /// of ten.
    pub(crate) fn log(low: f64, high: f64) -> Self {
        let marks = [0.0, 2_f64.log10(), 5_f64.log10(), 1.0];
        let [low, high] = [low, high].map(|end| end.max(f64::MIN_POSITIVE).log10());
        let (low, high) = (low - 0.03, high + 0.03);
        let below = |m: &f64| *m <= low - low.floor();
        let above = |m: &f64| *m >= high - high.floor();
        let down = low.floor() + marks.into_iter().rfind(below).unwrap_or(0.0);
        let up = high.floor() + marks.into_iter().find(above).unwrap_or(1.0);
        Self { log: true, short: false, ends: [down, up], places: [0.0, 1.0] }
    }

    /// Places the ends of the axis at these coordinates of the sheet.
    pub(crate) fn between(self, from: f64, to: f64) -> Self {
        Self { places: [from, to], ..self }
    }

    /// Returns the coordinate of a number; a number beyond the ends gets that of the nearer end.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        let value = if self.log { value.log10() } else { value };
        let part = (value - self.ends[0]) / (self.ends[1] - self.ends[0]);
        self.places[0] + part.clamp(0.0, 1.0) * (self.places[1] - self.places[0])
    }

    /// Returns whether a number lies between the ends.
    #[must_use]
    pub fn is_inside(&self, value: f64) -> bool {
        let value = if self.log { value.log10() } else { value };
        self.ends[0] < value && value < self.ends[1]
    }

    /// Lists the ticks, whose labels are at least `gap` apart on the sheet.
    pub(crate) fn ticks(&self, gap: f64) -> Vec<Tick> {
        let span = self.ends[1] - self.ends[0];
        let unit = (self.places[1] - self.places[0]).abs() / span;
        if self.log { self.decades(unit, gap) } else { self.steps((gap / unit).max(span / 12.0)) }
    }

    fn decades(&self, unit: f64, gap: f64) -> Vec<Tick> {
        let stride =
            [1.0, 2.0, 3.0, 5.0, 10.0].into_iter().find(|s| s * unit >= gap).unwrap_or(20.0);
        // 2 and 5 are labelled too if there would be hardly any labels otherwise.
        let rich = self.ends[1] - self.ends[0] < 2.5 && 0.3 * unit > 1.3 * gap;
        let mut ticks = vec![];
        let mut power = self.ends[0].floor();
        while power <= self.ends[1] {
            for digit in 1..10 {
                let place = power + f64::from(digit).log10();
                if place < self.ends[0] - 1e-9
                    || place > self.ends[1] + 1e-9
                    || (digit > 1 && unit < 2.0 * gap / 3.0)
                {
                    continue;
                }
                let label = match digit {
                    1 if power.rem_euclid(stride) == 0.0 => power_of_ten(power),
                    2 | 5 if rich => format!("{digit}×{}", power_of_ten(power)),
                    _ => String::new(),
                };
                ticks.push(Tick { value: 10_f64.powf(place), label });
            }
            power += 1.0;
        }
        ticks
    }

    fn steps(&self, least: f64) -> Vec<Tick> {
        let power = 10_f64.powf(least.log10().floor());
        let step = [1.0, 2.0, 5.0, 10.0]
            .map(|m| m * power)
            .into_iter()
            .find(|s| *s >= least * (1.0 - 1e-9))
            .unwrap_or(10.0 * power);
        let digits = (-step.log10().floor()).max(0.0) as usize;
        let label = |value: f64| match format!("{value:.digits$}") {
            long if self.short && long.len() > 6 => format!("{value:.1e}"),
            label => label,
        };
        let [first, last] = [(self.ends[0] / step).ceil(), (self.ends[1] / step).floor()];
        let values = (first as i64..=last as i64).map(|k| k as f64 * step);
        let tick = |value: f64| Tick { value, label: label(value).replace('-', "−") };
        values.map(tick).collect()
    }
}

fn power_of_ten(power: f64) -> String {
    format!("10^{{{power}}}").replace('-', "−")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_apart() {
        let linear = Axis::linear([-3.3, 1.2]).between(0.0, 300.0);
        let labels: Vec<_> = linear.ticks(40.0).into_iter().map(|tick| tick.label).collect();
        assert_eq!(labels, ["−3", "−2", "−1", "0", "1"]);
        let log = Axis::log(3e-4, 0.7).between(0.0, 400.0);
        let ticks = log.ticks(40.0);
        let labels: Vec<_> =
            ticks.iter().filter(|tick| !tick.label.is_empty()).map(|tick| &*tick.label).collect();
        assert_eq!(labels, ["10^{−3}", "10^{−2}", "10^{−1}", "10^{0}"]);
        assert!(ticks.len() > 25, "no minor ticks");
        assert!((log.at(1e-2) - f64::midpoint(log.at(1e-3), log.at(1e-1))).abs() < 1e-9);
        // The range of double precision.
        let all = Axis::log(0.0, f64::MAX).between(0.0, 200.0);
        assert!(all.ticks(40.0).iter().all(|tick| all.at(tick.value).is_finite()));
        // Many decades on a short axis have fewer labels.
        let long = Axis::log(1e-12, 1.0).between(0.0, 200.0);
        let labels = long.ticks(40.0).into_iter().filter(|tick| !tick.label.is_empty()).count();
        assert!((3..=5).contains(&labels), "{labels}");
    }
}
