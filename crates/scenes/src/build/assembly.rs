//! Assembly of the bodies of a scene: their particles, numbered through, and what joins them.

use std::ops::Range;

use a3_core::contact::Skin;
use a3_core::elements::{Buckling, Sheet};
use a3_core::{Constraint, MAX_PARTICLES, Path, Spring, Vector3};

use super::pins::pins;
use crate::description::{Pin, Spot};
use crate::fault::Fault;
use crate::surface::Surface;

/// Largest number of springs that belong to no grid.
const MAX_SPRINGS: usize = 1 << 23;

/// Numbers of particles and springs of a body.
pub(super) struct Counts {
    pub particles: usize,
    pub springs: usize,
}

/// A body that a scene is assembled from. Faults have their keys within the body.
pub(super) trait Body {
    /// Numbers of particles and springs, checked before memory is taken.
    fn counts(&self) -> Result<Counts, Fault>;

    /// Adds the body's particles, springs, constraints and surface.
    fn add_to(&self, assembly: &mut Assembly) -> Result<(), Fault>;

    /// Largest length over rest length of the body's springs, if it is limited.
    fn strain_limit(&self) -> Option<f64> {
        None
    }

    /// Pins of the body.
    fn pins(&self) -> &[Pin];

    /// The particles of a spot, numbered from 0 in this body; `None` if the body has no such spot.
    fn spot(&self, spot: Spot, positions: &[Vector3<f64>]) -> Option<Vec<usize>>;
}

/// The bodies so far, put together.
#[derive(Default)]
pub(super) struct Assembly {
    pub masses: Vec<f64>,
    pub positions: Vec<Vector3<f64>>,
    pub velocities: Vec<Vector3<f64>>,
    /// Springs of each cloth.
    pub sheets: Vec<Sheet>,
    pub surface: Surface,
    pub springs: Vec<Spring>,
    pub strips: Vec<Buckling>,
    pub rods: Vec<Constraint>,
    /// Skin of each particle, where surfaces touch.
    pub skins: Vec<Skin>,
    /// Edges and, with equal ends, points that are in no triangle.
    pub edges: Vec<[u32; 2]>,
    pub pins: Vec<(usize, Path)>,
    /// Keys and particles of the bodies whose strain is limited, and the limits.
    pub strain_limits: Vec<(String, Range<usize>, f64)>,
}

impl Assembly {
    /// Adds springs between particles that are numbered from `first` on.
    pub fn add_springs(&mut self, first: usize, springs: impl IntoIterator<Item = Spring>) {
        self.springs.extend(springs.into_iter().map(|s| Spring {
            i: s.i + first,
            j: s.j + first,
            ..s
        }));
    }

    /// Adds buckling springs between particles that are numbered from `first` on.
    pub fn add_strips(&mut self, first: usize, strips: Vec<Buckling>) {
        self.strips.extend(strips.into_iter().map(|s| Buckling {
            i: s.i + first,
            j: s.j + first,
            ..s
        }));
    }

    /// Adds the surface of the body that was added last, whose particles are numbered from `first`
    /// on.
    pub fn add_surface(&mut self, first: usize, triangles: impl IntoIterator<Item = [u32; 3]>) {
        let triangles = triangles.into_iter().map(|t| t.map(|i| i + first as u32));
        self.surface.triangles.extend(triangles);
        self.surface.bodies.push(self.masses.len());
    }

    /// Adds a body that has that key.
    pub fn add(&mut self, key: &str, body: &dyn Body) -> Result<(), Fault> {
        let counts = body.counts().map_err(|fault| fault.within(key))?;
        let particles = self.masses.len().saturating_add(counts.particles);
        if particles > MAX_PARTICLES {
            return Err(Fault::new(
                key,
                format!(
                    "the scene would have {particles} particles; at most {MAX_PARTICLES} are allowed"
                ),
            ));
        }
        // The springs of a cloth take no memory one by one.
        let springs = self.springs.len().saturating_add(counts.springs);
        if springs > MAX_SPRINGS && !key.starts_with("cloth") {
            return Err(Fault::new(
                key,
                format!(
                    "the scene would have some {springs} springs; at most {MAX_SPRINGS} are allowed besides those of cloths"
                ),
            ));
        }
        let first = self.masses.len();
        body.add_to(self).map_err(|fault| fault.within(key))?;
        if let Some(limit) = body.strain_limit() {
            let particles = first..self.masses.len();
            self.strain_limits.push((key.into(), particles, limit));
        }
        let positions = &self.positions[first..];
        let pins = pins(body.pins(), positions, |spot| body.spot(spot, positions))
            .map_err(|fault| fault.within(key))?;
        self.pins
            .extend(pins.into_iter().map(|(i, path)| (first + i, path)));
        Ok(())
    }
}
