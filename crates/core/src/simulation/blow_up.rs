//! Blow-ups: how a lost run is noticed, and what it goes back to.

use std::ops::Range;

use super::Simulation;
use crate::error::{BlowUp, Cause, Error, Refusal};
use crate::network::contradiction;
use crate::rigid::{Body, ROTATION};
use crate::scene::Model;

/// Distance from the scene's middle, in its radii, at which a particle is lost, unless it is there
/// without gaining energy.
const LOST: f64 = 100.0;

/// Distance, in radii, within which all particles of a state are that one goes back to: still a
/// picture of the scene.
const GOOD: f64 = 3.0;

/// Numbers that are looked at without a branch.
const BLOCK: usize = 64;

impl Simulation {
    /// The cause of a blow-up, if a particle of y seems lost.
    pub(super) fn lost(&self, y: &[f64]) -> Option<Cause> {
        self.beyond(LOST, y)
    }

    /// Remembers the state if it is in shape.
    ///
    /// # Errors
    /// The run blew up earlier.
    pub(super) fn keep(&mut self) -> Result<(), Error> {
        if let Some(blow_up) = self.blow_up {
            return Err(blow_up.into());
        }
        if let Model::Network(network) = &self.model {
            let (time, state) = (self.state.time(), &mut self.state);
            self.watch
                .forgive(network, &mut state.balance, time, &state.y);
        }
        if self.state.balance.is_sound() && self.beyond(GOOD, &self.state.y).is_none() {
            self.keep_good();
        }
        Ok(())
    }

    /// Counts a step that ends at `time` (s). After a blow-up, goes back to the last state in
    /// shape.
    pub(super) fn judge(&mut self, cause: Option<Cause>, time: f64) -> Result<(), Error> {
        self.state.steps += 1;
        cause.map_or(Ok(()), |cause| self.lose(cause, time))
    }

    /// Ends the run, which was lost by `time` (s), and goes back to the last state in shape.
    pub(super) fn lose(&mut self, cause: Cause, time: f64) -> Result<(), Error> {
        let mut blow_up = BlowUp {
            method: self.state.method.title,
            control: self.state.control,
            step: self.state.steps,
            time,
            cause,
        };
        if let Some(good) = self.good.take() {
            let result = self.go_back(&good);
            self.good = Some(good);
            result?;
        }
        // Constraints that contradict one another are lost in many ways.
        if let Some(network) = self.model.network() {
            let (x, _) = network.halves(&self.state.y);
            let contradiction = contradiction(network, time, x, self.radius);
            blow_up.cause = contradiction.map_or(cause, Cause::Contradiction);
        }
        self.blow_up = Some(blow_up);
        Err(blow_up.into())
    }

    /// The particle to which number k of the state belongs: for the rotation of a rigid body, its
    /// centre.
    fn particle_of(&self, k: usize) -> usize {
        let n = self.particles();
        let body = k.checked_sub(6 * n).map(|k| k / ROTATION);
        let network = self.model.network();
        let body = body.and_then(|body| network?.bodies().get(body));
        body.map_or(k % n, Body::center)
    }

    /// The first particle that is farther than this many radii from the middle, or not finite, if
    /// there is one.
    fn beyond(&self, radii: f64, y: &[f64]) -> Option<Cause> {
        let n = self.particles();
        let (x, v) = y.split_at(3 * n);
        let c = self.middle;
        let limit = (radii * self.radius).powi(2);
        let squared = |i: usize| {
            (x[i] - c.x).powi(2) + (x[n + i] - c.y).powi(2) + (x[2 * n + i] - c.z).powi(2)
        };
        // By blocks without a branch inside. Written so that NaN, which compares as false, is lost
        // too.
        let near = |block: Range<usize>| block.fold(true, |near, i| near & (squared(i) <= limit));
        let mut blocks = (0..n).step_by(BLOCK);
        if !blocks.all(|start| near(start..n.min(start + BLOCK))) {
            let particle = (0..n).find(|&i| !near(i..i + 1))?;
            let distance = squared(particle).sqrt();
            return Some(if distance.is_finite() {
                Cause::Away { particle, distance }
            } else {
                Cause::NotFinite { particle }
            });
        }
        let finite = |block: &[f64]| block.iter().fold(true, |finite, v| finite & v.is_finite());
        if v.chunks(BLOCK).all(finite) {
            return None;
        }
        v.iter()
            .position(|v| !v.is_finite())
            .map(|k| Cause::NotFinite {
                particle: self.particle_of(3 * n + k),
            })
    }
}

/// The cause of a blow-up of n particles by a step that failed; other errors are handed on.
pub(super) fn blow_up_by(error: Error, n: usize) -> Result<Cause, Error> {
    match error {
        Error::NotFinite { component, .. } => Ok(Cause::NotFinite {
            particle: component % n,
        }),
        Error::StepTooSmall { step, .. } => Ok(Cause::StepTooSmall { step }),
        Error::NoConvergence { residual } => Ok(Cause::NoConvergence { residual }),
        Error::Unsupported {
            why: Refusal::ReadsVelocity,
            ..
        } => Ok(Cause::ReadsVelocity),
        error => Err(error),
    }
}
