//! Scenes at rest: the state of rest, and the largest step with which a small disturbance of it
//! does not grow.

use super::checks::take_checked;
use super::limit::{GROWTH, Limit, largest_step};
use super::linearised::AtRest;
use super::mode::Mode;
use super::normalised::Mixing;
use super::observation::Observation;
use super::pencil::Pencil;
use super::search::{Budget, bisect, cost, steps};
use super::spectrum::{Undamped, of_drag, shapes};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, find};
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::{Model, Scene};
use crate::simulation::Simulation;
use crate::system::Linearized;

/// Relative precision of the largest step found by runs.
const PRECISION: f64 = 0.01;
/// Size of the disturbance of a scene at rest: the root of the sum of m v^2 over the particles
/// (kg^1/2 m/s).
const DISTURBANCE: f64 = 1e-6;
/// Random part of that disturbance, relative to its part in the limiting mode.
const RANDOM_SHARE: f64 = 0.1;

/// Rounds that bring a scene to rest: the step (s), the largest number of steps, and whether all
/// free particles are first displaced a little.
const SETTLING: [(f64, u32, bool); 5] = [
    (0.05, 400, false),
    (0.2, 400, false),
    (0.25, 400, true),
    (1.0, 400, false),
    (5.0, 400, false),
];

/// Time (s) in which gravity moves a scene by its radius, from which on the rounds have these
/// steps: smaller and faster scenes take proportionally shorter ones.
const SLOW_SCENE_TIME: f64 = 0.1;

/// Largest work of these rounds, in the unit of a [`Budget`].
const MAX_WORK: f64 = 1e9;

/// Largest number of free coordinates of a scene whose modes are found together if damping mixes
/// them: the eigenvalues of a matrix of twice that dimension take a second or two.
const MAX_DENSE_UNKNOWNS: usize = 200;

/// Largest length of the state of a scene with more coordinates than that whose limits are
/// confirmed by steps on all motion: longer ones would take minutes.
const MAX_STEPPED_LENGTH: usize = 1200;

/// Ratio of the next step to one in which the collision safeguard acted.
const GUARDED_STEP_RATIO: f64 = 0.25;
/// Ratio of the next step to one in which it did not act.
const FREE_STEP_RATIO: f64 = 1.5;

/// Scene at rest, with the modes around this state.
#[derive(Clone)]
pub struct RestState {
    /// Scene that starts in the state of rest; its springs do not tear.
    pub scene: Scene,
    /// Modes around the state of rest, fastest first: all of them, if x has fewer than about 1200
    /// numbers.
    pub modes: Vec<Mode>,
    shapes: RestShapes,
}

/// Shapes of the modes, or the matrices that they are computed from. A shape is the displacements
/// times the roots of the masses, of length 1.
#[derive(Clone)]
enum RestShapes {
    /// Shape of each mode.
    Known(Vec<Vec<f64>>),
    /// Shapes without damping, in a scene that is too large for the shapes with damping.
    Approximate(Vec<Vec<f64>>),
    /// Matrices of a scene in which damping mixes shapes.
    Mixed(Pencil),
}

impl RestState {
    /// Creates a state of rest from a scene that starts in it, with zero velocities.
    fn new(scene: Scene, network: &Network) -> Self {
        let x = &scene.state[..scene.state.len() / 2];
        let Undamped {
            mut modes,
            mut shapes,
            mixing,
        } = shapes(network, 0.0, x);
        let mixes = mixing > Mixing::None;
        let pencil = mixes
            .then(|| Pencil::of(network, 0.0, x, MAX_DENSE_UNKNOWNS))
            .flatten();
        let mixed = pencil.and_then(|pencil| Some((pencil.modes(&modes)?, pencil)));
        if let Some((modes, pencil)) = mixed {
            return Self {
                scene,
                modes,
                shapes: RestShapes::Mixed(pencil),
            };
        }
        if mixing < Mixing::Strong {
            return Self {
                scene,
                modes,
                shapes: RestShapes::Known(shapes),
            };
        }
        if let Some(mode) = of_drag(network) {
            modes.push(mode);
            shapes.push(vec![0.0; x.len()]);
        }
        Self {
            scene,
            modes,
            shapes: RestShapes::Approximate(shapes),
        }
    }

