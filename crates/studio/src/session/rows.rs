//! What is recorded of the last seconds, in rows: samples of a run for the panel's plots, values of
//! what is picked, and states of all runs.

use std::collections::VecDeque;

use a3_core::{Energy, Simulation};

/// What was recorded at one time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<T> {
    /// Simulated time (s).
    pub time: f64,
    pub values: T,
}

/// Rows in the order of their times.
pub type Rows<T> = VecDeque<Row<T>>;

/// Drops the rows after a time (s), because time may go back.
pub fn forget_after<T>(rows: &mut Rows<T>, time: f64) {
    let others = rows.partition_point(|row| row.time <= time);
    rows.truncate(others);
}

/// Returns the row nearest to a time (s).
pub fn nearest<T>(rows: &Rows<T>, time: f64) -> Option<&Row<T>> {
    let k = rows.partition_point(|row| row.time < time);
    let near = [k.checked_sub(1), Some(k)].into_iter().flatten();
    let near = near.filter_map(|k| rows.get(k));
    near.min_by(|a, b| (a.time - time).abs().total_cmp(&(b.time - time).abs()))
}

/// Simulated time that samples cover (s).
pub const SPAN: f64 = 20.0;
/// Shortest simulated time between two samples (s): slightly below 0.1, so that rounding does not
/// reduce their rate of ten per second.
const MIN_INTERVAL: f64 = 0.09;

/// Values of a run.
#[derive(Clone, Copy, Debug)]
pub struct Values {
    /// Energy by kind, if the scene has any.
    pub energy: Option<Energy>,
    /// The largest length over rest length, if the scene has springs.
    pub stretch: Option<f64>,
    /// Evaluations and computing time (ms) per simulated second, since the previous sample.
    pub cost: Option<[f64; 2]>,
    /// Evaluations and computing time (s) since the run started.
    total: [f64; 2],
}

/// Values of a run at one time.
pub type Sample = Row<Values>;

/// Samples in the order of their times.
#[derive(Default)]
pub struct Samples {
    samples: Rows<Values>,
}

impl Samples {
    /// Takes a sample if the last one is old enough. Drops samples of later times first, because
    /// time may go back. `computing` is the total computing time (s).
    pub fn take(
        &mut self,
        run: &Simulation,
        energy: Option<Energy>,
        stretch: Option<f64>,
        computing: f64,
    ) {
        let time = run.time();
        forget_after(&mut self.samples, time);
        let before = self.samples.back();
        if before.is_some_and(|last| time - last.time < MIN_INTERVAL) {
            return;
        }
        let total = [run.work().total(), computing];
        let cost = before.map(|last| {
            let elapsed = time - last.time;
            [
                (total[0] - last.values.total[0]) / elapsed,
                1e3 * (total[1] - last.values.total[1]) / elapsed,
            ]
        });
        let values = Values {
            energy,
            stretch,
            cost: cost.filter(|[evaluations, _]| *evaluations >= 0.0),
            total,
        };
        self.samples.push_back(Row { time, values });
        while self.samples[0].time < time - SPAN {
            self.samples.pop_front();
        }
    }

    /// Drops all samples.
    pub fn clear(&mut self) {
        self.samples.clear();
    }

    /// Returns the sample nearest to a time (s), if it is within five intervals.
    pub fn nearest(&self, time: f64) -> Option<&Sample> {
        let nearest = nearest(&self.samples, time);
        nearest.filter(|sample| (sample.time - time).abs() < 5.0 * MIN_INTERVAL)
    }

    /// Returns the samples, the oldest first.
    pub fn iter(&self) -> impl Iterator<Item = &Sample> {
        self.samples.iter()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{RunAction, compared, session, times};
    use a3_core::{Control, integrators};

    #[test]
    fn twenty_seconds_are_remembered_ten_times_a_second() {
        let scene = a3_scenes::find("pendulum").unwrap().build(None).unwrap().scene;
        let mut run =
            Simulation::new(scene, integrators::find("r").unwrap(), Control::Step(0.01)).unwrap();
        let mut kept = Samples::default();
        let mut computing = 0.0;
        for _ in 0..600 {
            run.take_steps(5).unwrap();
            computing += 0.001;
            kept.take(&run, run.energy(), run.largest_stretch(), computing);
        }
        let samples: Vec<_> = kept.iter().copied().collect();
        assert!((200..=202).contains(&samples.len()), "{}", samples.len());
        for pair in samples.windows(2) {
            assert!((pair[1].time - pair[0].time - 0.1).abs() < 1e-9);
            let [evaluations, computing] = pair[1].values.cost.unwrap();
            assert!((evaluations - 400.0).abs() < 1e-6 && (computing - 20.0).abs() < 1e-6);
        }
        assert!(samples[0].time >= 29.9 - SPAN && samples[0].values.energy.is_some());
        // A reset drops the later samples.
        run.reset();
        kept.take(&run, run.energy(), None, computing);
        assert_eq!(kept.iter().count(), 1);
    }

    #[test]
    fn a_diverged_run_leaves_no_line_across_the_picture() {
        let mut session = session(&["e", "2", "--scene", "simple"]);
        while session.runs.panes[0].simulation.blow_up().is_none() {
            session.act(RunAction::Step, 0);
        }
        let radius = |p: &[f32; 3]| p[0].hypot(p[1]);
        assert!(session.runs.panes[0].show.trail().all(|p| radius(p) <= 100.0));
        let last = session.runs.panes[0].show.trail().last().copied();
        session.act(RunAction::Step, 0);
        assert_eq!(session.runs.panes[0].show.trail().last().copied(), last);
    }

    #[test]
    fn a_diverged_pane_leaves_the_others_alone() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "mit"], 2.0);
        assert!(!session.runs.panes[0].alive() && session.runs.panes[0].error.is_none());
        assert!(session.animated() && session.runs.panes[1].error.unwrap() < 1e-3);
        assert!((times(&session)[1] - session.runs.clock).abs() < 0.011);
        session.act(RunAction::Reset, 0);
        assert!(session.runs.panes[0].alive());
    }
}
