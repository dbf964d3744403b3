//! Changes of velocities by impulses on bodies and particles that constraints hold.
//!
//! A rod or a joint passes an impulse on at once: what it holds gets the least change of its
//! velocities, weighted by the masses, with the impulse that the constraints can follow. So a body
//! on a hinge is struck with the mass that the hinge leaves it, and so is the end of a rod. A taut
//! rope, or an end of a joint, only pulls: its impulse is found with those of the impacts.

use nalgebra::Vector3;

use super::solids::{Arm, Field, Solid};
use crate::constraints::{Moved, Pushed};
use crate::interval::Interval;
use crate::rigid::{ROTATION, Rotation};

/// Constraints of a network.
pub(crate) trait Joints {
    /// Returns whether a constraint holds the particle, or the rigid body with that centre.
    fn hold(&self, i: usize) -> bool;

    /// Changes the velocities in the state y, which an impulse alone has given, by the least
    /// amount, weighted by the masses, so that they fit the constraints, without ropes and ends of
    /// joints.
    fn fit(&self, y: &mut [f64]);

    /// Returns the numbers of the ropes at their lengths and of the joints at an end, and the
    /// effects of an impulse of each, in the state y.
    fn pulls(&self, y: &[f64]) -> Vec<(usize, Vec<Pushed>)>;

    /// Returns the numbers of the taut ropes and of the held ends of joints, and the tension of
    /// each in the state y at time t (s): the impulse that it exerts in a second, in multiples of
    /// the one of [`pulls`](Self::pulls).
    fn tensions(&self, t: f64, y: &[f64]) -> Vec<(usize, f64)>;

    /// Adds these effects to the velocities in the state y.
    fn push(&self, effects: &[Pushed], y: &mut [f64]);

    /// Is told of an impulse (N s) that they have passed on, and of its work (J).
    fn note(&self, impulse: f64, work: f64);
}

/// Constraints, with the state at the end of a step.
#[derive(Clone, Copy)]
pub(super) struct JoinedBodies<'a> {
    pub joints: &'a dyn Joints,
    pub y: &'a [f64],
}

impl JoinedBodies<'_> {
    /// Returns the state with velocities of zero, and its number of particles.
    fn still(&self, solids: &[Solid]) -> (Vec<f64>, usize) {
        let mut y = self.y.to_vec();
        let n = (y.len() - ROTATION * solids.len()) / 6;
        y[3 * n..6 * n].fill(0.0);
        for k in 0..solids.len() {
            write_momentum(&mut y, n, k, Vector3::zeros());
        }
        (y, n)
    }
}

/// Returns the place of the rotation of body k in a state of n particles.
fn numbers(n: usize, k: usize) -> std::ops::Range<usize> {
    6 * n + ROTATION * k..6 * n + ROTATION * (k + 1)
}

/// Gives body k an angular momentum (kg m2/s) in a state of n particles.
fn write_momentum(y: &mut [f64], n: usize, k: usize, momentum: Vector3<f64>) {
    let q = Rotation::read(&y[numbers(n, k)]).q;
    Rotation { q, momentum }.write(&mut y[numbers(n, k)]);
}

/// A vector for each of some particles without bodies, and two for each of some bodies: of the
/// centre, and of the turn.
struct Effect {
    points: Vec<(usize, Vector3<f64>)>,
    solids: Vec<(usize, [Vector3<f64>; 2])>,
}

impl Effect {
    /// Reads the velocities (m/s) and angular velocities (rad/s) of the state y of n particles that
    /// are not zero.
    fn read(y: &[f64], n: usize, solids: &[Solid]) -> Self {
        let speed = |i: usize| Vector3::from([3, 4, 5].map(|row| y[row * n + i]));
        let on_bodies = |i: usize| {
            let is_of = |solid: &Solid| solid.center == i || solid.points.contains(&i);
            solids.iter().any(is_of)
        };
        let points = (0..n).filter(|i| speed(*i) != Vector3::zeros() && !on_bodies(*i));
        let changed = (0..solids.len()).map(|k| {
            let momentum = Rotation::read(&y[numbers(n, k)]).momentum;
            (k, [speed(solids[k].center), solids[k].spun(momentum)])
        });
        Self {
            points: points.map(|i| (i, speed(i))).collect(),
            solids: changed.filter(|(_, it)| *it != [Vector3::zeros(); 2]).collect(),
        }
    }

