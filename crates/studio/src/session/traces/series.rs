//! Values of what is plotted over the last minute of a run, and its Poincaré sections: the rows at
//! which a variable passes a value upwards, or a period ends, by cubic interpolation.

use std::f64::consts::TAU;

use a3_core::{Checkpoint, Simulation};
use a3_scenes::Splice;

use super::pick::{ANGLE, Kind, Pick, Row, VALUES, Variable};
use crate::session::rows::{self, Rows};

/// Simulated time that values cover (s).
pub const KEPT: f64 = 60.0;
/// Largest number of things that are plotted.
pub const MAX_PICKS: usize = 6;
/// Largest number of rows of a series, and of points of its section.
const MAX_ROWS: [usize; 2] = [30_000, 10_000];

/// Values of one pick, in the order of their times.
#[derive(Default)]
pub struct Series {
    rows: Rows<[f64; VALUES]>,
    section: Rows<[f64; VALUES]>,
    /// Time (s) up to which points of the section were searched for.
    searched: f64,
}

impl Series {
    /// Returns the values, the oldest first.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &Row> + DoubleEndedIterator + Clone {
        self.rows.iter()
    }

    /// Returns the points of the section, the oldest first.
    pub fn section(&self) -> impl ExactSizeIterator<Item = &Row> {
        self.section.iter()
    }

    /// Returns the row nearest to a time (s).
    pub fn nearest(&self, time: f64) -> Option<&Row> {
        rows::nearest(&self.rows, time)
    }

    /// Returns the row at a time (s) between the first and the last: one of the rows, or on the
    /// cubic through those around.
    pub fn at(&self, time: f64) -> Option<Row> {
        let k = self.rows.partition_point(|row| row.time < time);
        let row = self.rows.get(k)?;
        if row.time == time || k == 0 {
            return (row.time == time).then_some(*row);
        }
        let near = k.saturating_sub(2)..(k + 2).min(self.rows.len());
        let near: Vec<_> = self.rows.range(near).copied().collect();
        Some(interpolate(&near, time))
    }

    /// Adds a row, and finds the points of the section that it completes. Rows and points of later
    /// times are dropped first, because time may go back. Angles continue past a whole turn.
    fn push(&mut self, mut row: Row, trigger: Trigger) {
        rows::forget_after(&mut self.rows, row.time);
        let last = self.rows.back().map_or(f64::NEG_INFINITY, |last| last.time);
        rows::forget_after(&mut self.section, last);
        self.searched = self.searched.min(last);
        if last == row.time {
            return;
        }
        let before = self.rows.back().map_or(f64::NAN, |last| last.values[ANGLE]);
        let turns = ((before - row.values[ANGLE]) / TAU).round();
        row.values[ANGLE] += if turns.is_nan() { 0.0 } else { TAU * turns };
        self.rows.push_back(row);
        self.search(trigger, self.rows.len().saturating_sub(3));
        while self.rows.len() > MAX_ROWS[0] || self.rows[0].time < row.time - KEPT {
            self.rows.pop_front();
        }
    }

    /// Searches the intervals from row `first` on that were not searched and have a row after them.
    fn search(&mut self, trigger: Trigger, first: usize) {
        for k in first..self.rows.len().saturating_sub(2) {
            if trigger == Trigger::Off || self.rows[k].time < self.searched {
                continue;
            }
            let near = k.saturating_sub(1)..k + 3;
            let near: Vec<_> = self.rows.range(near).copied().collect();
            self.section.extend(trigger.within(&near, k.min(1)));
            self.searched = self.rows[k + 1].time;
            if self.section.len() > MAX_ROWS[1] {
                self.section.pop_front();
            }
        }
    }

    /// Finds the points of another section among the rows.
    fn search_again(&mut self, trigger: Trigger) {
        self.section.clear();
        self.searched = f64::NEG_INFINITY;
        self.search(trigger, 0);
    }
}

/// What is plotted of a run.
#[derive(Default)]
pub struct Traces {
    all: Vec<(Pick, Series)>,
    /// What takes the points of sections.
    pub trigger: Trigger,
}

