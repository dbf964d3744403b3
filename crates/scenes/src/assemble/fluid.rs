//! Fluids and their tanks: particles on a lattice, and liquid that flows in through an opening.
//!
//! That is a column of pinned particles behind the opening, which moves at the speed of the flow.
//! Each layer is let go as it passes the opening, so that the liquid that has flowed in always has
//! its neighbours behind it.

use std::ops::Range;

use a3_core::contact::Skin;
use a3_core::elements::{Fluid as Liquid, FluidLaw, Outflow as Space};
use a3_core::{Network, Path, Pin as Held, Rounded, Vector3};

use super::assembly::{Assembly, Body, Files, point_skin};
use crate::budget::{PINS, SMOOTHED};
use crate::description::{Fluid, FluidShape, Inflow, Outflow, SkinKeys};
use crate::fault::{Fault, at, at_least, key_of, positive};

/// Thickness of the skin of a particle, relative to the spacing.
const THICKNESS: f64 = 1.0;

/// Smallest initial distance of two particles of a fluid, relative to the spacing. Nearer ones
/// would repel each other violently.
const MIN_DISTANCE: f64 = 0.7;

/// Time in which sound crosses the spacing (s), from which on the methods' default steps, which are
/// chosen for cloth, suit a fluid.
const MIN_SOUND_TIME: f64 = 0.0125;

/// Returns the factor of the methods' default steps for these fluids, so that sound moves by a
/// fraction of the spacing in each step.
pub(super) fn step_scale(fluids: &[Fluid]) -> f64 {
    let scale = |fluid: &Fluid| fluid.spacing / fluid.sound / MIN_SOUND_TIME;
    fluids.iter().map(scale).fold(1.0, f64::min)
}

/// Lattices of a fluid.
struct Lattices<'a> {
    /// Liquid at the start.
    liquid: Option<ParticleLattice>,
    /// Space in the tank.
    tank: Option<ParticleLattice>,
    /// Liquid that flows in.
    column: Option<Column<'a>>,
    /// Space in which it flows out.
    outflows: Vec<Space>,
}

impl Fluid {
    fn law(&self) -> FluidLaw {
        FluidLaw {
            dimensions: self.dimensions,
            spacing: self.spacing,
            density: self.density,
            sound: self.sound,
            viscosity: self.viscosity,
        }
    }

    /// Returns the lattices of the fluid.
    fn lattices(&self) -> Result<Lattices<'_>, Fault> {
        for (key, number) in
            [("spacing", self.spacing), ("density", self.density), ("sound", self.sound)]
        {
            at(key, positive("it", number))?;
        }
        at("viscosity", at_least(0.0, "it", self.viscosity))?;
        refuse!(if !matches!(self.dimensions, 2 | 3) => "dimensions":
            "it must be 2 or 3, not {}", self.dimensions);
        let is_none = self.inflow.is_some() && self.size == [0.0; 3];
        let liquid = (!is_none).then(|| ParticleLattice::new(self, self.size, self.at));
        let tank = self.tank.as_ref().map(|tank| {
            let space = ParticleLattice::new(self, tank.size, tank.at);
            space.map_err(|fault| fault.within("tank"))
        });
        let column = self.inflow.as_ref().map(|inflow| {
            let column = Column::new(self, inflow);
            column.map_err(|fault| fault.within("inflow"))
        });
        Ok(Lattices {
            liquid: liquid.transpose()?,
            tank: tank.transpose()?,
            column: column.transpose()?,
            outflows: spaces(self)?,
        })
    }

    /// Checks that the fluid begins within its tank, or above its open top.
    fn check_inside(&self) -> Result<(), Fault> {
        let Some(tank) = self.tank.as_ref().filter(|_| self.size != [0.0; 3]) else {
            return Ok(());
        };
        for axis in 0..usize::from(self.dimensions) {
            let reach = |size: [f64; 3], at: [f64; 3]| {
                [at[axis] - 0.5 * size[axis], at[axis] + 0.5 * size[axis]]
            };
            let [low, high] = reach(self.size, self.at);
            let [floor, wall] = reach(tank.size, tank.at);
            let slack = 1e-6 * self.spacing;
            if low < floor - slack || axis != 1 && high > wall + slack {
                let name = ["x", "y", "z"][axis];
                let why = format!(
                    "the fluid would reach from {name} = {low} to {high}, outside the tank's walls \
                     at {floor} and {wall}"
                );
                return Err(Fault::new("at", why));
            }
        }
        Ok(())
    }
}

