//! The judgement of a file.

use a3_core::accuracy::{Frames, Reference, Scope};
use a3_core::stability::{Mode, spectrum};
use a3_core::{Model, Network, Scene};
use a3_files::failure::Failure;
use a3_files::states::States;

use super::grid::gcd;
use super::rows::{Difference, Rows, difference, distance, farthest, with_y_up};
use super::search::{Match, search};
use super::trial::{Course, Judged, stopped};
use crate::chart::measure::{precision, reference};

/// Ratio of the error with the axes y and z exchanged to that without, below which they are.
const MUCH_LESS: f64 = 0.1;
/// Largest number of coordinates in all frames of a reference.
const MAX_NUMBERS: f64 = 2e6;
/// Number of frames in a radian of the fastest mode, between which states are interpolated: eight
/// data in four frames then err by 1e-12 of its amplitude.
const FRAMES_PER_RADIAN: f64 = 10.0;
/// Least number of frames in a second.
const MIN_RATE: f64 = 60.0;
/// Largest error of a time at which it is that of a frame, relative to it.
const TOLERANCE: f64 = 1e-9;

/// Errors of a file, and the method that it agrees with.
#[derive(Clone, Debug, Default)]
pub struct Judgement {
    /// Number of states of the file.
    pub states: usize,
    /// Number of states up to the end of the judgement.
    pub judged: usize,
    /// One of how many of these is compared.
    pub every: usize,
    /// Last time that is judged (s).
    pub until: f64,
    /// Whether the file has velocities.
    pub has_velocities: bool,
    /// Difference of the first state from the start of the scene.
    pub start: Option<Difference>,
    /// Times (s), and the root mean square over the particles of their distances from the
    /// reference (m).
    pub errors: Vec<(f64, f64)>,
    /// Largest of these errors.
    pub worst: Worst,
    /// Uncertainty of the reference (m).
    pub floor: f64,
    /// Largest distance that the reference moves, root mean square over the particles (m).
    pub motion: f64,
    /// Error of the energy (J), if the scene has energy and the file velocities.
    pub energy: Option<Drift>,
    /// Largest kinetic energy of the reference (J).
    pub kinetic: f64,
    /// Error of the momentum of the particles that are not pinned (kg m/s).
    pub momentum: Option<Drift>,
    /// Step of the program (s): that of the method that it agrees with, or else the distance of
    /// its states.
    pub step: Option<f64>,
    /// Whether the times are multiples of a step, so that methods were compared.
    pub was_searched: bool,
    /// Whether the step of the program was given.
    pub has_known_step: bool,
    /// Method that the file agrees with.
    pub found: Match,
    /// Computing time of the run (s).
    pub seconds: Option<f64>,
    /// First time at which a number of the file is not finite (s).
    pub not_finite_at: Option<f64>,
}

/// Largest error.
#[derive(Clone, Copy, Debug, Default)]
pub struct Worst {
    /// Error (m).
    pub error: f64,
    /// Time (s).
    pub time: f64,
    /// The particle that is farthest from its place then.
    pub particle: usize,
    /// Its distance (m).
    pub distance: f64,
}

/// Error of a conserved quantity.
#[derive(Clone, Copy, Debug, Default)]
pub struct Drift {
    /// Largest error.
    pub worst: f64,
    /// Its time (s).
    pub time: f64,
    /// Error at the end: above 0 if there is too much.
    pub end: f64,
}

impl Drift {
    fn note(&mut self, time: f64, error: f64) {
        self.end = error;
        if error.abs() > self.worst {
            (self.worst, self.time) = (error.abs(), time);
        }
    }
}

impl Course<'_> {
    /// Judges the states of a file.
    ///
    /// # Errors
    /// No state is within the time of the judgement, the reference cannot be computed, or the
    /// monitor stopped it.
    pub fn judge(&mut self, file: &str, states: &States) -> Result<Judgement, Failure> {
        let (scene, of_file) = (self.scene, |why| Failure::usage(format!("{file}: {why}")));
        let rows = Rows::of(states, self.horizon.until, self.step).map_err(of_file)?;
        let mut judgement = match self.reference(&rows) {
            Err(Failure::Usage(why)) => return Err(of_file(why)),
            reference => measured(scene, states, &rows, reference?),
        };
        let at_start = matches!(judgement.start, None | Some(Difference::Later(_)));
        let judged = Judged::new(self, &rows, judgement.motion);
        let found = search(&judged, at_start).ok_or_else(stopped)?;
        let grid = rows.grid.as_ref().map(|grid| grid.step);
        let agreed = found.found.map(|agreement| agreement.step);
        judgement.step = agreed.or(self.step).or(grid);
        judgement.was_searched = grid.or(self.step).is_some();
        judgement.has_known_step = self.step.is_some();
        judgement.found = found;
        Ok(judgement)
    }

    /// Returns the reference with states at the times of rows.
    fn reference(&mut self, rows: &Rows) -> Result<&Reference, Failure> {
        let known = self.references.iter().position(|known| serves(known, rows));
        if let Some(known) = known {
            return Ok(&self.references[known]);
        }
        let frames = self.frames(rows).map_err(Failure::usage)?;
        let precision = precision(self.scene, self.horizon.motion);
        let go_on = &|| self.monitor.go_on();
        let made = reference(go_on, self.scene, frames, Scope::default(), precision);
        self.references.push(Failure::unless_stopped(made)?.ok_or_else(stopped)?);
        Ok(&self.references[self.references.len() - 1])
    }

    /// Frames at the times of rows or, if there is no such grid, so close together that states
    /// between them are interpolated accurately.
    fn frames(&self, rows: &Rows) -> Result<Frames, String> {
        let until = rows.until();
        let most = MAX_NUMBERS / (3.0 * self.scene.model.particles().max(1) as f64);
        if let Some(grid) = &rows.grid {
            let part = grid.numbers.iter().copied().fold(0, gcd);
            let last = grid.numbers[grid.numbers.len() - 1];
            let count = last / part.max(1);
            if count as f64 <= most {
                return Ok(Frames { until, count });
            }
        }
        let modes = spectrum(self.scene.model.system(), 0.0, &self.scene.state);
        let fastest = modes.first().map_or(0.0, Mode::frequency);
        let rate = (FRAMES_PER_RADIAN * fastest).max(MIN_RATE);
        let count = (rate * until).ceil().max(4.0);
        if count > most {
            let particles = self.scene.model.particles();
            return Err(match rows.grid {
                Some(_) => format!(
                    "{until} s of it are too many states of {particles} particles: write fewer, or judge less with --until"
                ),
                None => format!(
                    "its times are not equally spaced, and {until} s are too long to interpolate between them: write \
                     states at equal distances, or judge less with --until"
                ),
            });
        }
        Ok(Frames { until, count: count as u64 })
    }
}

