//! Particles that rest or slide on obstacles during a step.
//!
//! If contact acts only after each step, a particle falls freely within the step: it sinks into the
//! obstacle by half the acceleration times the square of the step, however small the tolerance.
//! Therefore, in steps that locate events, the obstacle's reaction and its friction are forces at
//! every stage. A particle that sticks moves with the obstacle. One that slides follows its
//! surface, with friction against its velocity relative to the obstacle. This holds for a whole
//! step, which ends where it ceases to hold: where the obstacle would have to pull, where friction
//! cannot hold a particle that sticks, where friction ends a slide, and at the edge of a face.

use std::ops::Range;

use nalgebra::Vector3;

use super::depths::Depths;
use crate::columns::{row, set_row};
use crate::contact::Obstacle;
use crate::measure::Measure;
use crate::network::Network;
use crate::path::Place;
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
    /// The face on which it lies, if the obstacle has faces.
    face: Option<ObstacleFace>,
    /// `None` if the particle sticks.
    slide: Option<Slide>,
}

impl Rest {
    /// Returns whether a particle rests on an obstacle, given by their numbers.
    pub fn is_listed(rests: &[Self], particle: usize, obstacle: usize) -> bool {
        let key = |rest: &Self| (rest.obstacle, rest.particle);
        rests.binary_search_by_key(&(obstacle, particle), key).is_ok()
    }
}

/// Face of an obstacle, in the obstacle's own frame.
#[derive(Clone, Copy, Debug)]
struct ObstacleFace {
    /// Point of it (m).
    point: Vector3<f64>,
    normal: Vector3<f64>,
}

/// Obstacle at one time, as a particle that touches it sees it.
struct SeenObstacle {
    /// Height (m) of the particle above the surface, or above the plane of its face.
    height: f64,
    normal: Vector3<f64>,
    /// Point of the obstacle at the particle.
    place: Place,
    /// Velocity (m/s) of the particle relative to that point.
    speed: Vector3<f64>,
    /// Angular velocity of the obstacle (rad/s).
    spin: Vector3<f64>,
    /// Normal acceleration (m/s2), inwards, of a particle that follows the surface at that
    /// velocity.
    curving: f64,
}

impl SeenObstacle {
    /// Returns an obstacle at time t (s), as a particle at x (m) with the velocity v (m/s) sees it.
    fn new(
        (obstacle, face): (&Obstacle, Option<ObstacleFace>),
        t: f64,
        [x, v]: [Vector3<f64>; 2],
    ) -> Self {
        let pose = obstacle.at(t);
        let inner = pose.inwards(x - pose.place.position);
        let place = pose.of(inner);
        let (height, normal) = if let Some(ObstacleFace { point, normal }) = face {
            ((inner - point).dot(&normal), normal)
        } else {
            let seen = obstacle.shape.separation(inner);
            (seen.distance, seen.normal)
        };
        let speed = v - place.velocity;
        Self {
            height,
            normal: pose.outwards(normal),
            place,
            speed,
            spin: pose.orientation.map_or(Vector3::zeros(), |it| it.spin),
            curving: obstacle.shape.curving(inner, pose.inwards(speed)),
        }
    }

    /// Returns the part of a vector along the surface.
    fn along(&self, a: Vector3<f64>) -> Vector3<f64> {
        a - self.normal * a.dot(&self.normal)
    }

    /// Returns the part of the velocity along the surface (m/s).
    fn slide(&self) -> Vector3<f64> {
        self.along(self.speed)
    }

    /// Returns an acceleration (m/s2) relative to the obstacle.
    fn relative(&self, acceleration: Vector3<f64>) -> Vector3<f64> {
        acceleration - self.place.acceleration - self.spin.cross(&self.speed) * 2.0
    }

    /// Returns the acceleration (m/s2) by which the obstacle pushes, where without it the
    /// acceleration relative to it is `free`.
    fn press(&self, free: Vector3<f64>) -> f64 {
        -free.dot(&self.normal) - self.curving
    }
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
        Some(Self { along, speed, slack })
    }
}

/// Particles that rest in a step, in the order of their obstacles.
#[derive(Clone, Debug, Default)]
pub(super) struct Rests {
    now: Vec<Rest>,
    scratch: RestScratch,
}

