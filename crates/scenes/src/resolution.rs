//! The same scene on finer or coarser grids and lattices, with the same mass, stiffness and
//! damping of its materials.

use std::collections::HashMap;

use a3_core::Vector3;

use crate::assemble::{damping_time, fluid_points, max_thickness, restrip};
use crate::description::{Cloth, Description, Fluid, Jelly, Pin};

/// Scene on another grid, with the places of the first grid's particles there.
#[derive(Clone, Debug)]
pub struct Regridded {
    /// Description of the scene on the other grid.
    pub description: Description,
    /// Particles of the first grid, each as a weighted mean of particles of the other grid, by
    /// multilinear interpolation in its cells: their numbers and weights. At the edges of a fluid,
    /// weights may be negative.
    pub places: Vec<Vec<(usize, f64)>>,
}

/// Returns the same scene on grids whose cells are about `factor` times shorter, or longer for
/// a factor below 1, and have the same shape. `particles` is the number of the scene's own
/// particles.
///
/// A cloth keeps its mass per area, the other bodies their mass per volume, and all keep their
/// elastic moduli and their damping times. Drag and wind keep their force per mass.
///
/// # Errors
/// The scene has no grid, or names particles by their numbers: the reason in words.
pub fn regridded(scene: &Description, factor: f64, particles: usize) -> Result<Regridded, String> {
    check_grids(scene)?;
    let mut other = scene.clone();
    let mut places = GridPlaces::default();
    for (own, other) in scene.cloth.iter().zip(&mut other.cloth) {
        regrid_cloth(own, other, factor)?;
        places.add(&own.grid, &other.grid);
    }
    for (own, other) in scene.jelly.iter().zip(&mut other.jelly) {
        regrid_jelly(own, other, factor);
        places.add_lattice(own.grid, other.grid);
    }
    let mesh_is_before = !scene.mesh.is_empty();
    for (own, other) in scene.solid.iter().zip(&mut other.solid) {
        let Some(grid) = own.grid else {
            return Err("a solid from a file has no grid".into());
        };
        refuse!(if mesh_is_before => "a solid keeps its grid if the scene has meshes");
        let finer = finer(grid, factor);
        other.grid = Some(finer);
        places.add_lattice(grid, finer);
    }
    let lattices = regrid_fluids(&scene.fluid, &mut other.fluid, factor)?;
    let in_fluids: usize = lattices.iter().map(|(own, _)| own.len()).sum();
    places.add_others(particles.saturating_sub(in_fluids));
    for (own, lattice) in &lattices {
        places.add_points(own, lattice)?;
    }
    keep_forces_per_mass(&mut other, scene, &places)?;
    other.trail = None;
    refuse!(if places.count == particles => "its cells cannot be larger and keep their shape");
    Ok(Regridded { description: other, places: places.of })
}

/// Counts the bodies that may have a grid.
fn gridded(scene: &Description) -> usize {
    scene.cloth.len() + scene.jelly.len() + scene.solid.len() + scene.fluid.len()
}

/// Checks that a body has a grid, and that nothing in the scene refers to single particles.
fn check_grids(scene: &Description) -> Result<(), String> {
    refuse!(if gridded(scene) == 0 => "no body has a grid that could be finer");
    refuse!(if !scene.fluid.is_empty() && !scene.body.is_empty() =>
        "rigid bodies carry particles of the fluid's lattice");
    for cloth in &scene.cloth {
        refuse!(if cloth.spacing.is_some() || cloth.mass.is_some() =>
            "a cloth gives the mass and the distance of its particles, not its width and density");
    }
    refuse!(if scene.jelly.iter().any(|jelly| jelly.mass.is_some()) =>
        "a jelly gives the mass of its particles, not its density");
    let pins = scene.cloth.iter().map(|it| &it.pin);
    let pins = pins.chain(scene.jelly.iter().map(|it| &it.pin));
    let mut pins = pins.chain(scene.solid.iter().map(|it| &it.pin)).flatten();
    let by_number = |pin: &Pin| !pin.particles.is_empty();
    let numbers = [
        (pins.any(by_number) || !scene.pin.is_empty(), "pins"),
        (!scene.springs.is_empty(), "springs"),
        (!scene.constraint.is_empty(), "constraints"),
        (!scene.torn.is_empty(), "torn springs"),
        (scene.state.is_some(), "a state"),
    ];
    for (is_there, what) in numbers {
        refuse!(if is_there => "the scene has {what} that name particles by their numbers");
    }
    Ok(())
}

