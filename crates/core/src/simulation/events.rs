//! Events within a step: a particle touches an obstacle, a spring is stretched so far that it
//! breaks, or a rope tightens.
//!
//! They are found on the step's own polynomial. It is sampled at the ends of some pieces, and each
//! piece is replaced by a cubic. On a piece, neither a first contact is missed, see
//! [`Approach`](crate::contact::Approach), nor a spring that is too long only briefly. Newton's
//! method then finds the time on the polynomial itself.

use nalgebra::Vector3;

use super::depths::Depths;
use super::phases::{first_beyond, first_longer};
use super::resting::Rest;
use crate::columns::row;
use crate::contact::{Approach, Course, Obstacle};
use crate::elements::Fluid;
use crate::network::{Network, slack};
use crate::scene::Model;
use crate::spring::Spring;
use crate::system::Mechanics;

/// Number of pieces in which a step is searched.
const PIECES: usize = 8;

/// Largest number of touches on a piece's cubic that may turn out not to be on the polynomial.
const MAX_GRAZES: usize = 8;

/// Distance after such a touch at which the search continues, as a share of the piece.
const GAP_AFTER_GRAZE: f64 = 1e-5;

/// First event within a step.
#[derive(Clone, Copy, Debug)]
pub(super) struct Event {
    /// Share of the step at which it happens.
    pub share: f64,
    pub kind: EventKind,
}

/// Particle that comes close to an obstacle or an outflow.
#[derive(Clone, Copy, Debug)]
struct Encounter {
    particle: usize,
    /// Number of the obstacle, or of the outflow after all obstacles.
    body: usize,
    /// Whether it has touched the obstacle since the beginning of the step, and does not leave it.
    touches: bool,
}

/// Spring that may become long enough to break, or slack rope that may tighten.
#[derive(Clone, Copy, Debug)]
struct Stretching {
    ends: [usize; 2],
    /// Length at which it does (m).
    longest: f64,
    is_rope: bool,
}

/// Search for events, with its scratch.
#[derive(Default)]
pub(super) struct Events {
    pairs: Vec<Encounter>,
    /// Particles that lie on faces, where, and the normals there.
    faces: Vec<(usize, Vector3<f64>, Vector3<f64>)>,
    springs: Vec<Stretching>,
    pieces: [Vec<f64>; 2],
    /// State at the last event that was found.
    pub state: Vec<f64>,
}

impl Events {
    /// Creates a search with room for all particles and obstacles of a model.
    pub fn new(model: &Model) -> Self {
        let obstacles = model.network().map_or(0, |network| network.solids().len());
        Self {
            pairs: Vec::with_capacity(model.particles() * obstacles),
            faces: Vec::with_capacity(model.particles() * obstacles),
            ..Self::default()
        }
    }

    /// Finds the first event of a step in which some particles rest, and the state there.
    pub fn first(&mut self, step: &Searched, rests: &[Rest], state_at: StateAt) -> Option<Event> {
        self.list_pairs(step);
        self.leave_out_level(step);
        // What rests stays at the surface.
        self.pairs.retain(|pair| !Rest::is_listed(rests, pair.particle, pair.body));
        self.list_springs(step);
        if self.pairs.is_empty() && self.springs.is_empty() {
            return None;
        }
        self.state.resize(step.ends[0].len(), 0.0);
        self.pieces[0].clear();
        self.pieces[0].extend_from_slice(step.ends[0]);
        for k in 1..=PIECES {
            self.pieces[1].resize(step.ends[1].len(), 0.0);
            if k == PIECES {
                self.pieces[1].copy_from_slice(step.ends[1]);
            } else {
                state_at(k as f64 / PIECES as f64, &mut self.pieces[1]);
            }
            if let Some(event) = self.first_in(step, k - 1, state_at) {
                return Some(event);
            }
            self.pieces.swap(0, 1);
        }
        None
    }

