//! Interaction with a run: what its scene shows, and how it can be disturbed.

use nalgebra::{DMatrixView, Vector3};

use super::disturbances::{check_touch, let_touch, touches_itself};
use super::hand::Hand;
use super::pins::{Grabbed, leave, leave_all_but, own_release, pin, unpin_all_but};
use super::run::Simulation;
use super::state::RunState;
use crate::columns::row;
use crate::control::Control;
use crate::elements::Wind;
use crate::energy::Energy;
use crate::error::Error;
use crate::integrators::Method;
use crate::network::{Network, let_go};
use crate::path::Path;
use crate::pin::Pin;
use crate::scene::{Disturbances, Model};

impl Simulation {
    /// Returns the model as it is now, with its current pins, obstacles, wind and tears.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Returns the state y: of a network [x | v], in m and m/s, and after these the rotation of
    /// each rigid body.
    #[must_use]
    pub fn state(&self) -> &[f64] {
        &self.state.y
    }

    /// Returns the number of particles; 0 where the state is plain numbers.
    #[must_use]
    pub fn particles(&self) -> usize {
        self.model.particles()
    }

    /// Returns the positions (m), n x 3.
    #[must_use]
    pub fn positions(&self) -> DMatrixView<'_, f64> {
        let n = self.particles();
        DMatrixView::from_slice(&self.state.y[..3 * n], n, 3)
    }

    /// Returns the position of particle i (m).
    ///
    /// # Panics
    /// There is no such particle.
    #[must_use]
    pub fn position(&self, i: usize) -> Vector3<f64> {
        let n = self.particles();
        row(&self.state.y[..3 * n], n, i)
    }

    /// Returns the velocities (m/s), n x 3 in column-major order: of particles with masses from the
    /// state, of points from f. Without particles, the rates of change of the state.
    #[must_use]
    pub fn velocities(&self) -> Vec<f64> {
        let (_, velocities) = self.model.motion(self.time(), &self.state.y);
        velocities.into_owned()
    }

    /// Returns the energy (J), if the scene has forces.
    #[must_use]
    pub fn energy(&self) -> Option<Energy> {
        let network = self.model.network();
        network.map(|network| network.energy_of(self.time(), &self.state.y))
    }

    /// Returns the height of the lowest particle (m); 0 without particles.
    #[must_use]
    pub fn lowest(&self) -> f64 {
        self.positions().column(1).min()
    }

    /// Returns the length over rest length of the most stretched structural spring, or the largest
    /// principal stretch of a solid, if there is any.
    #[must_use]
    pub fn largest_stretch(&self) -> Option<f64> {
        let x = &self.state.y[..3 * self.particles()];
        self.model.network()?.largest_stretch(x)
    }

    /// Returns the number of springs that have broken.
    #[must_use]
    pub fn tears(&self) -> usize {
        self.model.network().map_or(0, Network::tears)
    }

    /// Returns the middle of the scene as it began, and the distance of its farthest particle from
    /// there, at least 1 (m).
    #[must_use]
    pub fn extent(&self) -> (Vector3<f64>, f64) {
        let bounds = &self.driver.pipeline.bounds;
        (bounds.middle, bounds.radius)
    }

    /// Returns the contact forces on the particles (N), n x 3: those of surfaces as they are now,
    /// and the impulses of obstacles, friction and the collision safeguard in the last step,
    /// divided by its length. After the run went to another state, these impulses are unknown until
    /// the next step. `None` if nothing can touch.
    #[must_use]
    pub fn contact_forces(&self) -> Option<Vec<f64>> {
        let network = self.model.network().filter(|n| n.can_touch())?;
        let phases = &self.driver.pipeline.phases;
        Some(phases.contact_forces(network, self.time(), &self.state.y))
    }

    /// Ends the step at the time shown (s), changes the network and the state, and makes velocities
    /// fit the constraints.
    fn disturb<T>(
        &mut self,
        change: impl FnOnce(&mut Network, &mut RunState, f64) -> T,
    ) -> Option<T> {
        let time = self.time();
        self.stop();
        let (Model::Network(network), state) = (&mut self.model, &mut self.state) else {
            return None;
        };
        let changed = change(network, state, time);
        self.driver.pipeline.fit(network, state, time);
        Some(changed)
    }

    /// Ends the step at the time shown.
    pub(super) fn stop(&mut self) {
        self.driver.stop(&mut self.model, &mut self.state);
    }

    /// Recreates the integrator after the system changed: it sizes its scratch by the system.
    fn refit(&mut self) {
        let stepper = &mut self.driver.pipeline.stepper;
        stepper.refit(self.state.method, self.model.system());
    }

    /// Changes both the current model and the one that a reset goes back to. The state and the time
    /// stay. Does nothing in a scene without masses.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) {
        self.stop();
        for model in [&mut self.model, &mut self.scene.model] {
            if let Model::Network(network) = model {
                change(network);
            }
        }
        self.refit();
    }

    /// Returns whether the wind blows.
    #[must_use]
    pub fn windy(&self) -> bool {
        let network = self.model.network();
        network.is_some_and(|network| network.wind().is_some())
    }

    /// Switches the scene's wind on or off. A scene without wind stays as it is.
    pub fn set_wind(&mut self, on: bool) {
        let wind = self.scene.wind.filter(|_| on);
        self.disturb(|network, _, _| network.set_wind(wind));
    }

    /// Replaces the scene's wind. A scene without wind stays without.
    pub fn change_wind(&mut self, wind: Wind) {
        if self.scene.wind.is_some() {
            self.scene.wind = Some(wind);
            self.set_wind(self.windy());
        }
    }

    /// Returns whether the pins swing.
    #[must_use]
    pub fn swinging(&self) -> bool {
        self.state.swinging
    }

    /// Swings the pins from where they are, or stops them there. A scene without swing stays as it
    /// is.
    pub fn set_swinging(&mut self, on: bool) {
        let Some(swing) = self.scene.swing.filter(|_| on != self.state.swinging) else {
            return;
        };
        let turn = swing.rate * self.time();
        self.state.swing_phase += if on { -turn } else { turn };
        self.state.swinging = on;
        let (swing, held) = (on.then_some(swing), self.grabbed());
        self.disturb(|network, state, _| {
            let (swing, time) = ((swing, state.swing_phase), state.time());
            leave_all_but(held, network, &mut state.y, swing, time);
        });
    }

    /// Returns whether surfaces touch one another and themselves.
    #[must_use]
    pub fn touching(&self) -> bool {
        self.model.network().is_some_and(touches_itself)
    }

    /// Lets the scene's surfaces touch one another and themselves, or pass through. A scene without
    /// surfaces stays as it is. A reset keeps this setting, unless surfaces cross at the beginning.
    ///
    /// # Errors
    /// Surfaces cross now, and the error names the first pair; or the method does not support
    /// contact. The run then continues as before.
    pub fn set_touching(&mut self, on: bool) -> Result<(), Error> {
        let network = self.model.network().filter(|_| self.scene.touch.is_some());
        let Some(network) = network.filter(|_| on != self.touching()) else {
            return Ok(());
        };
        if on {
            let state = (self.time(), &*self.state.y);
            check_touch(network, &self.scene, state, self.state.method)?;
        }
        // Where surfaces touch, a spring attracts a grabbed particle that is pinned elsewhere.
        let held = self.grabbed();
        self.release();
        self.stop();
        if let Model::Network(network) = &mut self.model {
            let_touch(network, &self.scene, on)?;
        }
        self.refit();
        held.map_or(Ok(()), |i| self.grab(i))
    }

    /// Returns the disturbances that act.
    #[must_use]
    pub fn disturbances(&self) -> Disturbances {
        Disturbances { wind: self.windy(), swing: self.swinging(), contact: self.touching() }
    }

    /// Switches the scene's disturbances on or off, those of `on` and the others. A scene that does
    /// not allow one stays without.
    ///
    /// # Errors
    /// Surfaces that are to touch cross, and the error names the first pair; or the method does not
    /// support contact. Wind and swing are switched nevertheless.
    pub fn set_disturbances(&mut self, on: Disturbances) -> Result<(), Error> {
        if on.wind != self.windy() {
            self.set_wind(on.wind);
        }
        self.set_swinging(on.swing);
        self.set_touching(on.contact)
    }

    /// Creates a run from the start of the same scene with the disturbances that act now, and with
    /// freed pins if they are free now, by a method in fixed steps or to a tolerance.
    ///
    /// # Errors
    /// The method does not support the scene or the control; or surfaces cross at the start, where
    /// they cannot begin to touch.
    pub fn anew(&self, method: &'static Method, control: Control) -> Result<Self, Error> {
        let mut begun = Self::new(self.scene().clone(), method, control)?;
        begun.set_pinned(self.pinned());
        begun.set_disturbances(self.disturbances())?;
        Ok(begun)
    }

    /// Returns whether the scene's pins hold.
    #[must_use]
    pub fn pinned(&self) -> bool {
        !self.state.unpinned
    }

    /// Frees all pinned particles except the one in the hand, or pins those of the scene again,
    /// where they are now.
    pub fn set_pinned(&mut self, on: bool) {
        if on == self.pinned() {
            return;
        }
        self.state.unpinned = !on;
        if !on {
            let held = self.grabbed();
            if let Some(grabbed) = &mut self.state.grabbed {
                grabbed.was_pinned = false;
            }
            self.disturb(|network, _, _| unpin_all_but(held, network));
            return;
        }
        let own = self.scene.model.network();
        let own = own.into_iter().flat_map(Network::all_pins);
        let own: Vec<_> = own.filter(|pin| pin.holds_at(self.time())).collect();
        for i in own.into_iter().map(|pin| pin.particle) {
            match &mut self.state.grabbed {
                Some(grabbed) if grabbed.particle == i => grabbed.was_pinned = true,
                _ => self.leave_pin(i),
            }
        }
    }

    /// Pins particle i where it is, swinging if the pins do, or unpins it. Returns whether it is
    /// pinned now. For a grabbed particle this takes effect when the hand lets go. Does nothing in
    /// a scene without masses.
    ///
    /// # Errors
    /// There is no such particle, or it belongs to a rigid body.
    pub fn toggle_pin(&mut self, i: usize) -> Result<bool, Error> {
        let Some(network) = self.model.network() else {
            return Ok(false);
        };
        network.check_kinematic(i)?;
        let pinned = network.is_pinned(i);
        let grabbed = self.state.grabbed.as_mut();
        if let Some(grabbed) = grabbed.filter(|held| held.particle == i) {
            grabbed.was_pinned = !grabbed.was_pinned;
            return Ok(grabbed.was_pinned);
        }
        if pinned {
            self.disturb(|network, _, _| network.unpin(i));
        } else {
            self.leave_pin(i);
        }
        Ok(!pinned)
    }

    /// Pins particle i where it is, or swings it from there, up to the time at which the scene lets
    /// go of it.
    pub(super) fn leave_pin(&mut self, i: usize) {
        let swing = self.scene.swing.filter(|_| self.state.swinging);
        let path = leave(self.position(i), swing, self.state.swing_phase, self.time());
        let mut left = Pin::new(i, path);
        left.until = own_release(&self.scene, i, self.time());
        self.disturb(|network, state, time| pin(network, &mut state.y, left, time));
    }

    /// Returns the number of the grabbed particle.
    #[must_use]
    pub fn grabbed(&self) -> Option<usize> {
        self.state.grabbed.map(|grabbed| grabbed.particle)
    }

    /// Grabs particle i, and lets go of any other. The particle becomes a pin; or a spring attracts
    /// it, if constraints act on it or surfaces can touch. Does nothing in a scene without masses.
    ///
    /// # Errors
    /// There is no such particle.
    pub fn grab(&mut self, i: usize) -> Result<(), Error> {
        self.release();
        if let Some(hand) = self.hand() {
            self.lead(hand.grab(i)?);
        }
        Ok(())
    }

    /// Pulls the grabbed particle towards `target` (m), which it reaches within 1/30 s unless that
    /// is too fast, or springs or rods hold it back: the hand stretches a spring as far as the
    /// scene allows, a rod hardly at all, and continues as the other end follows.
    pub fn pull(&mut self, target: Vector3<f64>) {
        if let Some((hand, grabbed)) = self.hand().zip(self.state.grabbed) {
            self.lead(hand.pull(grabbed, target));
        }
    }

    /// Lets go of the grabbed particle. One that was free keeps the speed of the hand; one that was
    /// pinned is pinned where it is.
    pub fn release(&mut self) {
        let Some(grabbed) = self.state.grabbed.take() else {
            return;
        };
        self.disturb(|network, _, _| {
            network.unpin(grabbed.particle);
            let_go(network);
        });
        if grabbed.was_pinned {
            self.leave_pin(grabbed.particle);
        }
    }

    /// Moves the grabbed particle along its path.
    fn lead(&mut self, grabbed: Grabbed) {
        self.disturb(|network, state, time| {
            state.grabbed = Some(grabbed);
            grabbed.lead(network, &mut state.y, time);
        });
    }

    /// Returns the hand, if the scene has masses.
    fn hand(&self) -> Option<Hand<'_>> {
        Hand::of(&self.scene, &self.model, &self.state, self.extent().1)
    }

    /// Returns the number of the grabbed obstacle.
    #[must_use]
    pub fn grabbed_obstacle(&self) -> Option<usize> {
        self.state.grabbed_obstacle
    }

    /// Grabs obstacle k where it is, and lets go of any other. Does nothing in a scene without
    /// masses, where obstacles push nothing.
    ///
    /// # Errors
    /// There is no such obstacle, or it is a floor.
    pub fn grab_obstacle(&mut self, k: usize) -> Result<(), Error> {
        self.release_obstacle();
        let Some(hand) = self.hand() else {
            return Ok(());
        };
        hand.check_obstacle(k)?;
        self.state.grabbed_obstacle = Some(k);
        self.push(None);
        Ok(())
    }

    /// Moves the grabbed obstacle's place to `target` (m), as fast as a pulled particle.
    pub fn pull_obstacle(&mut self, target: Vector3<f64>) {
        self.push(Some(target));
    }

    /// Lets go of the obstacle: it stays where it is.
    pub fn release_obstacle(&mut self) {
        self.push(None);
        self.state.grabbed_obstacle = None;
    }

    /// Pushes the grabbed obstacle to a target (m), or leaves it where it is.
    fn push(&mut self, target: Option<Vector3<f64>>) {
        let hand = self.hand().zip(self.state.grabbed_obstacle);
        let pushed = hand.and_then(|(hand, k)| Some((k, hand.push(k, target)?)));
        if let Some((k, path)) = pushed {
            // The hand has checked that this obstacle exists.
            let _ = self.disturb(|network, _, _| network.lead_obstacle(k, path));
        }
    }

    /// Gives obstacle k another path, such as the one before it was pushed, and lets go of any
    /// obstacle. A reset restores the scene's own path.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn set_obstacle_path(&mut self, k: usize, path: Path) -> Result<(), Error> {
        self.release_obstacle();
        let led = self.disturb(|network, _, _| network.lead_obstacle(k, path));
        led.unwrap_or(Ok(()))
    }
}
