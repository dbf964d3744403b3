//! Contact of surfaces in a network: their primitives, the list of pairs that may touch, and how
//! far they may be from the straight courses that the collision safeguard takes them along.

use nalgebra::Vector3;

use super::candidates::{Candidates, Linear, Stretch};
use super::cut::Cuts;
use super::listing::Candidate;
use super::motion::Motion;
use super::obstacle::Obstacle;
use super::repulsion::{Pair, Stiffness};
use super::surface::Surface;
use crate::scratch::Scratch;

/// Contact of the surfaces of a network with themselves, one another and obstacles.
#[derive(Clone, Debug)]
pub struct ContactLayer {
    surface: Surface,
    obstacles: Vec<Obstacle>,
    pub(super) scratch: Scratch<Buffers>,
}

/// The list of pairs of primitives, and positions (m) and velocities (m/s) of all vertices.
#[derive(Default)]
pub(super) struct Buffers {
    pub candidates: Candidates,
    pub motion: Motion,
    pub cuts: Cuts,
    pub x: Vec<Vector3<f64>>,
    v: Vec<Vector3<f64>>,
}

impl ContactLayer {
    /// Creates the contact of a surface that was made with these obstacles.
    #[must_use]
    pub fn new(surface: Surface, obstacles: Vec<Obstacle>) -> Self {
        Self { surface, obstacles, scratch: Scratch::default() }
    }

    /// Returns the surface of the bodies and obstacles that can touch.
    #[must_use]
    pub fn surface(&self) -> &Surface {
        &self.surface
    }

    /// Returns the obstacles.
    pub(super) fn obstacles(&self) -> &[Obstacle] {
        &self.obstacles
    }

    /// Moves an obstacle along another path.
    pub(crate) fn set_obstacle(&mut self, k: usize, obstacle: Obstacle) {
        self.obstacles[k] = obstacle;
    }

    /// Visits what `find` has found for the pairs that may be within their thickness at time t (s)
    /// in the state (x, v), or at rest without v, in canonical order. Several threads may call
    /// `find`.
    fn visit<R: Send>(
        &self,
        t: f64,
        x: &[f64],
        v: Option<&[f64]>,
        find: impl Fn(&Candidate, &Pair) -> Option<R> + Sync,
        visit: impl FnMut(R),
    ) {
        self.scratch.lend(|buffers| self.visit_with(buffers, (t, x, v), find, visit));
    }

    fn visit_with<R: Send>(
        &self,
        buffers: &mut Buffers,
        (t, x, v): (f64, &[f64], Option<&[f64]>),
        find: impl Fn(&Candidate, &Pair) -> Option<R> + Sync,
        visit: impl FnMut(R),
    ) {
        let Buffers { candidates, x: places, v: speeds, .. } = buffers;
        self.surface.place(&self.obstacles, t, x, places);
        speeds.clear();
        match v {
            Some(v) => self.surface.speeds(&self.obstacles, t, v, speeds),
            None => speeds.resize(places.len(), Vector3::zeros()),
        }
        let stretch = Stretch { times: [t; 2], ends: [places; 2], speeds: Some(speeds) };
        candidates.cover(&self.surface, &stretch);
        let still = Linear { x: places, moves: None, rounding: self.surface.rounding() };
        self.surface.each_bare(candidates, &still, speeds, find, visit);
    }

    /// Adds the forces (N) at time t (s) in the state (x, v) to f.
    pub(crate) fn add_repulsion(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let find = |candidate: &Candidate, pair: &Pair| Some((candidate.points, pair.forces()?));
        self.visit(t, x, Some(v), find, |(points, forces)| {
            add(&points, &forces, f);
        });
    }

    /// Adds the change of the forces (N) by dx (m) and dv (m/s) to df.
    pub(crate) fn add_repulsion_differential(
        &self,
        t: f64,
        [x, v]: [&[f64]; 2],
        [dx, dv]: [&[f64]; 2],
        df: &mut [f64],
    ) {
        let find = |candidate: &Candidate, pair: &Pair| {
            let of = |a: &[f64]| candidate.points.map(|i| row(a, i));
            Some((candidate.points, pair.differential(&of(dx), &of(dv))?))
        };
        self.visit(t, x, Some(v), find, |(points, forces)| {
            add(&points, &forces, df);
        });
    }

    /// Returns the energy of repulsion (J) at time t (s) in the state (x, v).
    pub(crate) fn repulsion_energy(&self, t: f64, x: &[f64], v: &[f64]) -> f64 {
        let mut energy = 0.0;
        let find = |_: &Candidate, pair: &Pair| Some(pair.energy());
        self.visit(t, x, Some(v), find, |of_pair| energy += of_pair);
        energy
    }

    /// Returns the penetration at time t (s) at x (m), n x 3: the largest depth over the thickness.
    /// It is 0 where nothing touches, and 1 where a gap is 0.
    #[must_use]
    pub fn penetration(&self, t: f64, x: &[f64]) -> f64 {
        let mut deepest = 0.0_f64;
        let find = |_: &Candidate, pair: &Pair| Some(pair.share());
        self.visit(t, x, None, find, |share| deepest = deepest.max(share));
        deepest
    }

    /// Visits the stiffness of each pair, with its points, at time t (s) at x, at rest.
    pub(crate) fn stiffnesses(
        &self,
        t: f64,
        x: &[f64],
        mut visit: impl FnMut([u32; 4], Stiffness),
    ) {
        let find = |candidate: &Candidate, pair: &Pair| Some((candidate.points, pair.stiffness()?));
        self.visit(t, x, None, find, |(points, stiffness)| {
            visit(points, stiffness);
        });
    }

    /// Returns whether the forces depend on velocities.
    pub(crate) fn is_damped(&self) -> bool {
        self.surface.is_damped()
    }
}

/// Returns row i of an n x 3 matrix, or zero for a vertex of an obstacle.
fn row(a: &[f64], i: u32) -> Vector3<f64> {
    let (n, i) = (a.len() / 3, i as usize);
    if i < n { Vector3::new(a[i], a[n + i], a[2 * n + i]) } else { Vector3::zeros() }
}

/// Adds vectors to the rows of an n x 3 matrix, except to those of obstacles.
fn add(points: &[u32; 4], vectors: &[Vector3<f64>; 4], f: &mut [f64]) {
    let n = f.len() / 3;
    for (i, vector) in points.iter().zip(vectors) {
        let i = *i as usize;
        if i < n {
            f[i] += vector.x;
            f[n + i] += vector.y;
            f[2 * n + i] += vector.z;
        }
    }
}
