//! Scenes at rest: the state of rest, its modes, the largest step with which none grows, and the
//! largest one with which a small disturbance does not grow, as runs show it.

use super::limit::{GROWTH, Limit, largest_step};
use super::linearised::{AtRest, StateJacobian};
use super::mode::{Mixing, Mode, Observation, sort};
use super::own_rest;
use super::own_rest::own_rest;
use super::search::{Budget, bisect, cost, steps, take_checked};
use super::spectrum::{Pencil, Undamped, of_drag, shapes};
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Method, add_scaled, find};
use crate::measure::Measure;
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::{Model, Scene};
use crate::simulation::Simulation;
use crate::system::{Mechanics, ParticleSystem};

/// Rounds that bring a scene to rest: the step (s), the largest number of steps, and whether all
/// free particles are first displaced a little.
const SETTLING: [(f64, u32, bool); 5] = [
    (0.05, 400, false),
    (0.2, 400, false),
    (0.25, 400, true),
    (1.0, 400, false),
    (5.0, 400, false),
];

/// Largest displacements of the particles in such a round, over the radius of the scene. They are
/// tried in turn until no surfaces cross.
const PUSHES: [f64; 3] = [1e-4, 1e-6, 1e-8];

/// Time (s) in which gravity moves a scene by its radius, from which on the rounds have these
/// steps: smaller and faster scenes take proportionally shorter ones.
const SLOW_SCENE_TIME: f64 = 0.1;

/// Ratio of the steps of a round to those of the round before, if a step of that one failed.
const SHORTER_RATIO: f64 = 0.25;
/// Share of the rounds' steps below which they are not shortened.
const MIN_PACE_SHARE: f64 = 0.01;

/// Largest work of these rounds, in the unit of a [`Budget`].
const MAX_WORK: f64 = 1e9;

/// Largest number of free coordinates of a scene whose modes are found together if damping mixes
/// them: the eigenvalues of a matrix of twice that dimension take a second or two.
const MAX_DENSE_UNKNOWNS: usize = 200;

/// Largest length of the state of a scene with more coordinates than that whose limits are
/// confirmed by steps on all motion: longer ones would take minutes.
const MAX_STEPPED_LENGTH: usize = 1200;

/// Largest length of the state of a scene of particles whose steps are differentiated about the
/// method's own state of rest. Longer ones have stiffer springs than gravity displaces in a step.
const MAX_MAPPED_LENGTH: usize = 60;

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
    /// Jacobian of a scene with rigid bodies.
    Whole(StateJacobian),
}

impl RestState {
    /// Creates a state of rest from a scene that starts in it, with zero velocities. `None` if it
    /// has rigid bodies and is too large.
    fn new(scene: Scene, network: &Network) -> Option<Self> {
        if !network.bodies().is_empty() {
            let jacobian = StateJacobian::of(network, 0.0, &scene.state)?;
            let mut modes = jacobian.modes(network);
            sort(&mut modes);
            return Some(Self { scene, modes, shapes: RestShapes::Whole(jacobian) });
        }
        let (x, _) = network.halves(&scene.state);
        let Undamped { mut modes, mut shapes, mixing } = shapes(network, 0.0, x);
        let mixes = mixing > Mixing::None;
        let pencil = mixes.then(|| Pencil::of(network, 0.0, x, MAX_DENSE_UNKNOWNS)).flatten();
        let mixed = pencil.and_then(|pencil| Some((pencil.modes(&modes)?, pencil)));
        let shapes = if let Some((mixed, pencil)) = mixed {
            modes = mixed;
            RestShapes::Mixed(pencil)
        } else if mixing < Mixing::Strong {
            RestShapes::Known(shapes)
        } else {
            if let Some(mode) = of_drag(network) {
                modes.push(mode);
                shapes.push(vec![0.0; x.len()]);
            }
            RestShapes::Approximate(shapes)
        };
        Some(Self { scene, modes, shapes })
    }

