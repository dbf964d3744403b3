//! All constraints of a network, and the forces by which they act on its particles.

use std::collections::BTreeMap;
use std::sync::{Arc, OnceLock};

use nalgebra::{Matrix3, Vector3};

use super::constraint::{Constraint, Equation, Projected};
use super::joint::{JointEquation, Side};
use super::solve::{Lever, Row, RowPattern, System, Turning};
use crate::error::{Error, positive};
use crate::scratch::Scratch;
use crate::threads::each;

/// A particle under a constraint, with the places of what moves it: the particle itself or its
/// body's centre, and the rotation of the body, or 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct HeldEnd {
    particle: usize,
    pub(super) place: usize,
    pub(super) turn: usize,
}

/// Unit of motion: a particle, or the rotation of a body. Place 0 stands for none.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Moved {
    Nothing,
    Particle(usize),
    Body(usize),
}

/// All constraints of a network.
#[derive(Clone, Debug)]
pub(crate) struct Constraints {
    pub(super) all: Vec<Constraint>,
    /// Whether each constraint holds: a rope does while it is taut, and all others always.
    pub(super) holds: Vec<bool>,
    /// Particles and rotations that constraints move: the time of an evaluation is proportional to
    /// their number, not to that of all particles.
    pub(super) moved: Vec<Moved>,
    /// Places of particles and of rotations in `moved`.
    pub(super) particles: BTreeMap<usize, usize>,
    pub(super) rotations: BTreeMap<usize, usize>,
    /// The particles of each constraint.
    pub(super) ends: Vec<[HeldEnd; 2]>,
    /// The constraint of each equation, and its number within the constraint.
    pub(super) owners: Vec<(usize, usize)>,
    /// Natural frequency (1/s) with which errors decay.
    baumgarte_frequency: f64,
    /// Pattern of equations that move the same things, computed on first use.
    pub(super) pattern: OnceLock<Arc<RowPattern>>,
    pub(super) scratch: Scratch<System>,
}

impl Default for Constraints {
    fn default() -> Self {
        Self {
            all: vec![],
            holds: vec![],
            moved: vec![Moved::Nothing],
            particles: BTreeMap::new(),
            rotations: BTreeMap::new(),
            ends: vec![],
            owners: vec![],
            baumgarte_frequency: 10.0,
            pattern: OnceLock::new(),
            scratch: Scratch::default(),
        }
    }
}

impl Constraints {
    /// Adds a constraint whose particles exist. `carrier` returns the centre and the number of the
    /// body to which a particle belongs, as its centre or as a point.
    pub fn add(
        &mut self,
        constraint: &Constraint,
        carrier: impl Fn(usize) -> Option<(usize, usize)>,
    ) -> Result<(), Error> {
        let constraint = constraint.checked()?;
        let (first, second) = constraint.ends();
        let joint = constraint.joint();
        if let Some(joint) = joint {
            let is_center = |i: usize| carrier(i).map(|(center, _)| center == i);
            joint.check_bodies(is_center)?;
        }
        let moved = &mut self.moved;
        let mut place = |places: &mut BTreeMap<usize, usize>, of: usize, what| {
            *places.entry(of).or_insert_with(|| {
                moved.push(what);
                moved.len() - 1
            })
        };
        let mut hold = |particle: usize| {
            // No force at its centre turns a body, but a joint does.
            let turns = |(center, _): &(usize, usize)| joint.is_some() || *center != particle;
            let body = carrier(particle).filter(turns);
            let mover = body.map_or(particle, |(center, _)| center);
            HeldEnd {
                particle,
                place: place(&mut self.particles, mover, Moved::Particle(mover)),
                turn: body.map_or(0, |(_, k)| place(&mut self.rotations, k, Moved::Body(k))),
            }
        };
        let nothing = HeldEnd { particle: first, place: 0, turn: 0 };
        self.ends.push([hold(first), second.map_or(nothing, hold)]);
        let (own, owners) = (self.all.len(), &mut self.owners);
        let before = owners.len();
        constraint.equations(Vector3::zeros(), Vector3::zeros(), |_| {
            owners.push((own, owners.len() - before));
        });
        owners.extend((0..constraint.joint_equations()).map(|number| (own, number)));
        self.all.push(constraint);
        self.holds.push(!constraint.is_one_sided());
        self.pattern = OnceLock::new();
        Ok(())
    }

    /// Returns the same constraints, after particles were assigned to other bodies.
    pub fn with_carriers(
        &self,
        carrier: impl Fn(usize) -> Option<(usize, usize)>,
    ) -> Result<Self, Error> {
        let mut constraints =
            Self { baumgarte_frequency: self.baumgarte_frequency, ..Self::default() };
        for constraint in &self.all {
            constraints.add(constraint, &carrier)?;
        }
        constraints.holds.clone_from(&self.holds);
        Ok(constraints)
    }

    /// Returns all constraints, in the order in which they were added.
    pub fn all(&self) -> &[Constraint] {
        &self.all
    }