    /// Finds the largest steps of a method on the scene at rest, as by [`largest_step`] on its
    /// modes. If damping mixes shapes, those of a splitting method are found by its steps on all
    /// motion at once, and so are those of all explicit methods in a large scene.
    ///
    /// # Errors
    /// The method does not support the scene.
    pub fn largest_step(&self, method: &Method) -> Result<Option<Limit>, Error> {
        let by_modes = largest_step(method, &self.modes)?;
        let by_steps = match self.shapes {
            RestShapes::Known(_) => false,
            RestShapes::Mixed(_) => method.needs_mechanics(),
            RestShapes::Approximate(_) => {
                let small = self.scene.state.len() <= MAX_STEPPED_LENGTH;
                small && by_modes.is_some_and(|limit| limit.is_sharp())
            }
        };
        let explicit = !method.is_implicit() && !method.needs_springs();
        let (Some(limit), Some(network), true) =
            (by_modes, self.scene.model.network(), by_steps && explicit)
        else {
            return Ok(by_modes);
        };
        let fastest = self.modes.first().map_or(1.0, Mode::frequency);
        let guess = if limit.step.is_finite() {
            limit.step
        } else {
            1.0 / fastest
        };
        let half = self.scene.state.len() / 2;
        let step =
            AtRest::new(network, &self.scene.state[..half]).largest_step(method, guess, fastest)?;
        let found = step.map(|step| Limit {
            bounded: step,
            step,
            ..limit
        });
        Ok(found.or(by_modes))
    }

    /// Returns the shape of the mode of this index.
    fn shape(&self, mode: usize) -> Option<Vec<f64>> {
        match &self.shapes {
            RestShapes::Known(shapes) | RestShapes::Approximate(shapes) => {
                Some(shapes[mode].clone())
            }
            RestShapes::Mixed(pencil) => pencil.shape(&self.modes[mode]),
        }
    }
}

