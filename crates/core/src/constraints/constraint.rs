//! A constraint, and its equations in a state.

use nalgebra::Vector3;

use super::joint::{Joint, JointEquation, Side, Stop, check_restitution};
use crate::error::{Error, positive};
use crate::geometry::normals;

/// Distance from the centre of a circle or a sphere, in radii, up to which the direction outwards
/// is undefined.
const CENTER_SHARE: f64 = 1e-12;

/// Share of its length by which a taut rope may be shorter, because of the errors of a method: one
/// that is shorter is slack.
pub(super) const SLACK_SHARE: f64 = 1e-3;

/// Distance from its end, over its length, at which a joint is there, and a rope is taut.
const AT_END_SHARE: f64 = 1e-9;

/// What a step of a projection changes.
#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Projected {
    /// Positions (m) and orientations (rad), by the errors of the constraints.
    Places,
    /// Velocities (m/s) and angular velocities (rad/s), by the rates of these errors.
    Velocities,
}

/// A constraint on the positions of one or two particles.
///
/// ```
/// use a3_core::{Constraint, Control, Network, Path, Scene, Simulation, Vector3, integrators};
///
/// // A pendulum on a rod of 1 m, which falls from the horizontal.
/// let mut network = Network::new(vec![1.0; 2])?;
/// network.pin(0, Path::Still(Vector3::zeros()))?;
/// network.set_gravity(Vector3::new(0.0, -9.81, 0.0));
/// network.add_constraint(Constraint::Rod { i: 0, j: 1, length: 1.0 })?;
/// let mut state = vec![0.0; 12];
/// state[1] = 1.0;
/// let rk4 = integrators::find("rk4").unwrap();
/// let mut run = Simulation::new(Scene::new("rod", network, state), rk4, Control::Step(0.001))?;
/// run.advance_to(1.0)?;
/// assert!((run.position(1).norm() - 1.0).abs() < 1e-6);
/// # Ok::<(), a3_core::Error>(())
/// ```
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
    /// Two particles keep their distance: a rigid rod without mass.
    Rod {
        /// Particle at one end.
        i: usize,
        /// Particle at the other end.
        j: usize,
        /// Length (m).
        length: f64,
    },
    /// Two particles are no farther apart than a length: a rope without mass.
    Rope {
        /// Particle at one end.
        i: usize,
        /// Particle at the other end.
        j: usize,
        /// Length (m).
        length: f64,
        /// Coefficient of restitution, from 0 to 1: the speed at which the ends approach after the
        /// rope has tightened, over that at which they parted before.
        restitution: f64,
    },
    /// A rigid body is joined to another one or to the world, or a particle to a body.
    Joint(Joint),
    /// A joint turns or slides only so far.
    Stop(Stop),
}

impl Constraint {
    /// Returns its particle, and the other one of a rod, a rope or a joint.
    #[must_use]
    pub fn ends(&self) -> (usize, Option<usize>) {
        match *self {
            Self::Point { particle, .. }
            | Self::Line { particle, .. }
            | Self::Circle { particle, .. }
            | Self::Sphere { particle, .. } => (particle, None),
            Self::Rod { i, j, .. } | Self::Rope { i, j, .. } => (i, Some(j)),
            Self::Joint(joint) | Self::Stop(Stop { joint, .. }) => (joint.first, joint.second),
        }
    }

    /// Returns its joint, if it is a joint or the end of one.
    pub(super) fn joint(&self) -> Option<&Joint> {
        match self {
            Self::Joint(joint) | Self::Stop(Stop { joint, .. }) => Some(joint),
            _ => None,
        }
    }

    /// Returns the number of its equations as a joint.
    pub(super) fn joint_equations(&self) -> usize {
        match self {
            Self::Joint(joint) => joint.count(),
            Self::Stop(_) => 1,
            _ => 0,
        }
    }

    /// Returns the equation of a number as a joint with these sides.
    pub(super) fn joint_equation(&self, number: usize, sides: &[Side; 2]) -> JointEquation {
        match self {
            Self::Joint(joint) => joint.equation(number, sides),
            Self::Stop(stop) => stop.equation(sides),
            _ => JointEquation::default(),
        }
    }

    /// Returns whether it is the end of a joint that is clearly away from it.
    pub(super) fn is_away(&self, equation: &JointEquation) -> bool {
        matches!(self, Self::Stop(Stop { joint, .. }) if equation.value < -SLACK_SHARE * joint.length)
    }

    /// Returns whether it is the end of a joint.
    pub(super) fn is_end(&self) -> bool {
        matches!(self, Self::Stop(_))
    }

    /// Returns whether it is a rope or the end of a joint that, with this error (m) and its rate
    /// (m/s), is passed, or will be in a moment.
    pub(super) fn is_passed(&self, [value, rate]: [f64; 2], what: Projected) -> bool {
        let (Self::Stop(Stop { restitution, .. }) | Self::Rope { restitution, .. }) = self else {
            return false;
        };
        match what {
            Projected::Places => value > 0.0,
            // An elastic one rebounds where it is passed.
            Projected::Velocities => *restitution == 0.0 && self.is_at_end(value) && rate > 0.0,
        }
    }

