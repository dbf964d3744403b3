//! Scenes as lists of masses and springs in JSON, for programs that read no scene files, and with
//! the reference states of other programs.

use a3_core::{Model, Network, Path, Pin as Held, Scene};
use serde::de::IgnoredAny;
use serde::{Deserialize, Serialize};

use crate::description::{Description, Particles, Pin, SpringSpec, Triple};
use crate::fault::Fault;
use crate::reader;
use crate::reader::Places;
use crate::snapshot::rows;

/// Forces that a list states.
const STATED: [&str; 4] = ["springs", "spring damping", "gravity", "drag"];

/// Network of masses and springs, with its state at the start. Its text is JSON that
/// [`parse_json`](crate::parse_json) reads.
///
/// ```
/// let scene = a3_scenes::find("pendulum").unwrap().build(None)?.scene;
/// let list = a3_scenes::List::of(&scene)?;
/// let (description, _) = a3_scenes::parse_json(&list.text()?)?;
/// let no_files = &mut |_: &str| Err("there are no files here".into());
/// assert_eq!(description.build(None, no_files)?.scene.state, scene.state);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct List {
    /// Name of the scene.
    pub name: String,
    /// Gravity (m/s2).
    pub gravity: Triple,
    /// Coefficient of viscous drag (kg/s): each particle feels the force -`drag` v.
    pub drag: f64,
    /// Mass of each particle (kg).
    pub mass: Vec<f64>,
    /// Numbers of the particles that never move, counted from 0.
    pub pinned: Vec<usize>,
    /// Positions at the start (m).
    pub positions: Vec<Triple>,
    /// Velocities at the start (m/s).
    pub velocities: Vec<Triple>,
    /// Springs: [i, j, stiffness (N/m), rest length (m), damping (N s/m)].
    pub springs: Vec<SpringSpec>,
}

impl List {
    /// Lists the masses and springs of a scene.
    ///
    /// # Errors
    /// The scene has other parts, which are named.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let Some(network) = scene.model.network() else {
            let why = "is a single equation, without masses and springs";
            return Err(format!("the scene {} {why}", scene.name));
        };
        let others = others(network);
        if !others.is_empty() {
            return Err(format!(
                "the scene {} has more than masses and springs: {}; a list states springs with their damping, pins that \
                 stay, gravity and drag",
                scene.name,
                others.join(", ")
            ));
        }
        let (x, v) = network.halves(&scene.state);
        let springs = network.springs().map(|s| {
            let law = s.law;
            (s.i, s.j, law.stiffness, law.rest_length, law.damping)
        });
        Ok(Self {
            name: scene.name.clone(),
            gravity: network.gravity().map_or([0.0; 3], Into::into),
            drag: network.drag().unwrap_or(0.0),
            mass: network.masses().to_vec(),
            pinned: network.pins().map(|(i, _)| i).collect(),
            positions: rows(x),
            velocities: rows(v),
            springs: springs.collect(),
        })
    }

    /// Lists the masses and springs of a scene without its obstacles: its motion is that of the
    /// scene until a particle touches one.
    ///
    /// # Errors
    /// The scene has other parts, which are named.
    pub fn in_flight(scene: &Scene) -> Result<Self, String> {
        let mut scene = scene.clone();
        if let Model::Network(network) = &mut scene.model {
            while !network.obstacles().is_empty() {
                network.remove_obstacle(0).map_err(|e| e.to_string())?;
            }
        }
        Self::of(&scene)
    }

    /// Writes the list as JSON, with a line for each particle and each spring.
    ///
    /// # Errors
    /// A number is not finite.
    pub fn text(&self) -> Result<String, String> {
        let entries = [
            ("name", json(&self.name)?),
            ("units", json(&"m, kg, s")?),
            ("gravity", json(&self.gravity)?),
            ("drag", json(&self.drag)?),
            ("mass", json(&self.mass)?),
            ("pinned", json(&self.pinned)?),
            ("positions", lines(&self.positions)?),
            ("velocities", lines(&self.velocities)?),
            ("springs", lines(&self.springs)?),
        ];
        let entries = entries.map(|(key, value)| format!("\"{key}\": {value}"));
        Ok(format!("{{\n{}\n}}\n", entries.join(",\n")))
    }
}

/// Writes a value in a line.
fn json(value: &impl Serialize) -> Result<String, String> {
    serde_json::to_string(value).map_err(|e| e.to_string())
}

/// Writes a list with a line for each item.
fn lines(items: &[impl Serialize]) -> Result<String, String> {
    let items: Vec<_> = items.iter().map(json).collect::<Result<_, _>>()?;
    Ok(match &items[..] {
        [] => "[]".into(),
        items => format!("[\n{}\n]", items.join(",\n")),
    })
}

/// Names the parts of a network that a list does not state.
fn others(network: &Network) -> Vec<&'static str> {
    let forces = network.forces_in_use().into_iter();
    let mut others: Vec<_> = forces.filter(|name| !STATED.contains(name)).collect();
    let mut add = |there: bool, name| {
        if there && !others.contains(&name) {
            others.push(name);
        }
    };
    for obstacle in network.obstacles() {
        add(true, obstacle.shape.name());
    }
    add(!network.bodies().is_empty(), "rigid bodies");
    let moves = |(_, path): (usize, Path)| !matches!(path, Path::Still(_));
    add(network.pins().any(moves), "pins that move");
    let lets_go = |pin: Held| pin.until.is_some();
    add(network.all_pins().any(lets_go), "pins that let go");
    others
}

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
#[rustfmt::skip]
const NAMES: &[(&str, &str)] = &[
    ("particles.masses", "mass"), ("particles.pin.particles", "pinned"),
    ("particles.pin", "pinned"), ("particles.", ""),
];

/// Reads a description from a list of particles and springs in JSON. The places of its keys tell
/// the lines of faults that [`Description::build`] finds.
///
/// # Errors
/// The text is not JSON, a key is unknown or missing, a value is of the wrong kind, or a
/// number is not from -1e13 to 1e13.
pub fn parse_json(text: &str) -> Result<(Description, Places), Fault> {
    let (listed, places): (Listed, Places) = reader::read_json(text)?;
    let mut pin = vec![Pin { particles: listed.pinned, ..Pin::default() }];
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
