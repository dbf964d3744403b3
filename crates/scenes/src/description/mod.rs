//! Keys of scene files, as plain data. `docs/scenes.md` shows them by example.

mod bodies;
mod fluid;
mod motion;

use a3_core::Vector3;
use schemars::JsonSchema;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::budget::check_text;
use crate::fault::Fault;
use crate::material;
use crate::reader::{self, Places};

use bodies::SharedKeys;
pub use bodies::{BucklingSpec, RegionSpec, SpringSpec, SwingSpec, WindSpec};
pub use bodies::{
    Chain, Circle, Cloth, Jelly, MeshCloth, PartSpec, Particles, RigidBody, Solid, SolidModel,
};
pub(crate) use bodies::{Keys, SkinKeys};
pub use fluid::{Fluid, FluidShape, Inflow, Outflow, Tank};
pub use motion::{
    BallSpec, BoxSpec, CapsuleSpec, CircleSpec, ConstraintSpec, Floor, FloorSpec, HingeSpec,
    JointSpec, LineSpec, ObstacleSpec, Pin, Shift, Sine, SliderSpec, SphereSpec, Spot, Triple,
    Turn,
};
pub(crate) use motion::{Movable, ObstacleKeys};

/// Description of a scene: its bodies, the forces and obstacles that act on them, how it is run,
/// and where it is seen from. Units are m, kg, s, N and rad.
///
/// Particles are numbered through all bodies: those of cloths come first, then those of jellies,
/// meshes, solids, chains, single particles and rigid bodies, and last those of fluids, each
/// followed by its tank's walls.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
#[allow(clippy::struct_excessive_bools, reason = "keys of a file")]
pub struct Description {
    /// Short name; if not given, that of the file.
    pub name: Option<String>,
    /// Description of the scene in one line.
    pub summary: Option<String>,
    /// Solver to begin with, by letter or name.
    pub solver: Option<String>,
    /// Step of the solver (s), or relative tolerance of an adaptive solver.
    pub step: Option<f64>,
    /// Longest step of an adaptive solver (s).
    pub max_step: Option<f64>,
    /// Length of a run (s), where no other is asked for.
    pub duration: Option<f64>,
    /// Gravity (m/s2), such as [0, -9.81, 0]; none if not given.
    pub gravity: Option<Triple>,
    /// Gravity (m/s2) for which contact is made stiff enough where no `contact_stiffness` is given;
    /// if not given, the scene's, or 9.81 m/s2 without any.
    pub contact_gravity: Option<f64>,
    /// Viscous drag on each particle (kg/s). An alternative is `drag_per_mass`.
    pub drag: Option<f64>,
    /// Viscous drag on each particle over the mean mass of a particle (1/s). An alternative is
    /// `drag`.
    pub drag_per_mass: Option<f64>,
    /// Whether surfaces of bodies touch one another, themselves and obstacles, instead of passing
    /// through.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub self_collision: bool,
    /// Whether they do so at first in the window, where hands fold and cross them, and not
    /// elsewhere.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub window_self_collision: bool,
    /// Whether surfaces that can touch and cross at the start come apart.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub untangle: bool,
    /// Level floor: its height (m), or a table with `height` and `friction`.
    pub floor: Option<Floor>,
    /// Largest stretch, in rest lengths, to which a hand pulls the springs of the particle it
    /// holds.
    pub reach: Option<f64>,
    /// Number of the particle whose path is drawn.
    pub trail: Option<usize>,
    /// Camera that the scene is first seen by.
    pub camera: Option<Camera>,
    /// Wind, which key d turns on and off.
    pub wind: Option<WindSpec>,
    /// Swing of the pins, which key s turns on and off.
    pub swing: Option<SwingSpec>,
    /// A first-order system in place of all bodies: one particle on a circle, f = (-y, x, 0).
    pub circle: Option<Circle>,
    /// Rectangular cloths.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub cloth: Vec<Cloth>,
    /// Boxes of jelly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub jelly: Vec<Jelly>,
    /// Cloths of any shape, from files of triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub mesh: Vec<MeshCloth>,
    /// Elastic solids of tetrahedra.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub solid: Vec<Solid>,
    /// Rows of particles joined by springs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub chain: Vec<Chain>,
    /// Single particles.
    pub particles: Option<Particles>,
    /// Rigid bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub body: Vec<RigidBody>,
    /// Fluids, which are all of the same liquid.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub fluid: Vec<Fluid>,
    /// Springs between any particles: [i, j, stiffness (N/m), rest length (m), damping (N s/m)].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<SpringSpec>,
    /// Whether `springs` only pull, and hang slack if they are shorter than their rest length.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub tension_only: bool,
    /// Rods, ropes and wires, which solvers keep exactly.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub constraint: Vec<ConstraintSpec>,
    /// Joints of rigid bodies.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub joint: Vec<JointSpec>,
    /// Rate at which a drift off a constraint or a joint is corrected (1/s); 10 if not given.
    pub feedback: Option<f64>,
    /// Pins of any particles by number. They come after the pins of the bodies, and override them.
    /// If there is a `state`, pins are at the positions that it gives.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub pin: Vec<Pin>,
    /// Stretch, in rest lengths, at which springs break. If it is not given, they never break.
    pub tear: Option<f64>,
    /// Springs that are broken from the beginning, each given by the two particles it joins.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub torn: Vec<[usize; 2]>,
    /// Boxes that particles stay out of.
    #[serde(rename = "box", skip_serializing_if = "Vec::is_empty")]
    pub boxes: Vec<BoxSpec>,
    /// Capsules that particles stay out of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub capsule: Vec<CapsuleSpec>,
    /// Spheres that particles stay out of.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub sphere: Vec<SphereSpec>,
    /// Solids of any shape that particles stay out of, from files of triangles.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub obstacle: Vec<ObstacleSpec>,
    /// Positions and velocities of all particles at the start, in place of those of the bodies.
    pub state: Option<State>,
}

