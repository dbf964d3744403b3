//! The hands that swing, pull and blow.

use nalgebra::Vector3;

use super::Simulation;
use crate::error::Error;
use crate::network::Network;
use crate::path::Path;
use crate::scenes::{Model, Swing};

/// A hand stretches a spring to this many times its rest length.
const REACH: f64 = 3.0;

/// A pulled particle gets to where it is pulled in this time [s] ...
const PULL_TIME: f64 = 1.0 / 30.0;

/// ... but no faster than this many radii of the scene per second.
const PULL_SPEED: f64 = 10.0;

impl Simulation {
    fn network_mut(&mut self) -> Option<&mut Network> {
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
        self.swinging
    }

    /// Swings the pins from where they are, or stops them there. A scene without swing stays as it is.
    pub fn set_swinging(&mut self, on: bool) {
        let Some(swing) = self.scene.swing.filter(|_| on != self.swinging) else {
            return;
        };
        let turn = swing.rate * self.time();
        self.swing_phase += if on { -turn } else { turn };
        self.swinging = on;
        let held = self.grabbed.map(|(i, _)| i);
        let pins: Vec<usize> = self.pins().filter(|&i| Some(i) != held).collect();
        for i in pins {
            self.leave_pin(i);
        }
    }

    fn pins(&self) -> impl Iterator<Item = usize> {
        self.model
            .network()
            .into_iter()
            .flat_map(Network::pins)
            .map(|(i, _)| i)
    }

    /// Pins particle i where it is, or swings it from there.
    fn leave_pin(&mut self, i: usize) {
        let position = self.position(i);
        let path = match self.scene.swing.filter(|_| self.swinging) {
            None => Path::Still(position),
            Some(Swing { amplitude, rate }) => {
                let phase = self.swing_phase;
                let center = position - amplitude * libm::sin(rate * self.time() + phase);
                Path::Sine {
                    center,
                    amplitude,
                    rate,
                    phase,
                }
            }
        };
        self.pin(i, path);
    }

    /// Leads particle i along `path` from now on.
    fn pin(&mut self, i: usize, path: Path) {
        let (n, velocity) = (self.particles(), path.at(self.time()).velocity);
        if let Some(network) = self.network_mut()
            && network.pin(i, path).is_ok()
        {
            for axis in 0..3 {
                self.y[(3 + axis) * n + i] = velocity[axis];
            }
        }
    }

    /// The grabbed particle.
    #[must_use]
    pub fn grabbed(&self) -> Option<usize> {
        self.grabbed.map(|(i, _)| i)
    }

    /// Takes hold of particle i, and lets go of any other. Does nothing in a scene without masses, where there is
    /// nothing to hold against.
    ///
    /// # Errors
    /// There is no such particle.
    pub fn grab(&mut self, i: usize) -> Result<(), Error> {
        self.release();
        let Some(network) = self.model.network() else {
            return Ok(());
        };
        network.check_particle(i)?;
        self.grabbed = Some((i, network.is_pinned(i)));
        self.pin(i, Path::Still(self.position(i)));
        Ok(())
    }

    /// Draws the grabbed particle towards `target` [m]: there at once to the eye, unless springs hold it back. A hand
    /// is strong and not almighty: it stretches a spring it holds to [`REACH`] times its rest length, and gets farther
    /// as the other end comes along.
    pub fn pull(&mut self, target: Vector3<f64>) {
        let Some((i, _)) = self.grabbed else { return };
        let (from, start) = (self.position(i), self.time());
        let target = self.within_reach(i, from, target);
        let time = PULL_TIME.max((target - from).norm() / (PULL_SPEED * self.radius));
        self.pin(
            i,
            Path::Line {
                from,
                to: target,
                start,
                end: start + time,
            },
        );
    }

    /// The point on the way of particle i to `target` up to which no spring of its own is stretched too far. A spring
    /// that is already may not get longer.
    fn within_reach(&self, i: usize, from: Vector3<f64>, target: Vector3<f64>) -> Vector3<f64> {
        let way = target - from;
        let springs = self
            .model
            .network()
            .into_iter()
            .flat_map(|network| network.springs_of(i));
        let share = springs
            .map(|s| {
                let other = self.position(s.i + s.j - i);
                let limit = (REACH * s.law.rest_length).max((from - other).norm());
                // The larger root u of |from + u way - other| = limit.
                let d = from - other;
                let (a, b, c) = (
                    way.norm_squared(),
                    d.dot(&way),
                    d.norm_squared() - limit * limit,
                );
                if a > 0.0 {
                    (-b + (b * b - a * c).max(0.0).sqrt()) / a
                } else {
                    1.0
                }
            })
            .fold(1.0, f64::min);
        from + share * way
    }

    /// Lets go. A particle that was free keeps the speed of the hand; one that was pinned is pinned where it is.
    pub fn release(&mut self) {
        let Some((i, was_pinned)) = self.grabbed.take() else {
            return;
        };
        if was_pinned {
            self.leave_pin(i);
        } else if let Some(network) = self.network_mut() {
            network.unpin(i);
        }
    }
}
