//! Particles that rest or slide on flat obstacles during a step, and the first event that ends it.
//!
//! If contact acts only after each step, a particle falls freely within the step: it sinks into the
//! obstacle by half the acceleration times the square of the step, however small the tolerance.
//! Therefore, in steps that locate events, the obstacle's reaction and its friction are forces at
//! every stage. A particle that sticks does not move. One that slides has no acceleration along the
//! normal, and friction against its velocity. This holds for a whole step, which ends where it
//! ceases to hold: where the obstacle would have to pull, where friction cannot hold a particle
//! that sticks, where friction ends a slide, and at the edge of a face.

use std::ops::Range;

use nalgebra::Vector3;

use super::depths::Depths;
use super::events::{Event, EventKind, Events, Searched};
use super::state::RunState;
use super::stepper::Stepper;
use crate::columns::{row, set_row};
use crate::constraints::OneSided;
use crate::contact::{Obstacle, Shape};
use crate::elements::Outflow;
use crate::integrators::Work;
use crate::interval::Interval;
use crate::measure::Measure;
use crate::network::{Network, has_ropes, least_tension, open_ends, outflows, taut};
use crate::path::Path;
use crate::scene::Model;
use crate::system::ParticleSystem;

/// Length of the interval around the end of a contact at which its search ends, as a share of the
/// step.
const MIN_INTERVAL: f64 = 1e-13;
/// Largest speed at which a slide that turns back counts as stopped, over the speed at the
/// beginning of the step.
const MAX_TURNING_SPEED: f64 = 0.01;
/// Amount by which rounding may make a force exceed the force that a contact can hold, as a share
/// of it.
const ROUNDING: f64 = 1e-10;

/// Particle that touches an obstacle during a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Rest {
    particle: usize,
    obstacle: usize,
    /// Normal of the obstacle.
    normal: Vector3<f64>,
    /// `None` if the particle sticks.
    slide: Option<Slide>,
}

/// Slide of a particle over an obstacle.
#[derive(Clone, Copy, Debug)]
struct Slide {
    /// Direction in which it slides, or begins to.
    along: Vector3<f64>,
    /// Its speed (m/s).
    speed: f64,
    /// Backward speed (m/s) at which the slide counts as turned.
    slack: f64,
}

impl Slide {
    /// Creates a slide in the direction of a vector, unless that is 0.
    fn of(along: Vector3<f64>, speed: f64, slack: f64) -> Option<Self> {
        let along = along.try_normalize(0.0)?;
        Some(Self {
            along,
            speed,
            slack,
        })
    }
}

/// Particles that rest in a step.
#[derive(Clone, Debug, Default)]
struct Rests {
    now: Vec<Rest>,
    scratch: Scratch,
}

/// Scratch of the search for where a contact ceases.
#[derive(Clone, Debug, Default)]
pub(super) struct Scratch {
    /// Trial state.
    state: Vec<f64>,
    /// Its derivative without reactions.
    free: Vec<f64>,
}

/// Network in which particles rest on obstacles, as methods for first-order systems see it.
pub(super) struct Resting<'a> {
    network: &'a Network,
    rests: &'a [Rest],
}

/// Returns whether particles of a network may rest in this sense. In a network with constraints,
/// bodies or surfaces, their forces would have to be solved together with the reactions.
pub(crate) fn may_rest(network: &Network) -> bool {
    network.solids().iter().any(Obstacle::is_flat)
        && network.contact_layer().is_none()
        && network.bodies().is_empty()
        && !network.is_constrained()
}

impl Rests {
    /// Lists with room for all particles of a model.
    pub fn new(model: &Model) -> Self {
        let Some(network) = model.network().filter(|network| may_rest(network)) else {
            return Self::default();
        };
        let flat = network.solids().iter().filter(|o| o.is_flat()).count();
        let most = flat * network.particles();
        Self {
            now: Vec::with_capacity(most),
            scratch: Scratch {
                state: vec![0.0; network.dim()],
                free: vec![0.0; network.dim()],
            },
        }
    }

