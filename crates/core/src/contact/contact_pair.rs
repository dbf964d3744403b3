//! Contact of a pair in the collision safeguard: what an impulse changes, and the impulse with the
//! speed of separation and Coulomb friction that it has to have.

use std::ops::Range;

use nalgebra::{Matrix3, Vector3};

use super::impulse::{across, change_in_impact, friction, limited_to, restored};
use super::listing::Candidate;
use super::motion::Motion;
use super::response::{JoinedBodies, Response};
use super::skin::Law;
use super::solids::{Arm, Field, SAME_TOLERANCE, Solid};
use super::surface::Surface;
use crate::error::Vertex;
use crate::geometry::weighted;

/// Mobility that constraints leave, over that without them, below which it is a rounding error.
const LEAST_MOBILITY: f64 = 1e-12;

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
    directed: Option<Box<Directed>>,
}

/// Mobility of a contact that depends on the direction: with a rigid body on at least one side, or
/// with constraints that pass impulses on.
struct Directed {
    arms: [Option<Arm>; 2],
    /// Change of the relative velocity of the closest points by an impulse (1/kg).
    mobility: Matrix3<f64>,
    rolling: Option<Rolling>,
    /// Direction of the impulse of a frictionless contact, if it is not the normal. Its component
    /// along the normal is 1.
    push: Option<Vector3<f64>>,
    /// Changes by impulses in all directions that matter, if constraints pass them on.
    responses: Vec<Response>,
}

/// Resistance of a contact to turns of one side relative to the other.
struct Rolling {
    /// Largest angular impulse (N m s).
    most: f64,
    /// Angular impulse that stops a relative angular velocity: a matrix (kg m2).
    inertia: Matrix3<f64>,
    /// Angular velocity of an obstacle, with the sign of its side (rad/s).
    obstacle: Vector3<f64>,
    /// Changes by angular impulses about all axes, if constraints pass them on.
    responses: Vec<Response>,
}

impl Rolling {
    /// Lets constraints pass angular impulses on.
    fn join(&mut self, joined: JoinedBodies, solids: &[Solid], arms: &[Option<Arm>; 2]) {
        let arms = || arms.iter().flatten();
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        self.responses = axes.map(|axis| Response::to_turn(joined, solids, axis, arms())).into();
        let turned = self.responses.iter().zip(axes).map(|(response, axis)| {
            let mut field = Field::still(joined.y.len(), solids.len());
            response.push(axis, &mut field);
            arms().fold(Vector3::zeros(), |sum, arm| sum + arm.turn(&field))
        });
        let yields = Matrix3::from_columns(&turned.collect::<Vec<_>>());
        // A body on a hinge turns about one axis only: the matrix has no inverse.
        let least = LEAST_MOBILITY * yields.norm();
        self.inertia = yields.pseudo_inverse(least).unwrap_or_default();
    }
}

impl ContactPair {
    /// Returns the contact of a pair with these weights of its closest points at the end of a step.
    pub fn new(
        surface: &Surface,
        candidate: &Candidate,
        weights: [f64; 4],
        normal: Vector3<f64>,
        motion: &Motion,
    ) -> Self {
        let points = candidate.points;
        let arm = |side: Range<usize>, sign: f64| {
            let side = (&points[side.clone()], &weights[side]);
            Solid::arm(surface, &motion.solids, side, normal, sign)
        };
        let [first, second] = candidate.kind.sides();
        let arms = [arm(first, 1.0), arm(second, -1.0)];
        Self::with_arms((points, weights), normal, &motion.inverse_masses, &arms)
    }

    /// Returns the contact of points with these weights, and of these sides that are rigid bodies,
    /// whose points have no masses of their own (1/kg).
    pub fn with_arms(
        (points, weights): ([u32; 4], [f64; 4]),
        normal: Vector3<f64>,
        inverse_masses: &[f64],
        arms: &[Option<Arm>; 2],
    ) -> Self {
        let terms = weights.iter().zip(points);
        let terms = terms.map(|(weight, i)| weight * weight * inverse_masses[i as usize]);
        let mut contact = Self {
            points,
            weights,
            normal,
            inverse_mass: terms.sum(),
            wanted: 0.0,
            directed: None,
        };
        if arms.iter().any(Option::is_some) {
            let mut mobility = Matrix3::identity() * contact.inverse_mass;
            for arm in arms.iter().flatten() {
                mobility += arm.mobility();
            }
            contact.inverse_mass = normal.dot(&(mobility * normal));
            contact.directed = Some(Box::new(Directed {
                arms: *arms,
                mobility,
                rolling: None,
                push: None,
                responses: vec![],
            }));
        }
        contact
    }

