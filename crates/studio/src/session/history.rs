//! The history of the user's changes, for undo and redo.

use std::sync::Arc;
use web_time::{Duration, Instant};

use a3_core::{Checkpoint, Path};

use super::origin::{Origin, Passage};

/// Largest number of changes in the history.
const MAX_CHANGES: usize = 200;
/// Largest number of the latest changes whose states are kept.
const MAX_STATES: usize = 8;
/// Longest time between two turns of a knob by keys that count as one change.
const MERGE_TIME: Duration = Duration::from_millis(800);

/// States of all runs at one time; `None` for a run that has blown up.
pub type States = Arc<[Option<Checkpoint>]>;

/// A change that can be undone.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Particles were pinned or freed.
    Pins { particles: Vec<usize>, pinned: bool },
    /// An obstacle was pushed: its paths before and after.
    Push { obstacle: usize, paths: Box<[Path; 2]> },
    /// A knob was turned: its row in the table, its pane, and its value before and after.
    Knob { row: usize, pane: usize, from: f64, to: f64 },
    /// A part of the scene was left out, or brought back: its index, and whether it is in since.
    Part { part: usize, is_in: bool },
    /// Surfaces came apart to touch.
    Apart,
    /// The scene was edited.
    Edit(Arc<EditChange>),
}

/// A change in the history, with the states from which the runs go on.
#[derive(Clone, Debug, PartialEq)]
pub struct Recorded {
    pub change: Change,
    /// The states before the change, to which undoing it goes back, and those in which it was
    /// undone, to which redoing it goes back; `None` where the runs go on as they are, or these
    /// states are forgotten.
    pub states: [Option<States>; 2],
}

impl Recorded {
    /// Returns whether redoing the change goes back to the states in which it was undone: what it
    /// had added has moved since, or undoing it went back in time.
    pub fn returns(&self) -> bool {
        self.states[0].is_some() || matches!(self.change, Change::Edit(_))
    }
}

/// An edit of the scene, as a change that can be undone.
pub struct EditChange {
    /// What was done, in words.
    pub name: String,
    /// The scene before the edit, and after it.
    pub origins: [Origin; 2],
    /// Passages of the runs back to the scene before the edit, and to the one after it.
    pub passages: [Passage; 2],
}

impl PartialEq for EditChange {
    fn eq(&self, other: &Self) -> bool {
        (&self.name, &self.passages) == (&other.name, &other.passages)
    }
}

impl std::fmt::Debug for EditChange {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.name)
    }
}

/// Changes that were made, and those that were undone, the latest last.
#[derive(Default)]
pub struct History {
    done: Vec<Recorded>,
    undone: Vec<Recorded>,
    /// Time of the last change, `None` after a button was pressed or a change undone.
    last: Option<Instant>,
    /// Whether a mouse button is pressed.
    held: bool,
}

impl History {
    /// Records a change with the states before it, if undoing it goes back to them, and drops the
    /// undone changes. A turn of a knob extends the last change if it follows soon, or in the same
    /// drag.
    pub fn record(&mut self, change: Change, before: Option<States>) {
        let soon = self.last.is_some_and(|last| self.held || last.elapsed() < MERGE_TIME);
        self.last = Some(Instant::now());
        self.undone.clear();
        if let Change::Knob { row, pane, to, .. } = change
            && let Some(Change::Knob { row: last_row, pane: last_pane, to: last_to, .. }) =
                self.done.last_mut().map(|last| &mut last.change)
            && soon
            && (*last_row, *last_pane) == (row, pane)
        {
            *last_to = to;
            return;
        }
        self.done.push(Recorded { change, states: [before, None] });
        self.forget_states(MAX_STATES, |_| true);
        if self.done.len() > MAX_CHANGES {
            self.done.remove(0);
        }
    }

    /// Records that a mouse button was pressed or released. All turns of a knob in one drag are one
    /// change.
    pub fn set_button_held(&mut self, held: bool) {
        if held {
            self.last = None;
        }
        self.held = held;
    }

    /// Returns the change to undo, or with `redo` the change to redo.
    pub fn next(&self, redo: bool) -> Option<&Recorded> {
        if redo { &self.undone } else { &self.done }.last()
    }

    /// Records that the next change was undone, from states `now` if redoing it goes back to them,
    /// or with `redo` was redone.
    pub fn step(&mut self, redo: bool, now: Option<States>) {
        let (from, to) = if redo {
            (&mut self.undone, &mut self.done)
        } else {
            (&mut self.done, &mut self.undone)
        };
        if let Some(mut recorded) = from.pop() {
            if !redo {
                recorded.states[1] = now;
            }
            to.push(recorded);
        }
        self.last = None;
        self.forget_states(MAX_STATES, |_| true);
    }

    /// Forgets the states of all but the `latest` of some changes: undoing or redoing the others
    /// leaves the runs in their states.
    fn forget_states(&mut self, latest: usize, which: impl Fn(&Change) -> bool) {
        let all = self.done.iter_mut().rev().chain(self.undone.iter_mut());
        let with = all.filter(|it| it.states.iter().any(Option::is_some) && which(&it.change));
        with.skip(latest).for_each(|it| it.states = [None, None]);
    }

    /// Forgets the states of the present scene, because a new run of it begins.
    pub fn begin_new_run(&mut self) {
        self.forget_states(0, |change| !matches!(change, Change::Edit(_)));
    }

    /// Forgets all states, because the runs begin again.
    pub fn begin_again(&mut self) {
        self.forget_states(0, |_| true);
    }

