//! Power and work of everything that drives a scene: moving pins and obstacles, wind, motors and
//! constraints.
//!
//! A pin works against the springs at its particle and against gravity. Its power is integrated
//! over each step: for a method of order above 2 by Simpson's rule, with the state in the middle
//! from the Hermite polynomial, for others by the trapezoidal rule. The force F of wind changes
//! slowly: its work is F . dx over short times. If anything else works on a scene, the power of
//! everything together is the rate at which the energy of the exact motion grows, dE/dt = (E(t + e,
//! y + e f) - E(t - e, y - e f)) / 2e.

use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

use crate::contact::Obstacle;
use crate::elements::force::{Force, Matter};
use crate::energy::Energy;
use crate::error::Error;
use crate::network::{Network, add_wind, constraint_power, has_motors, next_known_time};
use crate::path::Path;
use crate::spring::Spring;
use crate::system::{Mechanics, ParticleSystem};

/// Longest time (s) between two evaluations of the work of wind, or of the total work, in a scene
/// of more than [`MAX_PARTICLES_PER_STEP`] particles.
const INTERVAL: f64 = 1.0 / 60.0;

/// Largest number of particles for which that work is evaluated at each step: with more, it would
/// take too long.
const MAX_PARTICLES_PER_STEP: usize = 200;

/// Share of the energy that moves up to which the total power counts as steady: its change between
/// two evaluations, times the time between them, is less, and the next two may be farther apart. It
/// is a tenth of the gain from which on users are warned.
const STEADY_SHARE: f64 = 0.01;

/// Least half of the interval of the difference quotient for the total power (s).
const LEAST_MOMENT: f64 = 1e-7;

/// That half over the step. For a motion of frequency w, the quotient is then off by 1.5e-6 (h w)2,
/// no more than Simpson's rule is where h w = 0.1. A rounding error of the energy makes an error of
/// the work in a step that is 170 times as large.
const MOMENT_SHARE: f64 = 0.003;

/// Order of a method up to which the trapezoidal rule is accurate enough.
const LOW_ORDER: u32 = 2;

/// Kinetic energy over that of the pins, below which it is a rounding error.
const ROUNDING: f64 = 1e-12;

/// End of a step.
#[derive(Clone, Copy)]
pub(super) struct End<'a> {
    /// Order of the method.
    pub order: u32,
    /// Whether the method is adaptive. Its steps end before a prescribed motion begins, and may be
    /// long; the forces at the end of a fixed step include that motion.
    pub is_adaptive: bool,
    /// Time (s).
    pub t: f64,
    /// State.
    pub y: &'a [f64],
}

/// Last evaluation of the power of a run, which may be before the end of its last step.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Evaluated {
    /// Time (s), positions (m) and forces (N) of wind.
    wind: Option<(f64, Vec<f64>, Vec<f64>)>,
    /// Time (s) and power (W) of everything together, and the time until the next evaluation (s).
    all: Option<[f64; 3]>,
}

impl Evaluated {
    /// Checks that this is an evaluation of a network.
    ///
    /// # Errors
    /// It has numbers of another network, or some that are not finite.
    pub fn check(&self, network: Option<&Network>) -> Result<(), Error> {
        let length = network.map_or(0, |network| 3 * network.particles());
        let fits = |v: &[f64]| v.len() == length && v.iter().all(|v| v.is_finite());
        let mut wind = self.wind.iter();
        let mut all = self.all.iter();
        if wind.all(|(t, x, f)| t.is_finite() && fits(x) && fits(f))
            && all.all(|all| all.iter().all(|number| number.is_finite()))
        {
            return Ok(());
        }
        let why = "the work in a checkpoint must be finite, and of its scene";
        Err(Error::Invalid(why.into()))
    }
}

/// Power of everything that works on a scene.
#[derive(Clone, Debug, Default)]
pub(super) struct Power {
    /// Whether the parts match the current network and state.
    is_fresh: bool,
    pins: Option<PinWork>,
    wind: Option<WindWork>,
    all: Option<TotalWork>,
}