/// Keeps the force per mass of drag and wind that are given for each particle.
fn keep_forces_per_mass(
    scene: &mut Description,
    own: &Description,
    places: &GridPlaces,
) -> Result<(), String> {
    let [was, is] = [places.of.len(), places.count].map(|n| n as f64);
    let by_particle = own.drag.is_some() || own.drag_per_mass.is_some();
    let wind = scene.wind.as_mut();
    let pushed = wind.filter(|wind| wind.force.is_some() || wind.force_per_mass.is_some());
    let uneven = places.kept > 0 || gridded(own) > 1;
    refuse!(if uneven && (by_particle || pushed.is_some()) =>
        "drag or wind is the same for each particle of several bodies");
    // The mean mass falls as the number of particles rises.
    if let Some(drag) = &mut scene.drag {
        *drag *= was / is;
    }
    if let Some(force) = pushed.and_then(|wind| wind.force.as_mut()) {
        *force = force.map(|f| f * was / is);
    }
    Ok(())
}

/// Puts a cloth on a grid with cells about `factor` times shorter.
fn regrid_cloth(own: &Cloth, other: &mut Cloth, factor: f64) -> Result<(), String> {
    let words = |fault: crate::Fault| fault.to_string();
    let mass = own.checked_mass().map_err(words)?;
    let time = damping_time(own.damping, own.damping_ratio, mass, own.stiffness[0]);
    (other.damping, other.damping_ratio) = (Some(time.map_err(words)?), None);
    other.grid = finer(own.grid, factor);
    let [default, max] = [own, &*other].map(Cloth::checked_spacing);
    let max = max_thickness(max.map_err(words)?);
    let default = max_thickness(default.map_err(words)?);
    other.thickness = Some(own.thickness.unwrap_or(default).min(max));
    restrip(own, other).map_err(words)
}

/// Puts a jelly on a grid with cells about `factor` times shorter.
fn regrid_jelly(own: &Jelly, other: &mut Jelly, factor: f64) {
    other.grid = finer(own.grid, factor);
    let cell = |jelly: &Jelly, axis: usize| jelly.size[axis] / (jelly.grid[axis].max(2) - 1) as f64;
    let spacing = |jelly: &Jelly| (cell(jelly, 0) * cell(jelly, 1) * cell(jelly, 2)).cbrt();
    // Young's modulus of a lattice is the stiffness of its springs over their length.
    let ratio = spacing(other) / spacing(own);
    other.stiffness = own.stiffness.map(|k| k * ratio);
    if let Some(ratio) = own.damping_ratio {
        let particles = own.grid.iter().product::<usize>() as f64;
        let volume = own.size.iter().product::<f64>();
        let mass = own.density.unwrap_or_default() * volume / particles;
        other.damping = Some(2.0 * ratio * (mass / own.stiffness[0]).sqrt());
        other.damping_ratio = None;
    }
    let nearest = |jelly: &Jelly| (0..3).map(|a| cell(jelly, a)).fold(f64::INFINITY, f64::min);
    let default = max_thickness(nearest(own));
    let thickness = own.thickness.unwrap_or(default);
    other.thickness = Some(thickness.min(max_thickness(nearest(other))));
}

/// Largest number of particles of a fluid, with its tank, on another lattice.
const MAX_PARTICLES: f64 = 1e6;

/// Positions of particles (m), by their numbers.
type Points = Vec<Vector3<f64>>;

