//! Error messages for surfaces that cross: the first pair, its place, and the connected parts that
//! the pairs belong to.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::elements::Element;
use super::parts::Network;
use crate::columns::row;
use crate::contact;
use crate::contact::{ContactLayer, Crossed, Freedom, Obstacle, Shape, is_crowded};
use crate::coupling::{AxialCoupling, BlockCoupling, Coupling, GeneralCoupling};
use crate::elements::force::Matter;
use crate::error::{Error, Vertex};
use crate::sets::Sets;

/// Largest number of pairs of parts that a message names.
const MAX_NAMED: usize = 3;

/// Checks that no surfaces pass through one another at time t (s) at x (m), n x 3.
pub(super) fn check_apart(network: &Network, t: f64, x: &[f64]) -> Result<(), Error> {
    if let Some(layer) = network.contact_layer() {
        check_crowded(layer, t, x)?;
    }
    let crossed = network.crossed(t, x);
    if crossed.is_empty() {
        return check_single(network, t, x);
    }
    let description = Description { network, x, crossed: &crossed };
    Err(Error::Invalid(description.to_string()))
}

/// Checks that no free particle without edges and triangles is inside a box or a mesh, or on it: no
/// edge of it crosses them.
fn check_single(network: &Network, t: f64, x: &[f64]) -> Result<(), Error> {
    let (Some(layer), Some(touch)) = (network.contact_layer(), network.touch()) else {
        return Ok(());
    };
    let points = touch.edges.iter().filter(|[a, b]| a == b);
    let free =
        points.filter(|[i, _]| layer.surface().is_single(*i) && !network.is_pinned(*i as usize));
    let n = network.particles();
    for [i, _] in free {
        let place = row(x, n, *i as usize);
        let is_in = |obstacle: &Obstacle| {
            let has_faces = matches!(obstacle.shape, Shape::Box { .. } | Shape::Mesh(_));
            has_faces && obstacle.depth(t, place) >= 0.0
        };
        if let Some(k) = network.obstacles().iter().position(is_in) {
            let name = name(network, Vertex::Obstacle(k));
            return Err(Error::Invalid(format!("particle {i} is in {name} or on it")));
        }
    }
    Ok(())
}

/// Returns the name of a vertex: of a floor, the only one of its kind, without its number.
fn name(network: &Network, vertex: Vertex) -> String {
    let shape = |k: usize| network.obstacles().get(k).map(|obstacle| &obstacle.shape);
    match vertex {
        Vertex::Obstacle(k) if shape(k) == Some(&Shape::Floor) => "the floor".into(),
        other => other.to_string(),
    }
}

/// Checks that there are not too many pairs at the same place to list them.
fn check_crowded(layer: &ContactLayer, t: f64, x: &[f64]) -> Result<(), Error> {
    let thickest = layer.surface().thickest();
    if is_crowded(layer, t, x, 0.0) {
        let why = "too many surfaces are at the same place for contact: move them apart";
        return Err(Error::Invalid(why.into()));
    }
    if is_crowded(layer, t, x, thickest) {
        return Err(Error::Invalid(format!(
            "too many surfaces are within their thickness of one another for contact: it is up to {thickest} m, and a \
             smaller one would do"
        )));
    }
    Ok(())
}

/// Moves the particles of the state y of a network at time 0 until no surfaces cross, with lengths
/// kept as far as possible. Pins, obstacles, and particles that constraints hold stay where they
/// are, rigid bodies keep their directions, and velocities do not change.
///
/// # Errors
/// Surfaces still cross after many attempts: the message is that of [`Network::check_apart`], and y
/// has the last attempt.
///
/// # Panics
/// y has fewer than three numbers for each particle.
pub fn untangle(network: &Network, y: &mut [f64]) -> Result<(), Error> {
    let Some(layer) = network.contact_layer() else {
        return Ok(());
    };
    let n = network.particles();
    let x = &mut y[..3 * n];
    check_crowded(layer, 0.0, x)?;
    let links = links(network, x);
    let mut weights: Vec<_> = network.masses().iter().map(|mass| 1.0 / mass).collect();
    for (i, weight) in weights.iter_mut().enumerate() {
        if network.is_pinned(i) || network.is_held(i) {
            *weight = 0.0;
        }
    }
    for body in network.bodies() {
        let all = || body.points().chain([body.center()]);
        let stays = all().any(|i| weights[i] == 0.0);
        let weight = if stays { 0.0 } else { weights[body.center()] };
        all().for_each(|i| weights[i] = weight);
    }
    let freedom = Freedom { links: &links, weights: &weights };
    if contact::untangle(layer, &freedom, 0.0, x) {
        return Ok(());
    }
    check_apart(network, 0.0, x)
        .map_err(|why| Error::Invalid(format!("they do not come apart: {why}")))
}

/// Returns the pairs of particles between which forces act, except contact and those of fluids.
fn links(network: &Network, x: &[f64]) -> Vec<[u32; 2]> {
    let mut links = BTreeSet::new();
    let all = network.elements().iter();
    let links_lastingly = |element: &&Element| {
        let flows = element.force().matter() == Some(Matter::Fluid);
        element.get::<ContactLayer>().is_none() && !flows
    };
    for element in all.filter(links_lastingly) {
        element.force().couplings(0.0, x, true, &mut |coupling| {
            let (i, j) = match coupling {
                Coupling::Axial(AxialCoupling { i, j, .. })
                | Coupling::Block(BlockCoupling { i, j, .. })
                | Coupling::General(GeneralCoupling { i, j, .. }) => (i, j),
                // Contact alone, which lasts as long as its surfaces touch.
                Coupling::RankOne(_) => return,
            };
            links.insert([i.min(j) as u32, i.max(j) as u32]);
        });
    }
    links.into_iter().collect()
}

