//! Scenes as JSON: lists of particles and springs, with the reference states of other programs.

use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::description::{Description, Particles, Pin};
use crate::fault::Fault;
use crate::reader::{self, Places};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Listed {
    name: Option<String>,
    note: Option<String>,
    #[serde(rename = "units")]
    _units: Option<String>,
    gravity: Option<[f64; 3]>,
    drag: Option<f64>,
    mass: Vec<f64>,
    #[serde(default)]
    pinned: Vec<usize>,
    positions: Vec<[f64; 3]>,
    #[serde(default)]
    velocities: Vec<[f64; 3]>,
    #[serde(default)]
    springs: Vec<(usize, usize, f64, f64, f64)>,
    /// Results of other programs, which a run does not need.
    #[serde(rename = "error_bound")]
    _error_bound: Option<f64>,
    #[serde(rename = "states")]
    _states: Option<IgnoredAny>,
}

/// Prefixes of keys: that of a description, and that of the list which stands for it.
const NAMES: &[(&str, &str)] = &[
    ("particles.masses", "mass"),
    ("particles.pin.particles", "pinned"),
    ("particles.pin", "pinned"),
    ("particles.", ""),
];

/// Reads a description from a list of particles and springs in JSON. The places of its keys tell
/// the lines of faults that [`Description::build`] finds.
///
/// # Errors
/// The text is not JSON, a key is unknown or missing, a value is of the wrong kind, or a
/// number is not from -1e13 to 1e13.
pub fn parse_json(text: &str) -> Result<(Description, Places), Fault> {
    let (listed, places): (Listed, Places) = reader::read_json(text)?;
    let mut pin = vec![Pin {
        particles: listed.pinned,
        ..Pin::default()
    }];
    pin.retain(|pin| !pin.particles.is_empty());
    let description = Description {
        name: listed.name,
        summary: listed.note,
        gravity: listed.gravity,
        drag: listed.drag,
        particles: Some(Particles {
            positions: listed.positions,
            velocities: listed.velocities,
            masses: listed.mass,
            springs: listed.springs,
            pin,
            ..Particles::default()
        }),
        ..Description::default()
    };
    Ok((description, places.named(NAMES)))
}
