//! Laws of springs as descriptions give them.

use a3_core::elements::Buckling;
use a3_core::{Spring, SpringKind, SpringLaw};

use crate::check::{at, at_least, positive};
use crate::description::{BucklingSpec, SpringSpec};
use crate::fault::Fault;

/// Creates springs between the particles of a body that has `particles` of them.
pub(super) fn springs(specs: &[SpringSpec], particles: usize) -> Result<Vec<Spring>, Fault> {
    let spring = |(k, &(i, j, stiffness, rest_length, damping)): (usize, &SpringSpec)| {
        let wrong =
            |why: String| Fault::new("springs", format!("spring {k}, counted from 0: {why}"));
        if i.max(j) >= particles || i == j {
            return Err(wrong(format!(
                "{i} and {j} must be two different particles from 0 to {}",
                particles - 1
            )));
        }
        let law =
            SpringLaw::new(stiffness, rest_length, damping).map_err(|e| wrong(e.to_string()))?;
        let kind = SpringKind::Structural;
        Ok(Spring { kind, i, j, law })
    };
    specs.iter().enumerate().map(spring).collect()
}

/// Returns damping over stiffness (s), which is given directly or by the damping ratio of a
/// particle of this mass (kg) on a spring of this stiffness (N/m).
pub fn damping_time(
    damping: Option<f64>,
    ratio: Option<f64>,
    mass: f64,
    stiffness: f64,
) -> Result<f64, Fault> {
    match (damping, ratio) {
        (None, None) => Ok(0.0),
        (Some(_), Some(_)) => Err(Fault::not_both("damping", "damping_ratio")),
        (Some(time), None) => at("damping", at_least(0.0, "it", time)).map(|()| time),
        (None, Some(ratio)) => {
            at("damping_ratio", at_least(0.0, "it", ratio))?;
            at(
                "damping_ratio",
                positive("the structural stiffness that it refers to", stiffness),
            )?;
            Ok(2.0 * ratio * (mass / stiffness).sqrt())
        }
    }
}

/// Creates a buckling spring between two particles from its rest length (m), and its stiffness
/// (N/m) and damping (N s/m) under tension.
pub(super) fn strip(
    law: &BucklingSpec,
    [i, j]: [usize; 2],
    rest_length: f64,
    [tension, damping]: [f64; 2],
) -> Buckling {
    Buckling {
        i,
        j,
        rest_length,
        bending: law.bending,
        compression: law.compression,
        tension,
        damping,
    }
}
