//! The phase after a step: particles out of obstacles, impulses, friction.

use std::ops::Range;

use nalgebra::Vector3;

use super::approach::Approach;
use super::cut::Squeezed;
use super::impulses::Impulses;
use super::layer::ContactLayer;
use super::motion::Guarded;
use super::obstacle::Obstacle;
use super::rebound::{Course, rebound_speed};
use crate::geometry::Shape;
use crate::geometry::nearest::{Nearest, of_box, of_capsule, of_floor, of_sphere};
use crate::path::Pose;

/// Gap before a step, as a share of the depth after it, up to which a particle counts as touching
/// from the beginning of the step: rounding errors are no gap.
const TOUCHING: f64 = 1e-6;

/// Step that an integrator has taken.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Time of its beginning (s).
    pub t: f64,
    /// Length (s).
    pub h: f64,
    /// State at its beginning, [x | v], or nothing: then displacements are not known, friction
    /// takes of velocities only, nothing rebounds, and the statistics have no depth.
    pub y0: &'a [f64],
}

/// What contact did in a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Statistics {
    /// Number of contacts: of particles, once for each obstacle that they were put out of.
    pub contacts: usize,
    /// Sum of the magnitudes of their impulses (N s).
    pub impulse: f64,
    /// Largest depth to which a particle moved into an obstacle during the step (m).
    pub depth: f64,
    /// Share of the step after which that particle touched the obstacle, if both moved uniformly.
    pub touched: f64,
    /// What the guard of surfaces did, if surfaces touch.
    pub guarded: Guarded,
}

/// Contact phase of a run, with its scratch.
#[derive(Clone, Debug, Default)]
pub struct Contact {
    y0: Vec<f64>,
    last: Statistics,
    /// Impulses of the last step, and its length (s).
    impulses: (Impulses, f64),
    /// Sum of the magnitudes of the impulses that were given at the end of a step before its other
    /// contacts are resolved (N s).
    struck: f64,
}

impl Contact {
    /// Contact phase with room for states of that length.
    #[must_use]
    pub fn new(dim: usize) -> Self {
        Self {
            y0: Vec::with_capacity(dim),
            last: Statistics::default(),
            impulses: (Impulses::with_room_for(dim / 6), 0.0),
            struck: 0.0,
        }
    }

    /// Remembers the state that a step begins with, if particles may pass through an obstacle, or it
    /// has friction or restitution, or, with `look_back`, if there is one at all.
    pub fn begin(&mut self, obstacles: &[Obstacle], y0: &[f64], look_back: bool) {
        self.y0.clear();
        let needs = |o: &Obstacle| {
            look_back || o.friction > 0.0 || o.restitution > 0.0 || o.shape != Shape::Floor
        };
        if obstacles.iter().any(needs) {
            self.y0.extend_from_slice(y0);
        }
    }

    /// Remembers the state that a step begins with, whatever there is.
    pub fn remember(&mut self, y0: &[f64]) {
        self.y0.clear();
        self.y0.extend_from_slice(y0);
    }

    /// State that the step began with, as far as [`begin`](Self::begin) remembered it.
    #[must_use]
    pub fn y0(&self) -> &[f64] {
        &self.y0
    }

    /// Statistics of the last step.
    #[must_use]
    pub fn last(&self) -> Statistics {
        self.last
    }

    /// Adds the impulses on particles in the last step, divided by its length, to forces (N),
    /// n x 3.
    pub(crate) fn add_forces(&self, f: &mut [f64]) {
        let (impulses, h) = &self.impulses;
        impulses.add_forces(*h, f);
    }

    /// Forgets the impulses of the last step: the state is no longer its end.
    pub(crate) fn forget_impulses(&mut self) {
        self.impulses.0.clear();
    }

    /// Resolves the contacts of a step of h (s) from time t (s) to y1, as [`resolve`] does.
    pub fn resolve(
        &mut self,
        obstacles: &[Obstacle],
        inverse_masses: &[f64],
        (t, h): (f64, f64),
        y1: &mut [f64],
    ) -> Statistics {
        let step = Step { t, h, y0: &self.y0 };
        let (impulses, length) = &mut self.impulses;
        *length = h;
        self.last = resolve_noting(obstacles, inverse_masses, &step, y1, impulses);
        self.last.impulse += std::mem::take(&mut self.struck);
        self.last
    }