/// Returns the initial positions (m) of a fluid's particles, and of the particles in the walls of
/// its tank, in the order of their numbers. Between them are those that flow in.
///
/// # Errors
/// A number makes no sense.
pub fn fluid_points(fluid: &Fluid) -> Result<[Vec<Vector3<f64>>; 2], Fault> {
    let lattices = fluid.lattices()?;
    let half = 0.5 * Vector3::from(fluid.size);
    let is_in_shape = |place: &Vector3<f64>| {
        let from_center = place - Vector3::from(fluid.at);
        let share = |axis: usize| match half[axis] {
            0.0 => 0.0,
            half => (from_center[axis] / half).powi(2),
        };
        fluid.shape == FluidShape::Box || (0..3).map(share).sum::<f64>() <= 1.0
    };
    let all = lattices.liquid.iter().flat_map(|places| places.all(0));
    let all = all.map(|(place, _)| place);
    let slack = SLACK * fluid.spacing;
    let is_open = |place: &Vector3<f64>| {
        let flows_in = lattices.column.as_ref().is_some_and(|it| it.passes(place));
        flows_in || lattices.outflows.iter().any(|it| it.contains(place, slack))
    };
    let tank = lattices.tank.iter();
    let walls = tank.flat_map(|tank| tank.all(LAYERS.into()));
    let walls = walls.filter(|(_, inside)| !inside).map(|(place, _)| place);
    let walls = walls.filter(|place| !is_open(place));
    Ok([all.filter(is_in_shape).collect(), walls.collect()])
}

impl Body for Fluid {
    fn add_to(&self, assembly: &mut Assembly, files: &mut Files) -> Result<(), Fault> {
        let lattices = self.lattices()?;
        let count =
            |places: Option<&ParticleLattice>, layers| places.map_or(0, |it| it.count(layers));
        let flows_in = count(lattices.column.as_ref().map(|it| &it.places), 0);
        let flowing = count(lattices.liquid.as_ref(), 0).saturating_add(flows_in);
        let tank = lattices.tank.as_ref();
        let walls = count(tank, LAYERS.into()).saturating_sub(count(tank, 0));
        let all = flowing.saturating_add(walls);
        let pinned = walls.saturating_add(flows_in);
        files.spend(all, &[(all, SMOOTHED), (pinned, PINS)])?;
        self.check_inside()?;
        let [fluid, walls] = fluid_points(self)?;
        let first = assembly.masses.len();
        let velocity = Vector3::from(self.velocity.unwrap_or_default());
        let strain = Vector3::from(self.strain.unwrap_or_default());
        for place in fluid {
            let strained = strain.component_mul(&(place - Vector3::from(self.at)));
            assembly.positions.push(place);
            assembly.velocities.push(velocity + strained);
        }
        let end = assembly.positions.len();
        assembly.drops.extend(first as u32..end as u32);
        let (column, next) = (lattices.column.iter(), assembly.positions.len());
        for (place, velocity, pin) in column.flat_map(|column| column.particles(next)) {
            assembly.positions.push(place);
            assembly.velocities.push(velocity);
            // What is never let go is a wall.
            if pin.is_none_or(|pin| pin.until.is_some()) {
                assembly.drops.push(assembly.positions.len() as u32 - 1);
            }
            assembly.pins.paths.extend(pin);
        }
        let free = assembly.positions.len();
        for place in walls {
            let i = assembly.positions.len();
            assembly.pins.paths.push(Held::new(i, Path::Still(place)));
            assembly.positions.push(place);
            assembly.velocities.push(Vector3::zeros());
        }
        let all = assembly.positions.len();
        let (mass, thickness) = (self.law().mass(), THICKNESS * self.spacing);
        assembly.masses.resize(all, mass);
        // As stiff as the fluid itself; against soft bodies, theirs counts.
        let stiffness = mass * (self.sound / self.spacing).powi(2);
        let keys = SkinKeys { contact_stiffness: Some(stiffness), ..SkinKeys::default() };
        let skin = point_skin(keys, assembly.gravity, [mass, thickness])?;
        assembly.skins.resize(free, skin);
        // Surfaces do not touch walls.
        assembly.skins.resize(all, Skin::default());
        if all > free {
            assembly.presentation.tanks.push(free..all);
        }
        let (law, particles) = (self.law(), first..all);
        assembly.outflows.extend(lattices.outflows);
        match &mut assembly.fluid {
            None => assembly.fluid = Some((law, vec![particles])),
            Some((other, all)) if *other == law => all.push(particles),
            Some(_) => {
                refuse!("": "all fluids of a scene are one liquid: spacing, density, sound, \
                viscosity and dimensions must be those of the first")
            }
        }
        Ok(())
    }
}