    /// Returns whether they act on a particle, or on the body whose centre it is.
    pub fn moves(&self, i: usize) -> bool {
        self.particles.contains_key(&i)
    }

    /// Returns the natural frequency (1/s) with which errors decay.
    pub fn baumgarte_frequency(&self) -> f64 {
        self.baumgarte_frequency
    }

    /// Sets the natural frequency (1/s) with which errors decay.
    pub fn set_baumgarte_frequency(&mut self, w: f64) -> Result<(), Error> {
        positive("the feedback of constraints", w)?;
        self.baumgarte_frequency = w;
        Ok(())
    }

    /// Adds J^T lambda (N) to all other forces f, also on pinned particles. `motion` returns the
    /// inverse mass (1/kg) of a particle on no body and its acceleration (m/s2) without
    /// constraints, and `turning` the rotation of a body, both under the forces f. Adds the torques
    /// (N m) by joints about the centres of bodies, three numbers for each body, to `torques`.
    /// Returns whether the constraints are too nearly singular for exact multipliers.
    pub fn add_forces(
        &self,
        motion: impl Fn(usize, &[f64]) -> (f64, Vector3<f64>),
        turning: impl Fn(usize, &[f64]) -> Turning,
        state: [&[f64]; 2],
        f: &mut [f64],
        torques: &mut [f64],
    ) -> bool {
        self.scratch.lend(|system| {
            let soft = self.find_multipliers(motion, turning, state, f, system);
            let n = f.len() / 3;
            for (row, (owner, _)) in system.rows.iter().zip(&self.owners) {
                let ([first, second], force) = (self.ends[*owner], row.force());
                for axis in 0..3 {
                    f[axis * n + first.particle] += force[axis];
                    if second.place != 0 {
                        f[axis * n + second.particle] -= force[axis];
                    }
                }
                if self.all[*owner].joint().is_some() {
                    self.add_torques(system, row, [first, second], torques);
                }
            }
            soft
        })
    }

    /// Returns the power (W) of the forces that were found last, on all that they move, also pins.
    /// It is zero where velocities fit the constraints.
    pub fn power(&self) -> f64 {
        self.scratch.lend(|system| {
            let powers = system.rows.iter().map(|row| row.unscaled() * row.rate);
            powers.sum()
        })
    }

    /// Adds the torques by a row of a joint about the centres of its bodies.
    fn add_torques(&self, system: &System, row: &Row, ends: [HeldEnd; 2], torques: &mut [f64]) {
        for end in ends {
            if let (Moved::Body(k), Some(turning)) =
                (self.moved[end.turn], &system.turnings[end.turn])
            {
                let torque = turning.rotation * row.at(end.turn);
                for (sum, torque) in torques[3 * k..3 * k + 3].iter_mut().zip(&torque) {
                    *sum += torque;
                }
            }
        }
    }

    /// Finds the multipliers under all other forces f (N), as [`add_forces`](Self::add_forces).
    pub(super) fn find_multipliers(
        &self,
        motion: impl Fn(usize, &[f64]) -> (f64, Vector3<f64>),
        turning: impl Fn(usize, &[f64]) -> Turning,
        state: [&[f64]; 2],
        f: &[f64],
        system: &mut System,
    ) -> bool {
        system.clear();
        for moved in &self.moved {
            let (weight, vector, turning) = match *moved {
                Moved::Nothing => (Vector3::zeros(), Vector3::zeros(), None),
                Moved::Particle(i) => {
                    let (weight, acceleration) = motion(i, f);
                    (Vector3::repeat(weight), acceleration, None)
                }
                Moved::Body(k) => {
                    let turning = turning(k, f);
                    let own = turning.rotation.tr_mul(&turning.acceleration);
                    (turning.inverse_inertia, own, Some(turning))
                }
            };
            system.weights.push(weight);
            system.vectors.push(vector);
            system.turnings.push(turning);
        }
        let w = self.baumgarte_frequency;
        let (ks, kd) = (w * w, 2.0 * w);
        self.solve(state, system, |_, row, equation, rate, vectors| {
            let a = row.product(vectors);
            let back = ks * equation.value + kd * rate;
            -equation.bend - a - back
        })
    }

    /// Clears a system, and writes the weights of all that the constraints move, and no vectors.
    pub(super) fn prepare(
        &self,
        system: &mut System,
        weight: impl Fn(usize) -> f64,
        turning: impl Fn(usize) -> Turning,
    ) {
        system.clear();
        for moved in &self.moved {
            let (weight, turning) = match *moved {
                Moved::Nothing => (Vector3::zeros(), None),
                Moved::Particle(i) => (Vector3::repeat(weight(i)), None),
                Moved::Body(k) => {
                    let turning = turning(k);
                    (turning.inverse_inertia, Some(turning))
                }
            };
            system.weights.push(weight);
            system.vectors.push(Vector3::zeros());
            system.turnings.push(turning);
        }
    }

