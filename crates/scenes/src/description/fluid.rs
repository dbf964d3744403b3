//! Fluids: what they are made of, where they begin, and the tanks that hold them.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::bodies::Keys;
use super::motion::{Triple, is_default};

/// Liquid of smoothed particles that begins as a box or a ball. All fluids of a scene are the same
/// liquid, which mixes: each repeats `spacing`, `density`, `sound`, `viscosity` and `dimensions`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fluid {
    /// Shape at the beginning; a box if not given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub shape: FluidShape,
    /// Lengths of the edges of the box or diameters of the ball (m), whole multiples of `spacing`.
    /// In two dimensions, the last one is 0. With an `inflow`, [0, 0, 0] means none of it at first.
    pub size: Triple,
    /// Distance of neighbouring particles (m).
    pub spacing: f64,
    /// Centre (m).
    pub at: Triple,
    /// Density at rest (kg/m3).
    pub density: f64,
    /// Speed of sound (m/s): about ten times the speed of the fastest flow keeps the density within
    /// a percent.
    pub sound: f64,
    /// Kinematic viscosity (m2/s); 0 if not given.
    #[serde(default)]
    pub viscosity: f64,
    /// Number of dimensions, 2 or 3; 3 if not given. In two, the fluid is a sheet across z, 1 m
    /// deep.
    #[serde(default = "three")]
    pub dimensions: u8,
    /// Velocity (m/s).
    pub velocity: Option<Triple>,
    /// Rates at which the fluid is being stretched along x, y and z (1/s): they times the distance
    /// from the centre are added to the velocity.
    pub strain: Option<Triple>,
    /// Tank around it.
    pub tank: Option<Tank>,
    /// More of the liquid, which flows in through an opening.
    pub inflow: Option<Inflow>,
    /// Boxes in which the liquid leaves the scene, whichever fluid it is of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outflow: Vec<Outflow>,
}

impl Keys for Fluid {}

impl Fluid {
    /// Returns a fluid of the same liquid that is one particle, far away.
    pub(crate) fn drop_of(&self) -> Self {
        let is_flat = self.dimensions == 2;
        let depth = if is_flat { 0.0 } else { self.spacing };
        Self {
            shape: FluidShape::Box,
            size: [self.spacing, self.spacing, depth],
            at: [0.0, FAR, 0.0],
            velocity: None,
            strain: None,
            tank: None,
            inflow: None,
            outflow: vec![],
            ..self.clone()
        }
    }
}

/// Height of a particle that is far away (m).
const FAR: f64 = 1e8;

/// Shape in which a fluid begins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FluidShape {
    /// Box.
    #[default]
    Box,
    /// Ball, or a disc in two dimensions.
    Ball,
}

/// Tank that is open at the top: its walls are pinned particles of the fluid.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Tank {
    /// Lengths of the edges of the space inside (m), whole multiples of the fluid's `spacing`. In
    /// two dimensions, the last one is 0.
    pub size: Triple,
    /// Centre of the space inside (m).
    pub at: Triple,
}

/// Liquid that flows in through an opening: layer by layer, out of a column behind it, which is
/// pinned. The column passes through the walls of the tank, and closes the opening at the end.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Inflow {
    /// Lengths of the edges of the opening (m), whole multiples of the fluid's `spacing`; 0 along
    /// the velocity. In two dimensions, the last one is 0.
    pub size: Triple,
    /// Centre of the opening (m).
    pub at: Triple,
    /// Velocity of the liquid in the opening (m/s), along one of the axes.
    pub velocity: Triple,
    /// Time for which the liquid flows (s).
    pub duration: f64,
    /// Time for which it has flowed at the start (s), straight on if no state is given; 0 if not
    /// given.
    #[serde(default, skip_serializing_if = "is_default")]
    pub ahead: f64,
}

/// Box in which the liquid leaves the scene, for good. It makes a hole in the walls of the tank.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Outflow {
    /// Lengths of the edges of the box (m). In two dimensions, the last one is 0.
    pub size: Triple,
    /// Centre (m).
    pub at: Triple,
}

fn three() -> u8 {
    3
}
