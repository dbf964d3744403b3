//! Motion of points in a run, to compare one model with another.

use std::time::{Duration, Instant};

use a3_core::accuracy::{FrameState, Frames, GoOn, Scope, run};
use a3_core::{Control, Method, Network, Scene, Simulation};
use a3_files::failure::Failure;
use a3_files::quantity::Quantity;

/// Particles of one grid, each as a weighted mean of particles of another grid.
pub type Places = [Vec<(usize, f64)>];

/// Quantity that is compared, at times of a run.
#[derive(Clone, Copy)]
pub struct Compared {
    /// Quantity that is compared.
    pub quantity: Quantity,
    /// Times at which it is taken.
    pub frames: Frames,
    /// Particles and times that count.
    pub scope: Scope,
}

/// The quantity that is compared, in a run.
pub struct Track {
    /// Values at the start and at each frame: positions (m), all x, all y, all z; or the energy (J)
    /// less that at the start.
    values: Vec<Vec<f64>>,
    /// Computing time of the run.
    pub time: Duration,
    /// Work of the run, in evaluations.
    pub work: f64,
}

impl Track {
    /// Extrapolates the motion past a finer model, by a share of its difference from a coarser one.
    pub fn extrapolated(coarse: &Self, fine: &Self, share: f64) -> Self {
        let frames = coarse.values.iter().zip(&fine.values);
        let values = frames.map(|(coarse, fine)| {
            let pairs = coarse.iter().zip(fine);
            pairs.map(|(c, f)| f + share * (f - c)).collect()
        });
        Self { values: values.collect(), time: Duration::ZERO, work: 0.0 }
    }
}

impl Compared {
    /// Runs a scene by a method, and records the quantity. On other grids than those of the scene
    /// that it is compared with, `places` gives the particles of that scene. `None` if the run
    /// blew up.
    ///
    /// # Errors
    /// The method does not support the scene, or `go_on` returned false.
    pub fn follow(
        self,
        scene: &Scene,
        (method, control): (&'static Method, Control),
        places: Option<&Places>,
        go_on: GoOn,
    ) -> Result<Option<Track>, Failure> {
        let mut simulation = Simulation::new(scene.clone(), method, control)?;
        let mut values = vec![self.of(&simulation, 0.0, &scene.state, places)];
        let begun = Instant::now();
        let mut spent = Duration::ZERO;
        let mut visit = |look: &FrameState| {
            let begun = Instant::now();
            let t = self.frames.time(look.frame);
            values.push(self.of(look.run, t, look.state, places));
            spent += begun.elapsed();
        };
        let end = run(&mut simulation, &self.frames, go_on, Some(&mut visit))?;
        let blow_up = end.ok_or_else(Failure::stopped)?;
        let time = begun.elapsed().saturating_sub(spent);
        if self.quantity == Quantity::Energy {
            let start = values[0][0];
            for value in &mut values {
                value[0] -= start;
            }
        }
        let work = simulation.work().total();
        Ok(blow_up.is_none().then_some(Track { values, time, work }))
    }

    /// Returns the quantity in a state of a run at time t (s).
    fn of(self, run: &Simulation, t: f64, state: &[f64], places: Option<&Places>) -> Vec<f64> {
        let n = run.particles();
        let columns = (0..3).map(|axis| &state[axis * n..(axis + 1) * n]);
        match (self.quantity, run.model().network()) {
            (Quantity::Centre, Some(network)) => return centre(network, columns),
            (Quantity::Energy, Some(network)) => return vec![network.energy_of(t, state).total()],
            _ => {}
        }
        let mut points = vec![];
        for x in columns {
            match places {
                None => points.extend_from_slice(x),
                Some(places) => points.extend(
                    places
                        .iter()
                        .map(|corners| corners.iter().map(|(i, w)| w * x[*i]).sum::<f64>()),
                ),
            }
        }
        let count = points.len() / 3;
        match self.scope.particle.filter(|i| *i < count) {
            Some(i) => vec![points[i], points[count + i], points[2 * count + i]],
            None => points,
        }
    }

    /// Returns the distance between two runs: the root mean square over the particles (m), or the
    /// difference of the energies (J). It is the largest over the frames, or that at the end if the
    /// scope says so.
    pub fn distance(self, a: &Track, b: &Track) -> f64 {
        let pairs = a.values.iter().zip(&b.values);
        let from = if self.scope.at_end { a.values.len() - 1 } else { 0 };
        let distances = pairs.skip(from).map(|(a, b)| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
            (squares.sum::<f64>() / (a.len() / 3).max(1) as f64).sqrt()
        });
        distances.fold(0.0, f64::max)
    }

    /// Returns the distance from a run in which nothing moves, as
    /// [`distance`](Self::distance) does.
    pub fn way(self, track: &Track) -> f64 {
        let still = Track {
            values: vec![track.values[0].clone(); track.values.len()],
            time: Duration::ZERO,
            work: 0.0,
        };
        self.distance(track, &still)
    }

    /// Returns the unit of the quantity.
    pub fn unit(self) -> &'static str {
        match self.quantity {
            Quantity::Position | Quantity::Centre => "m",
            Quantity::Energy => "J",
        }
    }
}

/// Returns the centre of mass (m) of particles, whose positions are given along each axis.
fn centre<'a>(network: &Network, columns: impl Iterator<Item = &'a [f64]>) -> Vec<f64> {
    let masses = network.masses();
    let sum: f64 = masses.iter().sum();
    let mean = |x: &[f64]| x.iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / sum;
    columns.map(mean).collect()
}
