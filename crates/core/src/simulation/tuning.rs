//! Tuning: changes of the model while it runs, which a reset keeps.

use super::Simulation;
use super::stepper::Kind;
use crate::elements::Wind;
use crate::error::Error;
use crate::network::{Network, Touch};
use crate::scene::{Model, Scene};

impl Simulation {
    /// Changes the model as it is now, and the one that a reset goes back to. The state and the
    /// time stay. Does nothing in a scene without masses.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) {
        self.look_again();
        for model in [&mut self.model, &mut self.scene.model] {
            if let Model::Network(network) = model {
                change(network);
            }
        }
        self.refit();
    }

    /// Makes the integrator anew for the system as it is now: it makes room for the forces that it
    /// meets, and knows what they cost.
    pub(super) fn refit(&mut self) {
        // The method served this system before.
        if let Kind::Fixed(integrator) = &mut self.stepper.kind
            && let Ok(other) = self.state.method.integrator(self.model.system())
        {
            *integrator = other;
        }
    }

    /// Puts another wind in the place of the scene's. A scene without wind stays without.
    pub fn change_wind(&mut self, wind: Wind) {
        if self.scene.wind.is_some() {
            self.scene.wind = Some(wind);
            self.set_wind(self.windy());
        }
    }

    /// Whether surfaces touch one another and themselves.
    #[must_use]
    pub fn touching(&self) -> bool {
        touches_itself(&self.model)
    }

    /// Lets the scene's surfaces touch one another and themselves, or pass through. A scene without
    /// surfaces stays as it is. A reset keeps this, unless surfaces cross at the beginning.
    ///
    /// # Errors
    /// Surfaces cross now, and the error names the first pair; or the method does not serve
    /// contact. The run goes on as before then.
    pub fn set_touching(&mut self, on: bool) -> Result<(), Error> {
        if on == self.touching() {
            return Ok(());
        }
        let Some(network) = self.model.network().filter(|_| self.scene.touch.is_some()) else {
            return Ok(());
        };
        if on {
            let mut touching = network.clone();
            let_touch(&mut touching, &self.scene, true)?;
            let apart = touching.check_apart(self.time(), touching.halves(&self.state.y).0);
            apart.map_err(|e| {
                Error::Invalid(format!("surfaces that cross cannot begin to touch: {e}"))
            })?;
            self.state.method.check(&touching)?;
        }
        // Where surfaces touch, a hand attracts a particle that it would lead as a pin elsewhere.
        let held = self.grabbed();
        self.release();
        self.look_again();
        if let Model::Network(network) = &mut self.model {
            let_touch(network, &self.scene, on)?;
        }
        self.refit();
        held.map_or(Ok(()), |i| self.grab(i))
    }

    /// Whether the scene's pins hold.
    #[must_use]
    pub fn pinned(&self) -> bool {
        !self.state.unpinned
    }

    /// Frees every pinned particle but the one in the hand, or pins those of the scene again, where
    /// they are now.
    pub fn set_pinned(&mut self, on: bool) {
        if on == self.pinned() {
            return;
        }
        self.state.unpinned = !on;
        let own = self.scene.model.network();
        let own: Vec<_> = own.into_iter().flat_map(Network::pins).collect();
        if on {
            for (i, _) in own {
                match &mut self.state.grabbed {
                    Some(grabbed) if grabbed.particle == i => grabbed.was_pinned = true,
                    _ => self.leave_pin(i),
                }
            }
            return;
        }
        let held = self.grabbed();
        if let Some(grabbed) = &mut self.state.grabbed {
            grabbed.was_pinned = false;
        }
        if let Some(network) = self.network_mut() {
            let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
            // The last ones first: whichever is removed, few are moved up.
            for i in pins.into_iter().rev().filter(|i| Some(*i) != held) {
                network.unpin(i);
            }
        }
    }
}

/// Whether the surfaces of a model touch one another and themselves.
pub(super) fn touches_itself(model: &Model) -> bool {
    let touch = model.network().and_then(Network::touch);
    touch.is_some_and(|touch| touch.bodies)
}

/// Lets the surfaces of a scene touch one another, themselves and obstacles, or, without `on`, only
/// what they touch in any case.
pub(super) fn let_touch(network: &mut Network, scene: &Scene, on: bool) -> Result<(), Error> {
    let own = scene.model.network().is_some_and(|n| n.touch().is_some());
    let touch = scene.touch.as_deref().filter(|_| on || own);
    network.set_touch(touch.map(|touch| Touch {
        bodies: on,
        ..touch.clone()
    }))
}
