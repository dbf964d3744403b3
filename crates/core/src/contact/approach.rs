//! First contact of a particle with an obstacle within a step.
//!
//! The particle follows a cubic, the obstacle its path. On an interval of the step, the distance is
//! bounded from below: by the largest relative speed and, for a convex shape, by the plane
//! perpendicular to the shortest line in the middle of the interval. Intervals whose bound is not
//! above 0 are halved, and the earlier half is searched first (conservative advancement: Mirtich,
//! *Impulse-based dynamic simulation of rigid body systems*, 1996). No contact is missed, however
//! fast or thin the obstacle is.

use nalgebra::Vector3;

use super::obstacle::{Course, Obstacle, velocity};
use crate::geometry::closest::Separation;
use crate::path::Pose;

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
            if turn.known_times().iter().any(|time| t < *time && *time < t + h) {
                bend = f64::INFINITY;
            }
        }
        Self { obstacle, course, t, speed, bend }
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

    /// Returns the place and orientation of the obstacle at the beginning.
    fn begun(&self) -> Pose {
        let [begun, _] = self.obstacle.at_ends([self.t, self.t + self.course.h]);
        begun
    }

    /// Returns whether the particle approaches the surface at the beginning.
    pub fn closes(&self) -> bool {
        let (pose, normal) = (self.begun(), self.separation(0.0).normal);
        let away = self.course.x[0] - pose.place.position;
        let speed = self.course.v[0] - velocity(&pose, away);
        pose.outwards(normal).dot(&speed) < 0.0
    }

    /// Returns a share of the step up to which a particle that begins at the surface flies above
    /// it, if it rises to a height, or falls from one, above the least that counts (m). That may
    /// depend on the acceleration towards the surface by the share of the step (m).
    pub fn flight(&self, least: impl Fn(f64) -> f64) -> Option<f64> {
        let begun = self.separation(0.0);
        let pose = self.begun();
        let (normal, away) = (pose.outwards(begun.normal), self.course.x[0] - pose.place.position);
        let rise = normal.dot(&(self.course.v[0] - velocity(&pose, away))) * self.course.h;
        let fall = -normal.dot(&self.course.bend());
        let least = least(fall);
        let crest = if fall > rise.abs() { rise / fall } else { rise.signum() };
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
        let [b, c] = [a + self.v[0] * (self.h / 3.0), d - self.v[1] * (self.h / 3.0)];
        let speeds = [b - a, c - b, d - c].map(|way| 3.0 * way.norm());
        let bends = [a - 2.0 * b + c, b - 2.0 * c + d].map(|way| 6.0 * way.norm());
        [speeds.into_iter().fold(0.0, f64::max), bends.into_iter().fold(0.0, f64::max)]
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
            let samples = 4_000;
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
