//! Observed stability: the largest stable step of a method on the nonlinear scene itself, by
//! bisection over runs.

use super::spectrum::shapes;
use super::{GROWTH, HORIZON, Limit, Mode, STEPS, spectrum};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, find};
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::{Model, Scene};
use crate::simulation::Simulation;
use crate::system::Linearized;

/// Relative precision of the observed step where a limit is predicted; ten times coarser elsewhere.
const PRECISION: f64 = 0.005;
/// Longest step that is tried where no limit is predicted (s).
const LONGEST: f64 = 1.0;
/// Longest step that is tried where a limit is predicted, as a multiple of that limit.
const BEYOND: f64 = 4.0;
/// Largest number of steps times particles of a run, which takes some seconds.
const MOST: f64 = 2e8;
/// Number of checks during a run that holds.
const LOOKS: u64 = 200;
/// Size of the disturbance of a scene at rest: the root of the sum of m v^2 over the particles
/// (kg^1/2 m/s).
const NUDGE: f64 = 1e-6;
/// Random part of that disturbance, relative to the limiting mode.
const OTHERS: f64 = 0.1;

/// Rounds that bring a scene to rest: the step (s), the largest number of steps, and whether all
/// free particles are first displaced a little.
const SETTLING: [(f64, u32, bool); 5] = [
    (0.05, 400, false),
    (0.2, 400, false),
    (0.25, 400, true),
    (1.0, 400, false),
    (5.0, 400, false),
];

/// Times at which the modes of a scene in motion are computed, as fractions of [`HORIZON`].
const MOMENTS: [f64; 8] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];

/// Modes of the scene at several times of the motion from its start, in one list, fastest first.
/// Stretched and folded springs have other modes than those at the start.
///
/// # Errors
/// The scene cannot be run.
pub fn modes_in_motion(scene: &Scene) -> Result<Vec<Mode>, Error> {
    let mut run = Simulation::new(scene.clone(), accurate()?, Control::Tolerance(1e-6))?;
    let mut modes = vec![];
    for share in MOMENTS {
        if run.advance_to(share * HORIZON).is_err() {
            break;
        }
        modes.extend(spectrum(run.model().system(), run.time(), run.state()));
    }
    // The fastest come first, as they set most limits.
    modes.sort_by(|a, b| b.stiffness.total_cmp(&a.stiffness));
    Ok(modes)
}

/// Method for accurate runs.
fn accurate() -> Result<&'static Method, Error> {
    find("dop853").ok_or_else(|| Error::Invalid("no accurate method is in the table".into()))
}

/// Largest stable step that bisection found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Largest step that held (s); infinite if every step that was tried held. Steps are tried up
    /// to four times the predicted limit, or up to 1 s if none is predicted.
    pub step: f64,
    /// Number of runs that the bisection took.
    pub runs: u32,
}

/// Scene at rest, with the modes around this state.
#[derive(Clone)]
pub struct RestState {
    /// Scene that starts in the state of rest; its springs do not tear.
    pub scene: Scene,
    /// Modes around the state of rest, fastest first: all of them, if x has fewer than about 1200
    /// numbers.
    pub modes: Vec<Mode>,
    /// Shape of each mode: the displacements times the roots of the masses, of length 1.
    shapes: Vec<Vec<f64>>,
}

/// State in which the scene comes to rest without wind and swing and without tearing, computed by
/// implicit Euler with growing steps.
///
/// `None` for a first-order scene, for one that implicit Euler does not support, for one whose pins
/// or obstacles move, and for one that does not settle.
///
/// # Errors
/// The scene cannot be run.
pub fn rest(scene: &Scene) -> Result<Option<RestState>, Error> {
    let Some((implicit, network)) = find("implicit").zip(scene.model.network()) else {
        return Ok(None);
    };
    if implicit.check(network).is_err() || network.moves_by_itself() {
        return Ok(None);
    }
    let mut scene = scene.clone();
    if let Model::Network(network) = &mut scene.model {
        network.set_tear(None)?;
    }
    let mut run = Simulation::new(scene.clone(), implicit, Control::Step(0.05))?;
    let mut random = SplitMix(4);
    for (step, steps, leaves) in SETTLING {
        if leaves {
            // A fold may be balanced on its edge. The push makes it fall to one side, and it needs
            // all the steps to come to rest there.
            let mut pushed = scene.clone();
            pushed.state = run.state().to_vec();
            let (n, size) = (run.particles(), 1e-4 * run.extent().1);
            for (k, x) in pushed.state[..3 * n].iter_mut().enumerate() {
                if !network.is_pinned(k % n) {
                    *x += size * random.between(-1.0, 1.0);
                }
            }
            run = Simulation::new(pushed, implicit, Control::Step(step))?;
        }
        run.set_control(Control::Step(step))?;
        for _ in 0..steps {
            let before = run.state().to_vec();
            if run.take_steps(1).is_err() {
                return Ok(None);
            }
            let half = before.len() / 2;
            let moved = |part: &[f64], was: &[f64]| {
                let squares = part.iter().zip(was).map(|(a, b)| (a - b).powi(2));
                (squares.sum::<f64>() / half as f64).sqrt()
            };
            if !leaves && moved(&run.state()[..half], &before[..half]) < 1e-9 * step {
                break;
            }
        }
    }
    let mut y = run.state().to_vec();
    let half = y.len() / 2;
    let speed = y[half..].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    y[half..].fill(0.0);
    if speed > 1e-4 {
        return Ok(None);
    }
    let (modes, shapes) = shapes(network, 0.0, &y[..half]).into_iter().unzip();
    scene.state = y;
    Ok(Some(RestState {
        scene,
        modes,
        shapes,
    }))
}

