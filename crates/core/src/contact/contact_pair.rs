//! Contact of a pair in the collision safeguard: impulses along the normal, and Coulomb friction.

use nalgebra::{Matrix3, Vector3};

use super::listing::Candidate;
use super::motion::Motion;
use super::obstacle::{RESTORED_SHARE, change_in_impact};
use super::skin::Law;
use super::solids::{Arm, Field, Masses, SAME_TOLERANCE, Solid};
use super::surface::Surface;
use crate::error::Vertex;
use crate::geometry::{PairKind, weighted};

/// Contact of a pair: the weights of its closest points, the normal from the second primitive to
/// the first, and the sum of the weighted inverse masses (1/kg).
pub(super) struct ContactPair {
    pub points: [u32; 4],
    pub weights: [f64; 4],
    pub normal: Vector3<f64>,
    /// Change of the relative velocity along the normal by an impulse along it (1/kg).
    pub inverse_mass: f64,
    /// Displacement (m) by which the primitives should separate in the step.
    pub wanted: f64,
    /// In a box, so that the contacts of cloth, which have none, are small.
    rigid: Option<Box<RigidContact>>,
}

/// Contact with a rigid body on at least one side, whose mobility depends on the direction.
struct RigidContact {
    arms: [Option<Arm>; 2],
    /// Change of the relative velocity of the closest points by an impulse (1/kg), and the inverse.
    mobility: Matrix3<f64>,
    inverse: Matrix3<f64>,
    rolling: Option<Rolling>,
}

/// Resistance of a contact to turns of one side relative to the other.
struct Rolling {
    /// Largest angular impulse (N m s).
    most: f64,
    /// Angular impulse that stops a relative angular velocity: a matrix (kg m2).
    inertia: Matrix3<f64>,
    /// Angular velocity of an obstacle, with the sign of its side (rad/s).
    obstacle: Vector3<f64>,
}

impl ContactPair {
    pub fn new(
        surface: &Surface,
        candidate: &Candidate,
        weights: [f64; 4],
        normal: Vector3<f64>,
        motion: &Motion,
    ) -> Self {
        let points = candidate.points;
        let inverse_masses = points.map(|i| motion.inverse_masses[i as usize]);
        let terms = weights.iter().zip(inverse_masses).map(|(w, m)| w * w * m);
        let mut contact = Self {
            points,
            weights,
            normal,
            inverse_mass: terms.sum(),
            wanted: 0.0,
            rigid: None,
        };
        if !motion.solids.is_empty() {
            contact.find_arms(surface, candidate.kind, motion);
        }
        contact
    }

    /// Lets rigid bodies separate by a tenth of the distance that they lack. Nothing else would
    /// restore what they lose in each step under pressure.
    pub fn restore_separation(&mut self, law: Law, distance: f64) {
        if self.rigid.is_some() {
            self.wanted = RESTORED_SHARE * (law.max_kept() - distance).max(0.0);
        }
    }

    fn find_arms(&mut self, surface: &Surface, kind: PairKind, motion: &Motion) {
        let first = kind.first();
        let side = |from: usize, to: usize, sign: f64| {
            let side = (&self.points[from..to], &self.weights[from..to]);
            Solid::arm(surface, &motion.solids, side, self.normal, sign)
        };
        let last = if kind == PairKind::VertexFloor { 2 } else { 4 };
        let arms = [side(0, first, 1.0), side(first, last, -1.0)];
        if arms.iter().all(Option::is_none) {
            return;
        }
        let mut mobility = Matrix3::identity() * self.inverse_mass;
        for arm in arms.iter().flatten() {
            mobility += motion.solids[arm.solid].mobility(arm);
        }
        self.inverse_mass = self.normal.dot(&(mobility * self.normal));
        // Sides that cannot move along the normal get no impulse.
        let inverse = mobility.try_inverse().unwrap_or_default();
        self.rigid = Some(Box::new(RigidContact {
            arms,
            mobility,
            inverse,
            rolling: None,
        }));
    }

    /// Lets the contact resist turns by an angular impulse of at most `most` (N m s).
    pub fn resist_turns(&mut self, most: f64, surface: &Surface, motion: &Motion) {
        let Some(rigid) = self.rigid.as_mut().filter(|_| most > 0.0) else {
            return;
        };
        let arms = rigid.arms.iter().flatten();
        let yields = arms.fold(Matrix3::zeros(), |sum, arm| {
            sum + arm.inverse_inertia(&motion.solids)
        });
        let spin = |i: u32| match surface.vertex(i) {
            Vertex::Obstacle(k) => motion.spins[k],
            _ => Vector3::zeros(),
        };
        rigid.rolling = Some(Rolling {
            most,
            inertia: yields.try_inverse().unwrap_or_default(),
            obstacle: spin(self.points[0]) - spin(self.points[3]),
        });
    }

    /// Adds the resistance to turns of a contact at the same point.
    pub fn add_resistance(&mut self, other: &Self) {
        let others = other
            .rigid
            .as_ref()
            .and_then(|rigid| rigid.rolling.as_ref());
        let own = self.rigid.as_mut().and_then(|rigid| rigid.rolling.as_mut());
        if let (Some(own), Some(other)) = (own, others) {
            own.most += other.most;
        }
    }

    /// Returns the angular impulse (N m s) that stops the relative turn in a span of time (s, or 1
    /// for velocities), and the largest one; none if the contact does not resist turns.
    pub fn turning(&self, field: &Field, span: f64) -> Option<(Vector3<f64>, f64)> {
        let rolling = self.rigid.as_ref()?.rolling.as_ref()?;
        let turned = self
            .arms()
            .fold(rolling.obstacle * span, |sum, arm| sum + arm.turn(field));
        Some((-(rolling.inertia * turned), rolling.most))
    }