    /// Finds the first event of a piece.
    fn first_in(&mut self, step: &Searched, piece: usize, state_at: StateAt) -> Option<Event> {
        let Self { pairs, springs, pieces, state, .. } = self;
        let n = step.network.particles();
        let begin = piece as f64 / PIECES as f64;
        let (t, h) = (step.t + begin * step.h, step.h / PIECES as f64);
        let mut first: Option<Event> = None;
        for pair in pairs.iter_mut() {
            let course = course(pieces, pair.particle, h, n);
            let obstacle = step.body(pair.body);
            let approach = Approach::new(obstacle, &course, t);
            let mut from = 0.0;
            if pair.touches && piece == 0 {
                let flight =
                    approach.flight(|_| step.depths.left_out(obstacle.restitution, course.x[0]));
                pair.touches = flight.is_none();
                from = flight.unwrap_or(0.0);
            }
            if pair.touches {
                let deepest = step.depths.deepest.min(match obstacle.shape.greatest_depth() {
                    // It is unknown.
                    0.0 => f64::INFINITY,
                    depth => 0.25 * depth,
                });
                let sunk = approach.first(0.0, deepest);
                if let Some(share) = sunk {
                    let share = begin + share / PIECES as f64;
                    keep_first(&mut first, share, EventKind::Sunk);
                } else {
                    pair.touches = approach.separation(1.0).distance <= step.depths.none;
                }
                continue;
            }
            for _ in 0..MAX_GRAZES {
                let Some(share) = approach.first(from, 0.0) else {
                    break;
                };
                let kind = EventKind::Touch { particle: pair.particle, body: pair.body };
                let guess = begin + share / PIECES as f64;
                if first.is_some_and(|event| event.share <= guess) {
                    break;
                }
                if step.ends_shallow([pair.particle, pair.body], &approach.separation(share).normal)
                {
                    break;
                }
                match step.refine(guess, kind, state, state_at) {
                    Some(share) => {
                        keep_first(&mut first, share, kind);
                        break;
                    }
                    None => from = share + GAP_AFTER_GRAZE,
                }
                if from >= 1.0 {
                    break;
                }
            }
        }
        for &Stretching { ends, longest, is_rope } in springs.iter() {
            let [a, b] = ends.map(|i| course(pieces, i, h, n));
            let apart = Course {
                x: [b.x[0] - a.x[0], b.x[1] - a.x[1]],
                v: [b.v[0] - a.v[0], b.v[1] - a.v[1]],
                h,
            };
            let found =
                if is_rope { first_beyond(&apart, longest) } else { first_longer(&apart, longest) };
            let Some(share) = found else {
                continue;
            };
            let guess = begin + share / PIECES as f64;
            let kind = EventKind::Stretch { ends, longest };
            if first.is_none_or(|event| guess < event.share) {
                let share = step.refine(guess, kind, state, state_at).unwrap_or(guess);
                keep_first(&mut first, share, kind);
            }
        }
        let event = first?;
        state_at(event.share, state);
        Some(event)
    }

    /// Lists the particles that come near an obstacle, and those that reach an outflow.
    fn list_pairs(&mut self, step: &Searched) {
        self.pairs.clear();
        let network = step.network;
        let obstacles = network.solids().len();
        let free = |i: &usize| network.inverse_masses()[*i] > 0.0;
        if network.contact_layer().is_none() {
            for body in 0..obstacles {
                self.list_near(step, body, (0..network.particles()).filter(free));
            }
        }
        let flowing = network.fluid().map_or(&[][..], Fluid::particles).iter();
        let flowing = flowing.map(|i| *i as usize).filter(free);
        for body in obstacles..obstacles + step.outflows.len() {
            self.list_near(step, body, flowing.clone());
        }
    }

    /// Leaves out obstacles that do not rise above the face on which a particle lies: it passes
    /// from one to the next where they are level.
    fn leave_out_level(&mut self, step: &Searched) {
        let n = step.network.particles();
        let Self { pairs, faces, .. } = self;
        let lying = pairs.iter().filter(|pair| pair.touches);
        faces.clear();
        faces.extend(lying.filter_map(|pair| {
            let obstacle = Some(step.body(pair.body)).filter(|obstacle| obstacle.is_flat())?;
            let x = row(step.ends[0], n, pair.particle);
            let pose = obstacle.at(0.0);
            let seen = obstacle.shape.separation(pose.inwards(x - pose.place.position));
            Some((pair.particle, x, pose.outwards(seen.normal)))
        }));
        if faces.len() == pairs.len() {
            return;
        }
        pairs.retain(|pair| {
            let obstacle = step.body(pair.body);
            let is_level = |(particle, x, normal): &(usize, Vector3<f64>, Vector3<f64>)| {
                *particle == pair.particle
                    && obstacle.is_still()
                    && obstacle.rise(x, normal) <= step.depths.none
            };
            pair.touches || !faces.iter().any(is_level)
        });
    }