    /// Returns the changes of motion after impulses and the response of the constraints to them.
    /// Before that response, the impulses change the velocity (m/s) of the centre and the angular
    /// momentum (kg m2/s) of each body in `on_bodies`, and the velocity (m/s) of each particle in
    /// `on_points`.
    fn passed_on(
        joined: JoinedBodies,
        solids: &[Solid],
        on_bodies: impl Iterator<Item = (usize, [Vector3<f64>; 2])>,
        on_points: impl Iterator<Item = (usize, Vector3<f64>)>,
    ) -> Self {
        let (mut y, n) = joined.still(solids);
        let mut momenta = vec![Vector3::zeros(); solids.len()];
        let of_centers = on_bodies.map(|(k, [change, turned])| {
            momenta[k] += turned;
            (solids[k].center, change)
        });
        for (i, change) in of_centers.chain(on_points.filter(|(i, _)| *i < n)) {
            for axis in 0..3 {
                y[(3 + axis) * n + i] += change[axis];
            }
        }
        for (k, momentum) in momenta.into_iter().enumerate() {
            write_momentum(&mut y, n, k, momentum);
        }
        joined.joints.fit(&mut y);
        Self::read(&y, n, solids)
    }

    /// Returns the impulses and angular impulses of a constraint.
    fn of(pushed: &[Pushed], solids: &[Solid]) -> Self {
        let (mut points, mut parts) = (vec![], vec![[Vector3::zeros(); 2]; solids.len()]);
        for Pushed { moved, impulse, .. } in pushed {
            match *moved {
                Moved::Nothing => {}
                Moved::Particle(i) => match solids.iter().position(|solid| solid.center == i) {
                    Some(k) => parts[k][0] += impulse,
                    None => points.push((i, *impulse)),
                },
                Moved::Body(k) => parts[k][1] += impulse,
            }
        }
        Self { points, solids: parts.into_iter().enumerate().collect() }
    }

    /// Adds a multiple of the vectors to a field. The points of the bodies must be settled
    /// afterwards.
    fn add(&self, size: f64, field: &mut Field) {
        for (i, change) in &self.points {
            field[*i] += change * size;
        }
        for (k, change) in &self.solids {
            field.change(*k, change.map(|change| change * size));
        }
    }

    /// Returns the product with a field.
    fn product(&self, field: &Field, solids: &[Solid]) -> f64 {
        let of_points = self.points.iter().map(|(i, part)| part.dot(&field[*i]));
        let of_solids = self.solids.iter().map(|(k, [along, turn])| {
            let [moved, turned] = field.of_solid(*k, solids[*k].center);
            along.dot(&moved) + turn.dot(&turned)
        });
        of_points.sum::<f64>() + of_solids.sum::<f64>()
    }
}

/// Changes by an impulse of 1 N s, or an angular one of 1 N m s, in a direction.
pub(super) struct Response {
    direction: Vector3<f64>,
    effect: Effect,
}

impl Response {
    /// Finds the response to an impulse of 1 N s in a direction on the first of two arms, and the
    /// opposite on the second. The points change their velocities by `pushed` (m/s).
    pub fn new<'a>(
        joined: JoinedBodies,
        solids: &[Solid],
        direction: Vector3<f64>,
        arms: impl Iterator<Item = &'a Arm>,
        pushed: impl Iterator<Item = (usize, Vector3<f64>)>,
    ) -> Self {
        let pushes = |arm: &Arm| {
            let impulse = direction * arm.sign;
            (arm.solid, [impulse * arm.inverse_mass, arm.lever.cross(&impulse)])
        };
        Self { direction, effect: Effect::passed_on(joined, solids, arms.map(pushes), pushed) }
    }

    /// Finds the response to an angular impulse of 1 N m s about a direction on the first of two
    /// arms, and the opposite on the second.
    pub fn to_turn<'a>(
        joined: JoinedBodies,
        solids: &[Solid],
        direction: Vector3<f64>,
        arms: impl Iterator<Item = &'a Arm>,
    ) -> Self {
        let turns = arms.map(|arm| (arm.solid, [Vector3::zeros(), direction * arm.sign]));
        Self { direction, effect: Effect::passed_on(joined, solids, turns, std::iter::empty()) }
    }

    /// Lists the particles, without those of bodies, whose velocities change.
    pub fn points(&self) -> impl Iterator<Item = u32> {
        self.effect.points.iter().map(|(i, _)| *i as u32)
    }

    /// Changes a field by an impulse (N s or N m s), as far as it is in this direction. The points
    /// of the bodies must be settled afterwards.
    pub fn push(&self, impulse: Vector3<f64>, field: &mut Field) {
        self.effect.add(self.direction.dot(&impulse), field);
    }
}