    /// Gives particles that touch an obstacle, and approach it, the velocities after the impact at
    /// time t (s), and puts them on its surface. The step of h (s) ends there. A distance of
    /// `none` (m) counts as none, and what would rebound by less than `height` (m) does not.
    pub(crate) fn strike(
        &mut self,
        obstacles: &[Obstacle],
        inverse_masses: &[f64],
        (t, h): (f64, f64),
        [none, height]: [f64; 2],
        y1: &mut [f64],
    ) {
        let n = inverse_masses.len();
        let (x, v) = y1.split_at_mut(3 * n);
        for obstacle in obstacles {
            let pose = obstacle.at(t);
            for i in (0..n).filter(|i| inverse_masses[*i] > 0.0) {
                let d = vector(x, n, i) - pose.place.position;
                let seen = obstacle.shape.separation(pose.inwards(d));
                if seen.distance.abs() > none {
                    continue;
                }
                let normal = pose.outwards(seen.normal);
                let point = d - normal * seen.distance;
                let relative = vector(v, n, i) - velocity(&pose, point);
                let approach = -relative.dot(&normal);
                if approach <= 0.0 {
                    continue;
                }
                let begun = self
                    .y0
                    .get(3 * n..6 * n)
                    .map_or(vector(v, n, i), |v0| vector(v0, n, i));
                let press = ((begun - vector(v, n, i)).dot(&normal) / h).max(0.0);
                // The time in which what rebounds by that height comes back.
                let shortest = if press > 0.0 {
                    (8.0 * height / press).sqrt()
                } else {
                    0.0
                };
                let along =
                    approach + rebound_speed(obstacle.restitution, approach, press, shortest);
                let slip = across(relative, normal);
                let most = obstacle.friction * along;
                let taken = if slip.norm() > most {
                    slip * (most / slip.norm())
                } else {
                    slip
                };
                let change = normal * along - taken;
                set(x, n, i, pose.place.position + point);
                set(v, n, i, vector(v, n, i) + change);
                let impulse = change / inverse_masses[i];
                self.struck += impulse.norm();
            }
        }
    }

    /// Guards the surfaces of a step of h (s) from time t (s) to y1.
    ///
    /// # Errors
    /// What is led leaves no room.
    pub fn guard(
        &mut self,
        layer: &ContactLayer,
        inverse_masses: &[f64],
        (t, h): (f64, f64),
        y1: &mut [f64],
    ) -> Result<Statistics, Squeezed> {
        let (impulses, length) = &mut self.impulses;
        *length = h;
        let guarded = layer.guard(inverse_masses, (t, h), &self.y0, y1, impulses)?;
        self.last = Statistics {
            contacts: guarded.impulses,
            impulse: guarded.impulse,
            guarded,
            ..Statistics::default()
        };
        Ok(self.last)
    }
}

/// Puts the particles of y1 = [x | v], the end of a step, out of the obstacles, one obstacle after
/// another, and takes from their velocities what contact and friction take. Pinned particles, whose
/// inverse mass (1/kg) is 0, are left alone. Does nothing where nothing touches.
pub fn resolve(
    obstacles: &[Obstacle],
    inverse_masses: &[f64],
    step: &Step,
    y1: &mut [f64],
) -> Statistics {
    resolve_noting(
        obstacles,
        inverse_masses,
        step,
        y1,
        &mut Impulses::default(),
    )
}

/// Does the same, and notes the impulses.
fn resolve_noting(
    obstacles: &[Obstacle],
    inverse_masses: &[f64],
    step: &Step,
    y1: &mut [f64],
    impulses: &mut Impulses,
) -> Statistics {
    impulses.clear();
    let mut statistics = Statistics::default();
    for obstacle in obstacles {
        let met = Met {
            x0: step.y0.get(..3 * inverse_masses.len()),
            v0: step
                .y0
                .get(3 * inverse_masses.len()..6 * inverse_masses.len()),
            inverse_masses,
            obstacle,
            friction: obstacle.friction,
            span: (step.t, step.h),
            before: obstacle.at(step.t),
            after: obstacle.at(step.t + step.h),
            // A smooth floor moves nothing sideways.
            axes: if obstacle.shape == Shape::Floor {
                1..2
            } else {
                0..3
            },
        };
        let noted = &mut (&mut statistics, &mut *impulses);
        match &obstacle.shape {
            &Shape::Sphere { radius } => {
                met.resolve(y1, noted, |d| of_sphere(d, radius, Vector3::y));
            }
            &Shape::Box { half_extents, axes } => {
                met.resolve(y1, noted, |d| of_box(d, half_extents, axes));
            }
            &Shape::Capsule { ends, radius } => {
                met.resolve(y1, noted, |d| of_capsule(d, ends, radius));
            }
            Shape::Mesh(mesh) => met.resolve(y1, noted, |d| mesh.nearest(d)),
            Shape::Floor => met.resolve(y1, noted, of_floor),
        }
    }
    statistics
}

