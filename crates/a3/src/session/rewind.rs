//! Going back on the timeline, and on again.

use std::time::Duration;

use a3_core::{Checkpoint, Error};

use super::reference::ReferenceRun;
use super::state::Session;

impl Session {
    /// Pauses and goes `by` kept moments on, or back if it is negative. The runs go on from the
    /// moment that is shown.
    pub fn scrub(&mut self, by: isize) {
        self.pause_to_scrub();
        if self.timeline.go(by) {
            self.show_moment();
        } else if by < 0 {
            self.say("There is nothing earlier to go back to.");
        }
    }

    /// Pauses and goes to a share of the kept time: 0 is the oldest moment, 1 the newest.
    pub fn scrub_to(&mut self, share: f32) {
        self.pause_to_scrub();
        if self.timeline.go_to(share) {
            self.show_moment();
        }
    }

    /// Pauses, and keeps the newest states to come back to.
    fn pause_to_scrub(&mut self) {
        self.readings.paused = true;
        if self.readings.rewound.is_none() {
            self.settle();
            self.keep(true);
        }
    }

    /// Gives all runs the states of the moment that is shown.
    fn show_moment(&mut self) {
        let panes = self.panes.iter_mut().map(|pane| &mut pane.simulation);
        let reference = self.reference.as_mut().map(ReferenceRun::any_run);
        self.timeline.show(panes.chain(reference));
        for pane in &mut self.panes {
            pane.set_errors(vec![]);
            pane.restart_cost();
        }
        if let Some(reference) = &mut self.reference {
            reference.follow(&mut self.panes, Duration::ZERO);
        }
        self.readings.rewound = self.timeline.position();
        self.hide_hand();
        self.start_anew();
    }

    /// The states of all runs over the last seconds that are kept, as
    /// [`Timeline::last`](super::timeline::Timeline::last) has them.
    pub fn kept_moments(&self, seconds: f64, interval: f64) -> Vec<Vec<Option<Checkpoint>>> {
        self.timeline.last(seconds, interval)
    }

    /// Takes the first run up where it was kept in a checkpoint. A hand lets go.
    pub fn take_up(&mut self, checkpoint: &Checkpoint) -> Result<(), Error> {
        let pane = &mut self.panes[0];
        pane.simulation.restore(checkpoint)?;
        pane.simulation.release();
        pane.simulation.release_obstacle();
        pane.wanted = pane.simulation.method();
        pane.show.clear_trail();
        pane.forces_changed();
        pane.restart_cost();
        self.clear_timeline();
        self.start_anew();
        Ok(())
    }

    /// Clears the timeline, because another run begins.
    pub(super) fn clear_timeline(&mut self) {
        self.timeline.clear();
        self.readings.rewound = None;
        self.hide_hand();
    }
}

#[cfg(test)]
mod tests {
    use crate::session::keys::Action;
    use crate::session::{frames, session};

    /// Back, on again to where it was, and from the middle a second time: the same to the bit.
    #[test]
    fn what_was_comes_back_to_the_bit_and_goes_on_from_there() {
        let mut session = session(&["t", "0.01", "--scene", "cloth"]);
        session.readings.in_window = true;
        frames(&mut session, 1.0);
        let newest = (session.first().time(), session.first().state().to_vec());
        session.act(Action::Scrub(-10), 0);
        let place = session.readings.rewound.unwrap();
        assert!(
            session.readings.paused && (place.back - 1.0 / 6.0).abs() < 0.02,
            "{place:?}"
        );
        let (time, steps) = (session.first().time(), session.first().steps());
        assert!(time < newest.0 && (time - 0.01 * steps as f64).abs() < 1e-9);
        let then = session.first().state().to_vec();
        // Nothing goes on by itself.
        session.tick(0.1);
        assert_eq!(session.first().state(), then);
        session.act(Action::Step, 0);
        session.act(Action::Scrub(10), 0);
        assert_eq!(session.readings.rewound, None);
        assert_eq!(
            (session.first().time(), session.first().state()),
            (newest.0, &newest.1[..])
        );
        session.act(Action::Scrub(-10), 0);
        assert_eq!(session.first().state(), then);
        session.act(Action::Pause, 0);
        while session.first().time() < newest.0 - 1e-9 {
            session.tick(0.01);
        }
        assert_eq!(
            (session.first().state(), session.readings.rewound),
            (&newest.1[..], None)
        );
        session.act(Action::Reset, 0);
        session.act(Action::Scrub(-1), 0);
        assert_eq!(
            (session.first().time(), session.readings.rewound),
            (0.0, None)
        );
    }

    #[test]
    fn going_back_undoes_a_blow_up() {
        let mut session = session(&["r", "0.05", "--scene", "mit"]);
        session.readings.in_window = true;
        while session.panes[0].alive() {
            session.tick(1.0 / 60.0);
        }
        session.act(Action::Scrub(-10), 0);
        assert!(session.panes[0].alive() && session.readings.rewound.is_some());
    }
}