    /// Lets constraints pass impulses on, if they hold something that is struck: particles with
    /// these inverse masses (1/kg), or bodies.
    pub fn join(
        &mut self,
        joined: JoinedBodies,
        is_smooth: bool,
        inverse_masses: &[f64],
        solids: &[Solid],
    ) {
        let holds = |i: usize| joined.joints.hold(i);
        let pushed = self.points.iter().zip(self.weights);
        let pushed = pushed.map(|(i, weight)| {
            let i = *i as usize;
            (i, weight * inverse_masses[i])
        });
        let pushed = pushed.filter(|(_, share)| *share != 0.0);
        let is_held = self.arms().any(|arm| holds(solids[arm.solid].center))
            || pushed.clone().any(|(i, _)| holds(i));
        if !is_held {
            return;
        }
        let across = self.normal.cross(&Vector3::ith(self.normal.iamin(), 1.0));
        let across = across.normalize();
        let mut all = vec![self.normal];
        if !is_smooth {
            all.extend([across, self.normal.cross(&across)]);
        }
        let mut mobility = Matrix3::zeros();
        let mut responses = vec![];
        for direction in all {
            let own = pushed.clone().map(|(i, share)| (i, direction * share));
            let response = Response::new(joined, solids, direction, self.arms(), own);
            let mut field = Field::still(inverse_masses.len(), solids.len());
            response.push(direction, &mut field);
            mobility += self.relative(&field) * direction.transpose();
            responses.push(response);
        }
        let left = self.normal.dot(&(mobility * self.normal));
        let is_free = left > LEAST_MOBILITY * self.inverse_mass;
        self.inverse_mass = if is_free { left } else { 0.0 };
        let arms = self.both_arms();
        let mut rolling = self.directed.take().and_then(|directed| directed.rolling);
        if let Some(rolling) = &mut rolling {
            rolling.join(joined, solids, &arms);
        }
        self.directed = Some(Box::new(Directed { arms, mobility, rolling, push: None, responses }));
    }

    /// Sets the direction of the impulse of a frictionless contact; its component along the normal
    /// is 1. The contact must be [joined](Self::join), and not as a smooth one.
    pub fn push_along(&mut self, push: Vector3<f64>) {
        if let Some(directed) = self.directed.as_mut().filter(|_| push != self.normal) {
            directed.push = Some(push);
            let left = self.normal.dot(&(directed.mobility * push));
            self.inverse_mass = if self.inverse_mass > 0.0 { left.max(0.0) } else { 0.0 };
        }
    }

    /// Lets rigid bodies get back a part of the separation that they lack.
    pub fn restore_separation(&mut self, law: Law, distance: f64) {
        if self.is_rigid() {
            self.wanted = restored(&law, distance);
        }
    }

    /// Lets the contact resist turns by an angular impulse of at most `most` (N m s).
    pub fn resist_turns(&mut self, most: f64, surface: &Surface, motion: &Motion) {
        let Some(directed) = self.directed.as_mut().filter(|_| most > 0.0) else {
            return;
        };
        let arms = directed.arms.iter().flatten();
        let yields = arms.fold(Matrix3::zeros(), |sum, arm| sum + arm.inverse_inertia);
        let spin = |i: u32| match surface.vertex(i) {
            Vertex::Obstacle(k) => motion.spins[k],
            _ => Vector3::zeros(),
        };
        directed.rolling = Some(Rolling {
            most,
            inertia: yields.try_inverse().unwrap_or_default(),
            obstacle: spin(self.points[0]) - spin(self.points[3]),
            responses: vec![],
        });
    }

    /// Adds the resistance to turns of a contact at the same point.
    pub fn add_resistance(&mut self, other: &Self) {
        let other = other.directed.as_ref().and_then(|it| it.rolling.as_ref());
        let own = self.directed.as_mut().and_then(|it| it.rolling.as_mut());
        if let (Some(own), Some(other)) = (own, other) {
            own.most += other.most;
        }
    }

