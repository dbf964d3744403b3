//! Whether surfaces of a run touch one another and themselves.

use super::state::RunState;
use crate::error::Error;
use crate::network::{Network, Touch};
use crate::scene::{Model, Scene};

/// Returns whether the surfaces of a model touch one another and themselves.
pub(super) fn touches_itself(model: &Model) -> bool {
    let touch = model.network().and_then(Network::touch);
    touch.is_some_and(|touch| touch.bodies)
}

/// Lets the surfaces of a scene touch one another, themselves and obstacles; without `on`, only
/// those contacts stay that the scene has in any case.
pub(super) fn let_touch(network: &mut Network, scene: &Scene, on: bool) -> Result<(), Error> {
    let own = scene.model.network().is_some_and(|n| n.touch().is_some());
    let touch = scene.touch.as_deref().filter(|_| on || own);
    network.set_touch(touch.map(|touch| Touch {
        bodies: on,
        ..touch.clone()
    }))
}

/// Checks that the surfaces of a scene can begin to touch in a state of its network.
///
/// # Errors
/// Surfaces cross, and the error names the first pair; or the method does not support contact.
pub(super) fn check_touch(network: &Network, scene: &Scene, state: &RunState) -> Result<(), Error> {
    let mut touching = network.clone();
    let_touch(&mut touching, scene, true)?;
    let apart = touching.check_apart(state.time(), touching.halves(&state.y).0);
    apart.map_err(|e| Error::Invalid(format!("surfaces that cross cannot begin to touch: {e}")))?;
    state.method.check(&touching)
}