impl Power {
    /// Prepares for a step from y at time t (s), unless that is done.
    pub fn begin(&mut self, network: &Network, t: f64, y: &[f64]) {
        if std::mem::replace(&mut self.is_fresh, true) {
            return;
        }
        (self.pins, self.wind, self.all) = (None, None, None);
        if works_together(network) {
            self.all = Some(TotalWork::new(network, t, y));
        } else {
            let moving = network.pins().any(|(_, path)| moves(&path));
            self.pins = moving.then(|| PinWork::new(network, t, y));
            self.wind = network.wind().map(|_| WindWork::new(network, t, y));
        }
    }

    /// Returns the last evaluation, unless the scene is forgotten.
    pub fn evaluated(&self) -> Option<Evaluated> {
        self.is_fresh.then(|| Evaluated {
            wind: (self.wind.as_ref()).map(|wind| (wind.t, wind.x.clone(), wind.f.clone())),
            all: self.all.as_ref().map(|all| [all.t, all.power, all.interval]),
        })
    }

    /// Continues from an evaluation up to the end of a step.
    pub fn resume(&mut self, network: &Network, end: End, last: &Evaluated) {
        self.forget();
        self.begin(network, end.t, end.y);
        if let (Some(wind), Some((t, x, f))) = (&mut self.wind, &last.wind) {
            wind.t = *t;
            wind.x.copy_from_slice(x);
            wind.f.copy_from_slice(f);
        }
        if let (Some(all), Some(last)) = (&mut self.all, last.all) {
            [all.t, all.power, all.interval] = last;
        }
    }

    /// Forgets the scene, because the network or the state has changed.
    pub fn forget(&mut self) {
        self.is_fresh = false;
    }

    /// Returns the work (J) since the last evaluation, up to this end of a step, if another one is
    /// due: when it is needed `now`, after an interval, or sooner if the power changes much beside
    /// the energy that moves (J).
    pub fn work(&mut self, network: &Network, end: End, now: bool, moving: f64) -> f64 {
        let few = network.particles() <= MAX_PARTICLES_PER_STEP;
        let is_due = |t: f64, interval: f64| now || few || end.t - t >= interval;
        let pins = self.pins.as_mut().map(|pins| pins.work(network, end));
        let known = |t: f64| !few && next_known_time(network, t) <= end.t;
        let wind = self.wind.as_mut().filter(|wind| is_due(wind.t, INTERVAL) || known(wind.t));
        let wind = wind.map(|wind| wind.work(network, end));
        let mut work = pins.into_iter().chain(wind).sum();
        if let Some(all) = &mut self.all {
            if is_due(all.t, all.interval) || known(all.t) {
                work += all.work(network, end, moving);
            }
            all.seen = end.t;
        }
        work
    }

    /// Returns the work (J) that is not evaluated yet at this end of a step, without noting it.
    pub fn rest(&self, network: &Network, end: End) -> f64 {
        if !self.is_fresh {
            return 0.0;
        }
        let wind = self.wind.as_ref().filter(|wind| wind.t < end.t);
        let wind = wind.map(|wind| wind.clone().work(network, end));
        let all = self.all.as_ref().filter(|all| all.t < end.t);
        let all = all.map(|all| all.clone().work(network, end, 0.0));
        [wind, all].into_iter().flatten().sum()
    }
}

/// Returns whether a path moves.
fn moves(path: &Path) -> bool {
    !matches!(path, Path::Still(_))
}

/// Returns whether something other than pins on springs, and wind, works on a scene.
fn works_together(network: &Network) -> bool {
    let has = |is: fn(&dyn Force) -> bool| {
        let mut elements = network.elements().iter();
        elements.any(|element| is(element.force()))
    };
    let pinned = network.pins().any(|(_, path)| moves(&path));
    let pushed = !network.obstacles().iter().all(Obstacle::is_still);
    !network.constraints().is_empty()
        || has_motors(network)
        || has(|force| force.is_driven() && !force.is_wind())
        || network.contact_layer().is_some() && pushed
        || !network.bodies().is_empty() && (pinned || network.wind().is_some())
        || pinned && has(|force| matches!(force.matter(), Some(Matter::Elastic | Matter::Fluid)))
}