/// Adds the fluid of all bodies to a network, whose initial positions are `x` (m). It touches the
/// `soaked` points of rigid bodies.
pub(super) fn add(
    fluid: Option<(FluidLaw, Vec<Range<usize>>)>,
    outflows: Vec<Space>,
    soaked: Vec<Range<usize>>,
    network: &mut Network,
    x: &[f64],
) -> Result<(), Fault> {
    let Some((law, particles)) = fluid else {
        return Ok(());
    };
    let particles = particles.into_iter().chain(soaked).flatten();
    let particles = particles.map(|i| i as u32);
    let fluid = at("fluid", Liquid::new(law, particles.collect()))?;
    refuse!(if outflows.len() > MAX_OUTFLOWS => "fluid":
        "there are {} outflows, more than {MAX_OUTFLOWS}", outflows.len());
    let fluid = at("fluid", fluid.with_outflows(outflows))?;
    if let Some(([i, j], distance)) = fluid.nearest_pair(x)
        && distance < MIN_DISTANCE * law.spacing
    {
        let apart = format!(
            "{} m apart; at least {} m is needed, so that they do not fly apart",
            Rounded(distance),
            Rounded(MIN_DISTANCE * law.spacing)
        );
        let body = |i: u32| network.body_of(i as usize);
        if let Some(k) = body(i).or(body(j)) {
            let key = key_of("body", k, network.bodies().len());
            let room = "move the body, or the liquid that begins in its place";
            refuse!(key: "a point of it and a particle of the liquid would begin {apart}: {room}");
        }
        refuse!("fluid": "particles {i} and {j} would begin {apart}");
    }
    at("fluid", network.add(fluid))
}

/// Column of particles behind the opening of an inflow of a fluid.
struct Column<'a> {
    places: ParticleLattice,
    fluid: &'a Fluid,
    inflow: &'a Inflow,
    /// Axis and speed (m/s) of the flow.
    axis: usize,
    speed: f64,
    /// Number of layers that flow in.
    layers: f64,
}

