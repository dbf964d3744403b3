//! Springs, wind and swing.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::motion::{Shift, Sine, Triple, Turn};

/// Spring: [i, j, stiffness (N/m), rest length (m), damping (N s/m)].
pub type SpringSpec = (usize, usize, f64, f64, f64);

/// Law of bend springs that buckle: under compression they give way like a strip that bends into an
/// arc, instead of pushing back ever harder.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct BucklingSpec {
    /// Bending stiffness of the strip (N m2).
    pub bending: f64,
    /// Stiffness under compression while the strip is still straight (N/m).
    pub compression: f64,
}

/// Wind, in gusts that are repeatable by their seed. It pushes each particle by `force` or by
/// `force_per_mass`, or it is air that streams with a `velocity` past the triangles of surfaces.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct WindSpec {
    /// Whether the wind blows from the beginning.
    #[serde(skip_serializing_if = "is_default")]
    pub on: bool,
    /// Seed of the gusts.
    pub seed: u64,
    /// Whether the wind has no gusts.
    #[serde(skip_serializing_if = "is_default")]
    pub steady: bool,
    /// Mean force on each particle (N).
    pub force: Option<Triple>,
    /// Mean force on each particle over the mean mass of a particle (m/s2).
    pub force_per_mass: Option<Triple>,
    /// Mean velocity of the air (m/s), which pushes triangles along its flow and across it.
    pub velocity: Option<Triple>,
    /// Density of the air (kg/m3), for a wind with a `velocity`; 1.2 if not given.
    pub density: Option<f64>,
    /// Drag coefficient of triangles in the air; 1.2 if not given.
    pub drag: Option<f64>,
    /// Lift coefficient of triangles in the air; 0.6 if not given.
    pub lift: Option<f64>,
    /// Time by which the gusts and the motion of the region run ahead of the run (s).
    #[serde(skip_serializing_if = "is_default")]
    pub ahead: f64,
    /// Region in which it blows, as that of a fan; everywhere if not given.
    pub region: Option<RegionSpec>,
}

/// Ellipsoid in which a wind blows: as it says at the centre, and fading towards the surface. A
/// region that turns turns the wind with it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct RegionSpec {
    /// Its centre (m).
    pub at: Triple,
    /// Radius across the wind (m).
    pub radius: f64,
    /// Radius along the mean wind (m); if not given, the same.
    #[serde(default)]
    pub length: Option<f64>,
    /// Oscillation.
    #[serde(default)]
    pub sine: Option<Sine>,
    /// Displacement.
    #[serde(default)]
    pub shift: Option<Shift>,
    /// Turn.
    #[serde(default)]
    pub turn: Option<Turn>,
}

/// Swing of all pins together: `amplitude sin(rate t)`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct SwingSpec {
    /// Amplitude (m).
    pub amplitude: Triple,
    /// Angular frequency (rad/s).
    pub rate: f64,
}

fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}