/// Scratch of the search for where a contact ceases.
#[derive(Clone, Debug, Default)]
pub(super) struct RestScratch {
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
    !network.solids().is_empty()
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
        let most = network.solids().len() * network.particles();
        Self {
            now: Vec::with_capacity(most),
            scratch: RestScratch {
                state: vec![0.0; network.dim()],
                free: vec![0.0; network.dim()],
            },
        }
    }

    /// Returns the particles that rest, and scratch.
    pub fn split(&mut self) -> (&[Rest], &mut RestScratch) {
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

    /// Adds the particles that press on an obstacle and do not leave it in the state y at time t
    /// (s): all further rebounds of them are left out. Velocities are set to those of the obstacle
    /// where a slide counts as stopped. Returns the number of evaluations.
    pub fn list(&mut self, network: &Network, t: f64, y: &mut [f64], depths: Depths) -> u64 {
        let n = network.particles();
        for (k, obstacle) in network.solids().iter().enumerate() {
            let pose = obstacle.at(t);
            for particle in (0..n).filter(|i| !network.is_pinned(*i)) {
                let inner = pose.inwards(row(y, n, particle) - pose.place.position);
                let seen = obstacle.shape.separation(inner);
                if seen.distance.abs() <= depths.none {
                    let face = ObstacleFace {
                        point: inner - seen.normal * seen.distance,
                        normal: seen.normal,
                    };
                    self.now.push(Rest {
                        particle,
                        obstacle: k,
                        face: Some(face).filter(|_| obstacle.shape.is_faceted()),
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
        self.now.retain_mut(|rest| {
            let (obstacle, i) = (&network.solids()[rest.obstacle], rest.particle);
            let seen = rest.seen(network, t, y);
            let free = seen.relative(row(a, n, i));
            let press = seen.press(free);
            let most = obstacle.friction * press;
            let leaving = seen.speed.dot(&seen.normal);
            let begun = seen.height.max(0.0);
            let highest = begun + 0.5 * leaving * leaving / press;
            let left_out = depths.left_out(obstacle.restitution, row(y, n, i));
            if press <= 0.0 || highest > left_out {
                return false;
            }
            let slide = seen.slide();
            let across = seen.along(free);
            let slack = (depths.still() * most).sqrt();
            let kept = if slide.norm() > slack {
                rest.slide = Slide::of(slide, slide.norm(), 0.0);
                slide
            } else if across.norm() > most {
                rest.slide = Slide::of(across, slack, slack);
                slide
            } else {
                Vector3::zeros()
            };
            set_row(&mut y[3 * n..6 * n], n, i, seen.place.velocity + kept);
            true
        });
        1
    }

    /// Returns the sum of the magnitudes of the impulses (N s) of moving obstacles on the particles
    /// that rest on them in a step of h (s), by the reactions in the state y at its end, at time t
    /// (s), and the number of evaluations.
    pub fn impulse(&mut self, network: &Network, (t, h): (f64, f64), y: &[f64]) -> (f64, u64) {
        let Self { now, scratch } = self;
        let moves = |rest: &&Rest| !network.solids()[rest.obstacle].is_still();
        if !now.iter().any(|rest| moves(&rest)) {
            return (0.0, 0);
        }
        let n = network.particles();
        network.eval_f(t, y, &mut scratch.free);
        let impulse = |rest: &Rest| {
            let free = row(&scratch.free[3 * n..6 * n], n, rest.particle);
            let reaction = rest.held(network, t, y, free) - free;
            network.masses()[rest.particle] * reaction.norm() * h
        };
        (now.iter().filter(moves).map(impulse).sum(), 1)
    }

    /// Returns a hash of which particles rest on which obstacles, and which of them slide: 0 if
    /// none rests.
    pub fn fingerprint(&self) -> u64 {
        let parts = self.now.iter().flat_map(|rest| {
            let slides = usize::from(rest.slide.is_some());
            [rest.particle, rest.obstacle, slides]
        });
        // Fowler, Noll and Vo's hash.
        parts.fold(0, |hash: u64, part| (hash ^ (part as u64 + 1)).wrapping_mul(0x0100_0000_01b3))
    }
}

impl<'a> Resting<'a> {
    /// Creates a view of a model in which particles rest, if any do.
    pub fn of(model: &'a Model, rests: &'a [Rest]) -> Option<Self> {
        let network = model.network().filter(|_| !rests.is_empty())?;
        Some(Self { network, rests })
    }
}

/// Finds the share of a step of h (s) from t (s), below `before`, after which a contact first ends,
/// on the step's polynomial. Writes the state there to `state`. Heights up to `none` (m) count as
/// zero.
pub(super) fn first_end(
    network: &Network,
    (rests, scratch): (&[Rest], &mut RestScratch),
    (t, h, none): (f64, f64, f64),
    before: f64,
    state: &mut Vec<f64>,
    state_at: &mut dyn FnMut(f64, &mut [f64]),
) -> Option<f64> {
    if rests.is_empty() {
        return None;
    }
    let RestScratch { state: found, free } = scratch;
    found.resize(network.dim(), 0.0);
    let mut margin = |share: f64, found: &mut [f64]| {
        state_at(share, found);
        network.eval_f(t + share * h, found, free);
        let margins =
            rests.iter().map(|rest| rest.margin(network, (t + share * h, none), found, free));
        margins.fold(f64::INFINITY, f64::min)
    };
    let share = first_negative(before, |share| margin(share, found))?;
    margin(share, found);
    state.clone_from(found);
    for rest in rests {
        rest.stop(network, t + share * h, state);
    }
    Some(share)
}

/// Returns a share of the step, up to `before`, just after which a margin becomes negative; `None`
/// if it is not negative there. If it is from the beginning, the result is `before`.
pub(super) fn first_negative(before: f64, mut margin: impl FnMut(f64) -> f64) -> Option<f64> {
    let mut high = (before, margin(before));
    if high.1 >= 0.0 {
        return None;
    }
    let mut low = (0.0, margin(0.0));
    if low.1 <= 0.0 {
        return Some(before);
    }
    while high.0 - low.0 > MIN_INTERVAL {
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
    /// Returns the obstacle in the state y at time t (s), as the particle sees it.
    fn seen(&self, network: &Network, t: f64, y: &[f64]) -> SeenObstacle {
        let (n, i) = (network.particles(), self.particle);
        let [x, v] = [y, &y[3 * n..]].map(|half| row(half, n, i));
        let obstacle = &network.solids()[self.obstacle];
        SeenObstacle::new((obstacle, self.face), t, [x, v])
    }

    /// Returns the margin by which the contact continues unchanged in the state y at time t (s)
    /// with the derivative `free` without reactions, over the force or speed that it depends on:
    /// negative where it ceases. Heights up to `none` (m) count as zero.
    fn margin(&self, network: &Network, (t, none): (f64, f64), y: &[f64], free: &[f64]) -> f64 {
        let (n, i) = (network.particles(), self.particle);
        let obstacle = &network.solids()[self.obstacle];
        if obstacle.depth(t, row(y, n, i)).abs() > none {
            return -1.0;
        }
        let seen = self.seen(network, t, y);
        let free = row(&free[3 * n..6 * n], n, i);
        let (size, free) = (free.norm(), seen.relative(free));
        let press = seen.press(free);
        let most = obstacle.friction * press;
        let other = match self.slide {
            None => most - seen.along(free).norm(),
            Some(slide) if slide.speed > 0.0 => {
                let speed = seen.slide().dot(&slide.along) + slide.slack;
                return (press / size + ROUNDING).min(speed / slide.speed);
            }
            Some(_) => press,
        };
        press.min(other) / size + ROUNDING
    }

    /// Stops a slide at time t (s) that friction has ended, rather than only turned.
    fn stop(&self, network: &Network, t: f64, y: &mut [f64]) {
        let Some(Slide { along, speed, .. }) = self.slide else {
            return;
        };
        let slide = self.seen(network, t, y).slide();
        if slide.dot(&along) <= 0.0 && slide.norm() <= MAX_TURNING_SPEED * speed {
            let (n, i) = (network.particles(), self.particle);
            let v = &mut y[3 * n..6 * n];
            let still = row(v, n, i) - slide;
            set_row(v, n, i, still);
        }
    }

    /// Puts the particle onto the surface in the state y at time t (s), with no velocity across.
    fn hold(&self, network: &Network, t: f64, y: &mut [f64]) {
        let (n, i) = (network.particles(), self.particle);
        let seen = self.seen(network, t, y);
        let leaving = seen.speed.dot(&seen.normal);
        let (x, v) = y.split_at_mut(3 * n);
        for (column, excess) in [(x, seen.height), (&mut v[..3 * n], leaving)] {
            let held = row(column, n, i) - seen.normal * excess;
            set_row(column, n, i, held);
        }
    }

    /// Returns the acceleration (m/s2) with the obstacle's reaction and friction in the state y at
    /// time t (s), from the acceleration without them.
    fn held(&self, network: &Network, t: f64, y: &[f64], free: Vector3<f64>) -> Vector3<f64> {
        let seen = self.seen(network, t, y);
        let Some(Slide { along, slack, .. }) = self.slide else {
            return seen.place.acceleration;
        };
        let driven = seen.relative(free);
        let slip = seen.slide();
        // Below its slack, friction turns a slip faster than any step can follow: it points where
        // the particle is driven.
        let slides = if slip.norm() > slack { slip } else { seen.along(driven) };
        // Past its turning point the slide continues as if friction did not turn: the step ends at
        // that point, and its polynomial stays smooth.
        let direction = match slides.try_normalize(0.0) {
            Some(direction) if direction.dot(&along) < 0.0 => -direction,
            Some(direction) => direction,
            None => along,
        };
        let friction = network.solids()[self.obstacle].friction;
        free + (seen.normal - direction * friction) * seen.press(driven)
    }
}

impl ParticleSystem for Resting<'_> {
    fn dim(&self) -> usize {
        self.network.dim()
    }

    fn eval_f(&self, t: f64, y: &[f64], dydt: &mut [f64]) {
        self.network.eval_f(t, y, dydt);
        let n = self.network.particles();
        let a = &mut dydt[3 * n..6 * n];
        for rest in self.rests {
            let held = rest.held(self.network, t, y, row(a, n, rest.particle));
            set_row(a, n, rest.particle, held);
        }
    }

    fn hold(&self, t: f64, y: &mut [f64]) {
        self.network.hold(t, y);
        for rest in self.rests {
            rest.hold(self.network, t, y);
        }
    }

    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure)) {
        self.network.measures(visit);
    }
}
