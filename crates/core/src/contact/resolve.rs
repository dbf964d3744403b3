//! The phase after a step: moves particles out of obstacles, and applies impulses and friction.

use nalgebra::Vector3;

use super::contact_pair::LeastSpeed;
use super::cut::Pinched;
use super::guard::{Bodies, guard};
use super::held::pass_on;
use super::impulse::{Impulses, across, change_in_impact, rebound_speed, shortest_rebound};
use super::layer::ContactLayer;
use super::met::{
    MIDDLE, Met, Noted, PointImpact, Rub, SIMULTANEOUS_SHARE, Statistics, Step, TOUCHING_SHARE,
    mean_normal,
};
use super::obstacle::{Obstacle, velocity};
use crate::columns::{row, set_row};
use crate::geometry::Shape;
use crate::geometry::closest::{of_box, of_capsule, of_floor, of_sphere};
use crate::interval::Interval;

/// Distance from an obstacle that may be a rounding error, over the distances that it is computed
/// from.
const ROUNDING: f64 = 1e-14;

/// Largest number of times in a step at which particles rebound that are told apart.
const MAX_REBOUNDS: usize = 4;

/// Contact phase of a run, with its scratch.
#[derive(Clone, Debug, Default)]
pub struct ContactPhase {
    y0: Vec<f64>,
    last: Statistics,
    /// Impulses of the last step, and its length (s).
    impulses: (Impulses, f64),
    struck: Struck,
    /// Shares of the last step after which particles rebounded.
    rebounds: Vec<f64>,
    /// Impacts of particles that constraints hold.
    held: Vec<PointImpact>,
    /// Displacements of such particles by obstacles in this step.
    rubs: Vec<([usize; 2], Rub)>,
}

/// Particles that are struck at the end of a step, before its other contacts are resolved.
#[derive(Clone, Debug, Default)]
struct Struck {
    particles: Vec<usize>,
    /// Sum of the magnitudes of their impulses (N s).
    impulse: f64,
    /// Impacts of particles that constraints hold. They are applied with the other contacts.
    held: Vec<PointImpact>,
}

impl ContactPhase {
    /// Creates a contact phase with room for states of length `dim`.
    #[must_use]
    pub fn new(dim: usize) -> Self {
        Self {
            y0: Vec::with_capacity(dim),
            last: Statistics::default(),
            impulses: (Impulses::with_room_for(dim / 6), 0.0),
            struck: Struck::default(),
            rebounds: Vec::with_capacity(dim / 6),
            held: vec![],
            rubs: vec![],
        }
    }

    /// Remembers the state at the beginning of a step, if particles may pass through an obstacle,
    /// or one has friction or restitution, or, with `look_back`, if there is any obstacle.
    pub fn begin(&mut self, obstacles: &[Obstacle], y0: &[f64], look_back: bool) {
        self.y0.clear();
        let needs = |o: &Obstacle| {
            look_back || o.friction > 0.0 || o.restitution > 0.0 || o.shape != Shape::Floor
        };
        if obstacles.iter().any(needs) {
            self.y0.extend_from_slice(y0);
        }
    }

    /// Remembers the state at the beginning of a step in any case.
    pub fn remember(&mut self, y0: &[f64]) {
        self.y0.clear();
        self.y0.extend_from_slice(y0);
    }

    /// Returns the state at the beginning of the step, if [`begin`](Self::begin) remembered it.
    #[must_use]
    pub fn y0(&self) -> &[f64] {
        &self.y0
    }

    /// Returns the statistics of the last step.
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

    /// Returns an upper bound of the impulses (N s) that held particles back in the last step: for
    /// each particle that got an impulse, its magnitude or, if larger, the force f on it (N, n x 3)
    /// times the step. An implicit method takes account of the stiffness of the springs: the
    /// velocity into the obstacle at the end of its step, and so the impulse that stops it, is
    /// smaller than the force on the particle times the step.
    pub(crate) fn reaction(&self, f: &[f64]) -> f64 {
        let mut held = vec![0.0; f.len()];
        self.add_forces(&mut held);
        let n = f.len() / 3;
        let met = (0..n).map(|i| [row(&held, n, i), row(f, n, i)].map(|force| force.norm()));
        let met = met.filter(|[held, _]| *held > 0.0);
        met.map(|[held, driven]| held.max(driven)).sum::<f64>() * self.impulses.1
    }

    /// Forgets the impulses of the last step, because the state is no longer that at its end.
    pub(crate) fn forget_impulses(&mut self) {
        self.impulses.0.clear();
    }

