//! The timeline: moments of the last seconds, to which all runs can return.

use a3_core::{Checkpoint, Simulation};

use super::rows::{self, Row, Rows};

/// Simulated time between two moments (s).
const INTERVAL: f64 = 1.0 / 60.0;
/// Longest simulated time from the oldest to the newest moment (s).
const SPAN: f64 = 20.0;
/// Largest memory of all moments together (bytes).
const MAX_MEMORY: usize = 64 << 20;

/// Recorded moments, the oldest first.
#[derive(Default)]
pub struct Timeline {
    moments: Rows<MomentStates>,
    /// Index of the chosen moment; `None` for the newest.
    shown: Option<usize>,
    /// Whether a run blew up after the newest moment.
    pub blew_up: bool,
}

/// The states of all runs at one time; `None` for a run that had diverged.
type MomentStates = Vec<Option<Checkpoint>>;

/// Returns the memory of the states of a moment (bytes).
fn size(moment: &Row<MomentStates>) -> usize {
    moment.values.iter().flatten().map(Checkpoint::size).sum()
}

/// Position of a moment on the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimelinePosition {
    /// Share of the timeline: 0 at the oldest moment, 1 at the newest.
    pub share: f32,
    /// Time before the newest moment (s).
    pub back: f64,
    /// Time from the oldest to the newest moment (s).
    pub span: f64,
    /// Whether a run blew up after the newest moment.
    pub blew_up: bool,
}

impl Timeline {
    /// Clears the timeline.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Drops the moments after a time (s), and chooses the newest of the others.
    pub fn forget_after(&mut self, clock: f64) {
        rows::forget_after(&mut self.moments, clock);
        (self.shown, self.blew_up) = (None, false);
    }

    /// Returns the states of all runs at the last moment before a time (s), or else at the oldest;
    /// no states if there is no moment.
    pub fn before(&self, clock: f64) -> MomentStates {
        let later = self.moments.partition_point(|moment| moment.time <= clock);
        let moment = self.moments.get(later.saturating_sub(1));
        moment.map_or(vec![], |moment| moment.values.clone())
    }

    /// Returns the time of the next moment (s), if there is one before it.
    pub fn due(&self) -> Option<f64> {
        self.moments.back().map(|newest| newest.time + INTERVAL)
    }

