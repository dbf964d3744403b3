//! Level floor of a scene: a height, or a table.

use std::fmt;

use schemars::JsonSchema;
use serde::de::value::MapAccessDeserializer;
use serde::de::{self, MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize};

use super::obstacles::is_zero;
use crate::check::{beyond, within};

/// Level floor: `floor = -1.0`, or `floor = { height = -1.0, friction = 0.4, restitution = 0.8 }`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(untagged)]
pub enum Floor {
    /// Height of a smooth floor (m).
    Height(f64),
    /// Floor with friction, restitution or thickness.
    Table(FloorSpec),
}

/// Level floor with its friction, restitution and thickness.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct FloorSpec {
    /// Height (m).
    pub height: f64,
    /// Coefficient of Coulomb friction on it; 0 if not given.
    #[serde(default)]
    pub friction: f64,
    /// Coefficient of restitution, from 0 to 1; 0 if not given.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub restitution: f64,
    /// Thickness (m), with which it repels bodies before they touch it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thickness: Option<f64>,
}

/// Written out, because an untagged enum does not say what is wrong with its table.
impl<'de> Deserialize<'de> for Floor {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(HeightOrTable)
    }
}

struct HeightOrTable;

impl<'de> Visitor<'de> for HeightOrTable {
    type Value = Floor;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a height (m), or a table with the keys `height` and `friction`")
    }

    fn visit_f64<E: de::Error>(self, height: f64) -> Result<Floor, E> {
        if within(height) {
            Ok(Floor::Height(height))
        } else {
            Err(E::custom(beyond(height)))
        }
    }

    fn visit_i64<E: de::Error>(self, height: i64) -> Result<Floor, E> {
        self.visit_f64(height as f64)
    }

    fn visit_u64<E: de::Error>(self, height: u64) -> Result<Floor, E> {
        self.visit_f64(height as f64)
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<Floor, A::Error> {
        FloorSpec::deserialize(MapAccessDeserializer::new(map)).map(Floor::Table)
    }
}
