//! Impact of a pair: what an impulse changes, with the speed of restitution and Coulomb friction.

use nalgebra::{Matrix3, Vector3};

use super::listing::Candidate;
use super::motion::Motion;
use super::obstacle::{RESTORED_SHARE, limited_to, rebound_speed};
use super::response::{Changes, Joined, Joints, Response};
use super::skin::Law;
use super::solids::SAME_TOLERANCE;
use super::surface::Surface;
use crate::geometry::{Closest, PairKind, closest, weighted};
use crate::interval::Interval;

/// Accuracy of the solution, as a share of the speed of an impact.
const TOLERANCE: f64 = 1e-13;

/// Share of its approach by which a pair that does not rebound stays farther apart than where it
/// touched, so that rounding does not make it a hit again.
const MARGIN_SHARE: f64 = 1e-6;

/// Side of an impact that is a rigid body.
struct Arm {
    solid: usize,
    /// 1 for the first primitive of a pair, -1 for the second.
    sign: f64,
    /// Point of the impact relative to the centre (m).
    lever: Vector3<f64>,
    inverse_mass: f64,
    /// Inverse of the inertia at the time of the impact (1/(kg m2)).
    inverse_inertia: Matrix3<f64>,
}

/// Pair that touches.
pub(super) struct Impact {
    pub candidate: Candidate,
    /// Weights of the closest points: 0 for points of rigid bodies.
    weights: [f64; 4],
    /// Weights of all closest points.
    all_weights: [f64; 4],
    normal: Vector3<f64>,
    point: Vector3<f64>,
    arms: [Option<Arm>; 2],
    /// Relative velocity before the impact (m/s).
    before: Vector3<f64>,
    /// Least speed at which the bodies separate (m/s), and whether that is a rebound.
    speed: f64,
    pub rebounds: bool,
    friction: f64,
    /// Change of the relative velocity by an impulse (1/kg).
    mobility: Matrix3<f64>,
    /// Time from the impact to the end of the step (s).
    pub left: f64,
    /// Change (m) of the displacement along the normal after the touch: it cancels the approach
    /// and restores missing separation.
    wanted: f64,
    /// Changes by impulses in all directions that matter, if joints hold a body.
    responses: Vec<Response>,
    pub impulse: Vector3<f64>,
}

impl Impact {
    /// Returns the impact of a pair that touches at a share of a step of h (s).
    pub fn new(
        surface: &Surface,
        pair: &Candidate,
        Interval { t: time, h }: Interval,
        motion: &Motion,
    ) -> Option<Self> {
        let law: Law = surface.law(pair.kind, &pair.points);
        let at = motion.places(pair, &law, time);
        let Closest { weights, offset } = closest(pair.kind, &at);
        let distance = offset.norm();
        if distance == 0.0 {
            return None;
        }
        let normal = offset / distance;
        let first = pair.kind.first();
        let last = if pair.kind == PairKind::VertexFloor {
            2
        } else {
            4
        };
        let sides = [(0, 0..first, 1.0), (1, first..last, -1.0)];
        // The middle between the two surfaces. A floor has no point below the vertex.
        let [radius, other] = [0, first].map(|k| surface.radius(pair.points[k]));
        let on_axis: Vector3<f64> = (0..first).map(|k| at[k] * weights[k]).sum();
        let point = on_axis - (offset + normal * (radius - other)) * 0.5;
        let left = (1.0 - time) * h;
        let mut impact = Self {
            candidate: *pair,
            weights,
            all_weights: weights,
            normal,
            point,
            arms: [None, None],
            before: Vector3::zeros(),
            speed: 0.0,
            rebounds: false,
            friction: law.skin.friction,
            mobility: Matrix3::zeros(),
            left,
            wanted: 0.0,
            responses: vec![],
            impulse: Vector3::zeros(),
        };
        // Relative velocities at the beginning and the end of the step, without other impacts.
        let mut ends = [Vector3::zeros(); 2];
        for (number, side, sign) in sides {
            let Some(k) = surface.solid(pair.points[side.start]) else {
                for k in side {
                    let (i, weight) = (pair.points[k] as usize, weights[k]);
                    let own = [motion.v[i] - motion.flight.gain(i), motion.v[i]];
                    impact.before += motion.velocity(i, time) * weight;
                    ends = [0, 1].map(|e| ends[e] + own[e] * weight);
                    let inverse_mass = weight * weight * motion.inverse_masses[i];
                    impact.mobility += Matrix3::identity() * inverse_mass;
                }
                continue;
            };
            let solid = &motion.solids[k];
            let center = solid.center;
            let v = motion.v[center];
            let lever = point - (motion.x0[center] + motion.moves[center] - v * left);
            let turn = motion.v.turns[k];
            let [gain, lag] = motion.flight.turn(k);
            let (spin, inverse_inertia) = solid.before([turn, lag], 1.0 - time, left);
            let spins = [turn - gain, turn];
            let speeds = [v - motion.flight.gain(center), v];
            ends = [0, 1].map(|e| ends[e] + (speeds[e] + spins[e].cross(&lever)) * sign);
            impact.before += (motion.velocity(center, time) + spin.cross(&lever)) * sign;
            let cross = lever.cross_matrix();
            let inverse_mass = motion.inverse_masses[center];
            impact.mobility += Matrix3::identity() * inverse_mass - cross * inverse_inertia * cross;
            impact.weights[side].fill(0.0);
            impact.arms[number] = Some(Arm {
                solid: k,
                sign,
                lever,
                inverse_mass,
                inverse_inertia,
            });
        }
        let [start, end] = ends.map(|v| v.dot(&normal));
        let speed = impact.before.dot(&normal);
        let press = (start - end) / h;
        impact.speed = rebound_speed(law.skin.restitution, -speed, press, h);
        impact.rebounds = impact.speed > 0.0;
        if !impact.rebounds {
            // They do not approach at the end of the step either.
            impact.speed = (speed - end).max(0.0);
            let approach = weighted(&weights, &pair.of(&motion.moves)).dot(&normal);
            impact.wanted = RESTORED_SHARE * (law.max_kept() - distance).max(0.0)
                - (1.0 - time) * approach
                + MARGIN_SHARE * approach.abs();
        }
        Some(impact)
    }