    /// Records the states at `clock` (s) if the last moment is old enough, or with `now` if it is
    /// older at all. Drops the moments after the chosen one first.
    pub fn record<'r>(
        &mut self,
        clock: f64,
        now: bool,
        runs: impl Iterator<Item = &'r Simulation>,
    ) {
        if let Some(k) = self.shown.take() {
            self.moments.truncate(k + 1);
            self.blew_up = false;
        }
        let last = self.moments.back().map(|moment| moment.time);
        let early = |due: f64| !now && clock < due - 1e-6 * INTERVAL;
        if last.is_some_and(|last| clock <= last) || self.due().is_some_and(early) {
            return;
        }
        let taken: usize = self.moments.iter().map(size).sum();
        let next = self.moments.back().map_or(0, size);
        let is_full = self.moments.len() > 1 && taken + next > MAX_MEMORY;
        // Reuse the memory of the oldest moment.
        let old = |oldest: &mut Row<MomentStates>| is_full || oldest.time < clock - SPAN;
        let spare = self.moments.pop_front_if(old);
        let mut places = spare.map_or(vec![], |moment| moment.values).into_iter();
        let states = runs.map(|run| {
            let spare = places.next().flatten();
            let moment = || match spare {
                Some(mut moment) => {
                    run.record(&mut moment);
                    moment
                }
                None => run.moment(),
            };
            run.blow_up().is_none().then(moment)
        });
        let (time, values) = (clock, states.collect());
        self.moments.push_back(Row { time, values });
    }

    /// Goes `by` moments forward, or back if it is negative, and returns whether that changed the
    /// moment.
    pub fn go(&mut self, by: isize) -> bool {
        let (newest, from) = (self.moments.len().saturating_sub(1), self.chosen());
        let to = from.saturating_add_signed(by).min(newest);
        self.shown = Some(to).filter(|k| *k < newest);
        to != from
    }

    /// Goes to a share of the timeline, from 0 for the oldest moment to 1 for the newest, and
    /// returns whether that changed the moment.
    pub fn go_to(&mut self, share: f32) -> bool {
        let newest = self.moments.len().saturating_sub(1);
        let to = (share.clamp(0.0, 1.0) * newest as f32).round() as isize;
        self.go(to - self.chosen() as isize)
    }

    /// Returns the states nearest to times that are `interval` (s) apart, over the last `seconds`
    /// (s) before the chosen moment, the oldest first.
    pub fn last(&self, seconds: f64, interval: f64) -> Vec<MomentStates> {
        let ends = self.moments.front().zip(self.moments.get(self.chosen()));
        let Some([first, last]) = ends.map(|(first, last)| [first.time, last.time]) else {
            return vec![];
        };
        let frames = (seconds.min(last - first) / interval + 1e-6).floor() as u32;
        let times = (0..=frames).rev().map(|k| last - f64::from(k) * interval);
        let nearest = times.filter_map(|time| rows::nearest(&self.moments, time));
        nearest.map(|moment| moment.values.clone()).collect()
    }

    /// Returns the states of run k up to the chosen moment, the oldest first.
    pub fn past(&self, k: usize) -> impl Iterator<Item = &Checkpoint> {
        let moments = self.moments.iter().take(self.chosen() + 1);
        moments.filter_map(move |moment| moment.values.get(k)?.as_ref())
    }

    /// Restores the runs to the chosen moment.
    pub fn show<'r>(&self, runs: impl Iterator<Item = &'r mut Simulation>) {
        let Some(chosen) = self.moments.get(self.chosen()) else {
            return;
        };
        for (run, moment) in runs.zip(&chosen.values) {
            // The checkpoint is of this run, so it fits.
            let _ = moment.as_ref().map(|moment| run.rewind(moment));
        }
    }

    /// Returns the index of the chosen moment.
    fn chosen(&self) -> usize {
        self.shown.unwrap_or(self.moments.len().saturating_sub(1))
    }

    /// Returns the position of the chosen moment; `None` before there are two.
    pub fn position(&self) -> Option<TimelinePosition> {
        let newest = self.moments.len().checked_sub(1).filter(|k| *k > 0)?;
        let k = self.chosen();
        let clock = |k: usize| self.moments[k].time;
        Some(TimelinePosition {
            share: k as f32 / newest as f32,
            back: clock(newest) - clock(k),
            span: clock(newest) - clock(0),
            blew_up: self.blew_up,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{RunAction, frames, session};
    use a3_core::{Control, integrators};

    fn run(rows: usize) -> Simulation {
        let entry = a3_scenes::find("cloth").unwrap();
        let grid = a3_core::Grid::new(rows, rows).unwrap();
        let scene = entry.build(Some(grid)).unwrap().scene;
        Simulation::new(scene, integrators::find("t").unwrap(), Control::Step(0.01)).unwrap()
    }

    #[test]
    fn it_keeps_twenty_seconds_and_no_more_than_its_memory() {
        let (small, large) = (run(3), run(200));
        let mut timeline = Timeline::default();
        for k in 0..3000 {
            timeline.record(f64::from(k) / 120.0, false, [&small].into_iter());
        }
        // Every second state is recorded.
        assert!(timeline.moments.len().abs_diff(1201) <= 1);
        timeline.clear();
        for k in 0..50 {
            timeline.record(f64::from(k), false, [&large, &large].into_iter());
        }
        let size = 2 * large.moment().size();
        assert_eq!(timeline.moments.len(), (MAX_MEMORY / size).min(21));
    }

    #[test]
    fn moments_after_the_chosen_one_are_dropped() {
        let (run, mut timeline) = (run(3), Timeline::default());
        for k in 0..5 {
            timeline.record(f64::from(k), false, [&run].into_iter());
        }
        assert!(timeline.go(-3));
        timeline.record(1.5, false, [&run].into_iter());
        let clocks: Vec<_> = timeline.moments.iter().map(|entry| entry.time).collect();
        assert_eq!(clocks, [0.0, 1.0, 1.5]);
    }

    #[test]
    fn the_last_seconds_are_evenly_spaced() {
        let (mut run, mut timeline) = (run(3), Timeline::default());
        // Every 20 ms, with a gap from 0.78 to 1.2 s.
        for k in (0..=100).filter(|k| !(40..60).contains(k)) {
            run.advance_to(0.02 * f64::from(k)).unwrap();
            timeline.record(run.time(), false, [&run].into_iter());
        }
        let times = |seconds, interval| -> Vec<f64> {
            let moments = timeline.last(seconds, interval).into_iter();
            moments.map(|runs| runs[0].as_ref().unwrap().time()).collect()
        };
        let near = |times: &[f64], right: &[f64]| {
            assert_eq!(times.len(), right.len(), "{times:?}");
            for (a, b) in times.iter().zip(right) {
                assert!((a - b).abs() < 1e-9, "{times:?}");
            }
        };
        near(&times(0.4, 0.1), &[1.6, 1.7, 1.8, 1.9, 2.0]);
        near(&times(1.3, 0.26), &[0.7, 0.78, 1.22, 1.48, 1.74, 2.0]);
        assert_eq!(times(99.0, 0.5).len(), 5);
        assert_eq!(Timeline::default().last(1.0, 0.1).len(), 0);
        // After going back, the moments end at the chosen one.
        assert!(timeline.go(-1));
        near(
            &timeline
                .last(0.0, 0.1)
                .iter()
                .map(|runs| runs[0].as_ref().unwrap().time())
                .collect::<Vec<_>>(),
            &[1.98],
        );
    }

    #[test]
    fn a_slow_window_records_as_many_moments_as_a_quick_one() {
        let moments = |tick: f64| {
            let mut session = session(&["v", "0.005", "--scene", "chain"]);
            session.readings.in_window = true;
            while session.runs.clock < 1.0 - 1e-9 {
                session.tick(tick);
            }
            session.timeline.moments.len()
        };
        assert_eq!((moments(0.1), moments(1.0 / 60.0)), (61, 61));
    }

    #[test]
    fn a_diverged_run_has_no_moment() {
        let scene = a3_scenes::find("mit").unwrap().build(None).unwrap().scene;
        let mut run =
            Simulation::new(scene, integrators::find("e").unwrap(), Control::Step(0.05)).unwrap();
        let mut timeline = Timeline::default();
        timeline.record(0.0, false, [&run].into_iter());
        while run.take_steps(1).is_ok() {}
        timeline.record(1.0, false, [&run].into_iter());
        let kept = timeline.moments.iter().map(|e| e.values[0].is_some());
        assert_eq!(kept.collect::<Vec<_>>(), [true, false]);
    }

    #[test]
    fn it_stops_at_both_ends() {
        let mut timeline = Timeline::default();
        assert!(!timeline.go(-1) && !timeline.go_to(0.0) && timeline.position().is_none());
        for k in 0..5 {
            timeline.record(f64::from(k), false, [&run(3)].into_iter());
        }
        assert!(timeline.go(-3) && timeline.go(-3) && !timeline.go(-1));
        let position = timeline.position().unwrap();
        assert_eq!((position.share, position.back, position.span), (0.0, 4.0, 4.0));
        assert!(timeline.go_to(0.5));
        assert_eq!(timeline.position().unwrap().back, 2.0);
        assert!(timeline.go(10));
        let position = timeline.position().unwrap();
        assert_eq!((position.share, position.back), (1.0, 0.0));
    }

    /// Goes back and forward again, then back and on by simulating: the states are equal to the
    /// bit.
    #[test]
    fn moments_come_back_to_the_bit_and_runs_continue_from_them() {
        let mut session = session(&["t", "0.01", "--scene", "cloth"]);
        session.readings.in_window = true;
        frames(&mut session, 1.0);
        let newest = (session.runs.first().time(), session.runs.first().state().to_vec());
        session.act(RunAction::Scrub(-10), 0);
        let place = session.readings.timeline.unwrap();
        assert!(session.readings.paused && (place.back - 1.0 / 6.0).abs() < 0.02, "{place:?}");
        let (time, steps) = (session.runs.first().time(), session.runs.first().steps());
        assert!(time < newest.0 && (time - 0.01 * steps as f64).abs() < 1e-9);
        let then = session.runs.first().state().to_vec();
        // The session is paused.
        session.tick(0.1);
        assert_eq!(session.runs.first().state(), then);
        session.act(RunAction::Step, 0);
        session.act(RunAction::Scrub(10), 0);
        assert!(!session.readings.rewound());
        assert_eq!(
            (session.runs.first().time(), session.runs.first().state()),
            (newest.0, &newest.1[..])
        );
        session.act(RunAction::Scrub(-10), 0);
        assert_eq!(session.runs.first().state(), then);
        session.act(RunAction::Pause, 0);
        while session.runs.first().time() < newest.0 - 1e-9 {
            session.tick(0.01);
        }
        assert_eq!(
            (session.runs.first().state(), session.readings.rewound()),
            (&newest.1[..], false)
        );
        session.act(RunAction::Reset, 0);
        session.act(RunAction::Scrub(-1), 0);
        assert_eq!((session.runs.first().time(), session.readings.rewound()), (0.0, false));
    }

    #[test]
    fn going_back_undoes_a_blow_up() {
        let mut session = session(&["r", "0.05", "--scene", "mit"]);
        session.readings.in_window = true;
        while session.runs.panes[0].alive() {
            session.tick(1.0 / 60.0);
        }
        session.act(RunAction::Scrub(-10), 0);
        assert!(session.runs.panes[0].alive() && session.readings.rewound());
    }
}
