//! Hands: swing, wind, grabbed particles and obstacles, and pins.

use nalgebra::Vector3;

use super::{Grabbed, Simulation};
use crate::contact::Shape;
use crate::error::Error;
use crate::network::{Network, attract, let_go, mass_behind};
use crate::path::Path;
use crate::scene::{Model, Swing};
use crate::system::ParticleSystem;

/// Time in which a pulled particle gets to where it is pulled (s) ...
const PULL_TIME: f64 = 1.0 / 30.0;

/// ... unless that is faster than this many radii of the scene per second.
const PULL_SPEED: f64 = 10.0;

/// Greatest distance, in radii of the scene, from which a spring attracts what constraints hold ...
const PULL_REACH: f64 = 0.05;

/// ... and what they do not, where surfaces touch.
const FREE_REACH: f64 = 0.5;

/// Natural frequency of that spring over that of the particle on its own springs: it pulls a cloth
/// along, and hardly shortens the largest stable step.
const PULL_STIFFNESS: f64 = 0.3;

/// Share of the particle's way to its target by which each pull moves the hand on: so it gets there
/// whatever hangs on it.
const FOLLOW: f64 = 0.25;

/// Least and greatest length that a hand gives to a rod whose other end has not followed yet, in
/// lengths of the rod.
const ROD: (f64, f64) = (0.95, 1.05);

impl Grabbed {
    /// Whether a spring attracts the particle: a pin would tear constraints that hold it too, and
    /// would not stop where surfaces that touch leave it no room; and a point of a rigid body
    /// cannot be led by itself.
    fn is_attracted(&self, network: &Network) -> bool {
        let touches = network.contact_layer().is_some();
        touches
            || network.is_carried(self.particle)
            || !self.was_pinned && network.is_held(self.particle)
    }

    /// Attracts the particle to its path, if it is not led as a pin.
    pub(super) fn attract(&self, network: &mut Network) {
        if self.is_attracted(network) {
            let own = network.springs_of(self.particle);
            let stiffness: f64 = own.map(|s| s.law.stiffness).sum();
            let own = (stiffness / mass_behind(network, self.particle)).sqrt();
            let free = !network.is_held(self.particle);
            let least = 1.0 / PULL_TIME;
            let frequency = if free {
                least.max(PULL_STIFFNESS * own)
            } else {
                least
            };
            attract(network, self.particle, self.path, frequency);
        }
    }
}

impl Simulation {
    pub(super) fn network_mut(&mut self) -> Option<&mut Network> {
        self.look_again();
        match &mut self.model {
            Model::FirstOrder(_) => None,
            Model::Network(network) => Some(network),
        }
    }

    /// Whether the wind blows.
    #[must_use]
    pub fn windy(&self) -> bool {
        self.model
            .network()
            .is_some_and(|network| network.wind().is_some())
    }

    /// Lets the scene's wind blow, or calms it. A scene without wind stays as it is.
    pub fn set_wind(&mut self, on: bool) {
        let wind = self.scene.wind.filter(|_| on);
        if let Some(network) = self.network_mut() {
            network.set_wind(wind);
        }
    }