/// Largest step with which a small disturbance of the scene at rest grows less than [`GROWTH`]
/// times in [`HORIZON`].
///
/// The disturbance is a velocity in the mode that limits the method, with a small random part.
/// Bisection begins at the predicted limit. `None` if no limit is given, if the runs would take too
/// long, and soon after `go_on` returns false.
///
/// # Errors
/// The method does not support the scene.
pub fn observe_at_rest(
    rest: &RestState,
    method: &'static Method,
    limit: Option<&Limit>,
    go_on: impl Fn() -> bool,
) -> Result<Option<Observation>, Error> {
    let still = &rest.scene;
    let mut nudged = still.clone();
    let half = still.state.len() / 2;
    let (Some(network), Some(limit)) = (still.model.network(), limit) else {
        return Ok(None);
    };
    let guess = limit.step;
    let mut random = SplitMix(5);
    let others: Vec<_> = (0..half).map(|_| random.between(-1.0, 1.0)).collect();
    let length = norm(&others);
    for (k, (z, other)) in rest.shapes[limit.mode].iter().zip(&others).enumerate() {
        let particle = k % network.particles();
        if !network.is_pinned(particle) {
            let z = z + OTHERS * other / length;
            nudged.state[half + k] = NUDGE * z / network.masses()[particle].sqrt();
        }
    }
    let size = EnergyNorm {
        network,
        rest: &still.state[..half],
    };
    let zero = vec![0.0; half];
    let nudge = size.of(&zero, &nudged.state[half..]);
    // The disturbance is the difference from a second run without it: a method's state of rest may
    // differ a little from the scene's, and particles on an obstacle are pushed out at every step.
    let least = least(guess);
    let holds = |h: f64| {
        let mut run = Simulation::new(nudged.clone(), method, Control::Step(h))?;
        let mut beside = Simulation::new(still.clone(), method, Control::Step(h))?;
        Ok(step_and_look(h, least, |count| {
            let held = go_on() && run.take_steps(count).is_ok() && beside.take_steps(count).is_ok();
            let both = run.state().iter().zip(beside.state());
            let apart: Vec<_> = both.map(|(a, b)| a - b).collect();
            let (dx, dv) = apart.split_at(half);
            held && size.of(dx, dv) < GROWTH * nudge
        }))
    };
    let seen = bisect(guess, still.model.particles(), holds)?;
    Ok(seen.filter(|_| go_on()))
}

/// Measure of disturbances around a state of rest by the root of twice their energy (J^1/2).
struct EnergyNorm<'a> {
    network: &'a Network,
    rest: &'a [f64],
}

impl EnergyNorm<'_> {
    fn of(&self, dx: &[f64], dv: &[f64]) -> f64 {
        let zero = vec![0.0; dx.len()];
        let mut df = zero.clone();
        let network = self.network;
        network.force_differential(0.0, self.rest, &zero, dx, &zero, &mut df);
        let parts = (dx.iter().zip(dv).zip(&df).enumerate()).map(|(k, ((dx, dv), df))| {
            network.masses()[k % network.particles()] * dv * dv - dx * df
        });
        parts.sum::<f64>().abs().sqrt()
    }
}

/// Least number of steps of a run; smaller where no limit is predicted.
fn least(guess: f64) -> f64 {
    if guess.is_finite() {
        STEPS
    } else {
        0.05 * STEPS
    }
}