    /// Lists those of some particles that come near an obstacle or an outflow.
    fn list_near(&mut self, step: &Searched, body: usize, particles: impl Iterator<Item = usize>) {
        let n = step.network.particles();
        let times = [step.t, step.t + step.h];
        let obstacle = step.body(body);
        let [speed, _] = obstacle.path.bounds(times);
        let place = obstacle.path.at(step.t + 0.5 * step.h).position;
        let reach = obstacle.shape.reach() + 0.5 * speed * step.h;
        let is_floor = reach.is_infinite();
        let begun = obstacle.at(step.t);
        let near_floor = place.y + 0.5 * speed * step.h;
        for particle in particles {
            if is_floor && lowest(step, particle, n) > near_floor {
                continue;
            }
            let course = course(&step.ends, particle, step.h, n);
            let middle = 0.5 * (course.x[0] + course.x[1]) - place;
            let is_near = is_floor || middle.norm_squared() <= (reach + course.reach()).powi(2);
            // States that are not finite are reported elsewhere.
            if is_near {
                let seen = begun.inwards(course.x[0] - begun.place.position);
                self.pairs.push(Encounter {
                    particle,
                    body,
                    touches: obstacle.shape.separation(seen).distance <= step.depths.none,
                });
            }
        }
    }

    /// Lists the springs that may become long enough to break, and the ropes that may tighten. A
    /// rope that has just rebounded begins at its length, and one that is too long is tightened
    /// after the step.
    fn list_springs(&mut self, step: &Searched) {
        self.springs.clear();
        let (network, none) = (step.network, step.depths.none);
        let breaking = network.tear_limit().into_iter().flat_map(|limit| {
            let longest = move |s: Spring| ([s.i, s.j], limit * s.law.rest_length, false);
            network.all_springs().map(longest)
        });
        let n = network.particles();
        let tightening = slack(network).map(|(ends, length)| {
            let [a, b] = ends.map(|i| row(step.ends[0], n, i));
            let missing = length - (a - b).norm();
            // Where it begins at its length or beyond, a little more than it has then.
            let beyond = (length + none).max(length - missing + 1e-3 * none);
            let longest = if missing > none { length } else { beyond };
            (ends, longest, true)
        });
        for (ends, longest, is_rope) in breaking.chain(tightening) {
            let [a, b] = ends.map(|i| course(&step.ends, i, step.h, n));
            let farthest = (0..2).map(|k| (a.x[k] - b.x[k]).norm()).fold(0.0, f64::max);
            // Half of the most by which one end can leave its chord relative to the other.
            let bulge = 0.5 * (0..2).map(|k| (a.v[k] - b.v[k]).norm() * step.h).sum::<f64>();
            if longest > 0.0 && farthest + bulge > longest {
                self.springs.push(Stretching { ends, longest, is_rope });
            }
        }
    }
}

/// Keeps the earlier of two events.
fn keep_first(first: &mut Option<Event>, share: f64, kind: EventKind) {
    if first.is_none_or(|event| share < event.share) {
        *first = Some(Event { share, kind });
    }
}

/// Returns a lower bound of the height (m) of particle i of n during the step, with room for a
/// polynomial that is not quite a cubic.
fn lowest(step: &Searched, i: usize, n: usize) -> f64 {
    let [[y0, v0], [y1, v1]] = step.ends.map(|y| [y[n + i], y[4 * n + i]]);
    let bulge = 0.5 * ((v0.abs() + v1.abs()) * step.h + (y1 - y0).abs());
    y0.min(y1) - bulge
}

/// Largest number of Newton steps, from the time on a piece's cubic to that on the polynomial.
const NEWTON_STEPS: usize = 8;

/// Kind of an event.
#[derive(Clone, Copy, Debug)]
pub(super) enum EventKind {
    /// A particle touches an obstacle, or reaches an outflow: their numbers. Outflows follow all
    /// obstacles.
    Touch { particle: usize, body: usize },
    /// A particle that rests on an obstacle sank deeper into it than allowed, or a joint that
    /// leaves its end passed it: the step is too long.
    Sunk,
    /// A particle ceases to stick or slide on an obstacle as it did, or a rope slackens.
    Rested,
    /// A spring between these ends reaches the length (m) at which it breaks, or a rope its own.
    Stretch { ends: [usize; 2], longest: f64 },
}

