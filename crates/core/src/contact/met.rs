//! Contacts of particles with one obstacle in a step.
//!
//! First contact of a particle with an obstacle within a step.
//!
//! The particle follows a cubic, the obstacle its path. On an interval of the step, the distance is
//! bounded from below: by the largest relative speed and, for a convex shape, by the plane
//! perpendicular to the shortest line in the middle of the interval. Intervals whose bound is not
//! above 0 are halved, and the earlier half is searched first (conservative advancement: Mirtich,
//! *Impulse-based dynamic simulation of rigid body systems*, 1996). No contact is missed, however
//! fast or thin the obstacle is.

use std::ops::Range;

use nalgebra::Vector3;

use super::impulse::{Impulses, across, change_in_impact, rebound_speed};
use super::motion::Guarded;
use super::obstacle::{Course, Obstacle, velocity};
use crate::columns::{row, set_row};
use crate::geometry::Shape;
use crate::geometry::closest::{Nearest, Separation};
use crate::interval::Interval;
use crate::path::Pose;

/// Gap before a step, as a share of the depth after it, up to which a particle counts as touching
/// from the beginning of the step: it may be a rounding error.
const TOUCHING_SHARE: f64 = 1e-6;

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
        if depth > self.statistics.depth {
            self.statistics.depth = depth;
            self.statistics.touched = share;
        }
        self.statistics.contacts += 1;
        self.statistics.impulse += impulse.norm();
        self.impulses.add(i, impulse);
        self.rebounds.push(share);
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
    pub friction: f64,
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
        let (x, v) = y1.split_at_mut(3 * n);
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
            let d = Vector3::new(x[i] - c.x, x[n + i] - c.y, x[2 * n + i] - c.z);
            let inside = surface(d);
            let at = row(x, n, i);
            let is_struck = self.struck.binary_search(&i).is_ok();
            let may_pass = !is_struck && x0.is_some_and(|x0| self.may_pass(row(x0, n, i), at));
            if inside.is_none() && !may_pass || self.inverse_masses[i] == 0.0 {
                continue;
            }
            let touch = (may_pass || !is_struck && self.obstacle.restitution > 0.0)
                .then(|| self.touch(i, [at, row(v, n, i)]))
                .flatten();
            let first = touch.as_ref();
            let passed = first.and_then(|touch| touch.passed(d, inside.as_ref()));
            let Some(nearest) = passed.or(inside) else {
                continue;
            };
            if let Some(rebound) = touch.and_then(|touch| self.rebound(row(v, n, i), &touch)) {
                let end = at + rebound.change * rebound.left;
                // A particle that is inside again at the end of the step is moved out there.
                if surface(end - c).is_none() {
                    set_row(x, n, i, end);
                    set_row(v, n, i, row(v, n, i) + rebound.change);
                    let depth = nearest.normal.dot(&(nearest.point - d));
                    let impulse = rebound.change / self.inverse_masses[i];
                    noted.add_rebound(i, 1.0 - rebound.left / self.span.h, depth, impulse);
                    continue;
                }
            }
            let own = self.velocity(nearest.point);
            let velocity = row(v, n, i) - own;
            let outwards = velocity.dot(&nearest.normal);
            let inwards = outwards.min(0.0);
            for axis in self.axes.clone() {
                x[axis * n + i] = c[axis] + nearest.point[axis];
                v[axis * n + i] -= inwards * nearest.normal[axis];
            }
            if let Some(x0) = self.x0 {
                // Position if the obstacle had carried the particle along.
                let carried = self.carried(row(x0, n, i));
                let depth = nearest.normal.dot(&(nearest.point - d));
                let approach = nearest.normal.dot(&(carried - at));
                if self.friction > 0.0 {
                    let share = if approach > depth * (1.0 + TOUCHING_SHARE) {
                        depth / approach
                    } else {
                        1.0
                    };
                    let touched = carried + (at - carried) * (1.0 - share);
                    let slip = across(row(x, n, i) - touched, nearest.normal);
                    let kept = self.kept(slip, depth);
                    let held = if kept > 0.0 {
                        row(x, n, i) - slip * (1.0 - kept)
                    } else {
                        surface(touched - c).map_or(touched, |nearest| c + nearest.point)
                    };
                    set_row(x, n, i, held);
                }
                let moved_in = depth.min(approach);
                if moved_in > noted.statistics.depth {
                    noted.statistics.depth = moved_in;
                    noted.statistics.touched = 1.0 - moved_in / approach;
                }
            }
            if self.friction > 0.0 {
                let slip = across(velocity, nearest.normal);
                let outwards = nearest.normal * outwards.max(0.0);
                let kept = self.kept(slip, -inwards);
                if kept == 0.0 {
                    let stop = self.stop(i, slip, (nearest.normal, -inwards));
                    if stop.way > noted.statistics.stop.way {
                        noted.statistics.stop = stop;
                    }
                }
                // A particle that sticks moves like the point at which it was left.
                let own = if kept > 0.0 {
                    own
                } else {
                    self.velocity(row(x, n, i) - c)
                };
                let left = self.left(i, (slip, kept), nearest.normal);
                set_row(v, n, i, own + outwards + left);
            }
            noted.statistics.contacts += 1;
            let change = row(v, n, i) - own - velocity;
            noted.statistics.impulse += change.norm() / self.inverse_masses[i];
            noted.impulses.add(i, change / self.inverse_masses[i]);
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
    /// [x, v], if it begins outside.
    fn touch(&self, i: usize, [x, v]: [Vector3<f64>; 2]) -> Option<Touch> {
        let (Interval { t, h }, n) = (self.span, self.inverse_masses.len());
        let course = Course {
            x: [row(self.x0?, n, i), x],
            v: [row(self.v0?, n, i), v],
            h,
        };
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
        let touches = flight.is_none();
        let shape = &self.obstacle.shape;
        if touches && !shape.is_convex() {
            return None;
        }
        let depth = if touches {
            0.25 * shape.greatest_depth() - begun.min(0.0)
        } else {
            0.0
        };
        let share = approach.first(flight.unwrap_or(0.0), depth)?;
        let (point, normal) = approach.touched(share);
        let pose = self.obstacle.at(t + share * h);
        Some(Touch {
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
    fn rebound(&self, v: Vector3<f64>, touch: &Touch) -> Option<Rebound> {
        let (h, restitution) = (self.span.h, self.obstacle.restitution);
        if restitution == 0.0 || touch.touches {
            return None;
        }
        let Touch {
            share,
            there: [point, normal],
            ref pose,
            ..
        } = *touch;
        let relative = touch.speed - velocity(pose, point);
        let [begun, ended] = [(touch.begun, &self.before), (v, &self.after)]
            .map(|(v, pose)| v - velocity(pose, point));
        let press = (begun - ended).dot(&normal) / h;
        let approach = -relative.dot(&normal);
        let speed = rebound_speed(restitution, approach, press, h);
        (speed > 0.0).then(|| Rebound {
            change: change_in_impact(relative, normal, speed, self.friction),
            left: (1.0 - share) * h,
        })
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
    /// of its speed that friction leaves. The slip turns with an obstacle that turns: friction acts
    /// along the mean of its directions at the beginning and the end of the step, or along the
    /// latter if the slip has reversed within the step.
    fn left(&self, i: usize, (slip, kept): (Vector3<f64>, f64), up: Vector3<f64>) -> Vector3<f64> {
        let turns = kept > 0.0 && self.after.orientation.is_some();
        let begun = turns.then(|| self.begun(i, up)).flatten();
        let begun = begun.filter(|begun| begun.dot(&slip) > 0.0);
        begun.map_or(slip * kept, |begun| {
            let (speed, along) = (slip.norm(), begun.normalize() + slip.normalize());
            let left = slip - along.normalize() * (speed * (1.0 - kept));
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
        // A particle on the surface may be moved inwards, by rounding: friction is 0 then.
        let (slip, most) = (slip.norm(), self.friction * normal.max(0.0));
        if slip > most { 1.0 - most / slip } else { 0.0 }
    }
}

/// First touch of a particle and the obstacle in a step.
struct Touch {
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

impl Touch {
    /// Returns the position, in the plane of the touch, of a particle that has passed through the
    /// surface there. At the end of the step the particle is at d, relative to the obstacle's
    /// place, and `inside` is the nearest point of the surface if it is still inside.
    fn passed(&self, d: Vector3<f64>, inside: Option<&Nearest>) -> Option<Nearest> {
        let [point, normal] = self.end;
        let depth = normal.dot(&(point - d));
        let leaves_here = inside.is_some_and(|inside| inside.normal.dot(&normal) > 0.0);
        (depth > 0.0 && !leaves_here).then(|| Nearest {
            point: d + normal * depth,
            normal,
        })
    }
}

/// Change of a particle's velocity by a rebound (m/s), and the time that remains of the step (s).
struct Rebound {
    change: Vector3<f64>,
    left: f64,
}

/// Length below which an interval is not halved, as a share of the step.
const MIN_INTERVAL: f64 = 1e-7;

/// Largest number of intervals in a search: if it does not decide, that counts as contact.
const MAX_INTERVALS: usize = 10_000;

/// Largest number of halvings of an interval.
const MAX_HALVINGS: usize = 64;

/// Number of Newton steps from an interval to the contact in it.
const NEWTON_STEPS: usize = 8;

/// Particle and obstacle during a step.
pub(crate) struct Approach<'a> {
    obstacle: &'a Obstacle,
    course: &'a Course,
    /// Time at the beginning of the step (s).
    t: f64,
    /// Bounds of the first and the second derivative of the particle's position relative to the
    /// obstacle, by the share of the step (m).
    speed: f64,
    bend: f64,
}

impl<'a> Approach<'a> {
    /// Creates the approach of a particle on a course that begins at time t (s).
    pub fn new(obstacle: &'a Obstacle, course: &'a Course, t: f64) -> Self {
        let h = course.h;
        let times = [t, t + h];
        let [speed, acceleration] = obstacle.path.bounds(times);
        let [own_speed, own_bend] = course.bounds();
        let (mut speed, mut bend) = (own_speed + speed * h, own_bend + acceleration * h * h);
        if let Some(turn) = obstacle.turn.filter(|turn| turn.is_on(times)) {
            let place = obstacle.path.at(t).position;
            let away = (course.x[0] - place).norm() + speed;
            let angle = turn.rate.abs() * h;
            bend += angle * (2.0 * speed + angle * away);
            speed += angle * away;
            if turn
                .known_times()
                .iter()
                .any(|time| t < *time && *time < t + h)
            {
                bend = f64::INFINITY;
            }
        }
        Self {
            obstacle,
            course,
            t,
            speed,
            bend,
        }
    }

    /// Returns the position (m) of the particle at a share of the step, in the obstacle's own
    /// frame, before it turned.
    fn seen(&self, share: f64) -> Vector3<f64> {
        let pose = self.obstacle.at(self.t + share * self.course.h);
        pose.inwards(self.course.position(share) - pose.place.position)
    }

    /// Returns the separation at a share of the step, in the obstacle's own frame.
    pub fn separation(&self, share: f64) -> Separation {
        self.obstacle.shape.separation(self.seen(share))
    }

    /// Returns the point of the surface nearest to the particle (m) at a share of the step, and the
    /// normal there, in the obstacle's own frame.
    pub fn touched(&self, share: f64) -> (Vector3<f64>, Vector3<f64>) {
        let seen = self.seen(share);
        let Separation { distance, normal } = self.obstacle.shape.separation(seen);
        (seen - normal * distance, normal)
    }

    /// Returns a share of the step up to which a particle that begins at the surface flies above
    /// it, if it rises to a height, or falls from one, above the least that counts (m). That may
    /// depend on the acceleration towards the surface by the share of the step (m).
    pub fn flight(&self, least: impl Fn(f64) -> f64) -> Option<f64> {
        let begun = self.separation(0.0);
        let pose = self.obstacle.at(self.t);
        let (normal, away) = (
            pose.outwards(begun.normal),
            self.course.x[0] - pose.place.position,
        );
        let rise = normal.dot(&(self.course.v[0] - velocity(&pose, away))) * self.course.h;
        let fall = -normal.dot(&self.course.bend());
        let least = least(fall);
        let crest = if fall > rise.abs() {
            rise / fall
        } else {
            rise.signum()
        };
        let height = begun.distance.max(0.0);
        if height + 0.5 * rise * crest <= least {
            return None;
        }
        if rise <= 0.0 {
            return (height > 0.0).then_some(0.0);
        }
        // Where the bend grows, the particle may be back at the time of that crest.
        let mut share = crest;
        while share > f64::EPSILON && 0.5 * rise * share > least {
            if self.separation(share).distance > least {
                return Some(share);
            }
            share *= 0.5;
        }
        None
    }

    /// Returns a lower bound of the distance (m) between two shares of the step.
    fn least(&self, [a, b]: [f64; 2]) -> f64 {
        let middle = 0.5 * (a + b);
        let seen = self.seen(middle);
        let Separation { distance, normal } = self.obstacle.shape.separation(seen);
        let least = distance - self.speed * 0.5 * (b - a);
        if !self.obstacle.shape.is_convex() || !self.bend.is_finite() {
            return least;
        }
        let beyond = |share: f64| normal.dot(&(self.seen(share) - seen));
        let sagitta = self.bend * (b - a).powi(2) / 8.0;
        let plane = distance + beyond(a).min(beyond(b)).min(0.0) - sagitta;
        least.max(plane)
    }

    /// Finds the first share of the step, from `from` on, at which the particle is within the
    /// obstacle by `depth` (m), if there is one.
    pub fn first(&self, from: f64, depth: f64) -> Option<f64> {
        let may_touch = |interval| self.least(interval) + depth <= 0.0;
        let found = earliest([from, 1.0], MIN_INTERVAL, may_touch)?;
        Some(self.refine(found, depth))
    }

    /// Finds the share of the step near a given one at which the depth (m) is reached.
    fn refine(&self, share: f64, depth: f64) -> f64 {
        let distance = |share: f64| self.separation(share).distance + depth;
        let mut now = share;
        for _ in 0..NEWTON_STEPS {
            let (here, there) = (distance(now), distance(now + MIN_INTERVAL));
            let next = now - here * MIN_INTERVAL / (there - here);
            if !(next - share).is_finite() || (next - share).abs() > 4.0 * MIN_INTERVAL {
                return share;
            }
            let is_found = (next - now).abs() < f64::EPSILON;
            now = next.clamp(0.0, 1.0);
            if is_found {
                break;
            }
        }
        now
    }
}

/// Finds the beginning of the first part of an interval, shorter than `finest`, in which an event
/// may happen. Intervals in which it may happen are halved.
pub(crate) fn earliest(
    whole: [f64; 2],
    finest: f64,
    may_happen: impl Fn([f64; 2]) -> bool,
) -> Option<f64> {
    // Each halving adds one interval.
    let mut left = [whole; MAX_HALVINGS];
    let mut count = 1;
    for _ in 0..MAX_INTERVALS {
        if count == 0 {
            return None;
        }
        count -= 1;
        let [a, b] = left[count];
        if !may_happen([a, b]) {
            continue;
        }
        if b - a < finest || count + 2 > MAX_HALVINGS {
            return Some(a);
        }
        let middle = 0.5 * (a + b);
        (left[count], left[count + 1]) = ([middle, b], [a, middle]);
        count += 2;
    }
    Some(left[count.max(1) - 1][0])
}

impl Course {
    /// Bounds the first and the second derivative of the position with respect to the share of the
    /// step (m).
    pub fn bounds(&self) -> [f64; 2] {
        // Control points of the polynomial's Bézier form, which stays within their convex hull.
        let [a, d] = self.x;
        let [b, c] = [
            a + self.v[0] * (self.h / 3.0),
            d - self.v[1] * (self.h / 3.0),
        ];
        let speeds = [b - a, c - b, d - c].map(|way| 3.0 * way.norm());
        let bends = [a - 2.0 * b + c, b - 2.0 * c + d].map(|way| 6.0 * way.norm());
        [
            speeds.into_iter().fold(0.0, f64::max),
            bends.into_iter().fold(0.0, f64::max),
        ]
    }

    /// Returns the second derivative of the position with respect to the share of the step at its
    /// beginning (m).
    fn bend(&self) -> Vector3<f64> {
        let [a, b] = self.v.map(|v| v * self.h);
        (self.x[1] - self.x[0]) * 6.0 - a * 4.0 - b * 2.0
    }

    /// Returns a distance (m) from the middle of the chord within which the whole course stays,
    /// with room for a polynomial that is not quite a cubic.
    pub fn reach(&self) -> f64 {
        let chord = self.x[1] - self.x[0];
        let bulges = self.v.map(|v| (v * self.h - chord).norm());
        0.5 * (chord.norm() + bulges[0] + bulges[1])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;
    use crate::path::Path;
    use crate::random::SplitMix;

    /// Draws a random vector whose coordinates are at most `most` in magnitude.
    fn vector(random: &mut SplitMix, most: f64) -> Vector3<f64> {
        Vector3::from_fn(|_, _| random.between(-most, most))
    }

    /// Small, thin, fast and turning obstacles, compared with a fine sampling of the distance.
    #[test]
    fn no_contact_is_missed() {
        let mut random = SplitMix(5);
        let mut hits = 0;
        for _ in 0..3000 {
            let thin = random.between(1e-3, 0.1);
            let shape = match (random.between(0.0, 3.0)) as u32 {
                0 => Shape::Sphere { radius: thin },
                1 => Shape::turned_box(Vector3::new(0.3, thin, 0.3), vector(&mut random, 2.0))
                    .unwrap(),
                _ => Shape::Capsule {
                    ends: [vector(&mut random, 0.3), vector(&mut random, 0.3)],
                    radius: thin,
                },
            };
            let path = match (random.between(0.0, 3.0)) as u32 {
                0 => Path::Still(vector(&mut random, 0.2)),
                1 => Path::Sine {
                    center: vector(&mut random, 0.2),
                    amplitude: vector(&mut random, 1.0),
                    rate: random.between(0.0, 5.0),
                    phase: random.between(0.0, 6.0),
                },
                _ => Path::Line {
                    from: vector(&mut random, 1.0),
                    to: vector(&mut random, 1.0),
                    start: random.between(0.0, 0.5),
                    end: random.between(0.5, 1.0),
                },
            };
            let mut obstacle = Obstacle::smooth(shape, path);
            if random.between(0.0, 1.0) < 0.5 {
                obstacle.turn = Some(crate::path::Turn {
                    axis: vector(&mut random, 1.0).normalize(),
                    rate: random.between(-6.0, 6.0),
                    start: 0.2,
                    end: None,
                });
            }
            let course = Course {
                x: [vector(&mut random, 1.0), vector(&mut random, 1.0)],
                v: [vector(&mut random, 3.0), vector(&mut random, 3.0)],
                h: 1.0,
            };
            let approach = Approach::new(&obstacle, &course, 0.0);
            if approach.separation(0.0).distance < 1e-6 {
                continue;
            }
            let samples = 20_000;
            let share = |k: u32| f64::from(k) / f64::from(samples);
            let sampled = (0..=samples).find(|k| approach.separation(share(*k)).distance < -1e-9);
            let found = approach.first(0.0, 0.0);
            match (sampled, found) {
                (Some(k), Some(found)) => {
                    hits += 1;
                    assert!(found <= share(k), "{obstacle:?} {course:?}");
                    assert!(found > 0.0 && approach.separation(found).distance.abs() < 1e-5);
                }
                (Some(_), None) => panic!("missed: {obstacle:?}"),
                // Contacts between two samples.
                (None, Some(found)) => {
                    assert!(approach.separation(found).distance.abs() < 1e-5);
                }
                (None, None) => {}
            }
        }
        assert!(hits > 100, "{hits}");
    }
}