/// Largest step with which the scene runs from its start for [`HORIZON`] without gaining energy.
///
/// A run of a network holds while its energy exceeds the true energy by less than half of the
/// largest true kinetic energy. Where no limit is predicted (`guess` is infinite), it holds unless
/// it is lost: errors at such long steps may be large, but do not grow. A run of a first-order
/// scene holds while the norm of its state is less than [`GROWTH`] times the initial one. Bisection
/// begins at `guess` (s). `None` if the runs would take too long, and soon after `go_on` returns
/// false.
///
/// # Errors
/// The method does not support the scene.
pub fn observe_from_start(
    scene: &Scene,
    truth: &Truth,
    method: &'static Method,
    guess: f64,
    go_on: impl Fn() -> bool,
) -> Result<Option<Observation>, Error> {
    let unlimited = guess.is_infinite() && scene.model.network().is_some();
    let least = least(guess);
    let holds = |h: f64| {
        let mut run = Simulation::new(scene.clone(), method, Control::Step(h))?;
        Ok(step_and_look(h, least, |count| {
            go_on()
                && run.take_steps(count).is_ok()
                && match (truth.at(run.time()), run.energy()) {
                    _ if unlimited => true,
                    (Some(most), Some(energy)) => energy.total() < most,
                    _ => norm(run.state()) < GROWTH * norm(&scene.state),
                }
        }))
    };
    let seen = bisect(guess, scene.model.particles(), holds)?;
    Ok(seen.filter(|_| go_on()))
}

/// True energy of a scene's motion from its start, and the excess over it that a stable run may
/// have (J).
#[derive(Clone, Debug, Default)]
pub struct Truth {
    /// Total energy (J) in each of the equal intervals from the start to [`HORIZON`]: the larger of
    /// those at its two ends. Empty for a first-order scene.
    total: Vec<f64>,
    /// Half of the largest kinetic energy (J).
    slack: f64,
}

impl Truth {
    /// Energy of an accurate run of the scene.
    ///
    /// # Errors
    /// The scene cannot be run.
    pub fn of(scene: &Scene) -> Result<Self, Error> {
        let mut run = Simulation::new(scene.clone(), accurate()?, Control::Tolerance(1e-6))?;
        let Some(mut last) = run.energy() else {
            return Ok(Self::default());
        };
        let (mut total, mut motion) = (vec![], last.kinetic);
        for look in 1..=LOOKS {
            let time = HORIZON * look as f64 / LOOKS as f64;
            if run.advance_to(time).is_err() {
                break;
            }
            let next = run.energy().unwrap_or(last);
            total.push(last.total().max(next.total()));
            motion = motion.max(next.kinetic);
            last = next;
        }
        total.push(last.total());
        let slack = 0.5 * motion;
        Ok(Self { total, slack })
    }

    /// Largest energy that a stable run may have at this time (J).
    fn at(&self, time: f64) -> Option<f64> {
        let part = (time / HORIZON * LOOKS as f64) as usize;
        let total = self.total.get(part).or(self.total.last())?;
        Some(total + self.slack)
    }
}

fn norm(y: &[f64]) -> f64 {
    y.iter().map(|y| y * y).sum::<f64>().sqrt()
}

/// Calls `look` with numbers of steps to take and to check, in all the steps of h (s) in which
/// nothing may grow and at least `least`, and then 8 more, one by one. Returns false as soon as
/// `look` does.
fn step_and_look(h: f64, least: f64, mut look: impl FnMut(u64) -> bool) -> bool {
    let steps = (HORIZON / h).ceil().max(least) as u64;
    let mut left = steps;
    while left > 0 {
        let count = (steps / LOOKS).clamp(1, left);
        if !look(count) {
            return false;
        }
        left -= count;
    }
    (0..8).all(|_| look(1))
}

/// Largest step (s) for which `holds` returns true, by bisection of its logarithm from `guess` (s).
fn bisect(
    guess: f64,
    particles: usize,
    holds: impl Fn(f64) -> Result<bool, Error>,
) -> Result<Option<Observation>, Error> {
    let mut runs = 0;
    let mut holds = |h: f64| {
        runs += 1;
        holds(h)
    };
    let shortest = (HORIZON * particles as f64 / MOST).max(1e-6);
    let limited = guess.is_finite();
    let longest = if limited { BEYOND * guess } else { LONGEST };
    let guess = guess.min(longest);
    if guess < shortest {
        return Ok(None);
    }
    let (mut low, mut high);
    if holds(guess)? {
        (low, high) = (guess, guess * 1.1);
        while high < longest && holds(high)? {
            (low, high) = (high, high * 1.4);
        }
        if high >= longest && holds(longest)? {
            let step = f64::INFINITY;
            return Ok(Some(Observation { step, runs }));
        }
        high = high.min(longest);
    } else {
        (low, high) = (guess / 1.1, guess);
        while !holds(low)? {
            (low, high) = (low / 1.4, low);
            if low < shortest {
                return Ok(None);
            }
        }
    }
    let precision = if limited { PRECISION } else { 10.0 * PRECISION };
    while high / low > 1.0 + precision {
        let middle = (low * high).sqrt();
        if holds(middle)? {
            low = middle;
        } else {
            high = middle;
        }
    }
    Ok(Some(Observation { step: low, runs }))
}
