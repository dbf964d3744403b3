//! Fluids and their tanks: particles on a lattice.

use std::ops::Range;

use a3_core::contact::Skin;
use a3_core::elements::{Fluid as Liquid, FluidLaw};
use a3_core::{Network, Path, Pin as Held, Vector3};

use super::assembly::{Assembly, Body, Counts};
use crate::check::{at, at_least, positive};
use crate::description::{Fluid, FluidShape, Pin, Spot};
use crate::fault::Fault;

/// Number of layers of particles in a wall: with three, the fluid particles next to a wall have all
/// their neighbours.
pub const LAYERS: u32 = 3;

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

/// Lattice of the particles of a fluid or a tank.
struct Places {
    /// Number of lattice points along each axis.
    counts: [i64; 3],
    /// Corner of the lattice (m).
    corner: Vector3<f64>,
    spacing: f64,
    flat: bool,
}

impl Places {
    /// Creates the lattice that fills a box.
    fn new(fluid: &Fluid, size: [f64; 3], center: [f64; 3]) -> Result<Self, Fault> {
        let flat = fluid.dimensions == 2;
        let mut counts = [1; 3];
        for (axis, (count, size)) in counts.iter_mut().zip(size).enumerate() {
            if flat && axis == 2 {
                if size != 0.0 {
                    let why = format!("in two dimensions, its last number is 0, not {size}");
                    return Err(Fault::new("size", why));
                }
                continue;
            }
            at("size", positive("each edge", size))?;
            let whole = (size / fluid.spacing).round();
            if whole < 1.0 || (whole * fluid.spacing - size).abs() > 1e-6 * size {
                let why = format!(
                    "each edge must be a whole multiple of the spacing {}, not {size}",
                    fluid.spacing
                );
                return Err(Fault::new("size", why));
            }
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
    fn count(&self, layers: i64) -> usize {
        let ends = (0..3).map(|axis| self.range(axis, layers));
        ends.fold(1, |all, range| {
            all.saturating_mul((range.end - range.start) as usize)
        })
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
    fn all(&self, layers: i64) -> impl Iterator<Item = (Vector3<f64>, bool)> {
        let [x, y, z] = [0, 1, 2].map(|axis| self.range(axis, layers));
        let places = z.flat_map(move |k| {
            let x = x.clone();
            y.clone()
                .flat_map(move |j| x.clone().map(move |i| [i, j, k]))
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

    /// Returns the lattices of the fluid and of the space in its tank.
    fn places(&self) -> Result<(Places, Option<Places>), Fault> {
        for (key, number) in [
            ("spacing", self.spacing),
            ("density", self.density),
            ("sound", self.sound),
        ] {
            at(key, positive("it", number))?;
        }
        at("viscosity", at_least(0.0, "it", self.viscosity))?;
        if !matches!(self.dimensions, 2 | 3) {
            let why = format!("it must be 2 or 3, not {}", self.dimensions);
            return Err(Fault::new("dimensions", why));
        }
        let fluid = Places::new(self, self.size, self.at)?;
        let tank = self.tank.as_ref().map(|tank| {
            let space = Places::new(self, tank.size, tank.at);
            space.map_err(|fault| fault.within("tank"))
        });
        Ok((fluid, tank.transpose()?))
    }

    /// Checks that the fluid begins within its tank, or above its open top.
    fn check_inside(&self) -> Result<(), Fault> {
        let Some(tank) = &self.tank else {
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
/// its tank, in the order of their numbers.
///
/// # Errors
/// A number makes no sense.
pub fn fluid_points(fluid: &Fluid) -> Result<[Vec<Vector3<f64>>; 2], Fault> {
    let (places, tank) = fluid.places()?;
    let half = 0.5 * Vector3::from(fluid.size);
    let is_in_shape = |place: &Vector3<f64>| {
        let from_center = place - Vector3::from(fluid.at);
        let share = |axis: usize| match half[axis] {
            0.0 => 0.0,
            half => (from_center[axis] / half).powi(2),
        };
        fluid.shape == FluidShape::Box || (0..3).map(share).sum::<f64>() <= 1.0
    };
    let all = places.all(0).map(|(place, _)| place);
    let walls = tank.iter().flat_map(|tank| tank.all(LAYERS.into()));
    let walls = walls.filter(|(_, inside)| !inside).map(|(place, _)| place);
    Ok([all.filter(is_in_shape).collect(), walls.collect()])
}

impl Body for Fluid {
    fn counts(&self) -> Result<Counts, Fault> {
        let (fluid, tank) = self.places()?;
        let walls = tank.map_or(0, |tank| {
            tank.count(LAYERS.into()).saturating_sub(tank.count(0))
        });
        Ok(Counts {
            particles: fluid.count(0).saturating_add(walls),
            smoothed: fluid.count(0).saturating_add(walls),
            walls,
            ..Counts::default()
        })
    }

    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault> {
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
        let free = assembly.positions.len();
        for place in walls {
            let i = assembly.positions.len();
            assembly.pins.paths.push(Held::new(i, Path::Still(place)));
            assembly.positions.push(place);
            assembly.velocities.push(Vector3::zeros());
        }
        let all = assembly.positions.len();
        assembly.masses.resize(all, self.law().mass());
        assembly.skins.resize(all, Skin::default());
        if all > free {
            assembly.tanks.push(free..all);
        }
        let (law, particles) = (self.law(), first..all);
        match &mut assembly.fluid {
            None => assembly.fluid = Some((law, vec![particles])),
            Some((other, all)) if *other == law => all.push(particles),
            Some(_) => {
                let why = "all fluids of a scene are one liquid: spacing, density, sound, \
                           viscosity and dimensions must be those of the first";
                return Err(Fault::new("", why));
            }
        }
        Ok(())
    }

    fn pins(&self) -> &[Pin] {
        &[]
    }

    fn spot(&self, _: Spot, _: &[Vector3<f64>]) -> Option<Vec<usize>> {
        None
    }
}

/// Adds the fluid of all bodies to a network, whose initial positions are `x` (m). It touches the
/// `soaked` points of rigid bodies.
pub(super) fn add(
    fluid: Option<(FluidLaw, Vec<Range<usize>>)>,
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
    if let Some(([i, j], distance)) = fluid.nearest_pair(x)
        && distance < MIN_DISTANCE * law.spacing
    {
        let why = format!(
            "particles {i} and {j} would begin {distance} m apart; at least {} is needed, so that \
             they do not fly apart",
            MIN_DISTANCE * law.spacing
        );
        return Err(Fault::new("fluid", why));
    }
    at("fluid", network.add(fluid))
}