    /// Returns the particles that rest, and scratch.
    pub fn split(&mut self) -> (&[Rest], &mut Scratch) {
        (&self.now, &mut self.scratch)
    }

    /// Returns a view of a model in which the particles rest, if any do.
    pub fn view<'a>(&'a self, model: &'a Model) -> Option<Resting<'a>> {
        Resting::of(model, &self.now)
    }

    /// Begins a step without resting particles.
    pub fn clear(&mut self) {
        self.now.clear();
    }

    /// Adds the particles that press on a flat obstacle and do not leave it in the state y at time
    /// t (s): all further rebounds of them are left out. Velocities are set to 0 where a slide
    /// counts as stopped. Returns the number of evaluations.
    pub fn list(&mut self, network: &Network, t: f64, y: &mut [f64], depths: Depths) -> u64 {
        let n = network.particles();
        for (k, obstacle) in network.solids().iter().enumerate() {
            if !obstacle.is_flat() {
                continue;
            }
            for particle in (0..n).filter(|i| !network.is_pinned(*i)) {
                let (distance, normal) = obstacle.height(row(y, n, particle));
                if distance.abs() <= depths.none {
                    self.now.push(Rest {
                        particle,
                        obstacle: k,
                        normal,
                        slide: None,
                    });
                }
            }
        }
        if self.now.is_empty() {
            return 0;
        }
        let free = &mut self.scratch.free;
        free.resize(network.dim(), 0.0);
        network.eval_f(t, y, free);
        let a = &free[3 * n..6 * n];
        let (x, v) = y.split_at_mut(3 * n);
        let v = &mut v[..3 * n];
        self.now.retain_mut(|rest| {
            let (free, speed) = (row(a, n, rest.particle), row(v, n, rest.particle));
            let press = -free.dot(&rest.normal);
            let obstacle = &network.solids()[rest.obstacle];
            let most = obstacle.friction * press;
            let leaving = speed.dot(&rest.normal);
            let place = row(x, n, rest.particle);
            let begun = obstacle.height(place).0.max(0.0);
            let highest = begun + 0.5 * leaving * leaving / press;
            if press <= 0.0 || highest > depths.left_out(obstacle.restitution, place) {
                return false;
            }
            let slide = speed - rest.normal * leaving;
            let across = free + rest.normal * press;
            let slack = (depths.still() * most).sqrt();
            if slide.norm() > slack {
                rest.slide = Slide::of(slide, slide.norm(), 0.0);
                set_row(v, n, rest.particle, slide);
            } else if across.norm() > most {
                rest.slide = Slide::of(across, slack, slack);
                set_row(v, n, rest.particle, slide);
            } else {
                set_row(v, n, rest.particle, Vector3::zeros());
            }
            true
        });
        1
    }

    /// Returns a hash of which particles rest on which obstacles, and which of them slide: 0 if
    /// none rests.
    pub fn fingerprint(&self) -> u64 {
        let parts = self.now.iter().flat_map(|rest| {
            let slides = usize::from(rest.slide.is_some());
            [rest.particle, rest.obstacle, slides]
        });
        // Fowler, Noll and Vo's hash.
        parts.fold(0, |hash: u64, part| {
            (hash ^ (part as u64 + 1)).wrapping_mul(0x0100_0000_01b3)
        })
    }
}

impl<'a> Resting<'a> {
    /// Creates a view of a model in which particles rest, if any do.
    pub fn of(model: &'a Model, rests: &'a [Rest]) -> Option<Self> {
        let network = model.network().filter(|_| !rests.is_empty())?;
        Some(Self { network, rests })
    }
}