impl Traces {
    /// Returns whether nothing is plotted.
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }

    /// Returns the number of things that are plotted.
    pub fn len(&self) -> usize {
        self.all.len()
    }

    /// Returns what is plotted, with its values.
    pub fn iter(&self) -> std::slice::Iter<'_, (Pick, Series)> {
        self.all.iter()
    }

    /// Returns whether something is plotted.
    pub fn has(&self, pick: Pick) -> bool {
        self.all.iter().any(|(own, _)| *own == pick)
    }

    /// Returns the same picks and the same trigger without values, for another run.
    pub fn without_values(&self) -> Self {
        let all = self.all.iter().map(|(pick, _)| (*pick, Series::default()));
        Self { all: all.collect(), trigger: self.trigger }
    }

    /// Plots something from now on, or no longer.
    pub fn toggle(&mut self, pick: Pick, run: &Simulation) {
        let before = self.all.len();
        self.all.retain(|(own, _)| *own != pick);
        if self.all.len() == before && before < MAX_PICKS {
            let mut series = Series::default();
            series.push(pick.read(run), self.trigger.of(pick.kind()));
            self.all.push((pick, series));
        }
    }

    /// Gives what has just been chosen its values in the past states of a run, the oldest first.
    pub fn recall<'m>(&mut self, run: &Simulation, past: impl Iterator<Item = &'m Checkpoint>) {
        let mut chosen: Vec<_> = self.all.iter_mut().filter(|(_, it)| it.rows.len() == 1).collect();
        if chosen.is_empty() {
            return;
        }
        let Ok(mut earlier) = run.anew(run.method(), run.control()) else {
            return;
        };
        for moment in past {
            if earlier.rewind(moment).is_ok() && earlier.time() < run.time() {
                for (pick, series) in &mut chosen {
                    series.push(pick.read(&earlier), self.trigger.of(pick.kind()));
                }
            }
        }
        for (pick, series) in chosen {
            series.push(pick.read(run), self.trigger.of(pick.kind()));
        }
    }

    /// Takes the points of sections at other events, also of the values so far.
    pub fn set_trigger(&mut self, trigger: Trigger) {
        self.trigger = trigger;
        for (pick, series) in &mut self.all {
            series.search_again(trigger.of(pick.kind()));
        }
    }

    /// Follows the same things by the numbers that particles and rigid bodies have since an edit.
    /// What was removed is plotted no longer.
    pub fn renumber(&mut self, numbers: [Splice; 2]) {
        self.all.retain_mut(|(pick, _)| {
            let now = pick.renumbered(numbers);
            *pick = now.unwrap_or(*pick);
            now.is_some()
        });
    }

    /// Plots those springs no longer that an edit of a run removed, but not their particles.
    pub fn drop_removed(&mut self, before: &Simulation, now: &Simulation, particles: Splice) {
        let back = [particles.back(), Splice::default()];
        let was_there = |pick: Pick| pick.renumbered(back).is_some_and(|it| it.is_in(before));
        self.all.retain(|(pick, _)| pick.is_in(now) || !was_there(*pick));
    }

    /// Adds the values of the present state of a run.
    pub fn take(&mut self, run: &Simulation) {
        for (pick, series) in &mut self.all {
            series.push(pick.read(run), self.trigger.of(pick.kind()));
        }
    }

    /// Forgets all values.
    pub fn forget(&mut self) {
        *self = self.without_values();
    }
}

/// Number of halvings that find a crossing within an interval: as many as a double has bits.
const HALVINGS: u32 = 53;

/// When a point of a section is taken.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Trigger {
    /// Never.
    #[default]
    Off,
    /// Whenever a variable passes a value upwards; an angle, also any number of turns from it.
    Rises(Variable, f64),
    /// Once in each period (s), at its multiples.
    Period(f64),
}

impl Trigger {
    /// Returns the trigger for things of a kind: none if they lack its variable.
    pub fn of(self, kind: Kind) -> Self {
        match self {
            Self::Rises(variable, _) if !variable.is_of(kind) => Self::Off,
            trigger => trigger,
        }
    }

    /// Returns the row at which the trigger acts in the interval from row k to the next, if it
    /// does. The polynomial through all rows interpolates.
    pub fn within(self, rows: &[Row], k: usize) -> Option<Row> {
        let [a, b] = [rows.get(k)?, rows.get(k + 1)?];
        let at = |time: f64| interpolate(rows, time);
        match self {
            Self::Off => None,
            Self::Period(period) => {
                let time = (b.time / period).floor() * period;
                (time > a.time).then(|| at(time))
            }
            Self::Rises(variable, value) => {
                let value = if variable == Variable::Angle {
                    value + TAU * ((variable.of(b) - value) / TAU).floor()
                } else {
                    value
                };
                if !(variable.of(a) < value && variable.of(b) >= value) {
                    return None;
                }
                let [mut low, mut high] = [a.time, b.time];
                for _ in 0..HALVINGS {
                    let middle = f64::midpoint(low, high);
                    if variable.of(&at(middle)) < value {
                        low = middle;
                    } else {
                        high = middle;
                    }
                }
                Some(at(high))
            }
        }
    }
}

