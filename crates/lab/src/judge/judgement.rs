//! The judgement of a file.

use a3_core::accuracy::Reference;
use a3_core::{Model, Network, Scene};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::states::States;

use super::plain::Plain;
use super::rows::{Difference, Rows, difference, distance, farthest, with_y_up};
use super::search::{Match, search};
use super::trial::{Judged, size};
use super::truth::{Truth, frame_at};

/// Ratio of the error with the axes y and z exchanged to that without, below which they are.
const MUCH_LESS: f64 = 0.1;

/// Scene with all that judgements of its files share.
pub struct Course<'a> {
    /// Companion of the work, which may stop it.
    pub monitor: &'a dyn Monitor,
    pub scene: &'a Scene,
    /// The scene as masses and springs, if it is that.
    pub plain: Option<&'a Plain>,
    /// Time up to which states are judged (s).
    pub until: f64,
    /// Step of the programs (s), if it is known.
    pub step: Option<f64>,
}

/// Errors of a file, and the method that it agrees with.
#[derive(Clone, Debug)]
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
#[derive(Clone, Copy, Debug)]
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

/// Judges states. `None` if the monitor stopped it.
///
/// # Errors
/// No state is within the time of the judgement, or the reference cannot be computed.
pub fn judge(
    course: &Course,
    truth: &mut Truth,
    states: &States,
) -> Result<Option<Judgement>, Failure> {
    let scene = course.scene;
    let rows = Rows::of(states, course.until, course.step).map_err(Failure::usage)?;
    let Some(reference) = truth.at(&rows)? else {
        return Ok(None);
    };
    let mut judgement = measured(scene, states, &rows, reference);
    let judged = Judged {
        monitor: course.monitor,
        scene,
        plain: course.plain,
        rows: &rows,
        motion: judgement.motion,
        step: course.step,
        size: size(scene),
        radius: scene.extent().1,
        noise: None,
    };
    let at_start = matches!(judgement.start, None | Some(Difference::Later(_)));
    let Some(found) = search(&judged, at_start) else {
        return Ok(None);
    };
    let grid = rows.grid.as_ref();
    let agreed = found.found.map(|agreement| agreement.step);
    judgement.step = agreed.or(course.step).or(grid.map(|grid| grid.step));
    judgement.was_searched = grid.is_some() || course.step.is_some();
    judgement.has_known_step = course.step.is_some();
    judgement.found = found;
    Ok(Some(judgement))
}

/// Measures the errors of rows.
fn measured(scene: &Scene, states: &States, rows: &Rows, reference: &Reference) -> Judgement {
    let model = &scene.model;
    let mut errors = vec![];
    let mut worst = Worst {
        error: -1.0,
        time: 0.0,
        particle: 0,
        distance: 0.0,
    };
    let (mut motion, n) = (0.0, 3 * model.particles());
    let mut turned = [0.0f64; 2];
    let network = conserving(model).filter(|_| rows.velocities(0).is_some());
    let (mut energy, mut momentum, mut kinetic) = (Drift::default(), Drift::default(), 0.0);
    for (k, &time) in rows.times.iter().enumerate() {
        let at = frame_at(reference, time).unwrap_or(time);
        let [x, v] = reference.motion(model, at);
        let error = distance(&x, rows.positions(k));
        motion = f64::max(motion, distance(&x, &scene.state[..n]));
        for (sign, turned) in [-1.0, 1.0].into_iter().zip(&mut turned) {
            *turned = turned.max(distance(&x, &with_y_up(rows.positions(k), sign)));
        }
        errors.push((time, error));
        if error > worst.error {
            let (particle, distance) = farthest(&x, rows.positions(k));
            worst = Worst {
                error,
                time,
                particle,
                distance,
            };
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
        step: None,
        was_searched: false,
        has_known_step: false,
        found: Match::default(),
        seconds: states.seconds,
        not_finite_at: states.not_finite_at,
    }
}

/// Returns the network of a model, if positions and velocities alone tell its energy.
fn conserving(model: &Model) -> Option<&Network> {
    model
        .network()
        .filter(|network| network.bodies().is_empty())
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