/// Gravity of the Earth (m/s2).
pub(crate) const EARTH: f64 = 9.81;

/// Position of the camera, and the point that it looks at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// Position of the camera (m).
    pub eye: Triple,
    /// Point that the camera looks at (m).
    pub target: Triple,
}

/// State of all particles, one row for each of them, and of all rigid bodies.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct State {
    /// Positions (m); if not given, those of the bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub positions: Vec<Triple>,
    /// Velocities (m/s); if not given, all particles are at rest.
    #[serde(default)]
    pub velocities: Vec<Triple>,
    /// Orientations of rigid bodies: quaternions w, x, y, z from their principal axes. If not
    /// given, those of the bodies.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub orientations: Vec<[f64; 4]>,
    /// Angular momenta of rigid bodies (kg m2/s).
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub angular_momenta: Vec<Triple>,
}

/// Reads a description from TOML. The places of its keys tell the lines of faults that
/// [`Description::build`] finds.
///
/// # Errors
/// As [`Description::parse`].
pub fn parse_toml(text: &str) -> Result<(Description, Places), Fault> {
    check_text(text.as_bytes()).map_err(|why| Fault::new("", why))?;
    reader::read_toml(text)
}

/// Makes a body of a material.
fn made_of<T: Serialize + DeserializeOwned>(body: &mut T, name: &str) -> Result<(), Fault> {
    let table = toml::Table::try_from(&*body);
    let mut table = table.map_err(|why| Fault::new("", why))?;
    table.retain(|key, _| !material::KEYS.contains(&key));
    table.insert("material".into(), name.into());
    *body = reader::read(&table.to_string())?;
    Ok(())
}

impl Description {
    /// Reads a description from TOML.
    ///
    /// # Errors
    /// The text is not TOML or too long, a key is unknown or missing, a value is of the
    /// wrong kind, or a number is not from -1e13 to 1e13.
    pub fn parse(text: &str) -> Result<Self, Fault> {
        parse_toml(text).map(|(description, _)| description)
    }

