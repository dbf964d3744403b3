//! Scenes at rest: the state of rest, and the largest step with which a small
//! disturbance around it does not grow.

use super::limit::{GROWTH, Limit, largest_step};
use super::linearised::AtRest;
use super::mode::Mode;
use super::normalised::Mixing;
use super::observation::Observation;
use super::pencil::Pencil;
use super::search::{Budget, bisect, cost, step_and_look, steps};
use super::spectrum::{Undamped, of_drag, shapes};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, find};
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::{Model, Scene};
use crate::simulation::Simulation;
use crate::system::Linearized;

/// Relative precision of the largest step that is seen.
const PRECISION: f64 = 0.01;
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

/// Time (s) in which gravity moves a scene by its radius, from which on these rounds have their
/// steps: smaller and faster scenes take shorter ones, in proportion.
const SLOW: f64 = 0.1;

/// Most work of these rounds, in that of a [`Budget`].
const MOST: f64 = 1e9;

/// Most free numbers in x of a scene whose modes are found together where damping mixes them: a
/// matrix of twice that dimension has its eigenvalues in a second or two.
const DENSE: usize = 200;

/// Most numbers in the state of a scene whose limits are confirmed by steps on all motion where it
/// has too many modes to be found together: more would take minutes.
const STEPPED: usize = 1200;

/// Next step over one in which the guard of surfaces acted, and over one in which it did not.
const SHORTER: f64 = 0.25;
const LONGER: f64 = 1.5;

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

/// What the shapes of modes are found from: the displacements times the roots of the masses, of
/// length 1.
#[derive(Clone)]
enum RestShapes {
    /// Shape of each mode.
    Known(Vec<Vec<f64>>),
    /// The shapes without damping, which damping mixes in a scene with too many of them.
    Approximate(Vec<Vec<f64>>),
    /// All motion of a scene where damping mixes shapes.
    Mixed(Pencil),
}

impl RestState {
    /// Scene that rests in its state, at the beginning of which its velocities are zero.
    fn new(scene: Scene, network: &Network) -> Self {
        let x = &scene.state[..scene.state.len() / 2];
        let Undamped {
            mut modes,
            mut shapes,
            mixing,
        } = shapes(network, 0.0, x);
        let mixes = mixing > Mixing::None;
        let pencil = mixes.then(|| Pencil::of(network, 0.0, x, DENSE)).flatten();
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

    /// Largest steps of a method on the scene at rest, as by [`largest_step`] on its modes. Where
    /// damping mixes shapes, those of a splitting method come from its steps on all motion at once,
    /// and so do those of all explicit methods in a large scene.
    ///
    /// # Errors
    /// The method does not support the scene.
    pub fn largest_step(&self, method: &Method) -> Result<Option<Limit>, Error> {
        let by_modes = largest_step(method, &self.modes)?;
        let by_steps = match self.shapes {
            RestShapes::Known(_) => false,
            RestShapes::Mixed(_) => method.needs_mechanics(),
            RestShapes::Approximate(_) => {
                let small = self.scene.state.len() <= STEPPED;
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

    /// Shape of the mode of this index.
    fn shape(&self, mode: usize) -> Option<Vec<f64>> {
        match &self.shapes {
            RestShapes::Known(shapes) | RestShapes::Approximate(shapes) => {
                Some(shapes[mode].clone())
            }
            RestShapes::Mixed(pencil) => pencil.shape(&self.modes[mode]),
        }
    }
}

/// State in which the scene comes to rest without wind and swing and without tearing, computed by
/// implicit Euler with growing steps.
///
/// `None` for a first-order scene, for one that implicit Euler does not support, for one with rigid
/// bodies, for one whose pins or obstacles move, and for one that does not settle, or takes too
/// much work to; soon after `go_on` returns false, too.
///
/// # Errors
/// The scene cannot be run.
pub fn rest(scene: &Scene, go_on: impl Fn() -> bool) -> Result<Option<RestState>, Error> {
    let Some((implicit, network)) = find("implicit").zip(scene.model.network()) else {
        return Ok(None);
    };
    let has_bodies = !network.bodies().is_empty();
    if implicit.check(network).is_err() || has_bodies || network.moves_by_itself() {
        return Ok(None);
    }
    let mut scene = scene.clone();
    if let Model::Network(network) = &mut scene.model {
        network.set_tear(None)?;
    }
    let mut run = Simulation::new(scene.clone(), implicit, Control::Step(SETTLING[0].0))?;
    let mut random = SplitMix(4);
    let gravity = network.gravity().map_or(0.0, |g| g.norm());
    let pace = ((scene.extent().1 / gravity).sqrt() / SLOW).min(1.0);
    // A run that begins again counts from nothing.
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
            let held = acts(&run);
            let dear = before_push + cost(&run) > MOST;
            if dear || !go_on() || run.take_steps(1).is_err() {
                return Ok(None);
            }
            // If the guard of surfaces carries the weight, and not the force of contact, there is
            // no equilibrium: steps become shorter.
            let now = run.control().value();
            let next = if acts(&run) > held {
                SHORTER * now
            } else {
                step.min(LONGER * now)
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
    let held = acts(&run);
    let rests = run.take_steps(1).is_ok() && acts(&run) == held;
    let speed = y[half..].iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    y[half..].fill(0.0);
    if speed > 1e-4 || !rests {
        return Ok(None);
    }
    scene.state = y;
    Ok(Some(RestState::new(scene, network)))
}

/// Number of times that the guard of surfaces has acted in a run.
fn acts(run: &Simulation) -> usize {
    let guarded = run.guarded();
    guarded.impulses + guarded.cuts
}

/// Largest step with which a small disturbance of the scene at rest grows less than [`GROWTH`]
/// times in [`HORIZON`](super::HORIZON).
///
/// The disturbance is a velocity in the mode that limits the method, with a small random part.
/// Bisection begins at the predicted limit. Where that is not sharp, growth is slower down to its
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
    let holds = |h: f64| {
        let mut run = Simulation::new(nudged.clone(), method, Control::Step(h))?;
        let mut beside = Simulation::new(still.clone(), method, Control::Step(h))?;
        Ok(step_and_look(steps(h, guess), |count| {
            let held = budget.take(&mut run, count).filter(|_| go_on())?;
            let held = held && budget.take(&mut beside, count)?;
            let both = run.state().iter().zip(beside.state());
            let apart: Vec<_> = both.map(|(a, b)| a - b).collect();
            let (dx, dv) = apart.split_at(half);
            Some(held && size.of(dx, dv) < GROWTH * nudge)
        }))
    };
    let mut seen = bisect(guess, still.model.work(), PRECISION, true, holds)?;
    // Shorter steps grow too, more slowly, where the limit by the modes is not sharp.
    if let Some(seen) = seen
        .as_mut()
        .filter(|seen| !seen.is_open() && !limit.is_sharp())
    {
        seen.failed = limit.bounded.min(seen.failed);
    }
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

/// Euclidean length of a vector.
fn norm(y: &[f64]) -> f64 {
    y.iter().map(|y| y * y).sum::<f64>().sqrt()
}