    /// Gives the first side an angular impulse (N m s), and the opposite to the second.
    pub fn spin(&self, impulse: Vector3<f64>, masses: Masses, field: &mut Field) {
        for arm in self.arms() {
            arm.spin(impulse, masses.solids, field);
        }
    }

    /// Returns the relative vector of the closest points.
    fn relative(&self, field: &Field) -> Vector3<f64> {
        let relative = weighted(&self.weights, &self.points.map(|i| field[i as usize]));
        self.arms()
            .fold(relative, |sum, arm| sum + arm.beyond_points(field))
    }

    /// Returns the arms at rigid bodies.
    fn arms(&self) -> impl Iterator<Item = &Arm> {
        let arms = self.rigid.as_ref().map(|rigid| rigid.arms.iter());
        arms.into_iter().flatten().flatten()
    }

    /// Returns whether a side is a rigid body.
    pub fn is_rigid(&self) -> bool {
        self.rigid.is_some()
    }

    /// Returns the numbers of the rigid bodies that touch.
    pub fn solids(&self) -> impl Iterator<Item = usize> {
        self.arms().map(|arm| arm.solid)
    }

    /// Returns the arms, if both sides are rigid bodies.
    pub fn both_arms(&self) -> Option<[Arm; 2]> {
        let [first, second] = self.rigid.as_ref()?.arms;
        Some([first?, second?])
    }

    /// Returns whether impulses at this contact have the same effect on two rigid bodies as those
    /// at another.
    pub fn is_at(&self, other: &Self) -> bool {
        let arms = self.both_arms().zip(other.both_arms());
        arms.is_some_and(|(own, others)| {
            let mut both = own.iter().zip(&others);
            (self.normal - other.normal).norm() < SAME_TOLERANCE && both.all(|(a, b)| a.is_at(b))
        })
    }

    /// Returns the component, perpendicular to the normal, of the relative vector of the closest
    /// points.
    pub fn slip(&self, field: &Field) -> Vector3<f64> {
        let relative = self.relative(field);
        relative - self.normal * relative.dot(&self.normal)
    }

    /// Returns the change of the relative velocity along a direction by an impulse along it (1/kg).
    pub fn mobility(&self, direction: Vector3<f64>) -> f64 {
        let squared = direction.norm_squared();
        match &self.rigid {
            Some(rigid) if squared > 0.0 => direction.dot(&(rigid.mobility * direction)) / squared,
            _ => self.inverse_mass,
        }
    }

    /// Changes the relative vector of the closest points by `change`, along it.
    pub fn apply(&self, change: Vector3<f64>, masses: Masses, field: &mut Field) {
        self.push(change / self.mobility(change), masses, field);
    }

    /// Gives the first primitive an impulse (N s), and the opposite to the second. The points of
    /// rigid bodies must be settled afterwards.
    pub fn push(&self, impulse: Vector3<f64>, masses: Masses, field: &mut Field) {
        for (i, weight) in self.points.iter().zip(self.weights) {
            let i = *i as usize;
            if masses.inverse[i] > 0.0 && weight != 0.0 {
                field[i] += impulse * (weight * masses.inverse[i]);
            }
        }
        for arm in self.arms() {
            masses.solids[arm.solid].push(arm, impulse, field);
        }
    }

    /// Returns whether the closest points do not approach.
    pub fn parts(&self, field: &Field) -> bool {
        self.relative(field).dot(&self.normal) >= 0.0
    }

    /// Stops an approach, so that the primitives separate by `wanted`, and slip by friction, at
    /// most mu times as much. Returns the impulse on the first primitive (N s).
    pub fn stop(
        &self,
        friction: f64,
        wanted: f64,
        masses: Masses,
        field: &mut Field,
    ) -> Vector3<f64> {
        let relative = self.relative(field) - self.normal * wanted;
        let approach = -relative.dot(&self.normal);
        if approach <= 0.0 {
            return Vector3::zeros();
        }
        if let Some(rigid) = &self.rigid {
            let impulse = self.rigid_impulse(rigid, friction, relative);
            self.push(impulse, masses, field);
            for arm in self.arms() {
                masses.solids[arm.solid].settle(arm.solid, field);
            }
            return impulse;
        }
        let change = change_in_impact(relative, self.normal, 0.0, friction);
        let impulse = change / self.inverse_mass;
        self.push(impulse, masses, field);
        impulse
    }

    /// Returns the impulse that stops approach and slip or, if friction is not large enough for
    /// that, the approach alone (Guendelman, Bridson, Fedkiw, *Nonconvex rigid bodies with
    /// stacking*, 2003).
    fn rigid_impulse(
        &self,
        rigid: &RigidContact,
        friction: f64,
        relative: Vector3<f64>,
    ) -> Vector3<f64> {
        let normal = self.normal;
        let sticking = -(rigid.inverse * relative);
        let pressed = sticking.dot(&normal);
        let across = sticking - normal * pressed;
        if pressed > 0.0 && across.norm() <= friction * pressed {
            return sticking;
        }
        let slip = relative - normal * relative.dot(&normal);
        let along = slip.try_normalize(0.0).unwrap_or_default();
        let direction = normal - along * friction;
        let stopped = normal.dot(&(rigid.mobility * direction));
        // Friction that would make the bodies approach is left out.
        let direction = if stopped > 0.1 * self.inverse_mass {
            direction
        } else {
            normal
        };
        direction * (-relative.dot(&normal) / normal.dot(&(rigid.mobility * direction)))
    }
}
