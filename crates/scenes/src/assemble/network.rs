//! The network of a description: bodies, pins, constraints, forces and obstacles.

use std::sync::Arc;

use a3_core::elements::Cords;
use a3_core::rigid::ROTATION;
use a3_core::{Element, Network, ParticleSystem, Touch, Vector3};

use super::assembly::{Assembly, Body, Files};
use super::{assembly, constraints, fluid, forces, springs};
use crate::budget::SPRINGS;
use crate::description::Description;
use crate::fault::{Fault, at, key_of, positive};
use crate::setup::Presentation;

/// Largest number of bodies: some work grows with the square of that number.
const MAX_BODIES: usize = 1000;

/// Network with its initial state, its presentation, and its surfaces for contact.
pub(super) struct NetworkParts {
    pub network: Network,
    pub state: Vec<f64>,
    pub presentation: Presentation,
    /// Surfaces that can touch, if there are any.
    pub touch: Option<Arc<Touch>>,
}

/// Lists all bodies with their keys, in the order in which their particles are numbered.
pub(super) fn bodies(all: &Description) -> impl Iterator<Item = (String, &dyn Body)> {
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
pub(super) fn build(description: &Description, files: &mut Files) -> Result<NetworkParts, Fault> {
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
    fluid::add(
        assembly.fluid,
        assembly.outflows,
        assembly.soaked,
        &mut network,
        &state[..3 * n],
    )?;
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
    let touch = Touch {
        skins: assembly.skins,
        edges: assembly.edges,
        drops: assembly.drops,
        bodies: true,
    };
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
pub(super) fn touches(description: &Description) -> bool {
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
    let mut assembly = Assembly {
        gravity,
        liquid: description.fluid.first(),
        ..Assembly::default()
    };
    for (key, body) in bodies(description) {
        let added = assembly.add(&key, body, files);
        added.map_err(|fault| fault.within(&key))?;
    }
    Ok(assembly)
}