/// Returns the row at a time (s) on the polynomial through rows (Lagrange).
pub fn interpolate(rows: &[Row], time: f64) -> Row {
    let mut values = [0.0; _];
    for (k, row) in rows.iter().enumerate() {
        let others = rows.iter().enumerate().filter(|(j, _)| *j != k);
        let weight: f64 =
            others.map(|(_, other)| (time - other.time) / (row.time - other.time)).product();
        for (sum, value) in values.iter_mut().zip(row.values) {
            *sum += weight * value;
        }
    }
    Row { time, values }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::Variable;

    /// Returns a row of the motion x = sin(3 t).
    fn row(time: f64) -> Row {
        let mut values = [0.0; _];
        (values[0], values[3]) = ((3.0 * time).sin(), 3.0 * (3.0 * time).cos());
        Row { time, values }
    }

    #[test]
    fn crossings_are_found_once_and_between_the_samples() {
        let mut series = Series::default();
        let trigger = Trigger::Rises(Variable::X, 0.5);
        let times = (0..2000).map(|k| 0.01 * f64::from(k) + 0.002 * f64::from(k % 3));
        let times: Vec<_> = times.collect();
        for t in &times {
            series.push(row(*t), trigger);
        }
        let right = |k: u32| (0.5_f64.asin() + TAU * f64::from(k)) / 3.0;
        let check = |series: &Series, count: usize| {
            let found: Vec<_> = series.section().collect();
            assert_eq!(found.len(), count);
            for (k, point) in (0..).zip(found) {
                assert!((point.time - right(k)).abs() < 1e-6, "{k}: {}", point.time);
                assert!((point.values[0] - 0.5).abs() < 1e-12);
                assert!((point.values[3] - 3.0 * 0.75_f64.sqrt()).abs() < 1e-5);
            }
        };
        check(&series, 10);
        // Time goes back, and the same motion comes again: no point is there twice.
        let back = times.iter().position(|t| *t > right(4) + 0.005).unwrap();
        for t in &times[back..] {
            series.push(row(*t), trigger);
        }
        check(&series, 10);
        assert!(series.rows().is_sorted_by(|a, b| a.time < b.time));
        // Going back before a crossing drops it.
        series.push(row(right(2)), trigger);
        check(&series, 2);
        // The same points are found among the values afterwards, and those of a period.
        for t in &times {
            series.push(row(*t), Trigger::Off);
        }
        series.search_again(trigger);
        check(&series, 10);
        series.search_again(Trigger::Period(0.7));
        let phases: Vec<_> = series.section().map(|point| point.time / 0.7).collect();
        assert_eq!(phases.len(), 28);
        for (k, phase) in (1..).zip(phases) {
            assert!((phase - f64::from(k)).abs() < 1e-9, "{phase}");
        }
    }

    /// A thing that turns by 2 rad/s and back passes each angle once in each turn forwards.
    #[test]
    fn an_angle_is_passed_once_in_each_turn() {
        let mut series = Series::default();
        let trigger = Trigger::Rises(Variable::Angle, 0.5);
        for k in 0..4000 {
            let time = 0.01 * f64::from(k);
            let angle = if time < 20.0 { 2.0 * time } else { 80.0 - 2.0 * time };
            let mut values = [0.0; VALUES];
            values[ANGLE] = angle.sin().atan2(angle.cos());
            series.push(Row { time, values }, trigger);
        }
        let times: Vec<_> = series.section().map(|point| point.time).collect();
        // 40 rad are 0.5 + 6.29 turns.
        assert_eq!(times.len(), 7);
        for (k, time) in (0..).zip(times) {
            let right = 0.25 + 0.5 * TAU * f64::from(k);
            assert!((time - right).abs() < 1e-9, "{time} {right}");
        }
    }

    #[test]
    fn values_between_the_rows_are_on_a_cubic() {
        let mut series = Series::default();
        for k in 0..400 {
            series.push(row(0.01 * f64::from(k)), Trigger::Off);
        }
        for time in [0.004, 0.015, 1.236, 3.984] {
            let [value, rate] = [0, 3].map(|k| series.at(time).unwrap().values[k]);
            assert!((value - row(time).values[0]).abs() < 1e-5, "{time}");
            assert!((rate - row(time).values[3]).abs() < 1e-4, "{time}");
        }
        assert_eq!(series.at(0.5), series.nearest(0.5).copied());
        assert!(series.at(-0.1).is_none() && series.at(4.1).is_none());
    }

    #[test]
    fn a_minute_is_kept_and_no_more() {
        let mut series = Series::default();
        for k in 0..40_000 {
            series.push(row(f64::from(k) / 240.0), Trigger::Off);
        }
        let count = series.rows().len();
        assert!(count.abs_diff(240 * KEPT as usize) <= 1, "{count}");
        let last = series.nearest(1e9).unwrap().time;
        assert_eq!(series.nearest(last - 0.998).unwrap().time, last - 239.0 / 240.0 - 1.0 / 240.0);
        assert!(Series::default().nearest(1.0).is_none());
    }
}