/// Finds the first end of a contact before the share `before` of a step of h (s) from t (s), on the
/// step's polynomial. Writes the state there to `state`. Heights up to `none` (m) count as zero.
pub(super) fn first_end(
    network: &Network,
    (rests, scratch): (&[Rest], &mut Scratch),
    (t, h, none): (f64, f64, f64),
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<Event> {
    if rests.is_empty() {
        return None;
    }
    let Scratch { state: found, free } = scratch;
    found.resize(network.dim(), 0.0);
    let mut margin = |share: f64, found: &mut [f64]| {
        state_at(share, found);
        network.eval_f(t + share * h, found, free);
        let margins = rests
            .iter()
            .map(|rest| rest.margin(network, found, free, none));
        margins.fold(f64::INFINITY, f64::min)
    };
    let share = first_negative(before, |share| margin(share, found))?;
    margin(share, found);
    state.clone_from(found);
    for rest in rests {
        rest.stop(network, state);
    }
    Some(Event {
        share,
        kind: EventKind::Rested,
    })
}

/// Returns a share of the step, up to `before`, just after which a margin becomes negative; `None`
/// if it is not negative there. If it is from the beginning, the result is `before`.
fn first_negative(before: f64, mut margin: impl FnMut(f64) -> f64) -> Option<f64> {
    let mut high = (before, margin(before));
    if high.1 >= 0.0 {
        return None;
    }
    let mut low = (0.0, margin(0.0));
    while low.1 > 0.0 && high.0 - low.0 > MIN_INTERVAL {
        // The secant's step, at some distance from the ends.
        let secant = low.0 + (high.0 - low.0) * low.1 / (low.1 - high.1);
        let edge = 0.01 * (high.0 - low.0);
        let share = secant.clamp(low.0 + edge, high.0 - edge);
        let at = margin(share);
        *(if at >= 0.0 { &mut low } else { &mut high }) = (share, at);
    }
    Some(high.0)
}

impl Rest {
    /// Returns the part of a particle's velocity along the obstacle (m/s).
    fn slide(&self, network: &Network, y: &[f64]) -> Vector3<f64> {
        let v = row(network.halves(y).1, network.particles(), self.particle);
        v - self.normal * v.dot(&self.normal)
    }

    /// Returns the margin by which the contact continues unchanged in the state y with the
    /// derivative `free` without reactions, over the force or speed that it depends on: negative
    /// where it ceases.
    fn margin(&self, network: &Network, y: &[f64], free: &[f64], none: f64) -> f64 {
        let (n, i) = (network.particles(), self.particle);
        let obstacle = &network.solids()[self.obstacle];
        if obstacle.height(row(y, n, i)).0.abs() > none {
            return -1.0;
        }
        let free = row(&free[3 * n..6 * n], n, i);
        let press = -free.dot(&self.normal);
        let most = obstacle.friction * press;
        let other = match self.slide {
            None => most - (free + self.normal * press).norm(),
            Some(slide) if slide.speed > 0.0 => {
                let speed = self.slide(network, y).dot(&slide.along) + slide.slack;
                return (press / free.norm() + ROUNDING).min(speed / slide.speed);
            }
            Some(_) => press,
        };
        press.min(other) / free.norm() + ROUNDING
    }

    /// Stops a slide that friction has ended, rather than only turned.
    fn stop(&self, network: &Network, y: &mut [f64]) {
        let Some(Slide { along, speed, .. }) = self.slide else {
            return;
        };
        let slide = self.slide(network, y);
        if slide.dot(&along) <= 0.0 && slide.norm() <= MAX_TURNING_SPEED * speed {
            let (n, i) = (network.particles(), self.particle);
            let v = &mut y[3 * n..6 * n];
            let still = row(v, n, i) - slide;
            set_row(v, n, i, still);
        }
    }

    /// Returns the acceleration (m/s2) with the obstacle's reaction and friction at a velocity
    /// (m/s), from the acceleration without them.
    fn held(&self, obstacle: &Obstacle, v: Vector3<f64>, free: Vector3<f64>) -> Vector3<f64> {
        let Some(Slide { along, .. }) = self.slide else {
            return Vector3::zeros();
        };
        let press = -free.dot(&self.normal);
        let slide = v - self.normal * v.dot(&self.normal);
        // Past its turning point the slide continues as if friction did not turn: the step ends at
        // that point, and its polynomial stays smooth.
        let direction = match slide.try_normalize(0.0) {
            Some(direction) if direction.dot(&along) < 0.0 => -direction,
            Some(direction) => direction,
            None => along,
        };
        free + (self.normal - direction * obstacle.friction) * press
    }
}

impl ParticleSystem for Resting<'_> {
    fn dim(&self) -> usize {
        self.network.dim()
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.network.eval_f(t, y, dydt);
        let n = self.network.particles();
        let (v, a) = (self.network.halves(y).1, &mut dydt[3 * n..6 * n]);
        for rest in self.rests {
            let (obstacle, i) = (&self.network.solids()[rest.obstacle], rest.particle);
            let held = rest.held(obstacle, row(v, n, i), row(a, n, i));
            set_row(a, n, i, held);
        }
    }

    fn hold(&self, t: f64, y: &mut [f64]) {
        self.network.hold(t, y);
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        self.network.measures(visit);
    }
}