    /// Finds the largest steps of a method on the scene at rest, as by [`largest_step`] on its
    /// modes. If damping mixes shapes, or there are rigid bodies, those of a splitting method are
    /// found by its steps on all motion at once, and so are those of all explicit methods in a
    /// large scene.
    ///
    /// # Errors
    /// The method does not support the scene.
    pub fn largest_step(&self, method: &'static Method) -> Result<Option<Limit>, Error> {
        let by_modes = largest_step(method, &self.modes)?;
        let by_steps = match self.shapes {
            RestShapes::Known(_) => false,
            RestShapes::Mixed(_) => method.needs_mechanics(),
            // If the motion grows by itself, so do all steps.
            RestShapes::Whole(_) => {
                method.needs_mechanics() && self.modes.iter().all(Mode::returns)
            }
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
        let guess = if limit.step.is_finite() { limit.step } else { 1.0 / fastest };
        let half = self.scene.state.len() / 2;
        let whole = matches!(self.shapes, RestShapes::Whole(_));
        let step = if whole || self.scene.state.len() <= MAX_MAPPED_LENGTH {
            own_rest::largest_step(&self.scene, method, guess)?
        } else {
            AtRest::new(network, &self.scene.state[..half]).largest_step(method, guess, fastest)?
        };
        let found = step.map(|step| Limit { bounded: step, step, ..limit });
        Ok(found.or(by_modes))
    }

    /// Returns a change of the state in the mode of this index, of any size: a velocity or, with
    /// rigid bodies, the change at one moment.
    pub(super) fn shape(&self, mode: usize) -> Option<Vec<f64>> {
        let shape = match &self.shapes {
            RestShapes::Known(shapes) | RestShapes::Approximate(shapes) => shapes[mode].clone(),
            RestShapes::Mixed(pencil) => pencil.shape(&self.modes[mode])?,
            RestShapes::Whole(jacobian) => return jacobian.shape(&self.modes[mode]),
        };
        let mut change = vec![0.0; self.scene.state.len()];
        let inverse_masses = self.scene.model.network()?.inverse_masses();
        for (k, z) in shape.iter().enumerate() {
            change[shape.len() + k] = z * inverse_masses[k % inverse_masses.len()].sqrt();
        }
        Some(change)
    }
}

/// Finds the state in which the scene comes to rest without wind, swing and tearing, by implicit
/// Euler with growing steps.
///
/// `None` if implicit Euler does not support the scene, if the scene has constraints, which the
/// modes around rest leave out, or moving pins or obstacles, if it has rigid bodies and is too
/// large, and if it does not settle or takes too much work; also soon after `go_on` returns false.
///
/// # Errors
/// The scene cannot be run.
pub fn rest(scene: &Scene, go_on: impl Fn() -> bool) -> Result<Option<RestState>, Error> {
    let Some((implicit, network)) = find("implicit").zip(scene.model.network()) else {
        return Ok(None);
    };
    let moves = network.moves_by_itself();
    if implicit.check(network).is_err() || network.is_constrained() || moves {
        return Ok(None);
    }
    let mut scene = scene.clone();
    if let Model::Network(network) = &mut scene.model {
        network.set_tear(None)?;
    }
    let mut run = Simulation::new(scene.clone(), implicit, Control::Step(SETTLING[0].0))?;
    let mut random = SplitMix(4);
    let gravity = network.gravity().map_or(0.0, |g| g.norm());
    let mut pace = ((scene.extent().1 / gravity).sqrt() / SLOW_SCENE_TIME).min(1.0);
    let least = MIN_PACE_SHARE * pace;
    // The work of a new run starts from zero.
    let mut before = 0.0;
    let again = |run: &Simulation, state: Vec<f64>| {
        let mut scene = scene.clone();
        scene.state = state;
        Simulation::new(scene, implicit, run.control())
    };
    for (step, steps, leaves) in SETTLING {
        if leaves {
            // A fold may be balanced on its edge. The push makes it fall to one side, and it needs
            // all the steps to come to rest there.
            let (begun, radius) = (run.state().to_vec(), run.extent().1);
            let mut pushes = vec![0.0; begun.len()];
            for (k, push) in pushes[..3 * run.particles()].iter_mut().enumerate() {
                if !network.is_pinned(k % run.particles()) {
                    *push = random.between(-1.0, 1.0);
                }
            }
            let pushed = |share: f64| {
                let moved = begun.iter().zip(&pushes);
                moved.map(|(x, push)| x + share * radius * push).collect()
            };
            // Where things lie close to one another, a push may let them cross.
            let found = PUSHES.into_iter().find_map(|share| again(&run, pushed(share)).ok());
            if let Some(found) = found {
                before += cost(&run);
                run = found;
            }
        }
        let begun = run.state().to_vec();
        loop {
            let allowed = |run: &Simulation| before + cost(run) <= MAX_WORK && go_on();
            let settled = settle(&mut run, (pace * step, steps, leaves), &allowed)?;
            match settled {
                RoundEnd::Yes => break,
                RoundEnd::Failed if pace > least => {}
                RoundEnd::Failed | RoundEnd::Stopped => return Ok(None),
            }
            // Implicit Euler turns a body by its spin at the start of a step.
            pace *= SHORTER_RATIO;
            before += cost(&run);
            run = again(&run, begun.clone())?;
        }
    }
    let mut y = run.state().to_vec();
    let held = safeguard_actions(&run);
    let rests = run.take_steps(1).is_ok() && safeguard_actions(&run) == held;
    let speeds = network.halves(&y).1.iter();
    let speed = speeds.fold(0.0, |m: f64, v| m.max(v.abs()));
    if speed > 1e-4 || !rests {
        return Ok(None);
    }
    network.measures(&mut |numbers, measure| {
        if matches!(measure, Measure::Velocity | Measure::Momentum { .. }) {
            y[numbers].fill(0.0);
        }
    });
    network.hold(0.0, &mut y);
    scene.state = y;
    Ok(RestState::new(scene, network))
}

/// Ways in which a round of steps towards rest ends.
enum RoundEnd {
    Yes,
    /// A step failed.
    Failed,
    /// No more work is allowed.
    Stopped,
}

/// Takes steps of a round of [`SETTLING`], while `allowed` returns true.
fn settle(
    run: &mut Simulation,
    (step, steps, leaves): (f64, u32, bool),
    allowed: &dyn Fn(&Simulation) -> bool,
) -> Result<RoundEnd, Error> {
    run.set_control(Control::Step(step))?;
    for _ in 0..steps {
        let before = run.state().to_vec();
        let held = safeguard_actions(run);
        if !allowed(run) {
            return Ok(RoundEnd::Stopped);
        }
        if !succeeded(run.take_steps(1))? {
            return Ok(RoundEnd::Failed);
        }
        // If the collision safeguard carries the weight, and not the force of contact, there is
        // no equilibrium: steps become shorter.
        let now = run.control().value();
        let next = if safeguard_actions(run) > held {
            GUARDED_STEP_RATIO * now
        } else {
            step.min(FREE_STEP_RATIO * now)
        };
        if next != now {
            run.set_control(Control::Step(next))?;
            continue;
        }
        let positions = |y| run.model().network().map_or(y, |network| network.halves(y).0);
        let [now, before] = [run.state(), &before].map(positions);
        let squares = now.iter().zip(before).map(|(a, b)| (a - b).powi(2));
        let moved = (squares.sum::<f64>() / now.len() as f64).sqrt();
        if !leaves && moved < 1e-9 * step {
            break;
        }
    }
    Ok(RoundEnd::Yes)
}

/// Returns the number of times that the collision safeguard has acted in a run.
fn safeguard_actions(run: &Simulation) -> usize {
    let guarded = run.guarded();
    guarded.impulses + guarded.cuts
}

/// Relative precision of the largest step found by runs.
const PRECISION: f64 = 0.01;
/// Size of the disturbance of a scene at rest: the root of twice its energy (J^1/2).
const DISTURBANCE: f64 = 1e-6;
/// Random part of that disturbance, relative to its part in the limiting mode.
const RANDOM_SHARE: f64 = 0.1;
/// Displacement at which the potential energy of a disturbance is computed, over the scene's
/// radius.
const DISPLACEMENT: f64 = 1e-6;

/// Finds the largest step with which a small disturbance of the scene at rest grows less than
/// [`GROWTH`] times in [`HORIZON`](super::HORIZON).
///
/// The disturbance is in the mode that limits the method, with a small random part, and its run is
/// compared with one without it. Both start in the method's own state of rest, which may differ
/// from the scene's: a splitting method balances forces over a step, not at its ends. Bisection
/// begins at the predicted limit. `None` if no limit is given, if the runs would take too long, and
/// soon after `go_on` returns false.
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
    let (Some(network), Some(limit)) = (still.model.network(), limit) else {
        return Ok(None);
    };
    let guess = limit.step;
    let energy = EnergyNorm::new(still, network);
    let nudge = energy.disturbance(rest.shape(limit.mode));
    let holds = |h: f64| {
        let start = own_rest(still, method, h)?;
        let begin = |share: f64| {
            let mut scene = still.clone();
            scene.state.clone_from(&start);
            add_scaled(&mut scene.state, share, &nudge);
            network.hold(0.0, &mut scene.state);
            Simulation::new(scene, method, Control::Step(h)).map(Simulation::tolerate_gains)
        };
        let (mut run, mut beside) = (begin(1.0)?, begin(0.0)?);
        let held = take_checked(steps(h, guess), |count| {
            let held = budget.take(&mut run, count).filter(|_| go_on())?;
            let held = held && budget.take(&mut beside, count)?;
            let both = run.state().iter().zip(beside.state());
            let apart: Vec<_> = both.map(|(a, b)| a - b).collect();
            Some(held && energy.of(&apart) < GROWTH * DISTURBANCE)
        });
        budget.check().map(|()| held)
    };
    let seen = bisect(guess, still.model.work(), PRECISION, true, holds)?;
    Ok(seen.filter(|_| go_on()))
}

