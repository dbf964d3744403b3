//! Constrained dynamics: C(x) = 0 is held by forces J^T lambda, J = dC/dx, that do no work where C
//! does not move. The acceleration of a free particle is a = W (Q + J^T lambda), with the inverse
//! masses W and all other forces Q; that of a pin is the one of its path, apin. The multipliers
//! solve C'' = J a + J' v = -ks C - kd C', which takes back what a step missed, or
//! J W J^T lambda = -(J' v + J (W Q + apin) + ks C + kd C').
//! Andrew Witkin, *Physically Based Modeling: Constrained Dynamics*, SIGGRAPH course notes.
//!
//! Each row of C is a distance (m), and each row of J a unit vector, and its opposite at the other
//! end of a rod.

mod pool;
mod solve;

use std::collections::BTreeMap;

use nalgebra::Vector3;

use crate::error::{Error, positive};
use pool::Pool;
use solve::{Row, Scratch};

/// Nearer than this, in radii, to the centre of a circle or a sphere there is no way out of it to
/// be told.
const CENTER: f64 = 1e-12;

/// A constraint on the positions of one or two particles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Constraint {
    /// A particle stays at a point.
    Point {
        /// The particle.
        particle: usize,
        /// The point (m).
        position: Vector3<f64>,
    },
    /// A particle slides along a straight line.
    Line {
        /// The particle.
        particle: usize,
        /// A point of the line (m).
        point: Vector3<f64>,
        /// Direction, of any length but 0.
        direction: Vector3<f64>,
    },
    /// A particle slides along a circle: a bead on a wire.
    Circle {
        /// The particle.
        particle: usize,
        /// Centre (m).
        center: Vector3<f64>,
        /// Normal of the circle's plane, of any length but 0.
        normal: Vector3<f64>,
        /// Radius (m).
        radius: f64,
    },
    /// A particle slides over a sphere, and does not leave it.
    Sphere {
        /// The particle.
        particle: usize,
        /// Centre (m).
        center: Vector3<f64>,
        /// Radius (m).
        radius: f64,
    },
    /// Two particles stay as far from one another: a rigid rod without mass.
    Rod {
        /// Particle at one end.
        i: usize,
        /// Particle at the other end.
        j: usize,
        /// Length (m).
        length: f64,
    },
}

impl Constraint {
    /// Its particle, and the other one of a rod.
    #[must_use]
    pub fn ends(&self) -> (usize, Option<usize>) {
        match *self {
            Self::Point { particle, .. }
            | Self::Line { particle, .. }
            | Self::Circle { particle, .. }
            | Self::Sphere { particle, .. } => (particle, None),
            Self::Rod { i, j, .. } => (i, Some(j)),
        }
    }

    /// The same constraint with directions of length 1, or an error if its numbers make no sense.
    fn checked(self) -> Result<Self, Error> {
        match self {
            Self::Point { position, .. } => finite("a constraint's point", position)?,
            Self::Line { point, .. } => finite("a point of a line", point)?,
            Self::Circle { center, radius, .. } => {
                finite("the centre of a circle", center)?;
                positive("the radius of a circle", radius)?;
            }
            Self::Sphere { center, radius, .. } => {
                finite("the centre of a sphere", center)?;
                positive("the radius of a sphere", radius)?;
            }
            Self::Rod { i, j, length } => {
                positive("the length of a rod", length)?;
                if i == j {
                    return Err(Error::Invalid(format!(
                        "a rod needs two different particles, not {i} twice"
                    )));
                }
            }
        }
        let mut unit = self;
        if let Self::Line { direction: u, .. } | Self::Circle { normal: u, .. } = &mut unit {
            let length = u.norm();
            positive("the length of a direction", length)?;
            *u /= length;
        }
        Ok(unit)
    }

    /// Visits its equations, always as many, where its first particle is at x and moves with v;
    /// those of a rod relative to its second particle.
    fn equations(&self, x: Vector3<f64>, v: Vector3<f64>, mut visit: impl FnMut(Equation)) {
        match *self {
            Self::Point { position, .. } => {
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    visit(Equation::plane(axis, x - position));
                }
            }
            Self::Line {
                point, direction, ..
            } => {
                for normal in normals(direction) {
                    visit(Equation::plane(normal, x - point));
                }
            }
            Self::Circle {
                center,
                normal,
                radius,
                ..
            } => {
                let within = |a: Vector3<f64>| a - normal * normal.dot(&a);
                visit(Equation::plane(normal, x - center));
                visit(Equation::distance(within(x - center), within(v), radius));
            }
            Self::Sphere { center, radius, .. } => {
                visit(Equation::distance(x - center, v, radius));
            }
            Self::Rod { length, .. } => visit(Equation::distance(x, v, length)),
        }
    }
}

/// An equation C = 0 in a state.
struct Equation {
    /// Gradient J by the position of the first particle.
    gradient: Vector3<f64>,
    /// Error C (m).
    value: f64,
    /// Change J' v of the gradient (m/s2).
    bend: f64,
}

impl Equation {
    /// normal . x = 0
    fn plane(normal: Vector3<f64>, x: Vector3<f64>) -> Self {
        Self {
            gradient: normal,
            value: normal.dot(&x),
            bend: 0.0,
        }
    }

    /// |x| = radius
    fn distance(x: Vector3<f64>, v: Vector3<f64>, radius: f64) -> Self {
        let distance = x.norm();
        let (gradient, bend) = if distance > CENTER * radius {
            let outwards = x / distance;
            let across = v - outwards * outwards.dot(&v);
            (outwards, across.norm_squared() / distance)
        } else {
            (Vector3::zeros(), 0.0)
        };
        Self {
            gradient,
            value: distance - radius,
            bend,
        }
    }
}