impl<'a> Column<'a> {
    /// Creates the column of an inflow of a fluid.
    pub fn new(fluid: &'a Fluid, inflow: &'a Inflow) -> Result<Self, Fault> {
        let velocity = Vector3::from(inflow.velocity);
        let speed = velocity.norm();
        let axis = (0..3).find(|axis| velocity[*axis].abs() == speed);
        let Some(axis) = axis.filter(|axis| speed > 0.0 && (fluid.dimensions == 3 || *axis < 2))
        else {
            let why = format!(
                "it must be along one of the axes x, y{}, not {:?}",
                if fluid.dimensions == 3 { ", z" } else { "" },
                inflow.velocity
            );
            return Err(Fault::new("velocity", why));
        };
        refuse!(if inflow.size[axis] != 0.0 => "size":
            "along the velocity, the opening has the length 0, not {}", inflow.size[axis]);
        at("duration", positive("it", inflow.duration))?;
        at("ahead", at_least(0.0, "it", inflow.ahead))?;
        let layers = (inflow.duration * speed / fluid.spacing).round().max(1.0);
        let mut size = inflow.size;
        // Three more layers close the opening behind the last ones.
        size[axis] = (layers + f64::from(LAYERS)) * fluid.spacing;
        let middle = Vector3::from(inflow.at) - velocity * (0.5 * size[axis] / speed);
        let places = ParticleLattice::new(fluid, size, middle.into())?;
        Ok(Self { places, fluid, inflow, axis, speed, layers })
    }

    /// Lists the particles, numbered from `first`: their places (m) and velocities (m/s) at the
    /// start, and the pins that hold them then. What has flowed in has flown straight on.
    pub fn particles(
        &self,
        first: usize,
    ) -> impl Iterator<Item = (Vector3<f64>, Vector3<f64>, Option<Held>)> {
        let (spacing, ahead) = (self.fluid.spacing, self.inflow.ahead);
        let flow = Vector3::from(self.inflow.velocity);
        let flows_until = self.layers * spacing / self.speed - ahead;
        let all = self.places.all(0).map(|(place, _)| place);
        all.zip(first..).map(move |(place, i)| {
            let layer = (self.depth(place) / spacing - 0.5).round();
            let until = (layer + 0.5) * spacing / self.speed - ahead;
            let last = layer >= self.layers;
            // The last layers stop where they close the opening.
            let end = if last { flows_until } else { until };
            let stopped = ahead.min(ahead + end);
            let gone = if last { stopped } else { ahead };
            let here = place + flow * gone;
            if end <= 0.0 {
                let closes = last.then(|| Held::new(i, Path::Still(here)));
                let still = Vector3::zeros();
                let velocity = if last { still } else { flow };
                return (here, velocity, closes);
            }
            let path = Path::Line { from: here, to: here + flow * end, start: 0.0, end };
            let held = Held { until: (!last).then_some(until), ..Held::new(i, path) };
            (here, flow, Some(held))
        })
    }

    /// Returns whether the column passes through a place, so that no wall can be there.
    pub fn passes(&self, place: &Vector3<f64>) -> bool {
        let from = place - Vector3::from(self.inflow.at);
        let spacing = self.fluid.spacing;
        let slack = 1e-6 * spacing;
        let across = (0..3).filter(|axis| *axis != self.axis);
        let mut is_within =
            across.map(|axis| from[axis].abs() <= 0.5 * self.inflow.size[axis] + slack);
        let length = (self.layers + f64::from(LAYERS)) * spacing;
        is_within.all(|is| is) && (-slack..=length + slack).contains(&self.depth(*place))
    }

    /// Returns the distance (m) of a place behind the opening.
    fn depth(&self, place: Vector3<f64>) -> f64 {
        let behind = Vector3::from(self.inflow.at) - place;
        behind.dot(&Vector3::from(self.inflow.velocity)) / self.speed
    }
}

/// Distance outside an outflow at which a particle is inside, relative to the spacing.
const SLACK: f64 = 1e-6;

/// Largest number of outflows of all fluids of a scene.
const MAX_OUTFLOWS: usize = 100;

/// Returns the outflows of a fluid. In two dimensions they are two spacings thick.
fn spaces(fluid: &Fluid) -> Result<Vec<Space>, Fault> {
    let spaces = fluid.outflow.iter().enumerate().map(|(k, outflow)| {
        let space = space(outflow, fluid);
        space.map_err(|fault| fault.within(&format!("outflow[{k}]")))
    });
    spaces.collect()
}