/// Rope at its length, or joint at an end, in the impacts of one time: it pulls so that its ends do
/// not part.
pub(super) struct Tie {
    /// Rate at which the ends part, as a product with velocities, and that rate before the impacts
    /// (m/s).
    parts: Effect,
    rate: f64,
    /// Changes by an impulse of 1 N s that the other constraints pass on, and the change of the
    /// rate (1/kg).
    effect: Effect,
    mobility: f64,
    /// Impulse (N s).
    pull: f64,
    /// Largest impulse (N s): 0, or the tension of the rope times the length of the step.
    most: f64,
}

impl Tie {
    /// Lists the taut ropes and the joints at an end, with the velocities v (m/s) before the
    /// impacts. Contact that lasts for the interval `lasting`, at whose end the bodies are in the
    /// given state, can slacken a rope by at most its tension times that interval.
    pub fn all(
        joined: JoinedBodies,
        solids: &[Solid],
        v: &Field,
        lasting: Option<Interval>,
    ) -> Vec<Self> {
        let pulls = joined.joints.pulls(joined.y);
        let taut = lasting.filter(|_| !pulls.is_empty()).map(|Interval { t, h }| {
            let tensions = joined.joints.tensions(t + h, joined.y);
            tensions.into_iter().map(move |(number, tension)| (number, tension.max(0.0) * h))
        });
        let taut: Vec<_> = taut.into_iter().flatten().collect();
        let pulled = |number| taut.iter().find(|(own, _)| *own == number);
        let ties = pulls.iter().map(|(number, pushed)| {
            let (mut y, n) = joined.still(solids);
            joined.joints.push(pushed, &mut y);
            joined.joints.fit(&mut y);
            let (parts, effect) = (Effect::of(pushed, solids), Effect::read(&y, n, solids));
            let mut changed = Field::still(v.len(), solids.len());
            effect.add(1.0, &mut changed);
            Self {
                rate: parts.product(v, solids),
                mobility: parts.product(&changed, solids),
                pull: 0.0,
                most: pulled(*number).map_or(0.0, |(_, impulse)| *impulse),
                parts,
                effect,
            }
        });
        ties.filter(|tie| tie.mobility > 0.0).collect()
    }

    /// Prepares for calls of [`press`](Self::press) with velocities instead of changes of
    /// velocities.
    pub fn read_velocities(&mut self) {
        self.rate = -self.rate.max(0.0);
    }

    /// Forgets the impulse.
    pub fn slacken(&mut self) {
        self.pull = 0.0;
    }

    /// Changes the impulse so that the ends do not part, or not faster than before. Returns the
    /// change of their rate (m/s).
    pub fn press(&mut self, changes: &mut Field, solids: &[Solid]) -> f64 {
        let rate = self.rate.min(0.0) + self.parts.product(changes, solids);
        let pull = (self.pull - rate / self.mobility).min(self.most);
        let change = pull - self.pull;
        self.pull = pull;
        self.effect.add(change, changes);
        (change * self.mobility).abs()
    }

    /// Changes a field by the impulse, times a factor. The points of the bodies must be settled
    /// afterwards.
    pub fn push(&self, factor: f64, field: &mut Field) {
        self.effect.add(self.pull * factor, field);
    }

    /// Lists the particles, without those of bodies, whose velocities change.
    pub fn points(&self) -> impl Iterator<Item = u32> {
        let pulls = self.pull != 0.0;
        let points = self.effect.points.iter().filter(move |_| pulls);
        points.map(|(i, _)| *i as u32)
    }
}