    /// Returns whether, with this error (m), a rope is at its length, or a joint at its end.
    pub(super) fn is_at_end(&self, value: f64) -> bool {
        let length = self.length().filter(|_| self.is_one_sided());
        length.is_some_and(|length| value > -AT_END_SHARE * length)
    }

    /// Returns whether it is a rope that is clearly shorter than its length.
    pub(super) fn is_slack(&self, equation: &Equation) -> bool {
        matches!(self, Self::Rope { length, .. } if equation.value < -SLACK_SHARE * length)
    }

    /// Returns the distance (m) that one of its equations is about; `None` for one that is linear.
    pub(super) fn distance(&self, equation: &Equation) -> Option<f64> {
        let length = match *self {
            Self::Point { .. } | Self::Line { .. } | Self::Joint(_) | Self::Stop(_) => return None,
            Self::Circle { radius, .. } | Self::Sphere { radius, .. } => radius,
            Self::Rod { length, .. } | Self::Rope { length, .. } => length,
        };
        let distance = equation.value + length;
        (distance > CENTER_SHARE * length).then_some(distance)
    }

    /// Returns whether it is a rope, which holds only while it is taut, or the end of a joint.
    pub(super) fn is_one_sided(&self) -> bool {
        matches!(self, Self::Rope { .. } | Self::Stop(_))
    }

    /// Returns the same constraint with directions of length 1, or an error if its numbers are
    /// invalid.
    pub(super) fn checked(self) -> Result<Self, Error> {
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
                check_different("rod", i, j)?;
            }
            Self::Rope { i, j, length, restitution } => {
                positive("the length of a rope", length)?;
                check_different("rope", i, j)?;
                check_restitution("a rope", restitution)?;
            }
            Self::Joint(joint) => joint.check()?,
            Self::Stop(stop) => stop.check()?,
        }
        let mut unit = self;
        if let Self::Line { direction: u, .. } | Self::Circle { normal: u, .. } = &mut unit {
            let length = u.norm();
            positive("the length of a direction", length)?;
            *u /= length;
        }
        Ok(unit)
    }

    /// Visits its equations, always the same number, where its first particle is at x with velocity
    /// v; for a rod or a rope, relative to its second particle. Those of joints are elsewhere.
    pub(super) fn equations(
        &self,
        x: Vector3<f64>,
        v: Vector3<f64>,
        mut visit: impl FnMut(Equation),
    ) {
        match *self {
            Self::Point { position, .. } => {
                for axis in [Vector3::x(), Vector3::y(), Vector3::z()] {
                    visit(Equation::plane(axis, x - position));
                }
            }
            Self::Line { point, direction, .. } => {
                for normal in normals(direction) {
                    visit(Equation::plane(normal, x - point));
                }
            }
            Self::Circle { center, normal, radius, .. } => {
                let within = |a: Vector3<f64>| a - normal * normal.dot(&a);
                visit(Equation::plane(normal, x - center));
                visit(Equation::distance(within(x - center), within(v), radius));
            }
            Self::Sphere { center, radius, .. } => {
                visit(Equation::distance(x - center, v, radius));
            }
            Self::Rod { length, .. } | Self::Rope { length, .. } => {
                visit(Equation::distance(x, v, length));
            }
            Self::Joint(_) | Self::Stop(_) => {}
        }
    }
}

/// An equation C = 0 in a state.
pub(super) struct Equation {
    /// Gradient J by the position of the first particle.
    pub gradient: Vector3<f64>,
    /// Error C (m).
    pub value: f64,
    /// Rate of change J' v of the gradient along the velocity (m/s2).
    pub bend: f64,
}

impl From<JointEquation> for Equation {
    fn from(equation: JointEquation) -> Self {
        Self { gradient: equation.gradient, value: equation.value, bend: equation.bend }
    }
}

impl Equation {
    /// normal . x = 0
    fn plane(normal: Vector3<f64>, x: Vector3<f64>) -> Self {
        Self { gradient: normal, value: normal.dot(&x), bend: 0.0 }
    }

    /// |x| = radius
    fn distance(x: Vector3<f64>, v: Vector3<f64>, radius: f64) -> Self {
        let distance = x.norm();
        let (gradient, bend) = if distance > CENTER_SHARE * radius {
            let outwards = x / distance;
            let across = v - outwards * outwards.dot(&v);
            (outwards, across.norm_squared() / distance)
        } else {
            (Vector3::zeros(), 0.0)
        };
        Self { gradient, value: distance - radius, bend }
    }
}

fn check_different(kind: &str, i: usize, j: usize) -> Result<(), Error> {
    if i != j {
        return Ok(());
    }
    Err(Error::Invalid(format!("a {kind} needs two different particles, not {i} twice")))
}

fn finite(what: &str, a: Vector3<f64>) -> Result<(), Error> {
    if a.iter().all(|a| a.is_finite()) {
        return Ok(());
    }
    let [x, y, z] = a.into();
    Err(Error::Invalid(format!("{what} must be three finite numbers, not ({x}, {y}, {z})")))
}