/// Number of intervals of a step at whose ends joints are looked at.
const INTERVALS: u32 = 16;

/// Search for the first event of a step.
pub(super) struct Locator {
    /// Whether fixed steps are split at events too: always in a network with ropes.
    pub splits_fixed_steps: bool,
    events: Events,
    /// Outflows of the fluid, as obstacles.
    outflows: Vec<Obstacle>,
    /// Particles that rest on obstacles in the current step.
    rests: Rests,
}

impl Locator {
    /// Creates a search in a model, with room for all its particles.
    pub fn new(model: &Model) -> Self {
        let outflows = model.network().map_or(&[][..], outflows).iter();
        Self {
            splits_fixed_steps: model.network().is_some_and(has_ropes),
            events: Events::new(model),
            outflows: outflows.map(obstacle).collect(),
            rests: Rests::new(model),
        }
    }

    /// Returns whether events are located in the steps of a stepper.
    pub fn serves(&self, stepper: &Stepper) -> bool {
        stepper.is_adaptive() || self.splits_fixed_steps
    }

    /// Returns whether fixed steps are split into parts, each up to an event.
    pub fn splits(&self, stepper: &Stepper) -> bool {
        self.splits_fixed_steps && !stepper.is_adaptive()
    }

    /// Returns a view of the model in which particles rest, if any do.
    pub fn view<'a>(&'a self, model: &'a Model) -> Option<Resting<'a>> {
        self.rests.view(model)
    }

    /// Returns the state at the event that was found.
    pub fn state(&self) -> &[f64] {
        &self.events.state
    }

    /// Lists the particles that rest on obstacles at time t (s), for steps that locate events.
    pub fn list_rests(
        &mut self,
        model: &Model,
        state: &mut RunState,
        stepper: &mut Stepper,
        t: f64,
        depths: Depths,
    ) {
        let method = state.method;
        let serves = !method.is_implicit() && !method.needs_mechanics() && !method.positions_only();
        let network = model.network();
        let network = network.filter(|network| serves && may_rest(network));
        self.rests.clear();
        if let Some(network) = network.filter(|_| self.serves(stepper)) {
            let evaluated = self.rests.list(network, t, &mut state.y, depths);
            state.work += Work::of(evaluated);
        }
        // If other particles rest, the last evaluation of the step before is of another system.
        let before = std::mem::replace(&mut state.resting, self.rests.fingerprint());
        if before != state.resting {
            stepper.forget();
        }
    }

