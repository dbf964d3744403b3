//! Scenes from descriptions.

mod assembly;
mod cloth;
mod constraints;
mod fluid;
mod forces;
mod motion;
mod rigid;
mod solid;
mod springs;

use std::ops::Range;
use std::sync::Arc;

use a3_core::elements::Cords;
use a3_core::rigid::ROTATION;
use a3_core::{
    Control, Element, Grid, Measure, Model, Network, ParticleSystem, Scene, Swing, Touch, Vector3,
    integrators,
};

use crate::budget::{Budget, SPRINGS};
use crate::description::{BucklingSpec, Cloth, Description};
use crate::fault::{Fault, at, at_least, key_of, positive};
use crate::material::strip_of;
use crate::mesh::Mesh;
use crate::setup::{Defaults, Presentation, Setup, Viewpoint};
use crate::wording::unknown_choice;
pub use assembly::max_thickness;
use assembly::{Assembly, Body, Files};
pub use fluid::{LAYERS, fluid_points};
pub use forces::air;
pub use springs::damping_time;

impl Description {
    /// Builds the scene. A `grid` replaces that of the first cloth. `mesh` reads a file of
    /// triangles or tetrahedra. Bounds of single numbers are checked where a text is read, and not
    /// again here for a description that is made in code.
    ///
    /// # Errors
    /// A number makes no sense, or a file cannot be read.
    pub fn build(
        &self,
        grid: Option<Grid>,
        mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
    ) -> Result<Setup, Fault> {
        let Some(grid) = grid else {
            return self.assemble(None, mesh);
        };
        let Some(own) = self.cloth.first() else {
            let name = self.name.as_deref().unwrap_or_default();
            refuse!("": "the scene {name} has no grid: only a cloth has one");
        };
        let in_cloth = |fault: Fault| fault.within(&key_of("cloth", 0, self.cloth.len()));
        let own_mass = own.checked_mass().map_err(in_cloth)?;
        let mut other = self.clone();
        other.cloth[0].grid = [grid.rows(), grid.cols()];
        restrip(own, &mut other.cloth[0]).map_err(in_cloth)?;
        let mass = other.cloth[0].checked_mass().map_err(in_cloth)?;
        let mut setup = other.assemble(Some(grid), mesh)?;
        // Its springs are equally stiff, so its highest frequency is proportional to the root of 1
        // / m.
        setup.defaults.step_scale = (mass / own_mass).sqrt().min(1.0);
        // A larger cloth is seen from farther away, in proportion.
        if let Ok(own) = self.assemble(None, mesh) {
            let (was, small) = own.scene.extent();
            let (is, large) = setup.scene.extent();
            let zoom = (large / small).max(1.0);
            let Viewpoint { eye, target } = &mut Arc::make_mut(&mut setup.presentation).viewpoint;
            for point in [eye, target] {
                *point = is + (*point - was) * zoom;
            }
        }
        Ok(setup)
    }

    /// Builds the scene. `asked` is a grid from the command line, which adds to the budget of the
    /// scene.
    fn assemble(
        &self,
        asked: Option<Grid>,
        mesh: &mut dyn FnMut(&str) -> Result<Mesh, String>,
    ) -> Result<Setup, Fault> {
        let mut files = Files { budget: Budget::new(asked), mesh, touching: touches(self) };
        let (mut model, mut state, presentation, touch) = if let Some(circle) = &self.circle {
            let model = Model::Points(Arc::new(Circling));
            (model, circle.start.to_vec(), Presentation::default(), None)
        } else {
            let parts = network_of(self, &mut files)?;
            let model = Model::Network(Box::new(parts.network));
            (model, parts.state, parts.presentation, parts.touch)
        };
        refuse!(if self.circle.is_some() && bodies(self).next().is_some() => "circle":
            "a circle is a first-order system and must be the only body");
        let n = model.particles();
        if let Some(given) = &self.state {
            assembly::write_state(given, n, &mut state)?;
        }
        if let (true, Model::Network(network)) = (self.untangle, &model) {
            at("untangle", a3_core::untangle(network, &mut state))?;
        }
        if let Model::Network(network) = &mut model {
            fluid::drain(network, &mut state);
        }
        if let Some(trail) = self.trail.filter(|i| *i >= n) {
            return Err(Fault::no_particle("trail", trail, n));
        }
        let mut scene = Scene::new(self.name.clone().unwrap_or_default(), model, state);
        scene.limits.max_step = self.max_step;
        scene.touch = touch;
        // A given state comes from a run, which reports the errors of its constraints.
        let given = self.state.as_ref();
        if given.is_none_or(|given| given.positions.is_empty()) {
            constraints::check(self, &scene)?;
        }
        let presentation =
            Presentation { viewpoint: self.viewpoint(&scene)?, trail: self.trail, ..presentation };
        if let Some(reach) = self.reach {
            at("reach", at_least(1.0, "it", reach))?;
            scene.reach = reach;
        }
        if let Some(swing) = &self.swing {
            scene.swing =
                Some(Swing { amplitude: Vector3::from(swing.amplitude), rate: swing.rate });
        }
        if let (Model::Network(network), Some(wind)) = (&mut scene.model, &self.wind) {
            scene.wind = Some(forces::wind(wind, network).map_err(|f| f.within("wind"))?);
            if wind.on {
                network.set_wind(scene.wind);
            }
        }
        Ok(Setup { scene, presentation: Arc::new(presentation), defaults: self.defaults()? })
    }