/// All constraints of a network.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    all: Vec<Constraint>,
    /// The particles that are held, each once: evaluations take time by their number, not by that
    /// of all particles.
    particles: Vec<usize>,
    /// The place of each particle that is held among these, from 1 on.
    places: BTreeMap<usize, usize>,
    /// For each constraint the places of its particles among these, from 1 on; 0 is a particle that
    /// nothing moves.
    ends: Vec<[usize; 2]>,
    /// Number of equations.
    rows: usize,
    /// Natural frequency (1/s) with which errors are taken back.
    baumgarte_frequency: f64,
    /// Scratch of evaluations, no part of the value.
    scratch: Pool,
}

impl Default for Constraints {
    fn default() -> Self {
        Self {
            all: vec![],
            particles: vec![],
            places: BTreeMap::new(),
            ends: vec![],
            rows: 0,
            baumgarte_frequency: 10.0,
            scratch: Pool::default(),
        }
    }
}

impl Constraints {
    /// Adds a constraint whose particles exist.
    pub fn add(&mut self, constraint: Constraint) -> Result<(), Error> {
        let constraint = constraint.checked()?;
        let (first, second) = constraint.ends();
        let mut end = |particle| {
            *self.places.entry(particle).or_insert_with(|| {
                self.particles.push(particle);
                self.particles.len()
            })
        };
        self.ends.push([end(first), second.map_or(0, end)]);
        constraint.equations(Vector3::zeros(), Vector3::zeros(), |_| self.rows += 1);
        self.all.push(constraint);
        self.scratch.reserve(self.rows, self.particles.len() + 1);
        Ok(())
    }

    /// All constraints, in the order in which they were added.
    pub fn all(&self) -> &[Constraint] {
        &self.all
    }

    /// Natural frequency (1/s) with which errors are taken back.
    pub fn baumgarte_frequency(&self) -> f64 {
        self.baumgarte_frequency
    }

    /// Sets the natural frequency (1/s) with which errors are taken back.
    pub fn set_baumgarte_frequency(&mut self, w: f64) -> Result<(), Error> {
        positive("the feedback of constraints", w)?;
        self.baumgarte_frequency = w;
        Ok(())
    }

    /// The largest error |C| (m).
    pub fn error(&self, x: &[f64]) -> Option<f64> {
        let mut largest = None;
        for constraint in &self.all {
            let (first, second) = constraint.ends();
            let from = second.map_or_else(Vector3::zeros, |j| vector(x, j));
            constraint.equations(vector(x, first) - from, Vector3::zeros(), |equation| {
                largest = Some(equation.value.abs().max(largest.unwrap_or(0.0)));
            });
        }
        largest
    }

    /// Adds J^T lambda (N) to all other forces: on pinned particles too, whose accelerations (m/s2)
    /// are asked for.
    pub fn add_forces(
        &self,
        inverse_masses: &[f64],
        pin: impl Fn(usize) -> Vector3<f64>,
        [x, v]: [&[f64]; 2],
        f: &mut [f64],
    ) {
        self.scratch.lend(|scratch| {
            let Scratch {
                weights,
                vectors,
                rows,
            } = scratch;
            weights.clear();
            vectors.clear();
            rows.clear();
            weights.push(0.0);
            vectors.push(Vector3::zeros());
            for &i in &self.particles {
                let w = inverse_masses[i];
                weights.push(w);
                vectors.push(if w == 0.0 { pin(i) } else { vector(f, i) * w });
            }
            let w = self.baumgarte_frequency;
            let (ks, kd) = (w * w, 2.0 * w);
            for (constraint, &[first, second]) in self.all.iter().zip(&self.ends) {
                let relative = |a: &[f64]| match constraint.ends() {
                    (i, Some(j)) => vector(a, i) - vector(a, j),
                    (i, None) => vector(a, i),
                };
                let (x, v) = (relative(x), relative(v));
                let a = vectors[first] - vectors[second];
                let weight = weights[first] + weights[second];
                constraint.equations(x, v, |equation| {
                    let Equation {
                        gradient,
                        value,
                        bend,
                    } = equation;
                    let wanted = -bend - gradient.dot(&a) - ks * value - kd * gradient.dot(&v);
                    rows.push(Row::new([first, second], gradient, weight, wanted));
                });
            }
            solve::solve(rows, weights, vectors);
            solve::transpose(rows, |row| row.multiplier, vectors);
            let n = f.len() / 3;
            for (&i, force) in self.particles.iter().zip(&vectors[1..]) {
                for axis in 0..3 {
                    f[axis * n + i] += force[axis];
                }
            }
        });
    }
}

/// The row of particle i.
fn vector(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}

/// Two unit vectors, at right angles to a third and to one another.
fn normals(direction: Vector3<f64>) -> [Vector3<f64>; 2] {
    let mut axis = Vector3::zeros();
    axis[direction.iamin()] = 1.0;
    let first = direction.cross(&axis).normalize();
    [first, direction.cross(&first)]
}

fn finite(what: &str, a: Vector3<f64>) -> Result<(), Error> {
    if a.iter().all(|a| a.is_finite()) {
        return Ok(());
    }
    let [x, y, z] = a.into();
    Err(Error::Invalid(format!(
        "{what} must be three finite numbers, not ({x}, {y}, {z})"
    )))
}
