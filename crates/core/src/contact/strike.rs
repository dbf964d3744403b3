//! Impacts of rigid and of elastic bodies, at the time within the step at which they touch.
//!
//! Pairs that touch at one time get impulses along the normal, after which each separates at least
//! at the speed of restitution, and Coulomb friction, by projected Gauss-Seidel iteration over all
//! of them (Moreau, *Unilateral contact and dry friction in finite freedom dynamics*, 1988). An
//! impulse J acts at one point p of both bodies, a time s before the end of the step. A free body
//! ends the step at x + s J / m with the angular momentum L + (p - x + s v) x J: as if it had moved
//! from x - s v with the momentum m v + J. Its momentum and its angular momentum about any point
//! change by J and p x J, so that both totals are conserved to rounding.

use nalgebra::{Matrix3, Vector3};

use super::candidates::Candidates;
use super::hits::{find, first_hits, parties};
use super::listing::Candidate;
use super::motion::{Guarded, Motion};
use super::rebound::rebound_speed;
use super::skin::Law;
use super::solids::SAME_TOLERANCE;
use super::surface::Surface;
use crate::geometry::{Closest, PairKind, closest, weighted};

/// Largest number of times in a step at which a body has impacts.
const MAX_TIMES: usize = 12;

/// Largest number of passes over the impacts of one time.
const MAX_SWEEPS: usize = 200;

/// Accuracy of the solution, as a share of the speed of an impact.
const TOLERANCE: f64 = 1e-13;

/// Share of its approach by which a pair that does not rebound stays farther apart than where it
/// touched, so that rounding does not make it a hit again.
const MARGIN_SHARE: f64 = 1e-6;

/// Fraction of the missing separation of bodies that is restored in a step.
const RESTORED_SHARE: f64 = 0.1;

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
struct Impact {
    candidate: Candidate,
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
    rebounds: bool,
    friction: f64,
    /// Change of the relative velocity by an impulse (1/kg).
    mobility: Matrix3<f64>,
    /// Time from the impact to the end of the step (s).
    left: f64,
    /// Change (m) of the displacement along the normal after the touch: it cancels the approach
    /// and restores missing separation.
    wanted: f64,
    impulse: Vector3<f64>,
}

/// Changes of velocities (m/s) and angular velocities (rad/s).
struct Changes {
    points: Vec<Vector3<f64>>,
    solids: Vec<[Vector3<f64>; 2]>,
}

/// Applies impulses to the pairs that touch in a step of h (s), one time after another, as long as
/// there are pairs with a rigid side or with restitution.
pub(super) fn strike(
    surface: &Surface,
    h: f64,
    candidates: &mut Candidates,
    motion: &mut Motion,
    guarded: &mut Guarded,
) -> bool {
    let mut changed = false;
    let mut moved = vec![];
    for time in 0..MAX_TIMES {
        let again = (time > 0).then_some(&moved[..]);
        let mut hits = find(surface, candidates, motion, again);
        hits.retain(|(pair, _)| surface.is_rigid_or_elastic_pair(pair.kind, &pair.points));
        moved.clear();
        moved.resize(motion.x0.len(), false);
        let hits = first_hits(surface, motion, hits, &mut moved);
        let mut impacts: Vec<Impact> = vec![];
        for (pair, time) in hits {
            let Some(impact) = Impact::new(surface, &pair, (time, h), motion) else {
                continue;
            };
            if !impacts
                .iter()
                .any(|other| impact.is_same_as(other, surface))
            {
                guarded.first = guarded.first.min(time);
                impacts.push(impact);
            }
        }
        let mut changes = Changes {
            points: vec![Vector3::zeros(); motion.x0.len()],
            solids: vec![[Vector3::zeros(); 2]; motion.solids.len()],
        };
        solve(&mut impacts, &mut changes, &motion.inverse_masses);
        impacts.retain(|impact| impact.impulse != Vector3::zeros());
        if impacts.is_empty() {
            break;
        }
        changed = true;
        for impact in &impacts {
            impact.apply(&changes, h, motion);
            guarded.impulses += 1;
            guarded.impulse += impact.impulse.norm();
            let struck: Vec<_> = parties(surface, motion, &impact.candidate).collect();
            for i in struck {
                moved[i as usize] = true;
                motion.flight.since[i as usize] = 1.0 - impact.left / h;
            }
        }
        for k in 0..motion.solids.len() {
            motion.solids[k].settle(k, &mut motion.v);
            if motion.solids[k].settle(k, &mut motion.moves) {
                motion.rotate_points(k);
                let (center, points) = (motion.solids[k].center, motion.solids[k].points.clone());
                moved[points.clone()].fill(true);
                let since = motion.flight.since[center];
                motion.flight.since[points].fill(since);
            }
        }
        motion.cover(surface, candidates);
    }
    changed
}

/// Finds the impulses of all impacts of one time, and the changes of velocities.
fn solve(impacts: &mut [Impact], changes: &mut Changes, inverse_masses: &[f64]) {
    for _ in 0..MAX_SWEEPS {
        let mut solved = true;
        for impact in &mut *impacts {
            let relative = impact.relative(changes);
            let along = impact.impulse.dot(&impact.normal);
            let inverse_mass = impact.normal.dot(&(impact.mobility * impact.normal));
            if inverse_mass <= 0.0 {
                continue;
            }
            let lacks = impact.speed - relative.dot(&impact.normal);
            let pressed = (along + lacks / inverse_mass).max(0.0);
            let mut change = impact.normal * (pressed - along);
            impact.push(change, changes, inverse_masses);
            impact.impulse += change;
            if impact.friction > 0.0 {
                let held = impact.friction_impulse(pressed, changes);
                let rubbed = held - (impact.impulse - impact.normal * pressed);
                impact.push(rubbed, changes, inverse_masses);
                impact.impulse += rubbed;
                change += rubbed;
            }
            let size = impact.speed + impact.before.norm();
            solved &= (impact.mobility * change).norm() <= TOLERANCE * size;
        }
        if solved {
            break;
        }
    }
}

impl Impact {
    /// Returns the impact of a pair that touches at a share of a step of h (s).
    fn new(
        surface: &Surface,
        pair: &Candidate,
        (time, h): (f64, f64),
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

    /// Returns whether impulses of this impact have the same effect as those of another one between
    /// the same bodies.
    fn is_same_as(&self, other: &Self, surface: &Surface) -> bool {
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
        let (length, most) = (held.norm(), self.friction * pressed);
        if length > most {
            held * (most / length)
        } else {
            held
        }
    }

    /// Changes the motion by the impulse.
    fn apply(&self, changes: &Changes, h: f64, motion: &mut Motion) {
        let changed = (self.relative(changes) - self.before).dot(&self.normal);
        // A pair that does not rebound stays where it touched; for others, the course from there on
        // is new.
        let span = if self.rebounds {
            self.left
        } else {
            (self.wanted / changed).clamp(0.0, h)
        };
        let impulse = self.impulse;
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
        motion
            .impulses
            .share(self.candidate.points, self.all_weights, impulse);
    }
}
