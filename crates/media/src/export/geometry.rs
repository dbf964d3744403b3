//! The interface of all exports, with checks and encodings of numbers for several of them; and the
//! geometry of a scene for other programs: a surface with normals, and lines and points of
//! particles without one.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::Path;

use a3_core::{Network, Simulation};
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::rounding::{DIGITS, short};
use a3_scenes::Surface;

use crate::surfaces::{tessellation, whole_triangles};

/// What an export is made of.
#[derive(Clone, Copy)]
pub struct Job<'a> {
    pub path: &'a Path,
    pub surface: &'a Surface,
    pub simulation: &'a Simulation,
    pub frames: FrameTimes,
}

/// An export that is being written.
pub trait Export {
    /// Adds the current state as a frame.
    fn add(&mut self, simulation: &Simulation) -> Result<(), Failure>;

    /// Completes the export after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}

/// Returns the velocities of all particles (m/s); a failure if a number of the state is not finite.
pub fn velocities(simulation: &Simulation) -> Result<Vec<f64>, Failure> {
    let velocities = simulation.velocities();
    let mut all = simulation.state().iter().chain(&velocities);
    if all.all(|x| x.is_finite()) {
        return Ok(velocities);
    }
    Err(Failure::run(format!(
        "the state at t = {} s has numbers that are not finite",
        short(simulation.time(), DIGITS)
    )))
}

/// Writes vectors in little-endian single precision, one after the other.
pub fn rows(file: &mut dyn Write, vectors: &[[f32; 3]]) -> io::Result<()> {
    for number in vectors.as_flattened() {
        if !number.is_finite() {
            let why = "a displacement is too large for single precision";
            return Err(io::Error::other(why));
        }
        file.write_all(&number.to_le_bytes())?;
    }
    Ok(())
}

/// The connections between particles, which stay the same from frame to frame until something
/// tears.
pub struct Geometry {
    /// Corners of the triangles of the surface, counter-clockwise as seen from outside.
    pub triangles: Vec<[u32; 3]>,
    /// The ends of springs of particles without a surface.
    pub lines: Vec<[u32; 2]>,
    /// The particles without a surface, except those of rigid bodies and of a tank's walls.
    pub points: Vec<u32>,
    /// Number of all vertices: particles, and after them the points of rigid bodies.
    pub vertices: usize,
}

impl Geometry {
    /// Finds the present geometry of the scene.
    pub fn of(surface: &Surface, simulation: &Simulation) -> Self {
        let covered = surface.particles();
        let network = simulation.model().network();
        let springs = network.into_iter().flat_map(Network::springs);
        let particles = simulation.particles();
        // Liquid that will flow in is pinned until then, and no wall. Some has flowed out again.
        let pins = network.into_iter().flat_map(Network::all_pins);
        let flowing: BTreeSet<usize> =
            pins.filter(|pin| pin.until.is_some()).map(|pin| pin.particle).collect();
        let has_left =
            |i: usize| network.and_then(Network::fluid).is_some_and(|it| it.members().has_left(i));
        let is_wall = |i: usize| {
            network.is_some_and(|n| n.is_wall(i)) && (!flowing.contains(&i) || has_left(i))
        };
        let is_rigid = |i: usize| network.is_some_and(|n| n.body_of(i).is_some());
        let rigid = network.map_or_else(Vec::new, |n| tessellation::triangles(n, particles as u32));
        Self {
            vertices: vertices(simulation),
            lines: springs
                .filter(|spring| spring.i.max(spring.j) >= covered)
                .map(|spring| [spring.i as u32, spring.j as u32])
                .collect(),
            points: (covered..particles)
                .filter(|i| !is_rigid(*i) && !is_wall(*i))
                .map(|i| i as u32)
                .collect(),
            triangles: whole_triangles(simulation).chain(rigid).collect(),
        }
    }

    /// Computes the unit normal at each vertex: the direction of the sum, over its triangles, of
    /// the cross product of two sides, so that triangles are weighted by area. A particle without a
    /// surface has a normal that points upwards.
    pub fn normals(&self, positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
        let mut sums = vec![[0.0f64; 3]; positions.len()];
        for triangle in &self.triangles {
            let [a, b, c] = triangle.map(|i| positions[i as usize].map(f64::from));
            let (u, v) = (minus(b, a), minus(c, a));
            let cross = [0, 1, 2].map(|k| {
                let (m, n) = ((k + 1) % 3, (k + 2) % 3);
                u[m] * v[n] - u[n] * v[m]
            });
            for i in triangle {
                let sum = &mut sums[*i as usize];
                *sum = [0, 1, 2].map(|k| sum[k] + cross[k]);
            }
        }
        let unit = |n: [f64; 3]| {
            let length = n.iter().map(|c| c * c).sum::<f64>().sqrt();
            if length > 1e-30 { n.map(|c| (c / length) as f32) } else { [0.0, 1.0, 0.0] }
        };
        sums.into_iter().map(unit).collect()
    }
}

/// Returns the difference of two vectors.
fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] - b[k])
}

/// Returns the number of vertices: particles, and points of rigid bodies.
pub fn vertices(simulation: &Simulation) -> usize {
    let network = simulation.model().network();
    simulation.particles() + network.map_or(0, tessellation::count)
}

/// Returns the position of every particle, and then of every point of a rigid body (m), in single
/// precision, as all files of geometry use it; an error if a number is too large for that.
pub fn positions(simulation: &Simulation) -> io::Result<Vec<[f32; 3]>> {
    let n = simulation.particles();
    let x = simulation.state();
    let position = |i| {
        let position = [i, n + i, 2 * n + i].map(|k| x[k] as f32);
        if position.iter().all(|x| x.is_finite()) {
            return Ok(position);
        }
        Err(io::Error::other(format!(
            "the position of particle {i} at t = {} s is too large for single precision",
            short(simulation.time(), DIGITS)
        )))
    };
    let mut all = (0..n).map(position).collect::<io::Result<Vec<_>>>()?;
    if let Some(network) = simulation.model().network() {
        let rigid = tessellation::points(network, simulation.state());
        all.extend(rigid.iter().map(|point| [point.x, point.y, point.z].map(|x| x as f32)));
    }
    Ok(all)
}

#[cfg(test)]
mod tests {
    use a3_core::{Model, Network, Scene, integrators};

    use super::*;

    /// Returns the position of a particle at x, as files have it.
    fn written(x: f64) -> io::Result<Vec<[f32; 3]>> {
        let model = Model::Network(Box::new(Network::new(vec![1.0]).unwrap()));
        let scene = Scene::new("far", model, vec![x, 0.0, 0.0, 0.0, 0.0, 0.0]);
        let method = &integrators::METHODS[0];
        let run = Simulation::new(scene, method, method.default_control).unwrap();
        positions(&run)
    }

    #[test]
    fn no_position_is_infinite() {
        assert_eq!(written(3e38).unwrap(), [[3e38, 0.0, 0.0]]);
        let why = written(4e38).unwrap_err().to_string();
        assert!(why.contains("particle 0 at t = 0 s is too large"), "{why}");
    }
}
