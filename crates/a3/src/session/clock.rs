//! Time for all runs of a session: they keep up with real time, together.

use web_time::{Duration, Instant};

use super::meter::Meter;
use super::pane::Pane;
use super::reference::ReferenceRun;
use super::state::Session;

/// Real time that a frame may spend on steps: at least so much, and at least this share of the real
/// time that the frame stands for, so that steps may take as long as a slow display. Steps that do
/// not fit are left out: all runs are then slower than real time. Tests run several at a time and
/// must not depend on it.
const BUDGET: (Duration, f64) = (
    Duration::from_millis(if cfg!(test) { 400 } else { 12 }),
    0.5,
);
/// Real time that a frame may spend on the reference: at least so much, and at least this share of
/// the real time that the frame stands for. Tests run several at a time and must not depend on it.
const REFERENCE_BUDGET: (Duration, f64) =
    (Duration::from_millis(if cfg!(test) { 400 } else { 4 }), 0.1);
/// Real time that a key may take.
pub(super) const KEY_BUDGET: Duration = Duration::from_millis(200);
/// The most real time (s) that a frame makes up for, however long the last one took.
const LONGEST_FRAME: f64 = 0.3;
/// Real time between two looks at the states while they move.
const READING_INTERVAL: Duration = Duration::from_millis(100);

impl Session {
    /// Brings the runs on by `real` seconds of real time, in steps of exactly the lengths that were
    /// asked for.
    pub fn tick(&mut self, real: f64) {
        if self.animated() {
            let real = real.min(LONGEST_FRAME);
            let budget = |(least, share): (Duration, f64)| {
                let share = Duration::from_secs_f64(share * real);
                share.max(least)
            };
            let simulated = real * 0.5f64.powi(self.readings.slowness);
            let until = self.clock + simulated;
            self.advance(until, budget(BUDGET), budget(REFERENCE_BUDGET));
        } else {
            self.settle();
        }
    }

    /// Brings all panes to a simulated time (s) in short slices, so that none is ahead of the
    /// others when the budget of real time is over before.
    pub(super) fn advance(&mut self, until: f64, budget: Duration, reference_budget: Duration) {
        self.keep(false);
        let (begun, start) = (Instant::now(), self.clock);
        let steps = self.panes.iter().map(Pane::pace);
        let mut slice = steps.fold(f64::INFINITY, f64::min);
        while self.clock < until && begun.elapsed() < budget && self.panes.iter().any(Pane::alive) {
            self.clock = (self.clock + slice).min(until);
            for pane in &mut self.panes {
                pane.take_due_steps(self.clock);
            }
            if begun.elapsed() < budget / 16 {
                slice *= 2.0;
            }
        }
        if let Some(reference) = &mut self.reference {
            reference.follow(&mut self.panes, reference_budget);
            self.readings.no_error = reference.stopped();
            self.readings.predictable = reference.predictable();
        }
        self.meter.count_steps(self.clock - start, begun.elapsed());
        for pane in &mut self.panes {
            pane.follow();
        }
        self.keep(false);
    }

    /// Keeps the states on the timeline if the last ones are old enough, or at once with `now`.
    pub(super) fn keep(&mut self, now: bool) {
        if self.readings.in_window {
            let panes = self.panes.iter().map(|pane| &pane.simulation);
            let reference = self.reference.as_ref().map(ReferenceRun::any);
            self.timeline.keep(self.clock, now, panes.chain(reference));
        }
        self.readings.rewound = self.timeline.position();
    }

    /// Sets the clock to the time of the pane that is farthest, so that no steps are due.
    pub(super) fn settle(&mut self) {
        let alive = self.panes.iter().filter(|pane| pane.alive());
        let times = alive.map(|pane| pane.simulation.time());
        self.clock = times.reduce(f64::max).unwrap_or(self.clock);
    }

    /// Brings all runs to `time` (s) exactly, however long that takes: without a window.
    pub fn run_to(&mut self, time: f64) {
        for pane in &mut self.panes {
            pane.run_to(time);
        }
        if let Some(reference) = &mut self.reference {
            reference.run_to(time, &mut self.panes);
            self.readings.no_error = reference.stopped();
            self.readings.predictable = reference.predictable();
        }
        self.settle();
    }

    /// Takes readings of the states: ten times a second while they move, and once when they stand
    /// still.
    pub fn read_state(&mut self) {
        let steps = self.panes.iter().map(|pane| pane.simulation.steps()).sum();
        let due = self.read.is_none_or(|(before, when)| {
            before != steps && (!self.animated() || when.elapsed() > READING_INTERVAL)
        });
        if due {
            self.read = Some((steps, Instant::now()));
            self.panes.iter_mut().for_each(Pane::read_state);
        }
    }

    /// Counts a frame that took `drawing` to draw. Twice a second the rates are taken, unless all
    /// runs stand still.
    pub fn drawn(&mut self, drawing: Duration) {
        if !self.animated() {
            self.readings.factor = 0.0;
            self.meter = Meter::new();
            return;
        }
        let Some(rates) = self.meter.count_frame(drawing) else {
            return;
        };
        self.readings.rate = rates.rate;
        self.readings.factor = rates.factor;
        self.readings.simulating = rates.simulating;
        self.readings.drawing = rates.drawing;
        self.panes.iter_mut().for_each(Pane::read_cost);
    }

    /// Begins to measure anew, with no steps due: after a time in which nothing was simulated.
    pub fn start_anew(&mut self) {
        self.settle();
        self.read = None;
        self.meter = Meter::new();
    }
}

#[cfg(test)]
mod tests {
    use a3_core::Vector3;

