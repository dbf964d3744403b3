//! Disturbances of a scene: its wind, the swing of its pins, and contact of its surfaces.

use super::pins::leave_all_but;
use crate::error::Error;
use crate::integrators::Method;
use crate::network::{Least, Network, Touch, fit};
use crate::scene::{Disturbances, Model, Scene};

impl Scene {
    /// Returns the scene with these disturbances from its start. Those that it does not allow do
    /// nothing.
    ///
    /// # Errors
    /// Surfaces that are to touch cross, and the error names the first pair.
    pub fn disturbed(self, on: Disturbances) -> Result<Self, Error> {
        let mut disturbed = self.clone();
        let (Model::Network(network), y) = (&mut disturbed.model, &mut disturbed.state) else {
            return Ok(self);
        };
        if on.wind && self.wind.is_some() {
            network.set_wind(self.wind);
        }
        if let Some(swing) = self.swing.filter(|_| on.swing) {
            leave_all_but(None, network, y, (Some(swing), 0.0), 0.0);
            fit(network, 0.0, y, Least::AT_START);
        }
        if on.contact && self.touch.is_some() && !touches_itself(network) {
            **network = touching(network, &self, (0.0, y))?;
        }
        Ok(disturbed)
    }
}

/// Returns whether the surfaces of a network touch one another and themselves.
pub(super) fn touches_itself(network: &Network) -> bool {
    network.touch().is_some_and(|touch| touch.bodies)
}

/// Lets the surfaces of a scene touch one another, themselves and obstacles; without `on`, only
/// those contacts stay that the scene has in any case.
pub(super) fn let_touch(network: &mut Network, scene: &Scene, on: bool) -> Result<(), Error> {
    let own = scene.model.network().is_some_and(|n| n.touch().is_some());
    let touch = scene.touch.as_deref().filter(|_| on || own);
    network.set_touch(touch.map(|touch| Touch { bodies: on, ..touch.clone() }))
}

/// Returns a network whose surfaces touch one another, themselves and obstacles from this state y
/// at a time t (s) on.
fn touching(network: &Network, scene: &Scene, (t, y): (f64, &[f64])) -> Result<Network, Error> {
    let mut touching = network.clone();
    let_touch(&mut touching, scene, true)?;
    let apart = touching.check_apart(t, touching.halves(y).0);
    apart.map_err(|e| Error::Invalid(format!("surfaces that cross cannot begin to touch: {e}")))?;
    Ok(touching)
}

/// Checks that the surfaces of a scene can begin to touch in a state y of its network at a time
/// t (s), and that the method supports it.
pub(super) fn check_touch(
    network: &Network,
    scene: &Scene,
    state: (f64, &[f64]),
    method: &Method,
) -> Result<(), Error> {
    method.check(&touching(network, scene, state)?)
}
