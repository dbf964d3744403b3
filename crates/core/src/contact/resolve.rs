//! The phase after a step: particles out of obstacles, impulses, friction.

use std::ops::Range;

use nalgebra::Vector3;

use super::cut::Squeezed;
use super::impulses::Impulses;
use super::layer::ContactLayer;
use super::motion::Guarded;
use super::obstacle::Obstacle;
use super::rebound::{Course, Rebound, across, first_inside, rebound_speed, set, vector, velocity};
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
}

impl Contact {
    /// Contact phase with room for states of that length.
    #[must_use]
    pub fn new(dim: usize) -> Self {
        Self {
            y0: Vec::with_capacity(dim),
            last: Statistics::default(),
            impulses: (Impulses::with_room_for(dim / 6), 0.0),
        }
    }

    /// Remembers the state that a step begins with, if an obstacle has friction or restitution or,
    /// with `look_back`, if there is one at all.
    pub fn begin(&mut self, obstacles: &[Obstacle], y0: &[f64], look_back: bool) {
        self.y0.clear();
        let needs = |o: &Obstacle| look_back || o.friction > 0.0 || o.restitution > 0.0;
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
        self.last
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
        let surface_at = |pose: &Pose, d: Vector3<f64>| {
            surface(pose.inwards(d)).map(|nearest| Nearest {
                point: pose.outwards(nearest.point),
                normal: pose.outwards(nearest.normal),
            })
        };
        let surface = |d: Vector3<f64>| surface_at(&self.after, d);
        let c = self.after.place.position;
        for i in 0..n {
            let d = Vector3::new(x[i] - c.x, x[n + i] - c.y, x[2 * n + i] - c.z);
            let Some(nearest) = surface(d) else {
                continue;
            };
            if self.inverse_masses[i] == 0.0 {
                continue;
            }
            let at = vector(x, n, i);
            if let Some(rebound) = self.rebound(i, (at, vector(v, n, i)), surface_at) {
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

    /// What restitution does to particle i, whose state at the end of the step is (x, v), if it
    /// does anything. `surface` finds nearest points of the obstacle in a pose, as seen from its
    /// place.
    fn rebound(
        &self,
        i: usize,
        (x, v): (Vector3<f64>, Vector3<f64>),
        surface: impl Fn(&Pose, Vector3<f64>) -> Option<Nearest>,
    ) -> Option<Rebound> {
        let ((t, h), n) = (self.span, self.inverse_masses.len());
        let restitution = self.obstacle.restitution;
        let (x0, v0) = (self.x0.filter(|_| restitution > 0.0)?, self.v0?);
        let course = Course {
            x: [vector(x0, n, i), x],
            v: [vector(v0, n, i), v],
            h,
        };
        let touch = |share: f64| {
            let pose = self.obstacle.at(t + share * h);
            let d = course.position(share) - pose.place.position;
            Some((surface(&pose, d)?, pose))
        };
        let share = first_inside(|share| touch(share).is_some())?;
        let (Nearest { point, normal }, pose) = touch(share)?;
        let relative = course.velocity(share) - velocity(&pose, point);
        let [begun, ended] = [(course.v[0], &self.before), (v, &self.after)]
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