/// Work of moving pins on springs.
#[derive(Clone, Debug)]
struct PinWork {
    /// The moving pins and their masses (kg): the first of the particles.
    paths: Vec<(Path, f64)>,
    /// Those particles, and then those at the other ends of their springs.
    particles: Vec<usize>,
    /// The springs, whose ends are numbers among these particles.
    springs: Vec<Spring>,
    /// Time (s), state of the particles, [x | v], and power (W) at the end of the last step.
    t: f64,
    y: Vec<f64>,
    power: f64,
    /// States of the particles.
    scratch: [Vec<f64>; 2],
}

impl PinWork {
    fn new(network: &Network, t: f64, y: &[f64]) -> Self {
        let (masses, moving) = (network.masses(), |p: &(usize, Path)| moves(&p.1));
        let moving: Vec<_> = network.pins().filter(moving).collect();
        let mut particles: Vec<_> = moving.iter().map(|(i, _)| *i).collect();
        let mut places = vec![usize::MAX; masses.len()];
        for (k, i) in particles.iter().enumerate() {
            places[*i] = k;
        }
        let mut springs = vec![];
        for spring in network.springs() {
            let is_moved = |i: usize| places[i] < moving.len();
            if is_moved(spring.i) || is_moved(spring.j) {
                let [i, j] = [spring.i, spring.j].map(|i| {
                    if places[i] == usize::MAX {
                        places[i] = particles.len();
                        particles.push(i);
                    }
                    places[i]
                });
                springs.push(Spring { i, j, ..spring });
            }
        }
        let paths = moving.into_iter().map(|(i, path)| (path, masses[i]));
        let mut pins = Self {
            paths: paths.collect(),
            particles,
            springs,
            t,
            y: vec![],
            power: 0.0,
            scratch: [vec![], vec![]],
        };
        let mut own = vec![];
        pins.copy_state(y, &mut own);
        pins.power = pins.power_at(network, &own);
        pins.scratch = [(); 2].map(|()| Vec::with_capacity(own.len()));
        pins.y = own;
        pins
    }

    /// Copies the state of the particles from that of the whole network.
    fn copy_state(&self, y: &[f64], own: &mut Vec<f64>) {
        own.clear();
        let n = y.len() / 6;
        // Rotations of bodies come last in y, so the first six columns are [x | v].
        for column in y.chunks_exact(n.max(1)).take(6) {
            own.extend(self.particles.iter().map(|i| column[*i]));
        }
    }

    fn work(&mut self, network: &Network, end: End) -> f64 {
        let [mut middle, mut own] = std::mem::take(&mut self.scratch);
        self.copy_state(end.y, &mut own);
        let jumps = may_jump(network, end);
        if jumps {
            self.place_pins(end.t.next_down(), &mut own);
        }
        let power = self.power_at(network, &own);
        let h = end.t - self.t;
        let mut mean = 0.5 * (self.power + power);
        if end.order > LOW_ORDER {
            write_middle(&self.y, &own, h, &mut middle);
            self.place_pins(self.t + 0.5 * h, &mut middle);
            mean = (2.0 * mean + 4.0 * self.power_at(network, &middle)) / 6.0;
        }
        (self.t, self.power) = (end.t, power);
        if jumps {
            self.place_pins(end.t, &mut own);
            self.power = self.power_at(network, &own);
        }
        std::mem::swap(&mut self.y, &mut own);
        self.scratch = [middle, own];
        mean * h
    }

    /// Writes the places and velocities of the pins at time t (s) to a state of the particles.
    fn place_pins(&self, t: f64, state: &mut [f64]) {
        let n = self.particles.len();
        for (k, (path, _)) in self.paths.iter().enumerate() {
            let place = path.at(t);
            for axis in 0..3 {
                state[axis * n + k] = place.position[axis];
                state[(3 + axis) * n + k] = place.velocity[axis];
            }
        }
    }