    /// Finds the first event of a step of h (s) from time t (s), from y0 to the current state.
    pub fn first_event(
        &mut self,
        model: &Model,
        state: &mut RunState,
        stepper: &mut Stepper,
        y0: &[f64],
        Interval { t, h }: Interval,
        depths: Depths,
    ) -> Option<Event> {
        let network = model.network()?;
        let has_ropes = has_ropes(network);
        let is_none = network.solids().is_empty() && self.outflows.is_empty();
        if is_none && network.tear_limit().is_none() && !has_ropes {
            return None;
        }
        let RunState { y, work, .. } = state;
        let step = Searched {
            network,
            outflows: &self.outflows,
            t,
            h,
            ends: [y0, y],
            depths,
        };
        if y0.len() != y.len() || y.iter().any(|y| !y.is_finite()) {
            return None;
        }
        let (rests, scratch) = self.rests.split();
        let resting = Resting::of(model, rests);
        let system = resting.as_ref().map_or(model.system(), |view| view);
        let mut state_at = |share: f64, out: &mut [f64]| {
            *work += stepper.state_at(system, t, share * h, y0, out);
            system.hold(t + share * h, out);
        };
        let event = self.events.first(&step, &mut state_at);
        let before = event.map_or(1.0, |event| event.share);
        let state = &mut self.events.state;
        let span = (t, h, depths.none);
        let mut evaluated = 0;
        let stop = if has_ropes {
            first_stop(&step, before, state, &mut state_at)
        } else {
            None
        };
        let event = stop.or(event);
        let before = event.map_or(1.0, |event| event.share);
        let end = first_end(
            network,
            (rests, scratch),
            span,
            before,
            state,
            &mut |share, out| {
                evaluated += 1;
                state_at(share, out);
            },
        );
        let slackens = if has_ropes {
            let at = &mut |share: f64, out: &mut [f64]| {
                evaluated += 1;
                state_at(share, out);
            };
            first_slack(network, Interval { t, h }, before, state, at)
        } else {
            None
        };
        *work += Work::of(evaluated);
        slackens.or(end).or(event)
    }
}

/// Returns an outflow as an obstacle.
fn obstacle(outflow: &Outflow) -> Obstacle {
    let shape = Shape::Box {
        half_extents: outflow.half,
        axes: [Vector3::x(), Vector3::y(), Vector3::z()],
    };
    Obstacle::smooth(shape, Path::Still(outflow.at))
}

/// Finds where a joint first reaches one of its ends before the share `before` of a step, on the
/// step's polynomial, unless that lasts for less than one of some intervals. Writes the state there
/// to `state`.
fn first_stop(
    step: &Searched,
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<Event> {
    let Searched { network, h, .. } = *step;
    let [begun, ended] = step.ends.map(|y| open_ends(network, y));
    // Half of the most by which an error can leave its chord.
    let is_near = |(a, b): (&OneSided, &OneSided)| {
        a.value.max(b.value) + 0.5 * h * (a.rate.abs() + b.rate.abs()) > 0.0
    };
    if !begun.iter().zip(&ended).any(is_near) {
        return None;
    }
    let none = step.depths.none;
    // A joint that begins at its end or beyond has passed it a little later.
    let passed = |value: f64| {
        if -value > none {
            0.0
        } else {
            none.max(value + 1e-3 * none)
        }
    };
    let mut found = vec![0.0; network.dim()];
    let mut margin = |share: f64| {
        state_at(share, &mut found);
        let now = open_ends(network, &found);
        let left = begun
            .iter()
            .zip(&now)
            .map(|(begun, now)| passed(begun.value) - now.value);
        left.fold(f64::INFINITY, f64::min)
    };
    let ends = (1..=INTERVALS).map(|k| before * f64::from(k) / f64::from(INTERVALS));
    let end = ends.into_iter().find(|share| margin(*share) < 0.0)?;
    let share = first_negative(end, &mut margin)?;
    state.resize(network.dim(), 0.0);
    state_at(share, state);
    Some(Event {
        share,
        kind: EventKind::Rested,
    })
}

/// Finds where a taut rope slackens before the share `before` of a step of h (s) from t (s), on the
/// step's polynomial. Writes the state there to `state`.
fn first_slack(
    network: &Network,
    Interval { t, h }: Interval,
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<Event> {
    taut(network).next()?;
    let mut found = vec![0.0; network.dim()];
    let mut margin = |share: f64| {
        state_at(share, &mut found);
        least_tension(network, t + share * h, &found).map_or(0.0, |(_, tension)| tension)
    };
    if margin(before) >= 0.0 || margin(0.0) <= 0.0 {
        return None;
    }
    let share = first_negative(before, &mut margin)?;
    state.resize(network.dim(), 0.0);
    state_at(share, state);
    Some(Event {
        share,
        kind: EventKind::Rested,
    })
}