    /// Returns the camera of the description, or else one that sees the whole scene.
    fn viewpoint(&self, scene: &Scene) -> Result<Viewpoint, Fault> {
        let Some(camera) = &self.camera else {
            return Ok(Viewpoint::of(scene));
        };
        let eye = Vector3::from(camera.eye);
        let target = Vector3::from(camera.target);
        refuse!(if eye == target => "camera.eye": "it must not be at the target");
        Ok(Viewpoint { eye, target })
    }

    /// Returns the solver, its step or tolerance, and the duration.
    fn defaults(&self) -> Result<Defaults, Fault> {
        let find = |name: &str| {
            let names: Vec<_> = integrators::METHODS.iter().map(|m| m.name).collect();
            let unknown = || Fault::new("solver", unknown_choice(name, &names));
            integrators::find(name).ok_or_else(unknown)
        };
        let solver = self.solver.as_deref().map(find).transpose()?;
        for (key, number) in
            [("step", self.step), ("max_step", self.max_step), ("duration", self.duration)]
        {
            if let Some(number) = number {
                at(key, positive("it", number))?;
            }
        }
        refuse!(if self.step.is_some() && self.solver.is_none() => "step":
            "a step also needs the key `solver`");
        let own = solver.zip(self.step);
        let control = own.map(|(solver, step)| solver.control(step));
        // A step that is given suits the fluid as it is.
        let step_scale = match control {
            Some(Control::Step(_)) => 1.0,
            _ => fluid::step_scale(&self.fluid),
        };
        Ok(Defaults { solver, control, duration: self.duration, step_scale })
    }
}

/// Gives `other`, a cloth on another grid, the strips of the material of `own` there, unless those
/// of `own` are not of its material.
///
/// # Errors
/// One of both has no size.
pub(crate) fn restrip(own: &Cloth, other: &mut Cloth) -> Result<(), Fault> {
    let strip = |spacing: f64| {
        let [bending, compression] = strip_of(own.material.as_deref()?, spacing)?;
        Some(BucklingSpec { bending, compression })
    };
    let (was, is) = (own.checked_spacing()?, other.checked_spacing()?);
    if own.buckling.is_some() && own.buckling == strip(was) {
        other.buckling = strip(is);
    }
    Ok(())
}

/// One particle whose velocity is its position turned by a right angle: f = (-y, x, 0).
struct Circling;

impl ParticleSystem for Circling {
    fn dim(&self) -> usize {
        3
    }

    fn eval_f(&self, _t: f64, y: &[f64], dydt: &mut [f64]) {
        dydt.copy_from_slice(&[-y[1], y[0], 0.0]);
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        visit(0..3, Measure::Alike);
    }
}

/// Largest number of bodies: some work grows with the square of that number.
const MAX_BODIES: usize = 1000;

/// Network with its initial state, its presentation, and its surfaces for contact.
struct NetworkParts {
    pub network: Network,
    pub state: Vec<f64>,
    pub presentation: Presentation,
    /// Surfaces that can touch, if there are any.
    pub touch: Option<Arc<Touch>>,
}

/// Lists all bodies with their keys, in the order in which their particles are numbered.
fn bodies(all: &Description) -> impl Iterator<Item = (String, &dyn Body)> {
    fn keyed<'a, T: Body>(
        kind: &str,
        all: &'a [T],
    ) -> impl Iterator<Item = (String, &'a dyn Body)> {
        let bodies = all.iter().map(|body| body as &dyn Body).enumerate();
        bodies.map(move |(k, body)| (key_of(kind, k, all.len()), body))
    }
    keyed("cloth", &all.cloth)
        .chain(keyed("jelly", &all.jelly))
        .chain(keyed("mesh", &all.mesh))
        .chain(keyed("solid", &all.solid))
        .chain(keyed("chain", &all.chain))
        .chain(keyed("particles", all.particles.as_slice()))
        .chain(keyed("body", &all.body))
        .chain(keyed("fluid", &all.fluid))
}