/// Returns whether a reference has states at the times of rows.
fn serves(reference: &Reference, rows: &Rows) -> bool {
    let all = rows.times.iter();
    all.into_iter().all(|t| frame_at(reference, *t).is_some())
}

/// Returns the time (s) of the frame at a time t (s).
pub fn frame_at(reference: &Reference, t: f64) -> Option<f64> {
    let frames = &reference.frames;
    let k = (t / frames.spacing()).round() as u64;
    let time = (k <= frames.count).then(|| frames.time(k))?;
    ((t - time).abs() <= TOLERANCE * t).then_some(time)
}

/// Measures the errors of rows.
fn measured(scene: &Scene, states: &States, rows: &Rows, reference: &Reference) -> Judgement {
    let model = &scene.model;
    let mut errors = vec![];
    let mut worst = Worst { error: -1.0, ..Worst::default() };
    let (mut motion, n) = (0.0, 3 * model.particles());
    let mut turned = [0.0f64; 2];
    let network = conserving(model).filter(|_| rows.velocities(0).is_some());
    let (mut energy, mut momentum, mut kinetic) = (Drift::default(), Drift::default(), 0.0);
    // Particles in the walls of a tank have no errors.
    let walls = model.network().map_or(0, Network::fixed_walls);
    let counted = model.particles() - walls.min(model.particles() - 1);
    let share = (model.particles() as f64 / counted as f64).sqrt();
    let apart = |a: &[f64], b: &[f64]| share * distance(a, b);
    for (k, &time) in rows.times.iter().enumerate() {
        let at = frame_at(reference, time).unwrap_or(time);
        let [x, v] = reference.motion(model, at);
        let error = apart(&x, rows.positions(k));
        motion = f64::max(motion, apart(&x, &scene.state[..n]));
        for (sign, turned) in [-1.0, 1.0].into_iter().zip(&mut turned) {
            *turned = turned.max(apart(&x, &with_y_up(rows.positions(k), sign)));
        }
        errors.push((time, error));
        if error > worst.error {
            let (particle, distance) = farthest(&x, rows.positions(k));
            worst = Worst { error, time, particle, distance };
        }
        if let (Some(network), Some(own)) = (network, rows.velocities(k)) {
            let right = network.energy_at(at, &x, &v);
            let found = network.energy_at(at, rows.positions(k), own);
            energy.note(time, found.total() - right.total());
            momentum.note(time, momentum_error(network, &v, own));
            kinetic = f64::max(kinetic, right.kinetic);
        }
    }
    let turned = turned[0].min(turned[1]);
    Judgement {
        states: states.times.len(),
        judged: rows.count,
        every: rows.every,
        until: rows.until(),
        has_velocities: states.velocities.is_some(),
        start: if turned < MUCH_LESS * worst.error {
            Some(Difference::Axes)
        } else {
            difference(scene, rows)
        },
        errors,
        worst,
        floor: reference.floor.position,
        motion,
        energy: network.map(|_| energy),
        kinetic,
        momentum: network.map(|_| momentum),
        seconds: states.seconds,
        not_finite_at: states.not_finite_at,
        ..Judgement::default()
    }
}

/// Returns the network of a model, if positions and velocities alone tell its energy.
fn conserving(model: &Model) -> Option<&Network> {
    let network = model.network();
    network.filter(|network| network.bodies().is_empty())
}

/// Returns the length of the difference of the momenta of particles that are not pinned (kg m/s).
fn momentum_error(network: &Network, v: &[f64], own: &[f64]) -> f64 {
    let n = network.particles();
    let of_axis = |axis: usize| {
        let free = (0..n).filter(|i| !network.is_pinned(*i));
        let each = free.map(|i| network.masses()[i] * (own[axis * n + i] - v[axis * n + i]));
        each.sum::<f64>()
    };
    (0..3).map(|axis| of_axis(axis).powi(2)).sum::<f64>().sqrt()
}