    /// Lets joints pass impulses on, if they hold a body that is struck.
    pub fn join(&mut self, joined: Joined, motion: &Motion) {
        let solids = &motion.solids;
        let held = |arm: &Arm| joined.joints.hold(solids[arm.solid].center);
        if !self.arms.iter().flatten().any(held) {
            return;
        }
        let across = self.normal.cross(&Vector3::ith(self.normal.iamin(), 1.0));
        let across = across.normalize();
        let all = [self.normal, across, self.normal.cross(&across)];
        let count = if self.friction > 0.0 { 3 } else { 1 };
        for direction in &all[..count] {
            let arms = self.arms.iter().flatten();
            let arms = arms.map(|arm| (arm.solid, arm.lever, arm.sign));
            let pushed = self.candidate.points.iter().zip(self.weights);
            let pushed = pushed.map(|(i, weight)| {
                let i = *i as usize;
                (i, direction * (weight * motion.inverse_masses[i]))
            });
            self.responses
                .push(Response::new(joined, solids, *direction, arms, pushed));
        }
        let mut changes = Changes {
            points: vec![Vector3::zeros(); motion.x0.len()],
            solids: vec![[Vector3::zeros(); 2]; solids.len()],
        };
        self.mobility = Matrix3::zeros();
        for direction in &all[..count] {
            changes.points.fill(Vector3::zeros());
            changes.solids.fill([Vector3::zeros(); 2]);
            self.push(*direction, &mut changes, &motion.inverse_masses);
            let change = self.relative(&changes) - self.before;
            self.mobility += change * direction.transpose();
        }
    }

    /// Returns whether impulses of this impact have the same effect as those of another one between
    /// the same bodies.
    pub fn is_same_as(&self, other: &Self, surface: &Surface) -> bool {
        let first = self.candidate.kind.first();
        let bodies = |impact: &Self| {
            let pair = &impact.candidate;
            [pair.points[0], pair.points[pair.kind.first()]].map(|i| surface.vertex(i))
        };
        let is_rigid = self.arms.iter().any(Option::is_some);
        let points = first..4;
        let is_solid = self.weights[..first].iter().all(|w| *w == 0.0)
            || self.weights[points].iter().all(|w| *w == 0.0);
        let lever = self
            .arms
            .iter()
            .flatten()
            .map(|arm| arm.lever.norm())
            .fold(0.0, f64::max);
        is_rigid
            && is_solid
            && bodies(self) == bodies(other)
            && (self.normal - other.normal).norm() < SAME_TOLERANCE
            && (self.point - other.point).norm() < SAME_TOLERANCE * lever
    }