/// Obstacle as a step meets it.
struct Met<'a> {
    /// Positions of the particles at the beginning of the step, if they are known (m).
    x0: Option<&'a [f64]>,
    /// Their velocities there (m/s).
    v0: Option<&'a [f64]>,
    inverse_masses: &'a [f64],
    obstacle: &'a Obstacle,
    friction: f64,
    /// Time at the beginning of the step, and its length (s).
    span: (f64, f64),
    /// Place and orientation of the obstacle at the beginning of the step.
    before: Pose,
    /// Place and orientation of the obstacle at the end of the step.
    after: Pose,
    /// Axes along which contact without friction pushes.
    axes: Range<usize>,
}

impl Met<'_> {
    /// Resolves the contacts with a surface: a function of a particle's position, seen from the
    /// obstacle's place before it turned, that answers from there if the particle is inside.
    fn resolve(
        &self,
        y1: &mut [f64],
        (statistics, impulses): &mut (&mut Statistics, &mut Impulses),
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
        for i in 0..n {
            let d = Vector3::new(x[i] - c.x, x[n + i] - c.y, x[2 * n + i] - c.z);
            let inside = surface(d);
            let at = vector(x, n, i);
            let may_pass = self.may_pass(i, at);
            if inside.is_none() && !may_pass || self.inverse_masses[i] == 0.0 {
                continue;
            }
            let touch = (may_pass || self.obstacle.restitution > 0.0)
                .then(|| self.touch(i, [at, vector(v, n, i)]))
                .flatten();
            let passed = touch
                .as_ref()
                .and_then(|touch| touch.passed(d, inside.as_ref()));
            let Some(nearest) = passed.or(inside) else {
                continue;
            };
            if let Some(rebound) = touch.and_then(|touch| self.rebound(vector(v, n, i), &touch)) {
                let end = at + rebound.change * rebound.left;
                // What comes back within the step is put out at its end.
                if surface(end - c).is_none() {
                    set(x, n, i, end);
                    set(v, n, i, vector(v, n, i) + rebound.change);
                    let depth = nearest.normal.dot(&(nearest.point - d));
                    if depth > statistics.depth {
                        statistics.depth = depth;
                        statistics.touched = 1.0 - rebound.left / self.span.1;
                    }
                    let impulse = rebound.change / self.inverse_masses[i];
                    statistics.contacts += 1;
                    statistics.impulse += impulse.norm();
                    impulses.add(i, impulse);
                    continue;
                }
            }
            let own = self.velocity(nearest.point);
            let velocity = vector(v, n, i) - own;
            let outwards = velocity.dot(&nearest.normal);
            let inwards = outwards.min(0.0);
            for axis in self.axes.clone() {
                x[axis * n + i] = c[axis] + nearest.point[axis];
                v[axis * n + i] -= inwards * nearest.normal[axis];
            }
            if let Some(x0) = self.x0 {
                // Where it would be if the obstacle had carried it along.
                let carried = self.carried(vector(x0, n, i));
                let depth = nearest.normal.dot(&(nearest.point - d));
                let approach = nearest.normal.dot(&(carried - at));
                if self.friction > 0.0 {
                    let share = if approach > depth * (1.0 + TOUCHING) {
                        depth / approach
                    } else {
                        1.0
                    };
                    let touched = carried + (at - carried) * (1.0 - share);
                    let slip = across(vector(x, n, i) - touched, nearest.normal);
                    let kept = self.kept(slip, depth);
                    let held = if kept > 0.0 {
                        vector(x, n, i) - slip * (1.0 - kept)
                    } else {
                        surface(touched - c).map_or(touched, |nearest| c + nearest.point)
                    };
                    set(x, n, i, held);
                }
                let moved_in = depth.min(approach);
                if moved_in > statistics.depth {
                    statistics.depth = moved_in;
                    statistics.touched = 1.0 - moved_in / approach;
                }
            }
            if self.friction > 0.0 {
                let slip = across(velocity, nearest.normal);
                let outwards = nearest.normal * outwards.max(0.0);
                let kept = self.kept(slip, -inwards);
                // What sticks moves as the point at which it was left.
                let own = if kept > 0.0 {
                    own
                } else {
                    self.velocity(vector(x, n, i) - c)
                };
                set(v, n, i, own + outwards + slip * kept);
            }
            statistics.contacts += 1;
            let change = vector(v, n, i) - own - velocity;
            statistics.impulse += change.norm() / self.inverse_masses[i];
            impulses.add(i, change / self.inverse_masses[i]);
        }
    }

    /// Whether particle i, at x at the end of the step, may have passed through the obstacle: it
    /// moved past it by more than half of the greatest depth.
    fn may_pass(&self, i: usize, x: Vector3<f64>) -> bool {
        let shape = &self.obstacle.shape;
        let (Some(x0), false) = (self.x0, *shape == Shape::Floor) else {
            return false;
        };
        let x0 = vector(x0, self.inverse_masses.len(), i);
        let way = (x - self.carried(x0)).norm();
        let near = shape.reach() + way;
        way > 0.5 * shape.greatest_depth()
            && (x - self.after.place.position).norm_squared() <= near * near
    }

    /// First touch of particle i in the step, at whose end its position and velocity are these, if
    /// it begins outside.
    fn touch(&self, i: usize, [x, v]: [Vector3<f64>; 2]) -> Option<Touch> {
        let ((t, h), n) = (self.span, self.inverse_masses.len());
        let course = Course {
            x: [vector(self.x0?, n, i), x],
            v: [vector(self.v0?, n, i), v],
            h,
        };
        let approach = Approach::new(self.obstacle, &course, t);
        // What touches at the beginning may sink a little, as long as it does not pass.
        let begun = approach.separation(0.0).distance;
        let touches = begun <= TOUCHING * course.reach();
        let shape = &self.obstacle.shape;
        if touches && !shape.is_convex() {
            return None;
        }
        let depth = if touches {
            0.25 * shape.greatest_depth() - begun.min(0.0)
        } else {
            0.0
        };
        let share = approach.first(0.0, depth)?;
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

    /// Effect of restitution on a particle, whose velocity at the end of the step is v, if there is
    /// any.
    fn rebound(&self, v: Vector3<f64>, touch: &Touch) -> Option<Rebound> {
        let ((_, h), restitution) = (self.span, self.obstacle.restitution);
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
        (speed > 0.0).then(|| {
            let along = approach + speed;
            let slip = across(relative, normal);
            Rebound {
                change: normal * along - slip * (1.0 - self.kept(slip, along)),
                left: (1.0 - share) * h,
            }
        })
    }

    /// Velocity of the obstacle at the end of the step, at a point seen from its place.
    fn velocity(&self, point: Vector3<f64>) -> Vector3<f64> {
        velocity(&self.after, point)
    }

    /// Position at the end of the step of what is at x at its beginning and moves with the
    /// obstacle.
    fn carried(&self, x: Vector3<f64>) -> Vector3<f64> {
        let (before, after) = (&self.before.place.position, &self.after.place.position);
        if self.after.orientation.is_some() {
            after + self.after.outwards(self.before.inwards(x - before))
        } else {
            x + (after - before)
        }
    }

    /// Share of a slip along the surface that friction leaves, where contact changed so much along
    /// the normal.
    fn kept(&self, slip: Vector3<f64>, normal: f64) -> f64 {
        let (slip, most) = (slip.norm(), self.friction * normal);
        if slip > most { 1.0 - most / slip } else { 0.0 }
    }
}

