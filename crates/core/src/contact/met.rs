//! Contacts of particles with one obstacle in a step.

use std::ops::Range;

use nalgebra::Vector3;

use super::approach::Approach;
use super::contact_pair::LeastSpeed;
use super::impulse::{Impulses, across, change_in_impact, rebound_speed};
use super::motion::Guarded;
use super::obstacle::{Course, Obstacle, velocity};
use super::response::Joints;
use crate::columns::{row, set_row};
use crate::geometry::Shape;
use crate::geometry::closest::Nearest;
use crate::interval::Interval;
use crate::path::Pose;

/// Gap before a step, as a share of the depth after it, up to which a particle counts as touching
/// from the beginning of the step: it may be a rounding error.
pub(super) const TOUCHING_SHARE: f64 = 1e-6;

/// Share of a step at which contact acts that lasts for all of it.
pub(super) const MIDDLE: f64 = 0.5;

/// Share of a step within which rebounds count as simultaneous.
pub(crate) const SIMULTANEOUS_SHARE: f64 = 1e-6;

/// Step that an integrator has taken.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Time of its beginning (s).
    pub t: f64,
    /// Length (s).
    pub h: f64,
    /// State at its beginning, [x | v], or empty. If it is empty, displacements are unknown:
    /// friction acts on velocities only, nothing rebounds, and the statistics have no depth.
    pub y0: &'a [f64],
}

/// Contact during a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Number of contacts: each particle counts once for each obstacle that it was moved out of.
    pub contacts: usize,
    /// Sum of the magnitudes of their impulses (N s).
    pub impulse: f64,
    /// Largest depth to which a particle moved into an obstacle during the step (m).
    pub depth: f64,
    /// Share of the step after which that particle touched the obstacle, for uniform motion.
    pub touched: f64,
    /// Estimated error of the displacements by contact on obstacles that are curved or turn, and by
    /// what constraints pass on of it (m): contact acts after the step, where the estimate of the
    /// method does not see it.
    pub missed: f64,
    /// Actions of the collision safeguard, if surfaces touch.
    pub guarded: Guarded,
    /// End of a slide that friction stops within the step: of the one that would go farthest after
    /// its end without friction.
    pub stop: Stop,
    /// Share of the step after which the first particle rebounded, if any did; `None` also where so
    /// many rebounded that forces between them are not worth another step.
    pub rebound: Option<f64>,
}

/// Record of the contacts in a step.
pub(super) struct Noted<'a> {
    pub statistics: &'a mut Statistics,
    pub impulses: &'a mut Impulses,
    /// Shares of the step after which particles rebounded.
    pub rebounds: &'a mut Vec<f64>,
    /// Constraints that pass impulses on, and the impacts of the particles that they hold, which
    /// have changed no velocity yet.
    pub joints: Option<&'a dyn Joints>,
    pub held: &'a mut Vec<PointImpact>,
    /// Displacements of such particles by obstacles in the step so far, with the numbers of
    /// particle and obstacle.
    pub rubs: &'a mut Vec<([usize; 2], Rub)>,
}

/// Displacements of a particle by an obstacle in one step, in which contact and constraints move it
/// in turns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Rub {
    /// Along the normals (m).
    pressed: f64,
    /// By friction (m).
    rubbed: Vector3<f64>,
}

impl Rub {
    /// Adds a depth (m) to which the particle went in, and the friction that holds it back from a
    /// slip (m). Returns the part of the slip that it takes, or `None` if the particle sticks.
    fn hold(&mut self, slip: Vector3<f64>, depth: f64, friction: f64) -> Option<Vector3<f64>> {
        self.pressed += depth.max(0.0);
        let (before, wanted) = (self.rubbed, self.rubbed - slip);
        let kept = kept(wanted, friction * self.pressed);
        self.rubbed = wanted * (1.0 - kept);
        (kept > 0.0).then(|| before - self.rubbed)
    }
}