/// Builds the network.
fn network_of(description: &Description, files: &mut Files) -> Result<NetworkParts, Fault> {
    let mut assembly = assembled(description, files)?;
    let budget = &mut files.budget;
    let n = assembly.masses.len();
    budget.spend("springs", description.springs.len(), SPRINGS)?;
    let between = springs::springs(&description.springs, n)?;
    assembly.add_springs(0, between, description.tension_only);
    let given = description.state.as_ref().map(|state| &state.positions);
    let given = given.filter(|positions| positions.len() == n);
    let given = given.map(|all| all.iter().map(|p| Vector3::from(*p)).collect::<Vec<_>>());
    let positions = given.as_ref().unwrap_or(&assembly.positions);
    let pins = &mut assembly.pins;
    pins.add(0, &description.pin, positions, budget, |_| None)?;
    let mut state = assembly::state_of(&assembly.positions, &assembly.velocities);
    let mut network = at("", Network::new(assembly.masses))?;
    let sheets = assembly.sheets.into_iter().map(Element::from);
    let solids = assembly.solids.into_iter().map(Element::from);
    let gases = assembly.gases.into_iter().map(Element::from);
    for element in sheets.chain(solids).chain(gases) {
        at("", network.add(element))?;
    }
    at("", network.add_springs(assembly.springs))?;
    if !assembly.cords.is_empty() {
        at("", network.add(Cords::new(assembly.cords)))?;
    }
    for (k, strip) in assembly.strips.into_iter().enumerate() {
        let added = network.add_buckling(strip);
        let added = added.map_err(|e| format!("bend spring {k}, counted from 0: {e}"));
        at("buckling", added)?;
    }
    for (body, rotation) in assembly.rigid {
        at("body", network.add_body(body))?;
        let first = state.len();
        state.resize(first + ROTATION, 0.0);
        rotation.write(&mut state[first..]);
    }
    // Moves the points of rigid bodies to their places.
    network.hold(0.0, &mut state);
    for rod in assembly.rods {
        at("", network.add_constraint(rod))?;
    }
    fluid::add(assembly.fluid, assembly.outflows, assembly.soaked, &mut network, &state[..3 * n])?;
    constraints::add(description, &mut network, &state)?;
    constraints::add_joints(description, budget, &assembly.pins, &mut network, &state)?;
    let triangles = assembly.presentation.surface.triangles.iter();
    let triangles = triangles.map(|t| t.map(|i| i as usize));
    at("", network.set_triangles(triangles))?;
    at("", network.pin_all(assembly.pins.paths))?;
    forces::set(description, &mut network)?;
    for (key, particles, limit) in assembly.strain_limits {
        let limited = network.set_strain_limit(particles, Some(limit));
        at("strain_limit", limited).map_err(|fault| fault.within(&key))?;
    }
    forces::add_obstacles(description, &mut network, files)?;
    let touch =
        Touch { skins: assembly.skins, edges: assembly.edges, drops: assembly.drops, bodies: true };
    if files.touching {
        let touch = Touch {
            bodies: description.self_collision || !description.body.is_empty(),
            ..touch.clone()
        };
        at("self_collision", network.set_touch(Some(touch)))?;
    }
    let has_edges = touch.edges.iter().any(|[i, j]| i != j);
    let has_surface = has_edges || !network.triangles().is_empty() || !network.bodies().is_empty();
    Ok(NetworkParts {
        network,
        state,
        presentation: assembly.presentation,
        touch: has_surface.then(|| Arc::new(touch)),
    })
}

/// Returns whether surfaces touch: those of rigid bodies and of bodies with a restitution always
/// do.
fn touches(description: &Description) -> bool {
    let asked = description.self_collision || forces::is_one_thick(description);
    let is_elastic = |(_, body): (_, &dyn Body)| body.skin().restitution != 0.0;
    asked || !description.body.is_empty() || bodies(description).any(is_elastic)
}

/// Adds all bodies.
fn assembled<'a>(description: &'a Description, files: &mut Files) -> Result<Assembly<'a>, Fault> {
    let count = bodies(description).count();
    refuse!(if count > MAX_BODIES => "":
        "the scene has {count} bodies; at most {MAX_BODIES} are allowed");
    if count == 0 {
        let why = "the scene is empty: it needs at least one of cloth, jelly, mesh, solid, chain, particles, body, fluid, circle";
        return Err(Fault::new("", why));
    }
    let gravity = description.contact_gravity();
    at("contact_gravity", positive("it", gravity))?;
    let mut assembly =
        Assembly { gravity, liquid: description.fluid.first(), ..Assembly::default() };
    for (key, body) in bodies(description) {
        let added = assembly.add(&key, body, files);
        added.map_err(|fault| fault.within(&key))?;
    }
    Ok(assembly)
}