/// First touch of a particle and the obstacle in a step.
struct Touch {
    /// Share of the step after which they touch.
    share: f64,
    /// Whether they touch from the beginning.
    touches: bool,
    /// Point of the obstacle, seen from its place, and its normal: at the end of the step, and when
    /// they touch.
    end: [Vector3<f64>; 2],
    there: [Vector3<f64>; 2],
    /// Place and orientation of the obstacle when they touch.
    pose: Pose,
    /// Velocity of the particle at the beginning of the step, and when they touch (m/s).
    begun: Vector3<f64>,
    speed: Vector3<f64>,
}

impl Touch {
    /// Where a particle belongs that has passed through the surface at the touch: to the plane
    /// there. At the end of the step it is at d, seen from the obstacle's place, for which `inside`
    /// is the nearest point of the surface, if it is inside still.
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

/// Change of a particle's velocity by a rebound (m/s), and what is left of the step then (s).
struct Rebound {
    change: Vector3<f64>,
    left: f64,
}

/// Velocity of a point of an obstacle, seen from its place, in a pose.
fn velocity(pose: &Pose, point: Vector3<f64>) -> Vector3<f64> {
    let along = pose.place.velocity;
    let turned = pose.orientation;
    turned.map_or(along, |turned| along + turned.spin.cross(&point))
}

/// Part of a vector at right angles to a unit normal.
fn across(a: Vector3<f64>, normal: Vector3<f64>) -> Vector3<f64> {
    a - normal * a.dot(&normal)
}

fn vector(a: &[f64], n: usize, i: usize) -> Vector3<f64> {
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

fn set(a: &mut [f64], n: usize, i: usize, to: Vector3<f64>) {
    for axis in 0..3 {
        a[axis * n + i] = to[axis];
    }
}