fn space(outflow: &Outflow, fluid: &Fluid) -> Result<Space, Fault> {
    let mut half = 0.5 * Vector3::from(outflow.size);
    if fluid.dimensions == 2 {
        refuse!(if half.z != 0.0 => "size":
            "in two dimensions, its last number is 0, not {}", outflow.size[2]);
        half.z = fluid.spacing;
    }
    for half in half.iter() {
        at("size", positive("each edge", *half))?;
    }
    Ok(Space { at: outflow.at.into(), half })
}

/// Lets the liquid leave the scene that begins in an outflow.
pub(super) fn drain(network: &mut Network, state: &mut [f64]) {
    if let Some(spacing) = network.fluid().map(|fluid| fluid.law().spacing) {
        network.drain(state, SLACK * spacing);
    }
}

/// Number of layers of particles in a wall: with three, the fluid particles next to a wall have all
/// their neighbours.
pub const LAYERS: u32 = 3;

/// Lattice of the particles of a fluid, a tank or a column that flows in.
struct ParticleLattice {
    /// Number of lattice points along each axis.
    counts: [i64; 3],
    /// Corner of the lattice (m).
    corner: Vector3<f64>,
    spacing: f64,
    flat: bool,
}

impl ParticleLattice {
    /// Creates the lattice that fills a box.
    pub fn new(fluid: &Fluid, size: [f64; 3], center: [f64; 3]) -> Result<Self, Fault> {
        let flat = fluid.dimensions == 2;
        let mut counts = [1; 3];
        for (axis, (count, size)) in counts.iter_mut().zip(size).enumerate() {
            if flat && axis == 2 {
                refuse!(if size != 0.0 => "size":
                    "in two dimensions, its last number is 0, not {size}");
                continue;
            }
            at("size", positive("each edge", size))?;
            let whole = (size / fluid.spacing).round();
            refuse!(if whole < 1.0 || (whole * fluid.spacing - size).abs() > 1e-6 * size => "size":
                "each edge must be a whole multiple of the spacing {}, not {size}", fluid.spacing);
            *count = whole as i64;
        }
        Ok(Self {
            counts,
            corner: Vector3::from(center) - 0.5 * Vector3::from(size),
            spacing: fluid.spacing,
            flat,
        })
    }

    /// Counts the points of the lattice with `layers` more around its sides and its bottom.
    pub fn count(&self, layers: i64) -> usize {
        let ends = (0..3).map(|axis| self.range(axis, layers));
        let counts = ends.map(|range| (range.end - range.start) as usize);
        counts.fold(1, usize::saturating_mul)
    }

    /// Returns the indices along an axis, with `layers` more outside.
    fn range(&self, axis: usize, layers: i64) -> Range<i64> {
        let n = self.counts[axis];
        match axis {
            2 if self.flat => 0..1,
            1 => -layers..n,
            _ => -layers..n.saturating_add(layers),
        }
    }

    /// Lists the points of the lattice with `layers` more around its sides and its bottom, x
    /// fastest, and tells whether each is inside.
    pub fn all(&self, layers: i64) -> impl Iterator<Item = (Vector3<f64>, bool)> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.range(axis, layers));
        let places = z.flat_map(move |k| {
            let (x, y) = (x.clone(), y.clone());
            y.flat_map(move |j| x.clone().map(move |i| [i, j, k]))
        });
        places.map(move |place| {
            let inside = (0..3).all(|axis| (0..self.counts[axis]).contains(&place[axis]));
            let depth = if self.flat { -0.5 } else { 0.0 };
            let [i, j, k] = place.map(|k| k as f64 + 0.5);
            let offset = Vector3::new(i, j, k + depth);
            (self.corner + self.spacing * offset, inside)
        })
    }
}