    /// Changes the impulse so that the pair separates as fast as it has to, with its friction.
    /// Returns whether it was right.
    pub fn press(&mut self, changes: &mut Changes, inverse_masses: &[f64]) -> bool {
        let relative = self.relative(changes);
        let along = self.impulse.dot(&self.normal);
        let inverse_mass = self.normal.dot(&(self.mobility * self.normal));
        if inverse_mass <= 0.0 {
            return true;
        }
        let lacks = self.speed - relative.dot(&self.normal);
        let pressed = (along + lacks / inverse_mass).max(0.0);
        let mut change = self.normal * (pressed - along);
        self.push(change, changes, inverse_masses);
        self.impulse += change;
        if self.friction > 0.0 {
            let held = self.friction_impulse(pressed, changes);
            let rubbed = held - (self.impulse - self.normal * pressed);
            self.push(rubbed, changes, inverse_masses);
            self.impulse += rubbed;
            change += rubbed;
        }
        let size = self.speed + self.before.norm();
        (self.mobility * change).norm() <= TOLERANCE * size
    }

    /// Returns the relative velocity (m/s), with changes.
    fn relative(&self, changes: &Changes) -> Vector3<f64> {
        let points = self.candidate.points.map(|i| changes.points[i as usize]);
        let mut relative = self.before + weighted(&self.weights, &points);
        for arm in self.arms.iter().flatten() {
            let [along, turned] = changes.solids[arm.solid];
            relative += (along + turned.cross(&arm.lever)) * arm.sign;
        }
        relative
    }

    /// Gives an impulse (N s) to the first primitive, and the opposite to the second.
    fn push(&self, impulse: Vector3<f64>, changes: &mut Changes, inverse_masses: &[f64]) {
        if !self.responses.is_empty() {
            for response in &self.responses {
                response.push(impulse, changes);
            }
            return;
        }
        for (i, weight) in self.candidate.points.iter().zip(self.weights) {
            let i = *i as usize;
            changes.points[i] += impulse * (weight * inverse_masses[i]);
        }
        for arm in self.arms.iter().flatten() {
            let [along, turned] = &mut changes.solids[arm.solid];
            *along += impulse * (arm.sign * arm.inverse_mass);
            *turned += arm.inverse_inertia * arm.lever.cross(&impulse) * arm.sign;
        }
    }

    /// Returns the impulse of friction that stops the slip, as far as the normal impulse allows.
    fn friction_impulse(&self, pressed: f64, changes: &Changes) -> Vector3<f64> {
        let relative = self.relative(changes);
        let slip = relative - self.normal * relative.dot(&self.normal);
        let so_far = self.impulse - self.normal * pressed;
        let squared = slip.norm_squared();
        if squared == 0.0 {
            return so_far;
        }
        let held = so_far - slip * (squared / slip.dot(&(self.mobility * slip)));
        limited_to(held, self.friction * pressed)
    }

    /// Tells joints of the impulse, if they pass it on.
    pub fn note(&self, changes: &Changes, joints: &dyn Joints) {
        if !self.responses.is_empty() {
            let sum = self.before + self.relative(changes);
            joints.note(self.impulse.norm(), 0.5 * self.impulse.dot(&sum));
        }
    }

    /// Changes the motion by the impulse.
    pub fn apply(&self, changes: &Changes, h: f64, motion: &mut Motion) {
        let changed = (self.relative(changes) - self.before).dot(&self.normal);
        // A pair that does not rebound stays where it touched; for others, the course from there on
        // is new.
        let span = if self.rebounds {
            self.left
        } else {
            (self.wanted / changed).clamp(0.0, h)
        };
        let impulse = self.impulse;
        motion
            .impulses
            .share(self.candidate.points, self.all_weights, impulse);
        if !self.responses.is_empty() {
            for response in &self.responses {
                response.apply(impulse, 1.0, &mut motion.v);
                response.apply(impulse, span, &mut motion.moves);
            }
            return;
        }
        for (i, weight) in self.candidate.points.iter().zip(self.weights) {
            let i = *i as usize;
            let change = impulse * (weight * motion.inverse_masses[i]);
            motion.v[i] += change;
            motion.moves[i] += change * span;
        }
        let velocity = |arm: &Arm| motion.v[motion.solids[arm.solid].center];
        let own = self.arms.each_ref().map(|arm| arm.as_ref().map(velocity));
        let mean = match own {
            [Some(a), Some(b)] => (a + b) * 0.5,
            [one, other] => one.or(other).unwrap_or_default(),
        };
        for (arm, own) in self.arms.iter().zip(own) {
            let Some((arm, own)) = arm.as_ref().zip(own) else {
                continue;
            };
            let lever = arm.lever + (own - mean) * (span - self.left);
            let solid = &motion.solids[arm.solid];
            solid.push_at(arm.solid, lever, impulse * arm.sign, 1.0, &mut motion.v);
            solid.push_at(
                arm.solid,
                lever,
                impulse * arm.sign,
                span,
                &mut motion.moves,
            );
        }
    }
}