    /// Clears the history.
    pub fn clear(&mut self) {
        *self = Self::default();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::panel;
    use crate::session::{RunAction, compared, frames, session};

    #[test]
    fn a_drag_is_one_change_and_a_new_change_drops_the_undone_ones() {
        let knob = |row, from: f64, to: f64| Change::Knob { row, pane: 0, from, to };
        let step = |history: &mut History, redo| {
            let next = history.next(redo).map(|it| it.change.clone());
            history.step(redo, None);
            next
        };
        let mut history = History::default();
        for (from, to) in [(1.0, 2.0), (2.0, 3.0), (3.0, 4.0)] {
            history.record(knob(5, from, to), None);
        }
        // Another drag of the same knob is another change, even right after the first.
        history.set_button_held(true);
        history.record(knob(5, 4.0, 5.0), None);
        history.record(knob(5, 5.0, 6.0), None);
        history.set_button_held(false);
        assert_eq!(step(&mut history, false), Some(knob(5, 4.0, 6.0)));
        history.record(knob(6, 0.0, 1.0), None);
        assert_eq!(step(&mut history, false), Some(knob(6, 0.0, 1.0)));
        assert_eq!(step(&mut history, false), Some(knob(5, 1.0, 4.0)));
        assert_eq!(step(&mut history, false), None);
        assert_eq!(step(&mut history, true), Some(knob(5, 1.0, 4.0)));
        history.record(knob(7, 0.0, 1.0), None);
        assert_eq!(step(&mut history, true), None);
        for k in 0..300 {
            let change = Change::Pins { particles: vec![k], pinned: true };
            history.record(change, None);
        }
        assert_eq!(history.done.len(), MAX_CHANGES);
    }

    #[test]
    fn pins_are_undone_and_redone_in_every_run() {
        let mut session = compared(&["t:0.01", "r:0.01", "--scene", "mit"], 0.2);
        let pins = |session: &crate::session::Session| {
            let runs = session.runs.panes.iter().map(|pane| &pane.simulation);
            runs.map(|run| run.model().network().unwrap().pins().count()).collect::<Vec<_>>()
        };
        assert_eq!(pins(&session), [2, 2]);
        session.pin_all(&[40, 41, 42, 0], true);
        let said = session.readings.message.clone().unwrap();
        assert_eq!((pins(&session), &*said), (vec![5, 5], "3 particles are pinned now."));
        session.act(RunAction::FreeAll, 0);
        assert_eq!(pins(&session), [0, 0]);
        frames(&mut session, 0.1);
        for expected in [5, 2] {
            panel::undo(&mut session, false);
            assert_eq!(pins(&session), [expected; 2]);
        }
        panel::undo(&mut session, false);
        assert_eq!(session.readings.message.as_deref(), Some("There is nothing to undo."));
        panel::undo(&mut session, true);
        assert_eq!(pins(&session), [5, 5]);
        // Another scene starts with an empty history.
        session.act(RunAction::NextScene, 0);
        panel::undo(&mut session, false);
        assert_eq!(session.readings.message.as_deref(), Some("There is nothing to undo."));
    }

    #[test]
    fn undoing_a_release_brings_the_cloth_back_where_it_was() {
        let mut session = compared(&["t:0.01", "v:0.01", "--scene", "cloth"], 0.5);
        session.readings.in_window = true;
        let states = |session: &crate::session::Session| {
            let runs = session.runs.panes.iter().map(|pane| &pane.simulation);
            runs.map(|run| (run.time(), run.state().to_vec())).collect::<Vec<_>>()
        };
        session.runs.align();
        let before = states(&session);
        session.act(RunAction::FreeAll, 0);
        frames(&mut session, 1.0);
        let fallen = session.runs.first().position(0).y;
        panel::undo(&mut session, false);
        assert_eq!(states(&session), before);
        assert!(session.runs.first().position(0).y > fallen + 1.0);
        let pins = session.runs.first().model().network().unwrap().pins();
        assert_eq!(pins.count(), 20);
        // The run goes on from there, and is recorded.
        frames(&mut session, 0.2);
        assert!((session.runs.first().time() - before[0].0 - 0.2).abs() < 0.02);
        assert!((session.readings.timeline.unwrap().span - 0.2).abs() < 0.03);
        // After a reset, the state is another run's.
        session.act(RunAction::FreeAll, 0);
        session.act(RunAction::Reset, 0);
        panel::undo(&mut session, false);
        assert_eq!(session.runs.first().time(), 0.0);
    }

    #[test]
    fn a_message_says_that_nothing_can_be_pinned() {
        let mut circle = session(&["t", "0.01", "--scene", "simple"]);
        circle.pin_all(&[0], true);
        assert_eq!(
            circle.readings.message.as_deref(),
            Some("There is nothing here that could be pinned.")
        );
        circle.act(RunAction::FreeAll, 0);
        assert_eq!(circle.readings.message.as_deref(), Some("There are no pins here."));
    }

    #[test]
    fn a_push_is_undone() {
        use a3_core::Vector3;
        let mut session = session(&["r", "0.005", "--scene", "mit-sphere"]);
        let place = |session: &crate::session::Session| {
            let run = session.runs.first();
            let sphere = run.model().network().unwrap().obstacles()[0].clone();
            sphere.path.at(run.time()).position
        };
        let before = place(&session);
        assert!(session.runs.grab_obstacle(0));
        session.runs.pull(before + Vector3::new(0.2, 0.0, 0.0));
        frames(&mut session, 1.0);
        session.release();
        let pushed = place(&session);
        assert!((pushed - before).norm() > 0.1);
        panel::undo(&mut session, false);
        assert_eq!(place(&session), before);
        panel::undo(&mut session, true);
        assert_eq!(place(&session), pushed);
        // A grab without a motion is not a change.
        assert!(session.runs.grab_obstacle(0));
        session.release();
        panel::undo(&mut session, false);
        assert_eq!(place(&session), before);
    }
}
