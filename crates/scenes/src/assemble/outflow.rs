//! Boxes in which a liquid leaves the scene.

use a3_core::elements::Outflow as Space;
use a3_core::{Network, Vector3};

use crate::check::{at, positive};
use crate::description::{Fluid, Outflow};
use crate::fault::Fault;

/// Distance outside an outflow at which a particle is inside, relative to the spacing.
pub(super) const SLACK: f64 = 1e-6;

/// Largest number of outflows of all fluids of a scene.
pub(super) const MAX_OUTFLOWS: usize = 100;

/// Returns the outflows of a fluid. In two dimensions they are two spacings thick.
pub(super) fn spaces(fluid: &Fluid) -> Result<Vec<Space>, Fault> {
    let spaces = fluid.outflow.iter().enumerate().map(|(k, outflow)| {
        let space = space(outflow, fluid);
        space.map_err(|fault| fault.within(&format!("outflow[{k}]")))
    });
    spaces.collect()
}

fn space(outflow: &Outflow, fluid: &Fluid) -> Result<Space, Fault> {
    let mut half = 0.5 * Vector3::from(outflow.size);
    if fluid.dimensions == 2 {
        if half.z != 0.0 {
            let why = format!(
                "in two dimensions, its last number is 0, not {}",
                outflow.size[2]
            );
            return Err(Fault::new("size", why));
        }
        half.z = fluid.spacing;
    }
    for half in half.iter() {
        at("size", positive("each edge", *half))?;
    }
    Ok(Space {
        at: outflow.at.into(),
        half,
    })
}

/// Lets the liquid leave the scene that begins in an outflow.
pub(super) fn drain(network: &mut Network, state: &mut [f64]) {
    let spacing = network.fluid().map(|fluid| fluid.law().spacing);
    if let Some(spacing) = spacing {
        network.drain(state, SLACK * spacing);
    }
}