    /// Whether the pins swing.
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
        self.look_again();
        let (held, time) = (self.grabbed(), self.time());
        let (from_now_on, phase) = (on.then_some(swing), self.state.swing_phase);
        if let Model::Network(network) = &mut self.model {
            network.lead_pins(|i, path| {
                if Some(i) == held {
                    path
                } else {
                    leave(path.at(time).position, from_now_on, phase, time)
                }
            });
            network.hold(time, &mut self.state.y);
        }
    }

    /// Pins particle i where it is, or swings it from there.
    pub(super) fn leave_pin(&mut self, i: usize) {
        let swing = self.scene.swing.filter(|_| self.state.swinging);
        self.pin(
            i,
            leave(self.position(i), swing, self.state.swing_phase, self.time()),
        );
    }

    /// Leads particle i along `path` from now on.
    fn pin(&mut self, i: usize, path: Path) {
        let (n, velocity) = (self.particles(), path.at(self.time()).velocity);
        if let Some(network) = self.network_mut()
            && network.pin(i, path).is_ok()
        {
            for axis in 0..3 {
                self.state.y[(3 + axis) * n + i] = velocity[axis];
            }
        }
    }

    /// Number of the grabbed particle.
    #[must_use]
    pub fn grabbed(&self) -> Option<usize> {
        self.state.grabbed.map(|grabbed| grabbed.particle)
    }

    /// Takes hold of particle i, and lets go of any other. The particle is a pin then, or a spring
    /// attracts it: if it is free but for constraints, and wherever surfaces touch. Does nothing in
    /// a scene without masses, where there is nothing to hold against.
    ///
    /// # Errors
    /// There is no such particle.
    pub fn grab(&mut self, i: usize) -> Result<(), Error> {
        self.release();
        let Some(network) = self.model.network() else {
            return Ok(());
        };
        network.check_particle(i)?;
        let grabbed = Grabbed {
            particle: i,
            was_pinned: network.is_pinned(i),
            path: Path::Still(self.position(i)),
        };
        self.lead(grabbed);
        Ok(())
    }

    /// Leads the grabbed particle along its path, as a pin or by a spring.
    fn lead(&mut self, grabbed: Grabbed) {
        self.state.grabbed = Some(grabbed);
        if !self.attracts(&grabbed) {
            self.pin(grabbed.particle, grabbed.path);
        } else if let Some(network) = self.network_mut() {
            network.unpin(grabbed.particle);
            grabbed.attract(network);
        }
    }

    fn attracts(&self, grabbed: &Grabbed) -> bool {
        let network = self.model.network();
        network.is_some_and(|network| grabbed.is_attracted(network))
    }

    /// Pulls the grabbed particle towards `target` (m), where it arrives at once to the eye, unless
    /// springs or rods hold it back: the hand stretches a spring as far as the scene allows, a rod
    /// hardly at all, and gets farther as the other end follows.
    pub fn pull(&mut self, target: Vector3<f64>) {
        let Some(grabbed) = self.state.grabbed else {
            return;
        };
        let i = grabbed.particle;
        let from = self.position(i);
        let is_held = |network: &Network| network.is_held(i);
        let held = self.model.network().is_some_and(is_held);
        let within =
            |share: f64, ahead: Vector3<f64>| from + ahead.cap_magnitude(share * self.radius);
        let path = match self.attracts(&grabbed) {
            true if held => self.way(from, within(PULL_REACH, target - from)),
            // The hand goes on where it was, until the particle is at the target.
            true => {
                let hand = grabbed.path.at(self.time()).position;
                let ahead = hand - from + (target - from) * FOLLOW;
                self.way(hand, within(FREE_REACH, ahead))
            }
            false => self.way(from, self.within_reach(i, from, target)),
        };
        self.lead(Grabbed { path, ..grabbed });
    }

    /// The path of a hand that begins to move now.
    fn way(&self, from: Vector3<f64>, to: Vector3<f64>) -> Path {
        let start = self.time();
        let time = PULL_TIME.max((to - from).norm() / (PULL_SPEED * self.radius));
        Path::Line {
            from,
            to,
            start,
            end: start + time,
        }
    }

    /// The point on the way of particle i to `target` up to which no spring of its own and no edge
    /// of a tetrahedron is stretched too far, and no rod stretched or squeezed. A spring or rod
    /// that is already may not become worse.
    fn within_reach(&self, i: usize, from: Vector3<f64>, target: Vector3<f64>) -> Vector3<f64> {
        let way = target - from;
        let network = || self.model.network().into_iter();
        let springs = network()
            .flat_map(|network| network.springs_of(i))
            .map(|s| (s.i + s.j - i, s.law.rest_length));
        let in_solids = network().flat_map(|network| network.neighbours_in_solids(i));
        let springs = springs
            .chain(in_solids)
            .map(|(other, rest)| (other, 0.0, self.scene.reach * rest));
        let rods = network()
            .flat_map(|network| network.rods_of(i))
            .map(|(other, length)| (other, ROD.0 * length, ROD.1 * length));
        let share = springs
            .chain(rods)
            .map(|(other, shortest, longest)| {
                share(from - self.position(other), way, shortest, longest)
            })
            .fold(1.0, f64::min);
        from + share * way
    }

    /// Lets go of the grabbed particle. One that was free keeps the speed of the hand; one that was
    /// pinned is pinned where it is.
    pub fn release(&mut self) {
        let Some(grabbed) = self.state.grabbed.take() else {
            return;
        };
        let i = grabbed.particle;
        if let Some(network) = self.network_mut() {
            network.unpin(i);
            let_go(network);
        }
        if grabbed.was_pinned {
            self.leave_pin(i);
        }
    }

    /// Pins particle i where it is, swinging if the pins do, or unpins it. Returns whether it is
    /// pinned now. For a grabbed particle this takes effect when the hand lets go. Does nothing in
    /// a scene without masses.
    ///
    /// # Errors
    /// There is no such particle, or a rigid body carries it.
    pub fn toggle_pin(&mut self, i: usize) -> Result<bool, Error> {
        let Some(network) = self.model.network() else {
            return Ok(false);
        };
        network.check_particle(i)?;
        network.check_led(i)?;
        let pinned = network.is_pinned(i);
        if let Some(grabbed) = self
            .state
            .grabbed
            .as_mut()
            .filter(|held| held.particle == i)
        {
            grabbed.was_pinned = !grabbed.was_pinned;
            return Ok(grabbed.was_pinned);
        }
        if !pinned {
            self.leave_pin(i);
        } else if let Some(network) = self.network_mut() {
            network.unpin(i);
        }
        Ok(!pinned)
    }

    /// Number of the grabbed obstacle.
    #[must_use]
    pub fn grabbed_obstacle(&self) -> Option<usize> {
        self.state.grabbed_obstacle
    }

    /// Takes hold of obstacle k where it is, and lets go of any other. Does nothing in a scene
    /// without masses, where obstacles push nothing.
    ///
    /// # Errors
    /// There is no such obstacle, or it is a floor.
    pub fn grab_obstacle(&mut self, k: usize) -> Result<(), Error> {
        self.release_obstacle();
        let Some(network) = self.model.network() else {
            return Ok(());
        };
        network.check_obstacle(k)?;
        if network.obstacles()[k].shape == Shape::Floor {
            return Err(Error::Invalid("a floor cannot be pushed".into()));
        }
        self.state.grabbed_obstacle = Some(k);
        self.lead_obstacle(|_, position| Path::Still(position));
        Ok(())
    }

    /// Moves the grabbed obstacle's place to `target` (m), as fast as a pulled particle.
    pub fn pull_obstacle(&mut self, target: Vector3<f64>) {
        self.lead_obstacle(|run, position| run.way(position, target));
    }

    /// Lets go of the obstacle: it stays where it is.
    pub fn release_obstacle(&mut self) {
        self.lead_obstacle(|_, position| Path::Still(position));
        self.state.grabbed_obstacle = None;
    }

    /// Gives obstacle k another path, such as the one that it had before it was pushed, and lets go
    /// of any. A reset goes back to the scene's own.
    ///
    /// # Errors
    /// There is no such obstacle.
    pub fn set_obstacle_path(&mut self, k: usize, path: Path) -> Result<(), Error> {
        self.release_obstacle();
        match self.network_mut() {
            Some(network) => network.lead_obstacle(k, path),
            None => Ok(()),
        }
    }

    /// Gives the grabbed obstacle a path, which `path` makes of its position (m).
    fn lead_obstacle(&mut self, path: impl FnOnce(&Self, Vector3<f64>) -> Path) {
        let network = self.model.network().zip(self.state.grabbed_obstacle);
        let Some(obstacle) = network.and_then(|(network, k)| network.obstacles().get(k)) else {
            return;
        };
        let path = path(self, obstacle.path.at(self.time()).position);
        if let Some((k, network)) = self.state.grabbed_obstacle.zip(self.network_mut()) {
            // It is there: it was found above.
            let _ = network.lead_obstacle(k, path);
        }
    }
}

