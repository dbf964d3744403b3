//! Time during which errors are meaningful: in chaotic motion the smallest errors grow large.

use nalgebra::{Matrix3, Vector3};

use super::frames::GoOn;
use super::snapshot::{Scope, Snapshot};
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Method, find};
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::stability::{Mode, accurate, fastest, is_stiff, largest_step, spectrum};
use crate::system::Linearized;

/// Largest factor by which the motion of the scene alone may amplify errors within the horizon.
const MAX_AMPLIFICATION: f64 = 1e4;
/// Longest step of both runs, over the largest stable step.
const MAX_STEP_SHARE: f64 = 1.0 / 6.0;
/// Least number of steps of the longest run.
const MIN_STEPS: f64 = 600.0;
/// Least number of steps before both runs have separated, and the largest number of times that the
/// step is halved to reach it. Contact that the start state does not have may be far stiffer than
/// everything else, and steps that are too long for it separate any two runs at once.
const MIN_RESOLVED_STEPS: f64 = 100.0;
const MAX_HALVINGS: u32 = 6;
/// Growth of the Lyapunov time, when the step is halved, from which on it is the step that
/// separates two runs.
const MIN_CALMING: f64 = 1.5;
/// Largest displacement of a coordinate between the two runs at the start, over the scene's radius;
/// of a plain number, over its own size.
const SEPARATION: f64 = 1e-8;
/// Tolerance of runs that take one, over the separation: their errors part them by less.
const TOLERANCE_SHARE: f64 = 0.1;
/// Number of comparisons of both runs between one round time and the next.
const CHECKS_PER_ROUND: u32 = 10;
/// Horizons to choose from: round numbers (s).
const ROUND_TIMES: [f64; 11] = [0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0];

/// Predictability of a scene's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Round time (s) until which the distance of two runs that start side by side grows less than
    /// 10,000-fold.
    pub until: f64,
    /// Lyapunov time (s), in which that distance grows by the factor e; infinite if it grows
    /// 30-fold at most.
    pub lyapunov: f64,
    /// Largest ratio of that distance, until then, to the one at the start.
    pub growth: f64,
    /// Whether the particles start and move in a plane, and the distance grows mostly out of it:
    /// then it is not chaos that makes small errors grow, but springs that buckle out of the plane
    /// under compression.
    pub buckles: bool,
    /// Largest root mean square distance of the particles from their start positions, until then
    /// (m); without particles, that of the numbers of the state.
    pub motion: f64,
}

/// Estimates the horizon of a scene from two runs that start side by side. They last up to 10 s, or
/// up to 3 s if the period of the scene's fastest mode is below 0.1 s, and no longer than `until`
/// (s), which may be infinite. `None` if `go_on` returned false.
///
/// Both runs take the same fixed steps, so that their distance is that of the motion and not of two
/// sequences of steps. The steps are shorter where a hundred of them separate the runs, and where
/// shorter steps in contact separate them less. In a stiff system and in one of one's own, whose
/// runs last until `until`, runs at a tight tolerance replace them.
///
/// # Errors
/// The scene cannot be run.
pub fn horizon(scene: &Scene, until: f64, go_on: GoOn) -> Result<Option<Horizon>, Error> {
    let method = find("rk4").ok_or_else(|| {
        Error::Invalid("no method that estimates the horizon is in the table".into())
    })?;
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let feedback = scene.model.network().and_then(Linearized::baumgarte_frequency);
    let fastest = fastest(&modes, feedback).map_or(1.0, Mode::frequency);
    let is_own = scene.model.network().is_none();
    let longest = if is_own && until.is_finite() {
        until
    } else if fastest > 20.0 * std::f64::consts::PI {
        3.0
    } else {
        10.0
    };
    let limit = largest_step(method, &modes)?.map_or(f64::INFINITY, |limit| limit.step);
    let mut step = (MAX_STEP_SHARE * limit).min(longest / MIN_STEPS);
    let longest = longest.min(until);
    let touches = scene.model.network().is_some_and(Network::can_touch);
    let tolerance = TOLERANCE_SHARE * SEPARATION;
    let Some((is_stiff, _)) = is_stiff(scene, longest, tolerance, go_on)? else {
        return Ok(None);
    };
    // The time of a system of one's own has any unit.
    if is_stiff || is_own {
        let control = Control::Tolerance(tolerance);
        let found = TwoRuns::start(scene, accurate(is_stiff)?, control, longest, go_on)?;
        return Ok(found.map(|runs| runs.horizon));
    }
    let mut found = TwoRuns::start(scene, method, Control::Step(step), longest, go_on)?;
    for _ in 0..MAX_HALVINGS {
        let Some(runs) = &found else { break };
        let is_early = |time| time <= MIN_RESOLVED_STEPS * step;
        // A little growth may be of steps that are nearly too long for contact.
        let is_mild = touches && runs.parted_at.is_none() && runs.horizon.lyapunov.is_finite();
        if !runs.parted_at.is_some_and(is_early) && !is_mild {
            break;
        }
        let before = runs.horizon.lyapunov;
        step *= 0.5;
        found = TwoRuns::start(scene, method, Control::Step(step), longest, go_on)?;
        let lyapunov = found.as_ref().map(|runs| runs.horizon.lyapunov);
        if is_mild && lyapunov.is_some_and(|now| now < MIN_CALMING * before) {
            break;
        }
    }
    Ok(found.map(|runs| runs.horizon))
}

/// Result of two runs that start side by side.
struct TwoRuns {
    horizon: Horizon,
    /// Time (s) at which they had separated, or one of them failed.
    parted_at: Option<f64>,
}