/// Connected part, body or obstacle that a surface belongs to.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Whole {
    /// Connected part, by its smallest particle.
    Part(u32),
    Body(usize),
    Obstacle(usize),
}

/// Connected parts of the surfaces of a network.
struct ConnectedParts {
    sets: Sets,
    /// Number of each part, counted from 1, and number of its particles, by its smallest particle.
    sizes: BTreeMap<u32, (usize, usize)>,
}

impl ConnectedParts {
    fn of(network: &Network) -> Self {
        let mut sets = Sets::new(network.particles());
        let edges = network.touch().into_iter().flat_map(|touch| &touch.edges);
        let sides = network.triangles().iter().flat_map(|&[a, b, c]| [[a, b], [b, c]]);
        let mut members = vec![];
        for [a, b] in sides.chain(edges.copied()) {
            sets.join(a, b);
            members.extend([a, b]);
        }
        members.sort_unstable();
        members.dedup();
        let mut sizes = BTreeMap::new();
        for i in members {
            let number = sizes.len() + 1;
            sizes.entry(sets.find(i)).or_insert((number, 0)).1 += 1;
        }
        Self { sets, sizes }
    }

    fn whole(&mut self, vertex: Vertex) -> Whole {
        match vertex {
            Vertex::Particle(i) => Whole::Part(self.sets.find(i as u32)),
            Vertex::Body(k) => Whole::Body(k),
            Vertex::Obstacle(k) => Whole::Obstacle(k),
        }
    }

    /// Returns the name of a part, with the number of its particles unless it was `told` before.
    fn name(
        &self,
        whole: Whole,
        told: &mut BTreeSet<Whole>,
        name: &dyn Fn(Vertex) -> String,
    ) -> String {
        match whole {
            Whole::Part(first) => {
                let (number, size) = self.sizes.get(&first).copied().unwrap_or((0, 1));
                if told.insert(whole) {
                    format!("part {number} ({size} particles from {first} on)")
                } else {
                    format!("part {number}")
                }
            }
            Whole::Body(k) => name(Vertex::Body(k)),
            Whole::Obstacle(k) => name(Vertex::Obstacle(k)),
        }
    }
}

/// Description in words of surfaces that pass through one another at positions x (m), n x 3.
struct Description<'a> {
    network: &'a Network,
    x: &'a [f64],
    crossed: &'a [Crossed],
}

impl Description<'_> {
    /// Returns the middle of the particles of a primitive (m), if it has any.
    fn place(&self, vertices: &[Vertex]) -> Option<[f64; 3]> {
        let n = self.network.particles();
        let particles = vertices.iter().filter_map(|vertex| match vertex {
            Vertex::Particle(i) => Some(*i),
            Vertex::Body(_) | Vertex::Obstacle(_) => None,
        });
        let particles: Vec<_> = particles.collect();
        let mean = |axis: usize| {
            let all = particles.iter().map(|i| self.x[axis * n + i]);
            all.sum::<f64>() / particles.len() as f64
        };
        (!particles.is_empty()).then(|| [0, 1, 2].map(mean))
    }
}

impl fmt::Display for Description<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Some((first, more)) = self.crossed.split_first() else {
            return f.write_str("nothing crosses");
        };
        let name = |vertex: Vertex| name(self.network, vertex);
        f.write_str(&first.told(&name))?;
        let place = self.place(&first.first).or_else(|| self.place(&first.second));
        if let Some([x, y, z]) = place {
            if x.abs().max(y.abs()).max(z.abs()) < 0.1 {
                write!(f, " near ({x:.2e}, {y:.2e}, {z:.2e})")?;
            } else {
                write!(f, " near ({x:.3}, {y:.3}, {z:.3})")?;
            }
        }
        if !more.is_empty() {
            write!(f, ", and so do {} other pairs", more.len())?;
        }
        let mut parts = ConnectedParts::of(self.network);
        let count = parts.sizes.len();
        if count < 2 {
            return Ok(());
        }
        let mut pairs = BTreeMap::<_, usize>::new();
        for Crossed { first, second } in self.crossed {
            if let (Some(a), Some(b)) = (first.first(), second.first()) {
                let (a, b) = (parts.whole(*a), parts.whole(*b));
                *pairs.entry((a.min(b), a.max(b))).or_default() += 1;
            }
        }
        write!(f, "; of {count} connected parts")?;
        let mut told = BTreeSet::new();
        for (k, ((a, b), times)) in pairs.iter().take(MAX_NAMED).enumerate() {
            let before = if k == 0 { "," } else { ";" };
            let a_name = parts.name(*a, &mut told, &name);
            let b_name = if a == b { "itself".into() } else { parts.name(*b, &mut told, &name) };
            write!(f, "{before} {a_name} crosses {b_name} ({times}x)")?;
        }
        match pairs.len() - MAX_NAMED.min(pairs.len()) {
            0 => Ok(()),
            others => write!(f, "; and so do {others} other pairs of parts"),
        }
    }
}