    /// Returns the power (W) of the pins in a state of the particles.
    fn power_at(&self, network: &Network, y: &[f64]) -> f64 {
        let (n, pins) = (self.particles.len(), self.paths.len());
        let row = |i: usize, first: usize| {
            let first = first * n + i;
            Vector3::new(y[first], y[first + n], y[first + 2 * n])
        };
        let mut power = 0.0;
        for Spring { i, j, law, .. } in &self.springs {
            let (d, v) = (row(*i, 0) - row(*j, 0), [row(*i, 3), row(*j, 3)]);
            let length = d.norm();
            if length > 0.0 {
                let along = d / length;
                let rate = along.dot(&(v[0] - v[1]));
                let pull = law.stiffness * (length - law.rest_length) + law.damping * rate;
                if *i < pins {
                    power += pull * along.dot(&v[0]);
                }
                if *j < pins {
                    power -= pull * along.dot(&v[1]);
                }
            }
        }
        if let Some(g) = network.gravity() {
            let weights = self.paths.iter().enumerate();
            power -= weights.map(|(k, (_, m))| m * g.dot(&row(k, 3))).sum::<f64>();
        }
        power
    }
}

/// Work of wind.
#[derive(Clone, Debug)]
struct WindWork {
    /// Time (s), positions (m) and forces (N) at the last evaluation.
    t: f64,
    x: Vec<f64>,
    f: Vec<f64>,
    scratch: Vec<f64>,
}

impl WindWork {
    fn new(network: &Network, t: f64, y: &[f64]) -> Self {
        let (x, v) = network.halves(y);
        let mut f = vec![0.0; x.len()];
        add_wind(network, t, x, v, &mut f);
        let (x, scratch) = (x.to_vec(), vec![0.0; f.len()]);
        Self { t, x, f, scratch }
    }

    fn work(&mut self, network: &Network, end: End) -> f64 {
        let End { t, y, .. } = end;
        let (x, v) = network.halves(y);
        let (free, n) = (network.inverse_masses(), network.particles());
        let jumps = may_jump(network, end);
        let blow = |t: f64, f: &mut [f64]| {
            f.fill(0.0);
            add_wind(network, t, x, v, f);
        };
        blow(if jumps { t.next_down() } else { t }, &mut self.scratch);
        let mut work = 0.0;
        for (k, (x1, x0)) in x.iter().zip(&self.x).enumerate() {
            if free[k % n] > 0.0 {
                work += 0.5 * (self.f[k] + self.scratch[k]) * (x1 - x0);
            }
        }
        self.t = t;
        self.x.copy_from_slice(x);
        if jumps {
            blow(t, &mut self.scratch);
        }
        std::mem::swap(&mut self.f, &mut self.scratch);
        work
    }
}

/// Work of everything together.
#[derive(Clone, Debug)]
struct TotalWork {
    /// Time (s) and power (W) at the last evaluation, the state there, and its rates of change: the
    /// Hermite polynomial of rotations needs them.
    t: f64,
    power: f64,
    y: Vec<f64>,
    f: Vec<f64>,
    /// Time (s) from the last evaluation to the next one, with many particles.
    interval: f64,
    /// End of the last step (s).
    seen: f64,
    /// States, and rates of change.
    scratch: [Vec<f64>; 3],
}

impl TotalWork {
    fn new(network: &Network, t: f64, y: &[f64]) -> Self {
        let mut all = Self {
            t,
            power: 0.0,
            y: y.to_vec(),
            f: vec![],
            interval: 0.0,
            seen: t,
            scratch: [(); 3].map(|()| vec![0.0; y.len()]),
        };
        all.begin(network, (t, LEAST_MOMENT), y);
        all
    }

    /// Evaluates the power at the beginning of a step from y at time t (s): just after a velocity
    /// jumps, if it does.
    fn begin(&mut self, network: &Network, (t, moment): (f64, f64), y: &[f64]) {
        let side = beside_jump(network, t, moment);
        self.power = self.power_at(network, (t + side, moment), y);
        self.f.clone_from(&self.scratch[1]);
    }