    /// Returns the angular impulse (N m s) that stops the relative turn in a span of time (s, or 1
    /// for velocities), and the largest one; none if the contact does not resist turns.
    pub fn turning(&self, field: &Field, span: f64) -> Option<(Vector3<f64>, f64)> {
        let rolling = self.directed.as_ref()?.rolling.as_ref()?;
        let turned = self.arms().fold(rolling.obstacle * span, |sum, arm| sum + arm.turn(field));
        Some((-(rolling.inertia * turned), rolling.most))
    }

    /// Gives the first side an angular impulse (N m s), and the opposite to the second.
    pub fn spin(&self, impulse: Vector3<f64>, field: &mut Field) {
        let rolling = self.directed.as_ref().and_then(|it| it.rolling.as_ref());
        let responses = rolling.map_or(&[][..], |rolling| &rolling.responses);
        for response in responses {
            response.push(impulse, field);
        }
        for arm in self.arms().filter(|_| responses.is_empty()) {
            arm.spin(impulse, field);
        }
    }

    /// Returns the relative vector of the closest points.
    pub fn relative(&self, field: &Field) -> Vector3<f64> {
        let relative = weighted(&self.weights, &self.points.map(|i| field[i as usize]));
        self.arms().fold(relative, |sum, arm| sum + arm.beyond_points(field))
    }

    /// Returns the arms at rigid bodies.
    fn arms(&self) -> impl Iterator<Item = &Arm> {
        let arms = self.directed.as_ref().map(|directed| directed.arms.iter());
        arms.into_iter().flatten().flatten()
    }

    /// Returns the arm of each side that is a rigid body.
    pub fn both_arms(&self) -> [Option<Arm>; 2] {
        let directed = self.directed.as_ref();
        directed.map_or([None; 2], |directed| directed.arms)
    }

    /// Returns whether a side is a rigid body.
    pub fn is_rigid(&self) -> bool {
        self.arms().next().is_some()
    }

    /// Returns whether its mobility depends on the direction.
    pub fn is_directed(&self) -> bool {
        self.directed.is_some()
    }

    /// Returns the numbers of the rigid bodies that touch.
    pub fn solids(&self) -> impl Iterator<Item = usize> {
        self.arms().map(|arm| arm.solid)
    }

    /// Returns the changes by impulses in all directions that matter, if constraints pass them on.
    pub fn responses(&self) -> &[Response] {
        let directed = self.directed.as_ref();
        directed.map_or(&[], |directed| &directed.responses)
    }

    /// Returns whether constraints pass its impulses on.
    pub fn is_joined(&self) -> bool {
        !self.responses().is_empty()
    }

    /// Returns whether impulses at this contact have the same effect on the rigid bodies as those
    /// at another one of the same bodies.
    pub fn is_at(&self, other: &Self) -> bool {
        let mut arms = self.arms().zip(other.arms());
        (self.normal - other.normal).norm() < SAME_TOLERANCE && arms.all(|(a, b)| a.is_at(b))
    }

    /// Returns the component, perpendicular to the normal, of the relative vector of the closest
    /// points.
    pub fn slip(&self, field: &Field) -> Vector3<f64> {
        across(self.relative(field), self.normal)
    }

    /// Returns the change of the relative velocity along a direction by an impulse along it (1/kg).
    pub fn mobility(&self, direction: Vector3<f64>) -> f64 {
        let squared = direction.norm_squared();
        match &self.directed {
            Some(directed) if squared > 0.0 => {
                direction.dot(&(directed.mobility * direction)) / squared
            }
            _ => self.inverse_mass,
        }
    }

    /// Returns the change of the relative velocity (m/s) by an impulse (N s).
    pub fn change(&self, impulse: Vector3<f64>) -> Vector3<f64> {
        match &self.directed {
            Some(directed) => directed.mobility * impulse,
            None => impulse * self.inverse_mass,
        }
    }

    /// Changes the relative vector of the closest points by `change`, along it, unless constraints
    /// leave them no way to move there.
    pub fn apply(&self, change: Vector3<f64>, inverse_masses: &[f64], field: &mut Field) {
        let mobility = self.mobility(change);
        if mobility > 0.0 {
            self.push(change / mobility, inverse_masses, field);
        }
    }

