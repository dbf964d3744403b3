//! Tuning: changes of the model while it runs, which a reset keeps.

use super::{Simulation, Stepper};
use crate::elements::Wind;
use crate::network::Network;
use crate::scene::Model;

impl Simulation {
    /// Changes the model as it is now, and the one that a reset goes back to. The state and the
    /// time stay. Does nothing in a scene without masses.
    pub fn adjust(&mut self, change: impl Fn(&mut Network)) {
        for model in [&mut self.model, &mut self.scene.model] {
            if let Model::Network(network) = model {
                change(network);
            }
        }
        self.look_again();
        self.refit();
    }

    /// Makes the integrator anew for the system as it is now: it makes room for the forces that it
    /// meets, and knows what they cost.
    pub(super) fn refit(&mut self) {
        // The method served this system before.
        if let Stepper::Fixed(integrator) = &mut self.stepper
            && let Ok(other) = self.method.integrator(self.model.system())
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

    /// Whether the scene's pins hold.
    #[must_use]
    pub fn pinned(&self) -> bool {
        !self.unpinned
    }

    /// Frees every pinned particle but the one in the hand, or pins those of the scene again, where
    /// they are now.
    pub fn set_pinned(&mut self, on: bool) {
        if on == self.pinned() {
            return;
        }
        self.unpinned = !on;
        let own = self.scene.model.network();
        let own: Vec<_> = own.into_iter().flat_map(Network::pins).collect();
        if on {
            for (i, _) in own {
                match &mut self.grabbed {
                    Some(grabbed) if grabbed.particle == i => grabbed.was_pinned = true,
                    _ => self.leave_pin(i),
                }
            }
            return;
        }
        let held = self.grabbed();
        if let Some(grabbed) = &mut self.grabbed {
            grabbed.was_pinned = false;
        }
        if let Some(network) = self.network_mut() {
            let pins: Vec<_> = network.pins().map(|(i, _)| i).collect();
            for i in pins.into_iter().filter(|i| Some(*i) != held) {
                network.unpin(i);
            }
        }
    }
}