impl TwoRuns {
    /// Runs a scene twice by a method with this control, for up to `longest` (s). `None` if `go_on`
    /// returned false.
    fn start(
        scene: &Scene,
        method: &'static Method,
        control: Control,
        longest: f64,
        go_on: GoOn,
    ) -> Result<Option<Self>, Error> {
        let mut run = Simulation::new(scene.clone(), method, control)?;
        let n = run.model().coordinates();
        let mut random = SplitMix(2);
        let mut beside = scene.clone();
        let last = ROUND_TIMES[ROUND_TIMES.len() - 1];
        let unit = match run.model().network() {
            None if longest < ROUND_TIMES[0] || longest > last => longest / last,
            _ => 1.0,
        };
        let is_plain = run.particles() == 0;
        let mut seen = Snapshot::of(&scene.model, 0.0, &scene.state);
        let mut sizes = vec![run.extent().1; n];
        if is_plain {
            let first = ROUND_TIMES[0] * unit / f64::from(CHECKS_PER_ROUND);
            let own = seen.sizes_until(first);
            // Of numbers that all rest at 0, nothing tells the size.
            if own.iter().any(|size| *size > 0.0) {
                sizes = own;
            }
        }
        for (k, x) in beside.state[..n].iter_mut().enumerate() {
            let network = scene.model.network();
            if !network.is_some_and(|network| network.is_pinned(k % (n / 3))) {
                *x += SEPARATION * sizes[k] * random.between(-1.0, 1.0);
            }
        }
        let mut beside = Simulation::new(beside, method, control)?;
        let distance = |a: &[f64], b: &[f64]| {
            let squares = a[..n].iter().zip(&b[..n]).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let norm = |y: &[f64]| y[..n].iter().map(|y| y * y).sum::<f64>().sqrt();
        // Plain numbers are compared as in charts, each over its own size.
        let mut apart = |time: f64, [a, b]: [&[f64]; 2]| {
            if !is_plain {
                return distance(a, b);
            }
            seen = seen.next(&scene.model, time, a);
            seen.errors_of(&Snapshot::of(&scene.model, time, b), Scope::default()).state
        };
        let first = apart(0.0, [run.state(), beside.state()]);
        // Numbers that grow from a small start have errors of the size to which they grow.
        let errors = match control {
            Control::Tolerance(tolerance) => tolerance / TOLERANCE_SHARE,
            Control::Step(_) => 0.0,
        };
        let mut largest = if is_plain { 1.0 } else { norm(run.state()) };
        let rounds = ROUND_TIMES.map(|t| t * unit).into_iter();
        let rounds = rounds.filter(|t| *t < longest);
        let (mut until, mut motion) = (ROUND_TIMES[0] * unit, 0.0f64);
        let (mut time, mut most, mut parted_at) = (0.0, 1.0f64, None);
        let mut grown = (until, most);
        'rounds: for round in rounds.chain([longest]) {
            let begin = time;
            for part in 1..=CHECKS_PER_ROUND {
                if !go_on() {
                    return Ok(None);
                }
                time = begin + (round - begin) * f64::from(part) / f64::from(CHECKS_PER_ROUND);
                if !succeeded(run.advance_to(time))? || !succeeded(beside.advance_to(time))? {
                    parted_at = Some(time);
                    break 'rounds;
                }
                if !is_plain {
                    largest = largest.max(norm(run.state()));
                }
                let least = first.max(errors * largest);
                most = most.max(apart(time, [run.state(), beside.state()]) / least);
                let count = match run.particles() {
                    0 => n,
                    particles => particles,
                };
                let moved = distance(run.state(), &scene.state) / (count as f64).sqrt();
                motion = motion.max(moved);
                if most > MAX_AMPLIFICATION {
                    (grown, parted_at) = ((time, most), Some(time));
                    break 'rounds;
                }
            }
            until = round;
            grown = (time, most);
        }
        // Growth by a small factor is not chaos.
        let lyapunov = if grown.1 > 30.0 { grown.0 / grown.1.ln() } else { f64::INFINITY };
        let horizon = Horizon {
            until,
            lyapunov,
            growth: grown.1,
            buckles: lyapunov.is_finite() && leaves_plane(&scene.state, &run, &beside),
            motion,
        };
        Ok(Some(Self { horizon, parted_at }))
    }
}

/// Returns whether particles start in a plane, with velocities in it, and two runs separate mostly
/// out of it.
fn leaves_plane(start: &[f64], run: &Simulation, beside: &Simulation) -> bool {
    let n = run.particles();
    if n == 0 {
        return false;
    }
    let at = |y: &[f64], i: usize| Vector3::new(y[i], y[n + i], y[2 * n + i]);
    let outer = |vectors: &mut dyn Iterator<Item = Vector3<f64>>| {
        vectors.fold(Matrix3::zeros(), |sum, v| sum + v * v.transpose())
    };
    let (x, v) = start.split_at(3 * n);
    let middle = (0..n).map(|i| at(x, i)).sum::<Vector3<f64>>() / n as f64;
    let mut spread = outer(&mut (0..n).map(|i| at(x, i) - middle));
    if v.len() == x.len() {
        spread += outer(&mut (0..n).map(|i| at(v, i)));
    }
    let eigen = spread.symmetric_eigen();
    let normal = eigen.eigenvectors.column(eigen.eigenvalues.imin());
    if eigen.eigenvalues.min() > 1e-20 * eigen.eigenvalues.max() {
        return false;
    }
    let parts = (0..n).map(|i| at(beside.state(), i) - at(run.state(), i));
    let (mut out, mut all) = (0.0, 0.0);
    for part in parts {
        out += part.dot(&normal).powi(2);
        all += part.norm_squared();
    }
    out > 0.5 * all
}