/// Impact of a particle on an obstacle, which constraints may pass on.
#[derive(Clone, Debug)]
pub(super) struct PointImpact {
    pub particle: usize,
    /// Number of the obstacle.
    pub obstacle: usize,
    pub normal: Vector3<f64>,
    /// Direction of the obstacle's push without friction; its component along the normal is 1.
    pub push: Vector3<f64>,
    pub least: LeastSpeed,
    /// Velocity of the obstacle there (m/s).
    pub carried: Vector3<f64>,
    /// Share of the step at which it acts.
    pub share: f64,
    /// Time that remains of the step after a rebound (s).
    pub left: f64,
}

impl PointImpact {
    /// Returns the change of the velocity (m/s) of a particle that is free.
    pub fn change(&self) -> Vector3<f64> {
        let LeastSpeed { before, speed, friction, .. } = self.least;
        change_in_impact(before, self.normal, speed, friction)
    }

    /// Adds a change of the velocity (m/s) before the impact. The coefficient of restitution stays.
    pub fn add(&mut self, change: Vector3<f64>) {
        let approach = self.least.before.dot(&self.normal);
        self.least.before += change;
        if self.least.speed > 0.0 {
            let share = self.least.before.dot(&self.normal) / approach;
            self.least.speed *= share.max(0.0);
        }
    }
}

/// End of a slide within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Stop {
    /// Share of the step after which the slide ends.
    pub share: f64,
    /// Distance to the end of the step from there, at half of the speed at its beginning (m); 0
    /// where nothing slides.
    pub way: f64,
}

impl Noted<'_> {
    /// Notes the rebound of particle i, after a share of the step, by an impulse (N s). Without it,
    /// the particle would have gone into the obstacle to that depth (m).
    fn add_rebound(&mut self, i: usize, share: f64, depth: f64, impulse: Vector3<f64>) {
        self.add_depth(depth, share);
        self.add_contact(i, impulse);
        self.rebounds.push(share);
    }

    /// Notes the depth (m) to which a particle moves into the obstacle, which it touches after a
    /// share of the step.
    fn add_depth(&mut self, depth: f64, share: f64) {
        if depth > self.statistics.depth {
            self.statistics.depth = depth;
            self.statistics.touched = share;
        }
    }

    /// Returns the displacements of a particle by an obstacle in the step so far, given the numbers
    /// of both.
    fn rub(&mut self, own: [usize; 2]) -> &mut Rub {
        let known = self.rubs.iter().position(|(it, _)| *it == own);
        let at = known.unwrap_or(self.rubs.len());
        if at == self.rubs.len() {
            self.rubs.push((own, Rub::default()));
        }
        &mut self.rubs[at].1
    }

    /// Notes the contact of particle i, by an impulse (N s).
    pub fn add_contact(&mut self, i: usize, impulse: Vector3<f64>) {
        self.statistics.contacts += 1;
        self.statistics.impulse += impulse.norm();
        self.impulses.add(i, impulse);
    }

    /// Returns whether constraints hold a particle, and pass its impulses on.
    pub fn is_held(&self, i: usize) -> bool {
        self.joints.is_some_and(|joints| joints.hold(i))
    }
}

/// Obstacle during a step.
pub(super) struct Met<'a> {
    /// Positions of the particles at the beginning of the step, if they are known (m).
    pub x0: Option<&'a [f64]>,
    /// Their velocities there (m/s).
    pub v0: Option<&'a [f64]>,
    pub inverse_masses: &'a [f64],
    /// Particles that were struck at the end of the step, in order: they met nothing before, and
    /// their velocities at the end are no longer those of their courses.
    pub struck: &'a [usize],
    pub obstacle: &'a Obstacle,
    /// Its number.
    pub number: usize,
    pub friction: f64,
    /// Coefficient of restitution; 0 where the end of the step has its rebounds already.
    pub restitution: f64,
    /// Time at the beginning of the step, and its length (s).
    pub span: Interval,
    /// Place and orientation of the obstacle at the beginning of the step.
    pub before: Pose,
    /// Place and orientation of the obstacle at the end of the step.
    pub after: Pose,
    /// Axes along which contact without friction moves particles.
    pub axes: Range<usize>,
}