    use crate::session::keys::Action;
    use crate::session::{compared, frames, session, times};

    use super::*;

    #[test]
    fn time_keeps_up_whatever_the_frame_rate() {
        for rate in [17.0, 60.0, 144.0] {
            let mut session = session(&["t", "0.01", "--scene", "chain"]);
            for _ in 0..(3.0 * rate) as u32 {
                session.tick(1.0 / rate);
            }
            assert!(
                (session.panes[0].simulation.time() - 3.0).abs() < 0.011,
                "{rate}: {}",
                session.panes[0].simulation.time()
            );
        }
    }

    #[test]
    fn a_frame_of_minutes_is_no_huge_step() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        session.tick(300.0);
        assert!(session.panes[0].simulation.time() <= LONGEST_FRAME + 1e-9);
        assert!(session.panes[0].simulation.steps() <= 30);
    }

    #[test]
    fn a_long_step_waits_until_it_is_due() {
        let mut session = session(&["r", "0.5", "--scene", "simple"]);
        for _ in 0..65 {
            session.tick(1.0 / 60.0);
        }
        assert_eq!(session.panes[0].simulation.steps(), 2);
    }

    #[test]
    fn paused_it_stands_still() {
        let mut session = session(&["t", "0.01", "--paused"]);
        session.tick(0.05);
        assert_eq!(session.panes[0].simulation.steps(), 0);
        session.act(Action::Step, 0);
        assert_eq!(session.panes[0].simulation.steps(), 1);
        session.act(Action::Pause, 0);
        session.tick(0.05);
        assert_eq!(session.panes[0].simulation.steps(), 6);
    }

    #[test]
    fn a_lost_run_leaves_no_line_across_the_picture() {
        let mut session = session(&["e", "2", "--scene", "simple"]);
        while session.panes[0].simulation.blow_up().is_none() {
            session.act(Action::Step, 0);
        }
        let radius = |p: &[f32; 3]| p[0].hypot(p[1]);
        assert!(session.panes[0].show.trail().all(|p| radius(p) <= 100.0));
        let last = session.panes[0].show.trail().last().copied();
        session.act(Action::Step, 0);
        assert_eq!(session.panes[0].show.trail().last().copied(), last);
    }

    #[test]
    fn slow_motion_is_slow_and_its_steps_are_the_same() {
        let mut session = session(&["t", "0.001", "--scene", "chain"]);
        for _ in 0..2 {
            session.act(Action::Slower, 0);
        }
        frames(&mut session, 2.0);
        let run = session.first();
        assert!((run.time() - 0.5).abs() < 2e-3, "{}", run.time());
        assert!((run.time() - 1e-3 * run.steps() as f64).abs() < 1e-9);
        for _ in 0..9 {
            session.act(Action::Slower, 0);
        }
        assert_eq!(session.readings.slowness, 6);
        for _ in 0..9 {
            session.act(Action::Faster, 0);
        }
        frames(&mut session, 1.0);
        assert!((session.first().time() - 1.5).abs() < 3e-3);
    }

    #[test]
    fn panes_keep_the_same_time() {
        let session = compared(&["t:0.03", "r:0.07", "v", "--scene", "chain"], 2.0);
        for pane in &session.panes {
            let (run, step) = (&pane.simulation, pane.pace());
            assert!(
                run.time() < session.clock + 1e-9 && run.time() > session.clock - step - 1e-9,
                "{}",
                run.time()
            );
            assert!(session.clock > 1.5 && (run.time() - step * run.steps() as f64).abs() < 1e-9);
        }
    }

    #[test]
    fn when_one_is_slow_all_are() {
        let mut session = session(&["compare", "e:0.0000001", "r:0.0001"]);
        for _ in 0..4 {
            session.tick(0.1);
        }
        let times = times(&session);
        assert!(times[0] > 0.0 && times[0] < 0.2, "{times:?}");
        assert!(
            times[1] <= times[0] + 1e-9 && times[0] - times[1] < 1.1e-4,
            "{times:?}"
        );
    }

    #[test]
    fn the_error_is_the_distance_from_the_truth() {
        let session = compared(&["e:0.05", "r:0.07", "--scene", "simple"], 5.0);
        for (pane, bound) in session.panes.iter().zip([0.2, 1e-5]) {
            let (run, error) = (&pane.simulation, pane.error.unwrap());
            let (sin, cos) = run.time().sin_cos();
            let truth = (run.position(0) - Vector3::new(cos, sin, 0.0)).norm();
            assert!(
                error < bound && (error - truth).abs() < 0.02 * truth,
                "{error} {truth}"
            );
        }
    }

    #[test]
    fn one_that_is_lost_leaves_the_others_alone() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "mit"], 2.0);
        assert!(!session.panes[0].alive() && session.panes[0].error.is_none());
        assert!(session.animated() && session.panes[1].error.unwrap() < 1e-3);
        assert!((times(&session)[1] - session.clock).abs() < 0.011);
        session.act(Action::Reset, 0);
        assert!(session.panes[0].alive());
    }

    #[test]
    fn without_a_window_all_end_at_the_same_time() {
        let mut session = session(&["compare", "e:0.03", "r:0.07", "--scene", "simple"]);
        session.run_to(1.0);
        assert_eq!(times(&session), [1.0, 1.0]);
        let errors: Vec<_> = session.panes.iter().map(|p| p.error.unwrap()).collect();
        assert!(errors[0] > 0.01 && errors[1] < 1e-5, "{errors:?}");
        let cost = session.panes[0].cost.unwrap();
        assert_eq!(cost.evaluations, 34.0);
        assert!(cost.computing > 0.0);
    }
}
