//! Interaction with all runs of a session at the same simulated time: pulls, pushes, pins, and
//! changes of the model.

use a3_core::{Network, Path, Simulation, Vector3};

use super::history::{Change, States};
use super::reference::ReferenceRun;
use super::runs::{KEY_BUDGET, Runs};

impl Runs {
    /// Returns the runs that have not diverged, and the reference unless it was stopped.
    fn running(&mut self) -> impl Iterator<Item = &mut Simulation> {
        let alive = self.panes.iter_mut().filter(|pane| pane.alive());
        let reference = self.reference.as_mut().and_then(ReferenceRun::run);
        alive.map(|pane| &mut pane.simulation).chain(reference)
    }

    /// Changes every run at the same simulated time, including diverged ones, which keep the change
    /// after a reset.
    pub fn change_all(&mut self, change: impl FnMut(&mut Simulation)) {
        self.align();
        self.all_mut().for_each(change);
        for pane in &mut self.panes {
            pane.forces_changed();
        }
        self.read = None;
    }

    /// Changes the model of every run; a reset keeps the change. Fails, and changes nothing, if
    /// self-collision is on and surfaces would cross.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) -> Result<(), String> {
        self.change_unless_crossing(&change, |run| run.adjust(&change))
    }

    /// Applies a change to every run. `change` changes a copy of the network, which is checked
    /// before `apply` changes the runs. Fails, and changes nothing, if self-collision is on and
    /// surfaces would cross.
    fn change_unless_crossing(
        &mut self,
        change: impl Fn(&mut Network),
        apply: impl FnMut(&mut Simulation),
    ) -> Result<(), String> {
        let apart = |run: &Simulation| {
            let Some(network) = run.model().network() else {
                return Ok(());
            };
            if network.contact_layer().is_none() {
                return Ok(());
            }
            let mut changed = network.clone();
            change(&mut changed);
            let state = run.state();
            changed.check_apart(run.time(), changed.halves(state).0)
        };
        if let Some(why) = self.all().find_map(|run| apart(run).err()) {
            return Err(format!("Surfaces would cross: {why}"));
        }
        self.change_all(apply);
        Ok(())
    }

    /// Returns the present states of all runs.
    pub fn moments(&self) -> States {
        let runs = self.all();
        runs.map(|run| run.blow_up().is_none().then(|| run.moment())).collect()
    }

    /// Advances several panes to exactly the same time, by a shortened step if need be, so that an
    /// interaction starts at the same time in all.
    pub fn align(&mut self) {
        if self.panes.len() < 2 {
            return;
        }
        self.drop_due_steps();
        let clock = self.clock;
        if let Some(reference) = &mut self.reference
            && reference.run().is_some()
            && !reference.reach(clock, KEY_BUDGET)
        {
            reference.stop("the reference is too slow");
        }
        for run in self.running() {
            // A blow-up is stored in the run, and shown from now on.
            let _ = run.advance_to(clock);
        }
    }

    /// Turns self-collision on or off in every run. Fails, and changes nothing, if the scene has no
    /// surfaces or they cross in a run.
    pub(super) fn toggle_touch(&mut self) -> Result<(), String> {
        if self.first().scene().touch.is_none() {
            return Err("There are no surfaces here that could touch.".into());
        }
        let on = !self.first().touching();
        let mut refused = Ok(());
        self.change_all(|run| {
            if refused.is_ok() {
                refused = run.set_touching(on);
            }
        });
        if refused.is_err() {
            self.change_all(|run| {
                // Turning self-collision off does not fail.
                let _ = run.set_touching(!on);
            });
        }
        refused.map_err(|why| why.to_string())
    }

    /// Grabs something in every run, and returns whether any run allowed it.
    fn hold(&mut self, grab: impl Fn(&mut Simulation) -> bool) -> bool {
        self.align();
        let grabbed = self.running().fold(false, |held, run| held | grab(run));
        self.touched |= grabbed;
        grabbed
    }

    /// Grabs particle i in every run, and returns whether any run allowed it.
    pub fn grab(&mut self, i: usize) -> bool {
        self.hold(|run| run.grab(i).is_ok())
    }

    /// Grabs obstacle k in every run, and returns whether any run allowed it.
    pub fn grab_obstacle(&mut self, k: usize) -> bool {
        self.align();
        self.pushed = self.obstacle_path(k).map(|path| (k, path));
        self.hold(|run| run.grab_obstacle(k).is_ok())
    }

    /// Pulls the grabbed particle or obstacle towards the same point (m) in every run.
    pub fn pull(&mut self, target: Vector3<f64>) {
        self.running().for_each(|run| {
            run.pull(target);
            run.pull_obstacle(target);
        });
        for pane in &mut self.panes {
            pane.show.hand = Some(target);
        }
    }

    /// Releases the grabbed particle or obstacle. Returns the push of an obstacle, if it moved it.
    pub(super) fn release(&mut self) -> Option<Change> {
        let held = |run: &Simulation| run.grabbed().is_some() || run.grabbed_obstacle().is_some();
        if self.running().any(|run| held(run)) {
            self.align();
        }
        for run in self.all_mut() {
            run.release();
            run.release_obstacle();
        }
        self.hide_hand();
        let (obstacle, from) = self.pushed.take()?;
        let now = self.first().time();
        let mut to = self.obstacle_path(obstacle)?;
        let way = to.at(now).position - from.at(now).position;
        if !from.is_still_from(now) {
            // It goes on moving as before, about its new place.
            to = from.moved(way);
            for run in self.all_mut() {
                // The obstacle exists, because it was pushed.
                let _ = run.set_obstacle_path(obstacle, to);
            }
        }
        (way != Vector3::zeros()).then(|| Change::Push { obstacle, paths: Box::new([from, to]) })
    }

    /// Returns the path of obstacle k in the first run.
    fn obstacle_path(&self, k: usize) -> Option<Path> {
        let network = self.first().model().network()?;
        Some(network.obstacles().get(k)?.path)
    }

    /// Moves an obstacle to a path in every run. Fails, and changes nothing, if self-collision is
    /// on and surfaces would cross.
    pub fn set_obstacle_path(&mut self, obstacle: usize, path: Path) -> Result<(), String> {
        let lead = |network: &mut Network| {
            // The obstacle exists, because it was pushed.
            let _ = network.lead_obstacle(obstacle, path);
        };
        self.change_unless_crossing(lead, |run| {
            let _ = run.set_obstacle_path(obstacle, path);
        })
    }

    /// Returns whether particle i is pinned in the first run.
    pub(super) fn is_pinned(&self, i: usize) -> bool {
        let network = self.first().model().network();
        network.is_some_and(|network| network.is_pinned(i))
    }

    /// Pins particles at their positions in every run, or frees them. Returns those that changed in
    /// the first run.
    pub(super) fn pin(&mut self, particles: &[usize], pinned: bool) -> Vec<usize> {
        let before = particles.iter().copied();
        let other: Vec<_> = before.filter(|i| self.is_pinned(*i) != pinned).collect();
        self.set_pins(&other, pinned);
        let now = other.into_iter();
        now.filter(|i| self.is_pinned(*i) == pinned).collect()
    }

    /// Pins particles at their positions in every run, or frees them.
    pub fn set_pins(&mut self, particles: &[usize], pinned: bool) {
        self.align();
        self.touched = true;
        for run in self.all_mut() {
            let mut set = |i: usize| {
                let network = run.model().network();
                if network.is_some_and(|network| network.is_pinned(i) != pinned) {
                    // A particle of a rigid body cannot be pinned.
                    let _ = run.toggle_pin(i);
                }
            };
            // Pins are a sorted array: removing the last ones first moves few others.
            for k in 0..particles.len() {
                let at = if pinned { k } else { particles.len() - 1 - k };
                set(particles[at]);
            }
        }
    }

    /// Hides the line from a grabbed particle to the pointer.
    pub(super) fn hide_hand(&mut self) {
        for pane in &mut self.panes {
            pane.show.hand = None;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::session::{RunAction, Session, compared, frames, session, times};

    use super::*;
    use a3_core::contact::Shape;

    #[test]
    fn a_released_sphere_stays_where_it_was_pushed() {
        let mut session = session(&["r", "0.005", "--scene", "mit-sphere"]);
        let place = |session: &Session| {
            let run = session.runs.first();
            let sphere = run.model().network().unwrap().obstacles()[0].clone();
            sphere.path.at(run.time()).position
        };
        let before = place(&session);
        assert!(session.runs.grab_obstacle(0));
        session.runs.pull(before + Vector3::new(0.2, 0.0, 0.0));
        frames(&mut session, 1.0);
        session.release();
        assert_eq!(session.runs.first().grabbed_obstacle(), None);
        let pushed = place(&session);
        assert!((pushed - before).norm() > 0.1);
        session.runs.pull(before);
        frames(&mut session, 1.0);
        assert_eq!(place(&session), pushed);
    }

    #[test]
    fn surfaces_touch_in_every_run_or_in_none() {
        let mut session = compared(&["r:0.013", "r:0.005", "--scene", "mit-sphere"], 0.1);
        let touching = |session: &Session| {
            let panes = session.runs.panes.iter();
            let mut touching: Vec<_> = panes.map(|pane| pane.simulation.touching()).collect();
            touching.extend(session.runs.reference.as_ref().map(|r| r.simulation.touching()));
            touching
        };
        session.act(RunAction::Touch, 0);
        assert_eq!(touching(&session), [true; 3]);
        assert_eq!(session.readings.message, None);
        // A sphere is not enlarged into the cloth.
        let radius = |session: &Session| {
            let network = session.runs.first().model().network().unwrap();
            network.obstacles()[0].shape.clone()
        };
        let own = radius(&session);
        session.adjust(|network| {
            let shape = Shape::Sphere { radius: 4.5 };
            network.reshape_obstacle(0, shape).unwrap();
        });
        let said = session.readings.message.clone().unwrap();
        assert!(said.starts_with("Surfaces would cross: "), "{said}");
        assert!(said.contains("obstacle 0"), "{said}");
        assert_eq!(radius(&session), own);
        session.act(RunAction::Touch, 0);
        assert_eq!(touching(&session), [false; 3]);
        // If surfaces cross in one run, self-collision changes in none.
        let shape = Shape::Sphere { radius: 4.5 };
        let last = &mut session.runs.panes[1].simulation;
        last.adjust(|network| network.reshape_obstacle(0, shape.clone()).unwrap());
        session.act(RunAction::Touch, 0);
        let said = session.readings.message.clone().unwrap();
        assert!(said.starts_with("Surfaces that cross cannot begin to touch: "), "{said}");
        assert_eq!(touching(&session), [false; 3]);
        let mut session = crate::session::session(&["e", "0.01", "--scene", "simple"]);
        session.act(RunAction::Touch, 0);
        let said = session.readings.message.unwrap();
        assert_eq!(said, "There are no surfaces here that could touch.");
    }

    #[test]
    fn a_pin_is_set_in_every_run_at_the_same_time() {
        let mut session = compared(&["r:0.013", "r:0.005", "--scene", "cloth"], 0.3);
        session.toggle_pin(210);
        let times = times(&session);
        assert_eq!(times[0], times[1]);
        let pinned = |session: &Session| {
            let networks =
                session.runs.panes.iter().map(|p| p.simulation.model().network().unwrap());
            networks.map(|n| n.is_pinned(210)).collect::<Vec<_>>()
        };
        assert_eq!(pinned(&session), [true, true]);
        frames(&mut session, 0.3);
        assert!(session.runs.panes.iter().all(|pane| pane.error.unwrap() < 2e-3));
        session.toggle_pin(210);
        assert_eq!(pinned(&session), [false, false]);
    }

    /// Every interaction with the panes acts on the reference too, at the same time.
    #[test]
    fn the_reference_gets_the_same_interaction() {
        let mut session = compared(&["r:0.013", "r:0.005", "--scene", "cloth"], 0.5);
        let small = |session: &Session, what: &str| {
            let errors: Vec<_> = session.runs.panes.iter().map(|pane| pane.error).collect();
            assert!(errors.iter().all(|e| e.is_some_and(|e| e < 2e-3)), "{what}: {errors:?}");
        };
        small(&session, "still");
        session.act(RunAction::Swing, 0);
        let aligned = times(&session);
        assert_eq!(aligned[0], aligned[1]);
        frames(&mut session, 0.5);
        small(&session, "swinging");
        session.act(RunAction::Wind, 0);
        frames(&mut session, 0.5);
        small(&session, "in the wind");
        assert!(session.runs.grab(399));
        for _ in 0..20 {
            session.runs.pull(Vector3::new(1.0, 1.0, 1.5));
            frames(&mut session, 1.0 / 60.0);
        }
        let places = session.runs.panes.iter().map(|pane| pane.simulation.position(399));
        assert!(places.clone().all(|p| (p - Vector3::new(1.0, 1.0, 1.5)).norm() < 0.1));
        session.release();
        frames(&mut session, 0.2);
        // Each run pulled its particle from another position.
        assert!(session.runs.panes.iter().all(|pane| pane.error.unwrap() < 0.1));
        session.act(RunAction::Reset, 0);
        assert_eq!(times(&session), [0.0, 0.0]);
        frames(&mut session, 0.5);
        small(&session, "again");
    }
}