    /// Lists the keys that bodies share, body for body, in the order of the numbers of particles.
    pub(crate) fn bodies_mut(&mut self) -> impl Iterator<Item = SharedKeys<'_>> {
        let jellies = self.jelly.iter_mut().map(Keys::shared);
        let meshes = self.mesh.iter_mut().map(Keys::shared);
        let solids = self.solid.iter_mut().map(Keys::shared);
        let chains = self.chain.iter_mut().map(Keys::shared);
        let particles = self.particles.iter_mut().map(Keys::shared);
        let rigid = self.body.iter_mut().map(Keys::shared);
        let all = self.cloth.iter_mut().map(Keys::shared);
        let all = all.chain(jellies).chain(meshes).chain(solids);
        all.chain(chains).chain(particles).chain(rigid)
    }

    /// Returns the names of the materials that some of its bodies can be of.
    #[must_use]
    pub fn materials(&self) -> Vec<&'static str> {
        let cloths = self.cloth.len() + self.mesh.len();
        let solids = self.jelly.len() + self.solid.len() + self.body.len();
        let all = [(true, cloths), (false, solids)].into_iter();
        // One that is named is exchanged for others of its kind.
        let named = self.named_material();
        let fits = |of_fabrics| named.is_none_or(|it| material::names(of_fabrics).contains(&it));
        let some = all.filter(|(of_fabrics, count)| *count > 0 && fits(*of_fabrics));
        some.flat_map(|(of_fabrics, _)| material::names(of_fabrics)).collect()
    }

    /// Returns the name of the material of its first body that has one.
    #[must_use]
    pub fn named_material(&self) -> Option<&str> {
        let cloths = self.cloth.iter().map(|it| &it.material);
        let meshes = self.mesh.iter().map(|it| &it.material);
        let jellies = self.jelly.iter().map(|it| &it.material);
        let solids = self.solid.iter().map(|it| &it.material);
        let bodies = self.body.iter().map(|it| &it.material);
        let all = cloths.chain(meshes).chain(jellies).chain(solids);
        all.chain(bodies).flatten().map(String::as_str).next()
    }

    /// Names the material of all bodies that can be of it, in place of their own keys.
    ///
    /// # Errors
    /// There is no such material.
    pub(crate) fn name_material(&mut self, name: &str) -> Result<(), Fault> {
        if material::names(true).contains(&name) {
            self.cloth.iter_mut().try_for_each(|it| made_of(it, name))?;
            self.mesh.iter_mut().try_for_each(|it| made_of(it, name))
        } else {
            self.jelly.iter_mut().try_for_each(|it| made_of(it, name))?;
            self.solid.iter_mut().try_for_each(|it| made_of(it, name))?;
            self.body.iter_mut().try_for_each(|it| made_of(it, name))
        }
    }

    /// Returns the gravity (m/s2) that the default stiffness of contact suits.
    pub(crate) fn contact_gravity(&self) -> f64 {
        let own = self.gravity.map(|g| Vector3::from(g).norm());
        let own = own.filter(|g| *g > 0.0).unwrap_or(EARTH);
        self.contact_gravity.unwrap_or(own)
    }

    /// Changes gravity (m/s2). Contact stays as stiff as it is.
    pub(crate) fn change_gravity(&mut self, gravity: Option<Triple>) {
        let suits = self.contact_gravity();
        (self.gravity, self.contact_gravity) = (gravity, None);
        self.contact_gravity = Some(suits).filter(|suits| *suits != self.contact_gravity());
    }

    /// Writes TOML that [`parse`](Self::parse) reads as the same description.
    ///
    /// # Errors
    /// The TOML writer fails; no description is known for which it does.
    pub fn to_toml(&self) -> Result<String, a3_core::Error> {
        toml::to_string(self).map_err(|e| a3_core::Error::Invalid(e.to_string()))
    }

    /// Returns the JSON Schema of scene files, by which editors complete and check them.
    #[must_use]
    pub fn schema() -> String {
        let schema = schemars::schema_for!(Self);
        serde_json::to_string_pretty(&schema).unwrap_or_default()
    }
}