    /// Resolves the contacts of a step of h (s) from time t (s) to y1, as [`resolve`] does, with
    /// constraints that pass impulses on.
    pub(crate) fn resolve(
        &mut self,
        obstacles: &[Obstacle],
        bodies: Bodies,
        Interval { t, h }: Interval,
        y1: &mut [f64],
    ) -> Statistics {
        let step = Step { t, h, y0: &self.y0 };
        let (impulses, length) = &mut self.impulses;
        *length = h;
        let Struck { particles: struck, impulse, held } = &mut self.struck;
        struck.sort_unstable();
        let masses = Masses { inverse: bodies.inverse_masses, struck, rebound: !bodies.are_struck };
        if !bodies.are_struck {
            self.rubs.clear();
        }
        let mut last = Statistics::default();
        let noted = &mut Noted {
            statistics: &mut last,
            impulses,
            rebounds: &mut self.rebounds,
            joints: bodies.joints.filter(|_| y1.len() == 6 * bodies.inverse_masses.len()),
            held: &mut self.held,
            rubs: &mut self.rubs,
        };
        resolve_noting(obstacles, &masses, &step, y1, noted);
        let held = std::mem::take(held);
        if !(held.is_empty() && noted.held.is_empty()) {
            noted.held.extend(touching(obstacles, noted, &masses, &step, y1));
        }
        pass_on(noted, held, (bodies.inverse_masses, &step), y1);
        last.impulse += std::mem::take(impulse);
        struck.clear();
        self.rebounds.sort_unstable_by(f64::total_cmp);
        self.rebounds.dedup_by(|later, share| *later - *share <= SIMULTANEOUS_SHARE);
        let few = self.rebounds.len() <= MAX_REBOUNDS;
        last.rebound = self.rebounds.first().copied().filter(|_| few);
        self.last = last;
        self.last
    }

    /// Applies impacts to particles that touch an obstacle and approach it at time t (s), at the
    /// end of a step of h (s), and moves them to its surface. Distances up to `none` (m) count as
    /// zero. `left_out` returns the height (m) up to which rebounds of a restitution at a
    /// place (m) do not begin.
    pub(crate) fn strike(
        &mut self,
        obstacles: &[Obstacle],
        bodies: Bodies,
        (t, h): (f64, f64),
        (none, left_out): (f64, &dyn Fn(f64, Vector3<f64>) -> f64),
        y1: &mut [f64],
    ) {
        let inverse_masses = bodies.inverse_masses;
        let n = inverse_masses.len();
        let mut statistics = Statistics::default();
        let noted = &mut Noted {
            statistics: &mut statistics,
            impulses: &mut self.impulses.0,
            rebounds: &mut self.rebounds,
            joints: bodies.joints.filter(|_| y1.len() == 6 * n),
            held: &mut self.struck.held,
            rubs: &mut self.rubs,
        };
        noted.held.clear();
        let (x, v) = y1.split_at_mut(3 * n);
        for (number, obstacle) in obstacles.iter().enumerate() {
            let pose = obstacle.at(t);
            for i in (0..n).filter(|i| inverse_masses[*i] > 0.0) {
                let d = row(x, n, i) - pose.place.position;
                let seen = obstacle.shape.separation(pose.inwards(d));
                if seen.distance.abs() > none {
                    continue;
                }
                let normal = pose.outwards(seen.normal);
                let point = d - normal * seen.distance;
                let carried = velocity(&pose, point);
                let relative = row(v, n, i) - carried;
                let approach = -relative.dot(&normal);
                if approach <= 0.0 {
                    continue;
                }
                let begun = self.y0.get(3 * n..6 * n).map_or(row(v, n, i), |v0| row(v0, n, i));
                let press = ((begun - row(v, n, i)).dot(&normal) / h).max(0.0);
                let height = left_out(obstacle.restitution, row(x, n, i));
                let shortest = shortest_rebound(press, [height, 0.0]);
                let speed = rebound_speed(obstacle.restitution, approach, press, shortest);
                set_row(x, n, i, pose.place.position + point);
                self.struck.particles.push(i);
                if noted.is_held(i) {
                    noted.held.push(PointImpact {
                        particle: i,
                        obstacle: number,
                        normal,
                        push: normal,
                        least: LeastSpeed::of_impact(relative, speed, obstacle.friction),
                        carried,
                        share: 1.0,
                        left: 0.0,
                    });
                    continue;
                }
                let change = change_in_impact(relative, normal, speed, obstacle.friction);
                set_row(v, n, i, row(v, n, i) + change);
                noted.add_contact(i, change / inverse_masses[i]);
            }
        }
        self.struck.impulse += statistics.impulse;
    }

