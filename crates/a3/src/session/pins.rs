//! Pins that the user sets, and lets go of.

use super::history::Change;
use super::state::Session;

impl Session {
    /// Pins particle i where it is in every run, or frees it if the first run has it pinned.
    pub fn toggle_pin(&mut self, i: usize) {
        let pinned = !self.is_pinned(i);
        if self.pin(&[i], pinned) > 0 {
            let now = if pinned { "pinned" } else { "free" };
            self.say(format!("particle {i} is {now} now"));
        }
    }

    /// Pins particles where they are in every run, or lets go of them, and says how many.
    pub fn pin_all(&mut self, particles: &[usize], pinned: bool) {
        let count = self.pin(particles, pinned);
        self.say(match (count, pinned) {
            (0, true) => "There is nothing here that could be pinned.".into(),
            (0, false) => "There are no pins here.".into(),
            (1, true) => "1 particle is pinned now.".into(),
            (1, false) => "1 particle is free now.".into(),
            (n, true) => format!("{n} particles are pinned now."),
            (n, false) => format!("{n} particles are free now."),
        });
    }

    /// Lets go of all pins.
    pub(super) fn free_all(&mut self) {
        let all: Vec<_> = (0..self.first().particles()).collect();
        self.pin_all(&all, false);
    }

    /// Whether the first run has particle i pinned.
    fn is_pinned(&self, i: usize) -> bool {
        let network = self.first().model().network();
        network.is_some_and(|network| network.is_pinned(i))
    }

    /// Pins or frees particles, notes what can be undone of that, and returns how many were changed
    /// in the first run.
    fn pin(&mut self, particles: &[usize], pinned: bool) -> usize {
        let before = particles.iter().copied();
        let other: Vec<_> = before.filter(|i| self.is_pinned(*i) != pinned).collect();
        self.set_pins(&other, pinned);
        let now = other.into_iter();
        let particles: Vec<_> = now.filter(|i| self.is_pinned(*i) == pinned).collect();
        let count = particles.len();
        if count > 0 {
            self.history.note(Change::Pins { particles, pinned });
        }
        count
    }

    /// Pins particles where they are in every run, or lets go of them.
    pub fn set_pins(&mut self, particles: &[usize], pinned: bool) {
        self.align();
        self.do_to_all(|run| {
            let mut set = |i: usize| {
                let network = run.model().network();
                if network.is_some_and(|network| network.is_pinned(i) != pinned) {
                    // One that a rigid body carries stays free.
                    let _ = run.toggle_pin(i);
                }
            };
            // Pins are kept in order: few are moved when the last ones are removed first.
            for k in 0..particles.len() {
                let at = if pinned { k } else { particles.len() - 1 - k };
                set(particles[at]);
            }
        });
    }
}

#[cfg(test)]
mod tests {
    use crate::hud::panel;
    use crate::session::{Action, compared, frames, session};

    #[test]
    fn pins_are_undone_and_done_again_in_every_run() {
        let mut session = compared(&["t:0.01", "r:0.01", "--scene", "mit"], 0.2);
        let pins = |session: &crate::session::Session| {
            let runs = session.panes.iter().map(|pane| &pane.simulation);
            runs.map(|run| run.model().network().unwrap().pins().count())
                .collect::<Vec<_>>()
        };
        assert_eq!(pins(&session), [2, 2]);
        session.pin_all(&[40, 41, 42, 0], true);
        let said = session.readings.message.clone().unwrap();
        assert_eq!(
            (pins(&session), &*said),
            (vec![5, 5], "3 particles are pinned now.")
        );
        session.act(Action::FreeAll, 0);
        assert_eq!(pins(&session), [0, 0]);
        frames(&mut session, 0.1);
        for expected in [5, 2] {
            panel::undo(&mut session, false);
            assert_eq!(pins(&session), [expected; 2]);
        }
        panel::undo(&mut session, false);
        assert_eq!(
            session.readings.message.as_deref(),
            Some("There is nothing to undo.")
        );
        panel::undo(&mut session, true);
        assert_eq!(pins(&session), [5, 5]);
        // Another scene knows of none of that.
        session.act(Action::NextScene, 0);
        panel::undo(&mut session, false);
        assert_eq!(
            session.readings.message.as_deref(),
            Some("There is nothing to undo.")
        );
    }

    #[test]
    fn what_cannot_be_pinned_is_said() {
        let mut circle = session(&["t", "0.01", "--scene", "simple"]);
        circle.pin_all(&[0], true);
        assert_eq!(
            circle.readings.message.as_deref(),
            Some("There is nothing here that could be pinned.")
        );
        circle.act(Action::FreeAll, 0);
        assert_eq!(
            circle.readings.message.as_deref(),
            Some("There are no pins here.")
        );
    }

    #[test]
    fn a_push_is_undone() {
        use a3_core::Vector3;
        let mut session = session(&["r", "0.005", "--scene", "mit-sphere"]);
        let place = |session: &crate::session::Session| {
            let run = session.first();
            let sphere = run.model().network().unwrap().obstacles()[0].clone();
            sphere.path.at(run.time()).position
        };
        let before = place(&session);
        assert!(session.grab_obstacle(0));
        session.pull(before + Vector3::new(0.2, 0.0, 0.0));
        frames(&mut session, 1.0);
        session.release();
        let pushed = place(&session);
        assert!((pushed - before).norm() > 0.1);
        panel::undo(&mut session, false);
        assert_eq!(place(&session), before);
        panel::undo(&mut session, true);
        assert_eq!(place(&session), pushed);
        // What was held and not moved is no change.
        assert!(session.grab_obstacle(0));
        session.release();
        panel::undo(&mut session, false);
        assert_eq!(place(&session), before);
    }
}