/// Step that is searched for events, between two times and states.
pub(super) struct Searched<'a> {
    pub network: &'a Network,
    /// Outflows of the fluid, as obstacles.
    pub outflows: &'a [Obstacle],
    pub t: f64,
    pub h: f64,
    pub ends: [&'a [f64]; 2],
    pub depths: Depths,
}

/// Writes the state at a share of the step to the slice.
type StateAt<'a> = &'a mut dyn FnMut(f64, &mut [f64]);

impl Searched<'_> {
    /// Returns the obstacle of that number, or the outflow that follows all obstacles.
    pub fn body(&self, k: usize) -> &Obstacle {
        let obstacles = self.network.solids();
        let outflow = || &self.outflows[k - obstacles.len()];
        obstacles.get(k).unwrap_or_else(outflow)
    }

    /// Returns whether a particle ends the step inside its obstacle, but within the tolerance and
    /// on the side with that normal: then it is moved to the surface at the end, without an event.
    /// Where it may rebound, it has the impact at the touch.
    pub fn ends_shallow(&self, [particle, body]: [usize; 2], normal: &Vector3<f64>) -> bool {
        let obstacle = self.body(body);
        if obstacle.restitution > 0.0 {
            return false;
        }
        let (pose, n) = (obstacle.at(self.t + self.h), self.network.particles());
        let x = course(&self.ends, particle, self.h, n).x[1];
        let end = obstacle.shape.separation(pose.inwards(x - pose.place.position));
        let shallow = self.depths.shallow.min(0.25 * obstacle.shape.greatest_depth());
        (-shallow..=0.0).contains(&end.distance) && end.normal.dot(normal) > 0.5
    }

    /// Finds the share of the step at which an event happens on the polynomial, by Newton's method
    /// from a guess; `None` if it does not happen. Leaves the state near it in `state`.
    pub fn refine(
        &self,
        guess: f64,
        kind: EventKind,
        state: &mut [f64],
        state_at: StateAt,
    ) -> Option<f64> {
        let mut share = guess;
        let mut gap = f64::INFINITY;
        for _ in 0..NEWTON_STEPS {
            state_at(share, state);
            let (found, rate) = self.gap(share, kind, state);
            let next = share - found / (rate * self.h);
            if found.abs() >= gap.abs() || !(0.0..=1.0).contains(&next) {
                gap = found;
                break;
            }
            gap = found;
            if (next - share).abs() <= f64::EPSILON {
                break;
            }
            share = next;
        }
        (gap.abs() <= self.depths.none).then_some(share)
    }

    /// Returns the distance (m) from an event at a share of the step, and the rate of that distance
    /// (m/s).
    fn gap(&self, share: f64, kind: EventKind, y: &[f64]) -> (f64, f64) {
        let n = self.network.particles();
        let row = |first: usize, i: usize| {
            Vector3::new(y[first + i], y[first + n + i], y[first + 2 * n + i])
        };
        match kind {
            EventKind::Touch { particle, body } => {
                let obstacle = self.body(body);
                let pose = obstacle.at(self.t + share * self.h);
                let d = row(0, particle) - pose.place.position;
                let seen = obstacle.shape.separation(pose.inwards(d));
                let normal = pose.outwards(seen.normal);
                let spin = pose.orientation.map(|turned| turned.spin.cross(&d));
                let own = pose.place.velocity + spin.unwrap_or_default();
                (seen.distance, normal.dot(&(row(3 * n, particle) - own)))
            }
            EventKind::Stretch { ends: [i, j], longest } => {
                let (d, v) = (row(0, j) - row(0, i), row(3 * n, j) - row(3 * n, i));
                (longest - d.norm(), -d.dot(&v) / d.norm())
            }
            EventKind::Sunk | EventKind::Rested => (0.0, 0.0),
        }
    }
}

/// Returns the course of particle i between two states.
pub(super) fn course<Y: AsRef<[f64]>>(ends: &[Y; 2], i: usize, h: f64, n: usize) -> Course {
    let row = |y: &[f64], first: usize| {
        Vector3::new(y[first + i], y[first + n + i], y[first + 2 * n + i])
    };
    Course {
        x: [0, 1].map(|k| row(ends[k].as_ref(), 0)),
        v: [0, 1].map(|k| row(ends[k].as_ref(), 3 * n)),
        h,
    }
}