/// Norm of disturbances of a state of rest: the root of twice their energy (J^1/2).
struct EnergyNorm<'a> {
    network: &'a Network,
    rest: &'a [f64],
    /// Displacement at which potential energy is computed (m).
    displacement: f64,
    /// Potential energy at rest (J).
    potential: f64,
}

impl<'a> EnergyNorm<'a> {
    fn new(scene: &'a Scene, network: &'a Network) -> Self {
        let mut norm = Self {
            network,
            rest: &scene.state,
            displacement: DISPLACEMENT * scene.extent().1,
            potential: 0.0,
        };
        norm.potential = norm.energies(0.0, &vec![0.0; scene.state.len()])[1];
        norm
    }

    /// Returns the kinetic and the potential energy (J) of the state of rest with a share of a
    /// change.
    fn energies(&self, share: f64, change: &[f64]) -> [f64; 2] {
        let mut y = self.rest.to_vec();
        add_scaled(&mut y, share, change);
        self.network.hold(0.0, &mut y);
        let energy = self.network.energy_of(0.0, &y);
        [energy.kinetic, energy.total() - energy.kinetic]
    }

    fn of(&self, change: &[f64]) -> f64 {
        let [kinetic, _] = self.energies(1.0, change);
        let farthest = change[..3 * self.network.particles()].iter();
        let farthest = farthest.fold(0.0, |m: f64, x| m.max(x.abs()));
        let potential = if farthest > 0.0 {
            let share = self.displacement / farthest;
            let ends = [share, -share].map(|share| self.energies(share, change)[1]);
            (ends[0] + ends[1] - 2.0 * self.potential) / (share * share)
        } else {
            0.0
        };
        (2.0 * kinetic + potential).abs().sqrt()
    }

    /// Returns a disturbance in the shape of a mode, if there is one, with a small random part.
    fn disturbance(&self, shape: Option<Vec<f64>>) -> Vec<f64> {
        let network = self.network;
        let (n, size) = (network.particles(), self.rest.len());
        let mut random = SplitMix(5);
        let mut all = vec![0.0; size];
        for k in 0..3 * n {
            let mass = network.masses()[k % n];
            if mass > 0.0 && !network.is_pinned(k % n) {
                all[3 * n + k] = random.between(-1.0, 1.0) / mass.sqrt();
            }
        }
        let scale = |change: &mut [f64], wanted: f64| {
            let own = self.of(change);
            for change in change {
                *change *= if own > 0.0 { wanted / own } else { 0.0 };
            }
        };
        scale(&mut all, RANDOM_SHARE);
        if let Some(mut shape) = shape {
            scale(&mut shape, 1.0);
            add_scaled(&mut all, 1.0, &shape);
        }
        scale(&mut all, DISTURBANCE);
        all
    }
}