    /// Applies the collision safeguard to the surfaces in a step of h (s) from time t (s) to y1.
    ///
    /// # Errors
    /// Kinematic vertices leave no room.
    pub(crate) fn guard(
        &mut self,
        layer: &ContactLayer,
        bodies: Bodies,
        Interval { t, h }: Interval,
        y1: &mut [f64],
    ) -> Result<Statistics, Pinched> {
        let (impulses, length) = &mut self.impulses;
        *length = h;
        let mut guarded = guard(layer, bodies, Interval { t, h }, &self.y0, y1, impulses)?;
        self.last = Statistics {
            contacts: guarded.impulses,
            impulse: guarded.impulse,
            missed: std::mem::take(&mut guarded.missed),
            guarded,
            ..Statistics::default()
        };
        Ok(self.last)
    }
}

/// Moves the particles of y1 = [x | v], the end of a step, out of the obstacles, one obstacle after
/// another, and applies contact and friction to their velocities. Pinned particles, whose inverse
/// mass (1/kg) is 0, do not move. Does nothing where nothing touches.
pub fn resolve(
    obstacles: &[Obstacle],
    inverse_masses: &[f64],
    step: &Step,
    y1: &mut [f64],
) -> Statistics {
    let masses = Masses { inverse: inverse_masses, struck: &[], rebound: true };
    let mut statistics = Statistics::default();
    let noted = &mut Noted {
        statistics: &mut statistics,
        impulses: &mut Impulses::default(),
        rebounds: &mut vec![],
        joints: None,
        held: &mut vec![],
        rubs: &mut vec![],
    };
    resolve_noting(obstacles, &masses, step, y1, noted);
    statistics
}

/// Particles of a step.
struct Masses<'a> {
    /// Inverse masses (1/kg).
    inverse: &'a [f64],
    /// Particles that were struck at the end of the step, in order.
    struck: &'a [usize],
    /// Whether particles rebound within the step.
    rebound: bool,
}

/// Does what [`resolve`] does, and records the contacts.
fn resolve_noting(
    obstacles: &[Obstacle],
    masses: &Masses,
    step: &Step,
    y1: &mut [f64],
    noted: &mut Noted,
) {
    let n = masses.inverse.len();
    if masses.rebound {
        noted.impulses.clear();
    }
    noted.rebounds.clear();
    noted.held.clear();
    for (number, obstacle) in obstacles.iter().enumerate() {
        let [before, after] = obstacle.at_ends([step.t, step.t + step.h]);
        let met = Met {
            x0: step.y0.get(..3 * n),
            v0: step.y0.get(3 * n..6 * n),
            inverse_masses: masses.inverse,
            struck: masses.struck,
            obstacle,
            number,
            friction: obstacle.friction,
            restitution: if masses.rebound { obstacle.restitution } else { 0.0 },
            span: Interval { t: step.t, h: step.h },
            before,
            after,
            // A smooth floor moves particles vertically only.
            axes: if obstacle.shape == Shape::Floor { 1..2 } else { 0..3 },
        };
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
}

/// Lists the contacts of particles that constraints hold and that are on the surface of an
/// obstacle, up to rounding, at both ends of a step. Where another particle of the same constraints
/// is struck, its impulse may press them against that surface.
fn touching(
    obstacles: &[Obstacle],
    noted: &Noted,
    masses: &Masses,
    step: &Step,
    y1: &[f64],
) -> Vec<PointImpact> {
    let n = masses.inverse.len();
    if step.y0.is_empty() {
        return vec![];
    }
    let held = (0..n).filter(|i| masses.inverse[*i] > 0.0 && noted.is_held(*i));
    let pairs = held.flat_map(|i| obstacles.iter().enumerate().map(move |it| (i, it)));
    let contacts = pairs.filter_map(|(i, (number, obstacle))| {
        let (begun, x, v) = (row(step.y0, n, i), row(y1, n, i), row(&y1[3 * n..], n, i));
        let [before, pose] = obstacle.at_ends([step.t, step.t + step.h]);
        let [d0, d] = [begun - before.place.position, x - pose.place.position];
        let near = ROUNDING * (x.norm() + d.norm()) + TOUCHING_SHARE * (x - begun).norm();
        let seen = obstacle.shape.separation(pose.inwards(d));
        let first = obstacle.shape.separation(before.inwards(d0));
        let touches = seen.distance.abs().max(first.distance.abs()) <= near;
        let (carried, normal) = (velocity(&pose, d), pose.outwards(seen.normal));
        let mean = mean_normal([before.outwards(first.normal), normal]);
        touches.then(|| PointImpact {
            particle: i,
            obstacle: number,
            normal,
            push: mean.map_or(normal, |mean| mean / mean.dot(&normal)),
            least: LeastSpeed {
                begun: across(row(&step.y0[3 * n..], n, i) - velocity(&before, d0), normal),
                ..LeastSpeed::of_impact(v - carried, 0.0, obstacle.friction)
            },
            carried,
            share: MIDDLE,
            left: 0.0,
        })
    });
    contacts.collect()
}