/// The share, at most 1, of a `way` (m) that a particle at d (m) from the other end of a spring or
/// rod may go before it is nearer than `shortest` or farther than `longest` (m).
fn share(d: Vector3<f64>, way: Vector3<f64>, shortest: f64, longest: f64) -> f64 {
    let (a, b, distance) = (way.norm_squared(), d.dot(&way), d.norm());
    if a == 0.0 {
        return 1.0;
    }
    // Where it crosses a limit: the roots u of |d + u way| = limit are (-b -+ root) / a.
    let squared = |limit: f64| b * b - a * (d.norm_squared() - limit * limit);
    let leaves = (-b + squared(longest.max(distance)).max(0.0).sqrt()) / a;
    let enters = squared(shortest.min(distance));
    if shortest > 0.0 && b < 0.0 && enters >= 0.0 {
        leaves.min(((-b - enters.sqrt()) / a).max(0.0))
    } else {
        leaves
    }
}

/// The path of a pin that is left at `position` at time t: still there, or swinging from there.
fn leave(position: Vector3<f64>, swing: Option<Swing>, phase: f64, t: f64) -> Path {
    match swing {
        None => Path::Still(position),
        Some(Swing { amplitude, rate }) => {
            let center = position - amplitude * libm::sin(rate * t + phase);
            Path::Sine {
                center,
                amplitude,
                rate,
                phase,
            }
        }
    }
}