    /// Builds the rows at x and v, and solves for the multipliers. `target` returns the right-hand
    /// side of a row of a constraint, with its equation, the rate of change of that (m/s), and the
    /// vectors of the system.
    pub(super) fn solve(
        &self,
        state: [&[f64]; 2],
        system: &mut System,
        target: impl Fn(usize, &Row, &Equation, f64, &[Vector3<f64>]) -> f64 + Sync,
    ) -> bool {
        self.build(state, system, None, target);
        system.solve(|| self.pattern())
    }

    /// Builds the rows at x and v; `target` is that of [`solve`](Self::solve).
    pub(super) fn build(
        &self,
        [x, v]: [&[f64]; 2],
        system: &mut System,
        ends_hold: Option<Projected>,
        target: impl Fn(usize, &Row, &Equation, f64, &[Vector3<f64>]) -> f64 + Sync,
    ) {
        let System { weights, vectors, turnings, rows, .. } = system;
        rows.resize_with(self.owners.len(), Row::default);
        each(rows, &|k, row| {
            let (owner, number) = self.owners[k];
            let (constraint, ends) = (&self.all[owner], self.ends[owner]);
            *row = Row::default();
            // In a projection of that kind, ropes and ends of joints hold where they are passed.
            let of_ends = ends_hold.filter(|_| constraint.is_one_sided());
            if !self.holds[owner] && of_ends.is_none() {
                return;
            }
            let holds = |value: f64, rate: f64| {
                of_ends.is_none_or(|what| constraint.is_passed([value, rate], what))
            };
            let turned = |turn: usize| turnings[turn].as_ref().map(Turning::turned);
            if let Some(sides) = self.sides(owner, [x, v], turned) {
                let equation = constraint.joint_equation(number, &sides);
                if !holds(equation.value, equation.rate) || constraint.is_away(&equation) {
                    return;
                }
                fill(row, ends, turnings, &equation);
                let (rate, equation) = (equation.rate, Equation::from(equation));
                row.rate = rate;
                row.set_target(target(owner, row, &equation, rate, vectors), weights);
                return;
            }
            let relative = |a: &[f64]| match constraint.ends() {
                (i, Some(j)) => vector(a, i) - vector(a, j),
                (i, None) => vector(a, i),
            };
            let v_relative = relative(v);
            let (mut count, mut own) = (0, None);
            constraint.equations(relative(x), v_relative, |equation| {
                if count == number {
                    own = Some(equation);
                }
                count += 1;
            });
            let Some(mut equation) = own.filter(|own| !constraint.is_slack(own)) else {
                return;
            };
            let gradient = equation.gradient;
            let rate = gradient.dot(&v_relative);
            if !holds(equation.value, rate) {
                return;
            }
            for (end, sign) in ends.iter().zip([1.0, -1.0]) {
                row.add(end.place, gradient * sign);
                if let Some(turning) = &turnings[end.turn] {
                    let lever = Lever::new(turning, vector(x, end.particle));
                    row.add(end.turn, lever.of(gradient) * sign);
                    equation.bend += gradient.dot(&lever.inwards) * sign;
                }
            }
            row.rate = rate;
            let target = target(owner, row, &equation, rate, vectors);
            row.set_target(target, weights);
        });
    }

    /// Returns the sides of a joint in the state (x, v), if the constraint of that number is one or
    /// the end of one. `turned` is that of [`Joint::sides`](super::Joint), for a rotation's place.
    pub(super) fn sides(
        &self,
        number: usize,
        state: [&[f64]; 2],
        turned: impl Fn(usize) -> Option<(Matrix3<f64>, Vector3<f64>)>,
    ) -> Option<[Side; 2]> {
        let joint = self.all[number].joint()?;
        let ends = self.ends[number];
        Some(joint.sides(state, |side| turned(ends[side].turn)))
    }

    /// Returns the pattern of what each equation moves.
    pub(super) fn pattern(&self) -> &Arc<RowPattern> {
        self.pattern.get_or_init(|| Arc::new(self.find_pattern()))
    }

    /// Finds the pattern of what each equation moves.
    fn find_pattern(&self) -> RowPattern {
        let rows = self.owners.iter().map(|(owner, _)| {
            let [a, b] = self.ends[*owner];
            [a.place, a.turn, b.place, b.turn]
        });
        RowPattern::new(&rows.collect::<Vec<_>>(), self.moved.len())
    }
}

/// Fills a row of J with an equation of a joint.
fn fill(row: &mut Row, ends: [HeldEnd; 2], turnings: &[Option<Turning>], equation: &JointEquation) {
    let signs = [1.0, -1.0];
    for ((end, sign), lever) in ends.iter().zip(signs).zip(equation.levers) {
        row.add(end.place, equation.gradient * sign);
        if let Some(turning) = &turnings[end.turn] {
            row.add(end.turn, turning.rotation.tr_mul(&lever));
        }
    }
}

/// Returns the row of particle i.
pub(super) fn vector(a: &[f64], i: usize) -> Vector3<f64> {
    let n = a.len() / 3;
    Vector3::new(a[i], a[n + i], a[2 * n + i])
}
