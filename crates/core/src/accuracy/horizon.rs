//! Time for which errors are meaningful: chaotic motion makes the smallest errors large.

use nalgebra::{Matrix3, Vector3};

use super::frames::GoOn;
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, find};
use crate::random::SplitMix;
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::stability::{largest_step, spectrum};

/// Largest factor by which errors may grow by the motion of the scene alone.
const AMPLIFICATION: f64 = 1e4;
/// Length of the steps of both runs, over the largest stable step, at most.
const SHARE: f64 = 1.0 / 6.0;
/// Least number of steps of the longest run.
const STEPS: f64 = 600.0;
/// Least number of steps in which runs may part for good, and number of times that steps are halved
/// until they take as many: contact that the state at the start does not have may be far stiffer
/// than all else, and steps that are too long for it part any runs at once.
const RESOLVED: f64 = 100.0;
const HALVINGS: u32 = 6;
/// Largest displacement of a coordinate between the two runs at the start, over the scene's radius.
const SEPARATION: f64 = 1e-8;
/// Number of looks at both runs from one of these times to the next.
const PARTS: u32 = 10;
/// Horizons to choose from, round numbers (s).
const ROUND: [f64; 11] = [0.05, 0.1, 0.2, 0.3, 0.5, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0];

/// Predictability of a scene's motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Horizon {
    /// Round time until which the distance of two runs that start side by side grows by less than
    /// 10,000 times (s).
    pub until: f64,
    /// Lyapunov time, in which that distance grows by the factor e (s); infinite if it grows by no
    /// more than 30 times in all.
    pub lyapunov: f64,
    /// Whether the particles start and move in a plane, and the distance grows mostly out of it:
    /// then it is not chaos that makes small errors grow, but springs that buckle out of the plane
    /// under compression.
    pub buckles: bool,
    /// Largest root mean square distance of the particles from where they start, until then (m);
    /// without particles, that of the numbers of the state.
    pub motion: f64,
}

/// Horizon of a scene, estimated from two runs that start side by side. They run for up to 10 s, or
/// for up to 3 s if the period of the scene's fastest mode is below 0.1 s, and no longer than
/// `until` (s), which may be infinite. `None` if `go_on` returned false.
///
/// Both runs take the same fixed steps, so that their distance is that of the motion and not of two
/// sequences of steps. These are shorter where a hundred of them part the runs.
///
/// # Errors
/// The scene cannot be run.
pub fn horizon(scene: &Scene, until: f64, go_on: GoOn) -> Result<Option<Horizon>, Error> {
    let method = find("rk4")
        .ok_or_else(|| Error::Invalid("no method to look ahead with is in the table".into()))?;
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let fastest = modes.first().map_or(1.0, crate::stability::Mode::frequency);
    let longest = if fastest > 20.0 * std::f64::consts::PI {
        3.0
    } else {
        10.0
    };
    let limit = largest_step(method, &modes)?.map_or(f64::INFINITY, |limit| limit.step);
    let mut step = (SHARE * limit).min(longest / STEPS);
    let longest = longest.min(until);
    let mut found = Ahead::look(scene, method, step, longest, go_on)?;
    for _ in 0..HALVINGS {
        let is_resolved = |ahead: &Ahead| ahead.parted_at.is_none_or(|time| time > RESOLVED * step);
        if found.as_ref().is_none_or(is_resolved) {
            break;
        }
        step *= 0.5;
        found = Ahead::look(scene, method, step, longest, go_on)?;
    }
    Ok(found.map(|ahead| ahead.horizon))
}

/// Outcome of two runs that start side by side.
struct Ahead {
    horizon: Horizon,
    /// Time at which they had parted, or could not go on (s).
    parted_at: Option<f64>,
}

impl Ahead {
    /// Runs a scene by steps of that length (s) twice, for up to `longest` (s). `None` if `go_on`
    /// returned false.
    fn look(
        scene: &Scene,
        method: &'static Method,
        step: f64,
        longest: f64,
        go_on: GoOn,
    ) -> Result<Option<Self>, Error> {
        let control = Control::Step(step);
        let mut run = Simulation::new(scene.clone(), method, control)?;
        let n = run.model().coordinates();
        let mut random = SplitMix(2);
        let mut beside = scene.clone();
        let size = SEPARATION * run.extent().1;
        for (k, x) in beside.state[..n].iter_mut().enumerate() {
            let network = scene.model.network();
            if !network.is_some_and(|network| network.is_pinned(k % (n / 3))) {
                *x += size * random.between(-1.0, 1.0);
            }
        }
        let mut beside = Simulation::new(beside, method, control)?;
        let distance = |a: &[f64], b: &[f64]| {
            let squares = a[..n].iter().zip(&b[..n]).map(|(a, b)| (a - b).powi(2));
            squares.sum::<f64>().sqrt()
        };
        let first = distance(run.state(), beside.state());
        let rounds = ROUND.into_iter().filter(|t| *t < longest);
        let (mut until, mut motion) = (ROUND[0], 0.0f64);
        let (mut time, mut most, mut parted_at) = (0.0, 1.0f64, None);
        let mut grown = (until, most);
        'rounds: for round in rounds.chain([longest]) {
            let begin = time;
            for part in 1..=PARTS {
                if !go_on() {
                    return Ok(None);
                }
                time = begin + (round - begin) * f64::from(part) / f64::from(PARTS);
                if run.advance_to(time).is_err() || beside.advance_to(time).is_err() {
                    parted_at = Some(time);
                    break 'rounds;
                }
                most = most.max(distance(run.state(), beside.state()) / first);
                let count = match run.particles() {
                    0 => n,
                    particles => particles,
                };
                let moved = distance(run.state(), &scene.state) / (count as f64).sqrt();
                motion = motion.max(moved);
                if most > AMPLIFICATION {
                    (grown, parted_at) = ((time, most), Some(time));
                    break 'rounds;
                }
            }
            until = round;
            grown = (time, most);
        }
        // Growth by a small factor is not chaos.
        let lyapunov = if grown.1 > 30.0 {
            grown.0 / grown.1.ln()
        } else {
            f64::INFINITY
        };
        let horizon = Horizon {
            until,
            lyapunov,
            buckles: lyapunov.is_finite() && leaves_plane(&scene.state, &run, &beside),
            motion,
        };
        Ok(Some(Self { horizon, parted_at }))
    }
}

/// Whether particles start in a plane, with velocities in it, and two runs part mostly out of it.
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