impl Met<'_> {
    /// Resolves the contacts with a surface: a function that returns the nearest point of the
    /// surface to a position in the obstacle's own frame, if that is inside.
    pub fn resolve(
        &self,
        y1: &mut [f64],
        noted: &mut Noted,
        surface: impl Fn(Vector3<f64>) -> Option<Nearest>,
    ) {
        let n = self.inverse_masses.len();
        let surface = |d: Vector3<f64>| {
            surface(self.after.inwards(d)).map(|nearest| Nearest {
                point: self.after.outwards(nearest.point),
                normal: self.after.outwards(nearest.normal),
            })
        };
        let c = self.after.place.position;
        // A particle below a floor is always inside.
        let x0 = self.x0.filter(|_| self.obstacle.shape != Shape::Floor);
        for i in 0..n {
            let at = row(y1, n, i);
            let inside = surface(at - c);
            let is_struck = self.struck.binary_search(&i).is_ok();
            let may_pass = !is_struck && x0.is_some_and(|x0| self.may_pass(row(x0, n, i), at));
            if inside.is_none() && !may_pass || self.inverse_masses[i] == 0.0 {
                continue;
            }
            self.meet(i, y1, noted, (inside, may_pass), &surface);
        }
    }

    /// Resolves the contact of particle i, which is inside the surface at the end of the step, or
    /// may have passed through it.
    fn meet(
        &self,
        i: usize,
        y1: &mut [f64],
        noted: &mut Noted,
        (inside, may_pass): (Option<Nearest>, bool),
        surface: &dyn Fn(Vector3<f64>) -> Option<Nearest>,
    ) {
        let n = self.inverse_masses.len();
        let (x, v) = y1.split_at_mut(3 * n);
        let (c, at) = (self.after.place.position, row(x, n, i));
        let d = at - c;
        let is_struck = self.struck.binary_search(&i).is_ok();
        let touch = (may_pass || !is_struck && self.restitution > 0.0)
            .then(|| self.touch(i, [at, row(v, n, i)], inside.is_some()))
            .flatten();
        let first = touch.as_ref();
        let passed = first.and_then(|touch| touch.passed(d, inside.as_ref()));
        let Some(nearest) = passed.or(inside) else {
            return;
        };
        let is_held = noted.is_held(i);
        let depth = nearest.normal.dot(&(nearest.point - d));
        if let Some(rebound) = touch.and_then(|touch| self.rebound(i, row(v, n, i), &touch)) {
            if is_held {
                noted.add_depth(depth, rebound.share);
                noted.rebounds.push(rebound.share);
                noted.held.push(rebound);
                return;
            }
            let change = rebound.change();
            let end = at + change * rebound.left;
            // A particle that is inside again at the end of the step is moved out there.
            if surface(end - c).is_none() {
                set_row(x, n, i, end);
                set_row(v, n, i, row(v, n, i) + change);
                noted.add_rebound(i, rebound.share, depth, change / self.inverse_masses[i]);
                return;
            }
        }
        let own = self.velocity(nearest.point);
        let velocity = row(v, n, i) - own;
        let outwards = velocity.dot(&nearest.normal);
        let inwards = outwards.min(0.0);
        let (up, approach) = (nearest.normal, -inwards);
        let pushes = approach > 0.0 || is_held;
        let mean = pushes.then(|| self.push(i, (at, velocity), up)).flatten();
        let along = |size: f64| mean.map_or(up * size, |mean| mean * (size / mean.dot(&up)));
        let reaction = along(approach);
        let missed = &mut noted.statistics.missed;
        *missed = missed.max((reaction - up * approach).norm() * self.span.h);
        for axis in self.axes.clone() {
            x[axis * n + i] = c[axis] + nearest.point[axis];
            if !is_held {
                v[axis * n + i] += reaction[axis];
            }
        }
        if let Some(x0) = self.x0 {
            // Position if the obstacle had carried the particle along.
            let carried = self.carried(row(x0, n, i));
            let approach = nearest.normal.dot(&(carried - at));
            if self.friction > 0.0 {
                let touched = touched([carried, at], [depth, approach]);
                let slip = across(row(x, n, i) - touched, nearest.normal);
                // Coulomb's law holds for the sums of these displacements over the step.
                let rub = &mut Rub::default();
                let rub = if is_held { noted.rub([i, self.number]) } else { rub };
                let held = match rub.hold(slip, depth, self.friction) {
                    None => surface(touched - c).map_or(touched, |nearest| c + nearest.point),
                    Some(taken) => row(x, n, i) - taken,
                };
                set_row(x, n, i, held);
            }
            let moved_in = depth.min(approach);
            noted.add_depth(moved_in, 1.0 - moved_in / approach);
        }
        if self.friction > 0.0 {
            let slip = across(velocity + reaction, nearest.normal);
            let outwards = nearest.normal * outwards.max(0.0);
            let kept = self.kept(slip, -inwards);
            if kept == 0.0 {
                let stop = self.stop(i, slip, (nearest.normal, -inwards));
                if stop.way > noted.statistics.stop.way {
                    noted.statistics.stop = stop;
                }
            }
            // A particle that sticks moves like the point at which it was left.
            let own = if kept > 0.0 { own } else { self.velocity(row(x, n, i) - c) };
            let left = self.left(i, (slip, kept), nearest.normal);
            if !is_held {
                set_row(v, n, i, own + outwards + left);
            }
        }
        if is_held {
            let mut impact = self.impact(i, nearest.normal, [velocity, own], 0.0);
            impact.push = along(1.0);
            impact.least.begun = self.begun(i, nearest.normal).unwrap_or_default();
            noted.held.push(impact);
        } else {
            let change = row(v, n, i) - own - velocity;
            noted.add_contact(i, change / self.inverse_masses[i]);
        }
    }

    /// Returns whether a particle that the step took from x0 to x may have passed through the
    /// obstacle: whether it moved relative to it by more than half of its greatest depth.
    fn may_pass(&self, x0: Vector3<f64>, x: Vector3<f64>) -> bool {
        let shape = &self.obstacle.shape;
        let way = (x - self.carried(x0)).norm();
        let near = shape.reach() + way;
        way > 0.5 * shape.greatest_depth()
            && (x - self.after.place.position).norm_squared() <= near * near
    }

    /// Finds the first touch of particle i in the step, at whose end its position and velocity are
    /// [x, v], if it begins outside. One that ends `inside` touches at the end of the step at the
    /// latest.
    fn touch(&self, i: usize, [x, v]: [Vector3<f64>; 2], inside: bool) -> Option<FirstTouch> {
        let (Interval { t, h }, n) = (self.span, self.inverse_masses.len());
        let course = Course { x: [row(self.x0?, n, i), x], v: [row(self.v0?, n, i), v], h };
        let approach = Approach::new(self.obstacle, &course, t);
        // A particle that touches at the beginning may sink in a little, as long as it does not
        // pass.
        let begun = approach.separation(0.0).distance;
        let is_near = begun <= TOUCHING_SHARE * course.reach();
        // Less than a rebound that lasts for the step.
        let least = |fall: f64| 0.125 * fall.max(0.0);
        let flight = if is_near {
            let flight = approach.flight(least);
            flight.filter(|share| *share > 0.0 || self.obstacle.shape.is_convex())
        } else {
            Some(0.0)
        };
        // One that touches from the beginning and approaches has an impact there.
        let begins = flight.is_none() && self.restitution > 0.0 && approach.closes();
        let touches = flight.is_none() && !begins;
        let shape = &self.obstacle.shape;
        if touches && !shape.is_convex() {
            return None;
        }
        let depth = if touches { 0.25 * shape.greatest_depth() - begun.min(0.0) } else { 0.0 };
        let last = (inside && !touches).then_some(1.0);
        let share =
            if begins { 0.0 } else { approach.first(flight.unwrap_or(0.0), depth).or(last)? };
        let (point, normal) = approach.touched(share);
        let pose = self.obstacle.at(t + share * h);
        Some(FirstTouch {
            share,
            touches,
            end: [point, normal].map(|vector| self.after.outwards(vector)),
            there: [point, normal].map(|vector| pose.outwards(vector)),
            pose,
            begun: course.v[0],
            speed: course.velocity(share),
        })
    }

    /// Returns the effect of restitution on a particle, whose velocity at the end of the step is v,
    /// if there is any.
    fn rebound(&self, i: usize, v: Vector3<f64>, touch: &FirstTouch) -> Option<PointImpact> {
        let (h, restitution) = (self.span.h, self.restitution);
        if restitution == 0.0 || touch.touches {
            return None;
        }
        let FirstTouch { share, there: [point, normal], ref pose, .. } = *touch;
        let carried = velocity(pose, point);
        let relative = touch.speed - carried;
        let [begun, ended] = [(touch.begun, &self.before), (v, &self.after)]
            .map(|(v, pose)| v - velocity(pose, point));
        let press = (begun - ended).dot(&normal) / h;
        let approach = -relative.dot(&normal);
        let speed = rebound_speed(restitution, approach, press, h);
        (speed > 0.0).then(|| PointImpact {
            share,
            left: (1.0 - share) * h,
            ..self.impact(i, normal, [relative, carried], speed)
        })
    }

    /// Returns the impact of particle i at the end of the step, along a normal, with its velocity
    /// relative to the obstacle before it, the obstacle's velocity, and the least speed along the
    /// normal after it (m/s).
    fn impact(
        &self,
        i: usize,
        normal: Vector3<f64>,
        [before, carried]: [Vector3<f64>; 2],
        speed: f64,
    ) -> PointImpact {
        PointImpact {
            particle: i,
            obstacle: self.number,
            normal,
            push: normal,
            least: LeastSpeed::of_impact(before, speed, self.friction),
            carried,
            share: MIDDLE,
            left: 0.0,
        }
    }

    /// Returns the direction in which the obstacle pushes particle i, unless that is the normal
    /// `up` at the end of the step, where the particle is at x (m) with the velocity `relative` to
    /// the obstacle (m/s). If it touches from the beginning of the step, the reaction acts along
    /// the mean of the normals at both ends: on a curved obstacle, or one that turns, that is of
    /// order 2.
    fn push(
        &self,
        i: usize,
        (x, relative): (Vector3<f64>, Vector3<f64>),
        up: Vector3<f64>,
    ) -> Option<Vector3<f64>> {
        let shape = &self.obstacle.shape;
        let is_flat = shape.is_faceted() && self.after.orientation.is_none();
        let x0 = row(self.x0.filter(|_| !is_flat)?, self.inverse_masses.len(), i);
        let begun = shape.separation(self.before.inwards(x0 - self.before.place.position));
        let touches = begun.distance.abs() <= TOUCHING_SHARE * (x - x0).norm();
        let mean = mean_normal([self.before.outwards(begun.normal), up]).filter(|_| touches)?;
        // Where the normal turns too far within the step, the mean would add energy.
        let reaction = mean * (-relative.dot(&up).min(0.0) / mean.dot(&up));
        ((relative * 2.0 + reaction).dot(&reaction) <= 0.0).then_some(mean)
    }

    /// Finds the end of the slide of particle i, whose slip at the end of the step (m/s) friction
    /// stops, where contact changed the velocity along the normal `up` by `change` (m/s).
    fn stop(&self, i: usize, slip: Vector3<f64>, (up, change): (Vector3<f64>, f64)) -> Stop {
        let Some(begun) = self.begun(i, up) else {
            return Stop::default();
        };
        let speed = begun.norm();
        // The speed falls linearly, by friction and by other forces.
        let fall = speed - slip.dot(&begun) / speed + self.friction * change;
        let share = speed / fall;
        if share > 0.0 && share < 1.0 {
            let way = 0.5 * speed * (1.0 - share) * self.span.h;
            Stop { share, way }
        } else {
            Stop::default()
        }
    }

    /// Returns the slip of particle i at the beginning of the step (m/s), across `up`.
    fn begun(&self, i: usize, up: Vector3<f64>) -> Option<Vector3<f64>> {
        let n = self.inverse_masses.len();
        let d = row(self.x0?, n, i) - self.before.place.position;
        let begun = row(self.v0?, n, i) - velocity(&self.before, d);
        Some(across(begun, up))
    }

    /// Returns the slip of particle i after friction (m/s), from the slip before it and the share
    /// of its speed that friction leaves. The slip turns within a step, and friction acts along the
    /// mean of the slips at the beginning and the end of the step, or along the latter if the slip
    /// has reversed within the step.
    fn left(&self, i: usize, (slip, kept): (Vector3<f64>, f64), up: Vector3<f64>) -> Vector3<f64> {
        let begun = (kept > 0.0).then(|| self.begun(i, up)).flatten();
        let begun = begun.filter(|begun| begun.dot(&slip) > 0.0);
        begun.map_or(slip * kept, |begun| {
            let (speed, along) = (slip.norm(), (begun + slip).normalize());
            let left = slip - along * (speed * (1.0 - kept));
            left.cap_magnitude(speed * kept)
        })
    }

    /// Returns the velocity (m/s) of the obstacle at the end of the step, at a point relative to
    /// its place.
    fn velocity(&self, point: Vector3<f64>) -> Vector3<f64> {
        velocity(&self.after, point)
    }

    /// Returns the position (m) at the end of the step of a point that is at x at its beginning and
    /// moves with the obstacle.
    fn carried(&self, x: Vector3<f64>) -> Vector3<f64> {
        let (before, after) = (&self.before.place.position, &self.after.place.position);
        if self.after.orientation.is_some() {
            after + self.after.outwards(self.before.inwards(x - before))
        } else {
            x + (after - before)
        }
    }

    /// Returns the share of a slip along the surface that friction leaves, where contact changed
    /// the motion along the normal by `normal`.
    fn kept(&self, slip: Vector3<f64>, normal: f64) -> f64 {
        kept(slip, self.friction * normal.max(0.0))
    }
}