/// Puts fluids on lattices whose spacing is about `factor` times shorter, and which fill the same
/// boxes. Returns the particles of each fluid and of each tank, by their positions (m), with the
/// other lattice of each.
///
/// # Errors
/// A fluid makes no sense, or would have too many particles.
fn regrid_fluids(
    own: &[Fluid],
    other: &mut [Fluid],
    factor: f64,
) -> Result<Vec<(Points, GridLattice)>, String> {
    refuse!(if own.iter().any(|fluid| fluid.inflow.is_some()) =>
        "a fluid that flows in has no other lattice");
    // All fluids of a scene have the same spacing, so that all edges are multiples of the other.
    let edges = own.iter().flat_map(|fluid| {
        let tank = fluid.tank.iter().flat_map(|tank| tank.size);
        let edges = fluid.size.into_iter().chain(tank);
        edges.map(|edge| (edge / fluid.spacing).round() as usize)
    });
    let cells = edges.fold(0, gcd);
    let ratio = cells as f64 / divided(cells, factor) as f64;
    let mut lattices = vec![];
    for (own, other) in own.iter().zip(other) {
        other.spacing = own.spacing * ratio;
        let points = |fluid: &Fluid| fluid_points(fluid).map_err(|fault| fault.to_string());
        let own = points(own)?;
        let dimensions = other.dimensions;
        let count = own.iter().map(Vec::len).sum::<usize>() as f64;
        refuse!(if count * ratio.powi(-i32::from(dimensions)) > MAX_PARTICLES =>
            "a finer fluid has too many particles");
        for (own, points) in own.into_iter().zip(points(other)?) {
            let lattice = GridLattice::new(&points, other.spacing, dimensions.into());
            lattices.push((own, lattice));
        }
    }
    Ok(lattices)
}

/// Returns a grid with cells of the same shape, about `factor` times shorter. A grid is given by
/// its numbers of particles.
fn finer<const N: usize>(grid: [usize; N], factor: f64) -> [usize; N] {
    let cells = grid.map(|n| n.max(2) - 1);
    let parts = cells.into_iter().fold(0, gcd);
    cells.map(|n| n / parts * divided(parts, factor) + 1)
}

/// Returns the number of cells about `factor` times shorter in the place of `cells`, at least 1.
fn divided(cells: usize, factor: f64) -> usize {
    ((cells as f64 * factor).round() as usize).max(1)
}

/// Returns the greatest common divisor.
fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Places of the particles of one grid on another, body by body.
#[derive(Default)]
struct GridPlaces {
    /// Place of each particle, as a weighted mean of particles of the other grid: their numbers and
    /// weights.
    pub of: Vec<Vec<(usize, f64)>>,
    /// Number of particles of the scene on the other grid.
    pub count: usize,
    /// Number of particles that belong to no grid.
    pub kept: usize,
}

impl GridPlaces {
    /// Adds a body with its numbers of particles along each axis, on its own grid and on the other.
    /// The index along the last axis varies fastest.
    pub fn add(&mut self, own: &[usize], other: &[usize]) {
        let first = self.count;
        let total: usize = own.iter().product();
        for number in 0..total {
            // The place along each axis: the index of the particle before it, and the distance from
            // there in cells.
            let mut rest = number;
            let along = own.iter().zip(other).rev().map(|(&n, &m)| {
                let i = rest % n;
                rest /= n;
                let at = i as f64 * (m - 1) as f64 / (n.max(2) - 1) as f64;
                let before = (at.floor() as usize).min(m - 2);
                (before, at - before as f64, m)
            });
            let mut along: Vec<(usize, f64, usize)> = along.collect();
            along.reverse();
            let mut corners = vec![(0, 1.0)];
            for (before, share, m) in along {
                let both = corners.iter().flat_map(|&(at, weight)| {
                    let at = at * m + before;
                    [(at, weight * (1.0 - share)), (at + 1, weight * share)]
                });
                corners = both.filter(|(_, weight)| *weight > 1e-12).collect();
            }
            let corners = corners.into_iter().map(|(at, w)| (first + at, w));
            self.of.push(corners.collect());
        }
        self.count += other.iter().product::<usize>();
    }

    /// Adds a lattice, in which the index along x varies fastest.
    pub fn add_lattice(&mut self, [x, y, z]: [usize; 3], [i, j, k]: [usize; 3]) {
        self.add(&[z, y, x], &[k, j, i]);
    }

