//! Motion of points in a run, to compare one model with another.

use std::time::{Duration, Instant};

use a3_core::accuracy::{FrameState, Frames, Scope, run};
use a3_core::{Control, Method, Scene, Simulation};

use crate::base::failure::Failure;
use crate::base::interrupt;

/// Particles of one grid, each as a weighted mean of particles of another grid.
pub type Places = [Vec<(usize, f64)>];

/// Points whose motion is compared.
#[derive(Clone, Copy)]
pub struct Points {
    /// Times at which positions are taken.
    pub frames: Frames,
    /// Particles and times that count.
    pub scope: Scope,
    /// Whether the centre of mass is compared, instead of the particles.
    pub centre: bool,
}

/// Motion of the points in a run.
pub struct Track {
    /// Positions of the points (m) at the start and at each frame: all x, all y, all z.
    positions: Vec<Vec<f64>>,
    /// Computing time of the run.
    pub time: Duration,
    /// Work of the run, in evaluations.
    pub work: f64,
}

impl Track {
    /// Extrapolates the motion past a finer model, by a share of its difference from a coarser one.
    pub fn extrapolated(coarse: &Self, fine: &Self, share: f64) -> Self {
        let frames = coarse.positions.iter().zip(&fine.positions);
        let positions = frames.map(|(coarse, fine)| {
            let pairs = coarse.iter().zip(fine);
            pairs.map(|(c, f)| f + share * (f - c)).collect()
        });
        Self {
            positions: positions.collect(),
            time: Duration::ZERO,
            work: 0.0,
        }
    }

    /// Replaces the computing time.
    pub fn timed(self, time: Duration) -> Self {
        Self { time, ..self }
    }
}

/// Motion of a model.
pub enum Motion {
    /// Motion of the points in the whole run.
    Known(Track),
    /// The run blew up.
    Failed,
}

impl Points {
    /// Runs a scene by a method, and records the positions of the points. On other grids than those
    /// of the points, `places` gives the points there. `None` if the command was interrupted.
    pub fn follow(
        self,
        scene: &Scene,
        (method, control): (&'static Method, Control),
        places: Option<&Places>,
    ) -> Result<Option<Motion>, Failure> {
        let mut simulation =
            Simulation::new(scene.clone(), method, control).map_err(Failure::run)?;
        let start = self.of(&simulation, &scene.state, places);
        let mut positions = vec![start];
        let begun = Instant::now();
        let mut spent = Duration::ZERO;
        let mut visit = |look: &FrameState| {
            let begun = Instant::now();
            positions.push(self.of(look.run, look.state, places));
            spent += begun.elapsed();
        };
        let end = run(
            &mut simulation,
            &self.frames,
            &interrupt::go_on,
            Some(&mut visit),
        );
        let time = begun.elapsed().saturating_sub(spent);
        Ok(match end.map_err(Failure::run)? {
            None => None,
            Some(Some(_)) => Some(Motion::Failed),
            Some(None) => Some(Motion::Known(Track {
                positions,
                time,
                work: simulation.work().total(),
            })),
        })
    }

    /// Returns the positions of the points in a state of a run.
    fn of(self, run: &Simulation, state: &[f64], places: Option<&Places>) -> Vec<f64> {
        let n = run.particles();
        let columns = (0..3).map(|axis| &state[axis * n..(axis + 1) * n]);
        if let (true, Some(network)) = (self.centre, run.model().network()) {
            let masses = network.masses();
            let sum: f64 = masses.iter().sum();
            let mean = |x: &[f64]| x.iter().zip(masses).map(|(x, m)| x * m).sum::<f64>() / sum;
            return columns.map(mean).collect();
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

    /// Returns the root mean square distance (m) between the points of two motions: the largest
    /// over the frames, or that at the end if the scope says so.
    pub fn distance(self, a: &Track, b: &Track) -> f64 {
        let pairs = a.positions.iter().zip(&b.positions);
        let from = if self.scope.at_end {
            a.positions.len() - 1
        } else {
            0
        };
        let distances = pairs.skip(from).map(|(a, b)| {
            let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
            (squares.sum::<f64>() / (a.len() / 3).max(1) as f64).sqrt()
        });
        distances.fold(0.0, f64::max)
    }

    /// Returns the distance (m) of the points from where they start, as
    /// [`distance`](Self::distance) does.
    pub fn way(self, track: &Track) -> f64 {
        let still = Track {
            positions: vec![track.positions[0].clone(); track.positions.len()],
            time: Duration::ZERO,
            work: 0.0,
        };
        self.distance(track, &still)
    }
}