/// Returns the mean of the normals at both ends of a step, unless they are opposite.
pub(super) fn mean_normal([begun, up]: [Vector3<f64>; 2]) -> Option<Vector3<f64>> {
    let mean = (begun + up).try_normalize(0.0);
    mean.filter(|mean| mean.dot(&up) > 0.0)
}

/// Returns the share of a slip that friction leaves, if it takes at most that much. A particle on
/// the surface may be moved inwards, by rounding: friction is 0 then.
fn kept(slip: Vector3<f64>, most: f64) -> f64 {
    let slip = slip.norm();
    if slip > most { 1.0 - most / slip } else { 0.0 }
}

/// Returns the place (m) at which a particle touches the obstacle on its straight way from
/// `carried`, its place if the obstacle had carried it along, to `at` (m): it approaches by a
/// distance (m) along the normal, and ends at a depth (m), which rounding may make negative.
fn touched([carried, at]: [Vector3<f64>; 2], [depth, approach]: [f64; 2]) -> Vector3<f64> {
    let depth = depth.max(0.0);
    let share = if approach > depth * (1.0 + TOUCHING_SHARE) { depth / approach } else { 1.0 };
    carried + (at - carried) * (1.0 - share)
}

/// First touch of a particle and the obstacle in a step.
struct FirstTouch {
    /// Share of the step after which they touch.
    share: f64,
    /// Whether they touch from the beginning.
    touches: bool,
    /// Point of the obstacle, relative to its place, and the normal there: at the end of the step,
    /// and at the touch.
    end: [Vector3<f64>; 2],
    there: [Vector3<f64>; 2],
    /// Place and orientation of the obstacle at the touch.
    pose: Pose,
    /// Velocity of the particle at the beginning of the step, and at the touch (m/s).
    begun: Vector3<f64>,
    speed: Vector3<f64>,
}

impl FirstTouch {
    /// Returns the position, in the plane of the touch, of a particle that has passed through the
    /// surface there. At the end of the step the particle is at d, relative to the obstacle's
    /// place, and `inside` is the nearest point of the surface if it is still inside.
    fn passed(&self, d: Vector3<f64>, inside: Option<&Nearest>) -> Option<Nearest> {
        let [point, normal] = self.end;
        let depth = normal.dot(&(point - d));
        let leaves_here = inside.is_some_and(|inside| inside.normal.dot(&normal) > 0.0);
        (depth > 0.0 && !leaves_here).then(|| Nearest { point: d + normal * depth, normal })
    }
}