    /// Adds the other particles of the scene, up to this number in all, which belong to no grid.
    pub fn add_others(&mut self, particles: usize) {
        self.kept = particles.saturating_sub(self.of.len());
        for _ in 0..self.kept {
            self.of.push(vec![(self.count, 1.0)]);
            self.count += 1;
        }
    }

    /// Adds particles of a fluid or of the walls of a tank: their positions (m) on their own
    /// lattice, and those of all particles on the other. Each is interpolated in the nearest cell
    /// that has a particle at each corner, and extrapolated from it where that does not enclose it.
    ///
    /// # Errors
    /// The other lattice has no such cell near a particle.
    pub fn add_points(&mut self, own: &[Vector3<f64>], other: &GridLattice) -> Result<(), String> {
        for place in own {
            let corners = other.corners(place);
            let corners = corners.ok_or("a fluid has too few particles on another lattice")?;
            let corners = corners.into_iter().map(|(at, w)| (self.count + at, w));
            self.of.push(corners.collect());
        }
        self.count += other.numbers.len();
        Ok(())
    }
}

/// Particles on points of a cubic lattice, or of a square one across z.
struct GridLattice {
    origin: Vector3<f64>,
    spacing: f64,
    /// Number of axes.
    dimensions: usize,
    /// Number of the particle on each point that has one.
    numbers: HashMap<[i64; 3], usize>,
}

/// Largest distance of a cell from a particle that is interpolated in it (cells).
const MAX_DISTANCE: i64 = 5;

impl GridLattice {
    /// Creates the lattice of particles at these positions (m).
    pub fn new(points: &[Vector3<f64>], spacing: f64, dimensions: usize) -> Self {
        let origin = points.first().copied().unwrap_or_default();
        let index = |place: &Vector3<f64>| {
            let cells = (place - origin) / spacing;
            [0, 1, 2].map(|axis| cells[axis].round() as i64)
        };
        let numbers = points.iter().enumerate().map(|(i, p)| (index(p), i));
        Self { origin, spacing, dimensions, numbers: numbers.collect() }
    }

    /// Returns the particles at the corners of the nearest complete cell, with their weights at a
    /// place (m).
    fn corners(&self, place: &Vector3<f64>) -> Option<Vec<(usize, f64)>> {
        let at = (place - self.origin) / self.spacing;
        // Rounding must not move a place across a point of the lattice.
        let first = [0, 1, 2].map(|axis| (at[axis] + 1e-9).floor() as i64);
        let nearest = |distance: i64| {
            let offsets = (-distance..=distance).flat_map(move |z| {
                (-distance..=distance)
                    .flat_map(move |y| (-distance..=distance).map(move |x| [x, y, z]))
            });
            let ring = offsets.filter(|offset| {
                offset.iter().any(|k| k.abs() == distance)
                    && offset[self.dimensions..].iter().all(|k| *k == 0)
            });
            let cells = ring.map(|offset| [0, 1, 2].map(|axis| first[axis] + offset[axis]));
            let complete = cells.filter_map(|cell| Some((self.weights(cell, &at)?, cell)));
            complete.min_by(|(_, a), (_, b)| {
                let far = |cell: &[i64; 3]| {
                    let axes = 0..self.dimensions;
                    axes.map(|k| (cell[k] as f64 + 0.5 - at[k]).powi(2)).sum::<f64>()
                };
                far(a).total_cmp(&far(b))
            })
        };
        (0..=MAX_DISTANCE).find_map(nearest).map(|found| found.0)
    }

    /// Returns the particles at the corners of a cell, with their weights at a place (cells).
    /// `None` if one of them is missing.
    fn weights(&self, cell: [i64; 3], at: &Vector3<f64>) -> Option<Vec<(usize, f64)>> {
        let corners = (0..1_usize << self.dimensions).map(|corner| {
            let (mut point, mut weight) = (cell, 1.0);
            for axis in 0..self.dimensions {
                let share = at[axis] - cell[axis] as f64;
                let is_far = corner >> axis & 1 == 1;
                point[axis] += i64::from(is_far);
                weight *= if is_far { share } else { 1.0 - share };
            }
            Some((*self.numbers.get(&point)?, weight))
        });
        corners.collect()
    }
}