/// Finds the state in which the scene comes to rest without wind, swing and tearing, by implicit
/// Euler with growing steps.
///
/// `None` if implicit Euler does not support the scene, if the scene has constraints, which the
/// modes around rest leave out, rigid bodies, or moving pins or obstacles, and if it does not
/// settle or takes too much work; also soon after `go_on` returns false.
///
/// # Errors
/// The scene cannot be run.
pub fn rest(scene: &Scene, go_on: impl Fn() -> bool) -> Result<Option<RestState>, Error> {
    let Some((implicit, network)) = find("implicit").zip(scene.model.network()) else {
        return Ok(None);
    };
    let is_held = network.is_constrained() || !network.bodies().is_empty();
    if implicit.check(network).is_err() || is_held || network.moves_by_itself() {
        return Ok(None);
    }
    let mut scene = scene.clone();
    if let Model::Network(network) = &mut scene.model {
        network.set_tear(None)?;
    }
    let mut run = Simulation::new(scene.clone(), implicit, Control::Step(SETTLING[0].0))?;
    let mut random = SplitMix(4);
    let gravity = network.gravity().map_or(0.0, |g| g.norm());
    let pace = ((scene.extent().1 / gravity).sqrt() / SLOW_SCENE_TIME).min(1.0);
    // The work of a new run starts from zero.
    let mut before_push = 0.0;
    for (step, steps, leaves) in SETTLING {
        let step = pace * step;
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
            before_push = cost(&run);
            run = Simulation::new(pushed, implicit, Control::Step(step))?;
        }
        run.set_control(Control::Step(step))?;
        for _ in 0..steps {
            let before = run.state().to_vec();
            let held = safeguard_actions(&run);
            let costs_too_much = before_push + cost(&run) > MAX_WORK;
            if costs_too_much || !go_on() || run.take_steps(1).is_err() {
                return Ok(None);
            }
            // If the collision safeguard carries the weight, and not the force of contact, there is
            // no equilibrium: steps become shorter.
            let now = run.control().value();
            let next = if safeguard_actions(&run) > held {
                GUARDED_STEP_RATIO * now
            } else {
                step.min(FREE_STEP_RATIO * now)
            };
            if next != now {
                run.set_control(Control::Step(next))?;
                continue;
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
    let held = safeguard_actions(&run);
    let rests = run.take_steps(1).is_ok() && safeguard_actions(&run) == held;
    let speed = y[half..].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    y[half..].fill(0.0);
    if speed > 1e-4 || !rests {
        return Ok(None);
    }
    scene.state = y;
    Ok(Some(RestState::new(scene, network)))
}

/// Returns the number of times that the collision safeguard has acted in a run.
fn safeguard_actions(run: &Simulation) -> usize {
    let guarded = run.guarded();
    guarded.impulses + guarded.cuts
}

/// Finds the largest step with which a small disturbance of the scene at rest grows less than
/// [`GROWTH`] times in [`HORIZON`](super::HORIZON).
///
/// The disturbance is a velocity in the mode that limits the method, with a small random part.
/// Bisection begins at the predicted limit. If that is not sharp, growth is slower down to its
/// `bounded` step, which counts as the shortest that fails.
/// `None` if no limit is given, if the runs would take too long, and soon after `go_on` returns
/// false.
///
/// # Errors
/// The method does not support the scene.
pub fn observe_at_rest(
    rest: &RestState,
    method: &'static Method,
    limit: Option<&Limit>,
    budget: &Budget,
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
    let shape = rest.shape(limit.mode).unwrap_or_else(|| vec![0.0; half]);
    for (k, (z, other)) in shape.iter().zip(&others).enumerate() {
        let particle = k % network.particles();
        if !network.is_pinned(particle) {
            let z = z + RANDOM_SHARE * other / length;
            nudged.state[half + k] = DISTURBANCE * z / network.masses()[particle].sqrt();
        }
    }
    let size = EnergyNorm {
        network,
        rest: &still.state[..half],
    };
    let zero = vec![0.0; half];
    let nudge = size.of(&zero, &nudged.state[half..]);
    // The disturbance is measured against a second run without it: a method's state of rest may
    // differ a little from the scene's, and particles on an obstacle are moved out at every step.
    let holds = |h: f64| {
        let mut run = Simulation::new(nudged.clone(), method, Control::Step(h))?;
        let mut beside = Simulation::new(still.clone(), method, Control::Step(h))?;
        let held = take_checked(steps(h, guess), |count| {
            let held = budget.take(&mut run, count).filter(|_| go_on())?;
            let held = held && budget.take(&mut beside, count)?;
            let both = run.state().iter().zip(beside.state());
            let apart: Vec<_> = both.map(|(a, b)| a - b).collect();
            let (dx, dv) = apart.split_at(half);
            Some(held && size.of(dx, dv) < GROWTH * nudge)
        });
        budget.check().map(|()| held)
    };
    let mut seen = bisect(guess, still.model.work(), PRECISION, true, holds)?;
    // If the limit of the modes is not sharp, shorter steps grow too, but more slowly.
    if let Some(seen) = seen
        .as_mut()
        .filter(|seen| !seen.is_open() && !limit.is_sharp())
    {
        seen.failed = limit.bounded.min(seen.failed);
    }
    Ok(seen.filter(|_| go_on()))
}

/// Norm of disturbances around a state of rest: the root of twice their energy (J^1/2).
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

/// Returns the Euclidean length of a vector.
fn norm(y: &[f64]) -> f64 {
    y.iter().map(|y| y * y).sum::<f64>().sqrt()
}