    fn work(&mut self, network: &Network, end: End, moving: f64) -> f64 {
        let h = end.t - self.t;
        let before = self.power;
        let moment = (MOMENT_SHARE * h).max(LEAST_MOMENT);
        let side = beside_jump(network, end.t, moment);
        let after = self.power_at(network, (end.t - side, moment), end.y);
        // Now f is at the end, and the scratch has that at the beginning.
        std::mem::swap(&mut self.f, &mut self.scratch[1]);
        let mut mean = 0.5 * (before + after);
        if self.t < self.seen {
            // The motion in the steps between two evaluations is unknown: its work must not count
            // as a gain of the method.
            mean = 0.5 * (before.max(0.0) + after.max(0.0));
        } else if end.order > LOW_ORDER {
            let mut middle = std::mem::take(&mut self.scratch[2]);
            let (t, moving) = (self.t + 0.5 * h, 6 * network.particles());
            write_middle(&self.y[..moving], &end.y[..moving], h, &mut middle);
            let (f0, f1) = (&self.scratch[1], &self.f);
            let turned = |k: usize| 0.5 * (self.y[k] + end.y[k]) + 0.125 * h * (f0[k] - f1[k]);
            middle.extend((moving..f1.len()).map(turned));
            network.hold(t, &mut middle);
            mean = (2.0 * mean + 4.0 * self.power_at(network, (t, moment), &middle)) / 6.0;
            self.scratch[2] = middle;
        }
        let is_steady = (after - before).abs() * h <= STEADY_SHARE * moving;
        self.interval = if is_steady { self.interval.max(2.0 * h).min(INTERVAL) } else { 0.5 * h };
        (self.t, self.power) = (end.t, after);
        self.y.copy_from_slice(end.y);
        if side > 0.0 {
            self.begin(network, (end.t, moment), end.y);
            self.interval = 0.0;
        }
        mean * h
    }

    /// Returns the rate (W) at which the energy of the exact motion grows at y at time t (s), by
    /// its change from a moment (s) before to one after. Constraints take no part in it but by what
    /// moves their ends: where velocities do not fit them, their work is an error of the method.
    fn power_at(&mut self, network: &Network, (t, moment): (f64, f64), y: &[f64]) -> f64 {
        let [state, f, _] = &mut self.scratch;
        network.eval_f(t, y, f);
        let mut at = |moment: f64| {
            state.clear();
            state.extend(y.iter().zip(&*f).map(|(y, f)| y + moment * f));
            energy_of(network, t + moment, state).total()
        };
        (at(moment) - at(-moment)) / (2.0 * moment) - constraint_power(network)
    }
}

/// Returns whether a prescribed velocity, or the wind, may jump at the end of a step of an adaptive
/// method, which ends just before the jump.
fn may_jump(network: &Network, End { is_adaptive, t, .. }: End) -> bool {
    is_adaptive && next_known_time(network, t.next_down()) <= t
}

/// Returns the time (s) by which the power is evaluated before or after a time t (s) at which a
/// prescribed velocity may jump, so that its difference over two moments (s) lies on one side of
/// the jump; 0 without one.
fn beside_jump(network: &Network, t: f64, moment: f64) -> f64 {
    let side = 1.5 * moment;
    let jumps = next_known_time(network, t - side) <= t + side;
    if jumps { side } else { 0.0 }
}

/// Writes the state [x | v] in the middle of a step of h (s) from y0 to y1, by the Hermite
/// polynomial of x.
fn write_middle(y0: &[f64], y1: &[f64], h: f64, out: &mut Vec<f64>) {
    let half = y0.len() / 2;
    let ([x0, v0], [x1, v1]) = ([&y0[..half], &y0[half..]], [&y1[..half], &y1[half..]]);
    out.clear();
    out.extend((0..half).map(|k| 0.5 * (x0[k] + x1[k]) + 0.125 * h * (v0[k] - v1[k])));
    out.extend((0..half).map(|k| 1.5 * (x1[k] - x0[k]) / h - 0.25 * (v0[k] + v1[k])));
}

/// Returns the energy of y at time t (s), without the kinetic energy of pins: their motion is
/// prescribed, and may begin at once.
pub(super) fn energy_of(network: &Network, t: f64, y: &[f64]) -> Energy {
    let (_, v) = network.halves(y);
    let (n, masses) = (network.particles(), network.masses());
    let mut energy = network.energy_of(t, y);
    let mut of_pins = 0.0;
    for (i, _) in network.pins() {
        let squared: f64 = (0..3).map(|axis| v[axis * n + i].powi(2)).sum();
        of_pins += 0.5 * masses[i] * squared;
    }
    energy.kinetic -= of_pins;
    if energy.kinetic.abs() < ROUNDING * of_pins {
        energy.kinetic = 0.0;
    }
    energy
}