    /// Gives the first primitive an impulse (N s), and the opposite to the second. The points of
    /// rigid bodies must be settled afterwards.
    pub fn push(&self, impulse: Vector3<f64>, inverse_masses: &[f64], field: &mut Field) {
        if self.is_joined() {
            for response in self.responses() {
                response.push(impulse, field);
            }
            return;
        }
        for (i, weight) in self.points.iter().zip(self.weights) {
            let i = *i as usize;
            if inverse_masses[i] > 0.0 && weight != 0.0 {
                field[i] += impulse * (weight * inverse_masses[i]);
            }
        }
        for arm in self.arms() {
            arm.push(impulse, field);
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
        inverse_masses: &[f64],
        field: &mut Field,
    ) -> Vector3<f64> {
        let relative = self.relative(field) - self.normal * wanted;
        if relative.dot(&self.normal) >= 0.0 {
            return Vector3::zeros();
        }
        if self.is_rigid() {
            let least = LeastSpeed::of_impact(Vector3::zeros(), wanted, friction);
            return self.press(Vector3::zeros(), &least, inverse_masses, field);
        }
        let change = change_in_impact(relative, self.normal, 0.0, friction);
        let impulse = change / self.inverse_mass;
        self.push(impulse, inverse_masses, field);
        impulse
    }

    /// Returns the change of an impulse so far (N s) after which the closest points separate as
    /// fast as they have to, and slip as little as friction allows; and applies it.
    pub fn press(
        &self,
        so_far: Vector3<f64>,
        least: &LeastSpeed,
        inverse_masses: &[f64],
        field: &mut Field,
    ) -> Vector3<f64> {
        let along = so_far.dot(&self.normal);
        let push = self.directed.as_ref().and_then(|it| it.push).unwrap_or(self.normal);
        let relative = least.before + self.relative(field);
        let lacks = least.speed - relative.dot(&self.normal);
        let pressed = (along + lacks / self.inverse_mass).max(0.0);
        let mut change = push * (pressed - along);
        self.push(change, inverse_masses, field);
        if least.friction > 0.0 {
            let rubbed = so_far - push * along;
            let slip = across(least.before + self.relative(field), self.normal);
            let most = least.friction * pressed;
            let more = self.held_along(rubbed, [least.begun, slip], most) - rubbed;
            self.push(more, inverse_masses, field);
            change += more;
        }
        change
    }

    /// Returns the impulse of friction (N s), after `so_far`, that stops a slip (m/s) as far as the
    /// largest one allows.
    pub fn held(&self, so_far: Vector3<f64>, slip: Vector3<f64>, most: f64) -> Vector3<f64> {
        match &self.directed {
            Some(directed) => {
                let free = slip - directed.mobility * so_far;
                friction(&directed.mobility, self.normal, free, most)
            }
            None => limited_to(so_far - slip / self.inverse_mass, most),
        }
    }

    /// Returns the impulse of friction (N s), after `so_far` and of at most `most`, where the slip
    /// is `begun` (m/s) at the beginning of a step and `slip` (m/s) at its end. It acts against the
    /// mean of both slips if the contact slides on in about the same direction, else against the
    /// latter.
    fn held_along(
        &self,
        so_far: Vector3<f64>,
        [begun, slip]: [Vector3<f64>; 2],
        most: f64,
    ) -> Vector3<f64> {
        let held = self.held(so_far, slip, most);
        let slides = held.norm() >= (1.0 - SAME_TOLERANCE) * most;
        if slides && begun.dot(&slip) > 0.0 { self.held(so_far, begun + slip, most) } else { held }
    }
}

/// Least separation after an impulse.
#[derive(Clone, Copy, Debug)]
pub(super) struct LeastSpeed {
    /// Slip at the beginning of a step for which contact lasts (m/s); 0 in an impact.
    pub begun: Vector3<f64>,
    /// Relative velocity before all impulses (m/s).
    pub before: Vector3<f64>,
    /// Speed along the normal afterwards (m/s).
    pub speed: f64,
    /// Coefficient of friction.
    pub friction: f64,
}

impl LeastSpeed {
    /// Creates the least speed along the normal after an impact (m/s), with the relative velocity
    /// before it (m/s) and a coefficient of friction.
    pub fn of_impact(before: Vector3<f64>, speed: f64, friction: f64) -> Self {
        Self { begun: Vector3::zeros(), before, speed, friction }
    }

    /// Returns a speed (m/s) that compares with those of the impact.
    pub fn size(&self) -> f64 {
        self.speed.abs() + self.before.norm()
    }
}
