//! Masses and springs alone, with the forces of a course's program. They share no code with the
//! solvers, and make the usual mistakes on request.

use a3_core::{Network, Scene, SpringKind};
use a3_scenes::List;

use super::constant::{CONSTANTS, Change, Constant, Mistake};

/// Vector of a particle.
pub type Triple = [f64; 3];

/// Masses and springs, with the state at the start.
pub struct Plain {
    pub list: List,
    /// Kind of each spring.
    kinds: Vec<SpringKind>,
    /// Whether each particle is pinned.
    pinned: Vec<bool>,
}

impl Plain {
    /// Returns the masses and springs of a scene, without its obstacles.
    ///
    /// # Errors
    /// The scene has other parts.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let (list, network) = (List::in_flight(scene)?, scene.model.network().into_iter());
        let pinned = (0..list.mass.len()).map(|i| list.pinned.contains(&i));
        Ok(Self {
            pinned: pinned.collect(),
            kinds: network.flat_map(Network::springs).map(|it| it.kind).collect(),
            list,
        })
    }

    /// Returns whether forces depend on velocities.
    pub fn is_damped(&self) -> bool {
        self.list.drag > 0.0 || self.list.springs.iter().any(|spring| spring.4 > 0.0)
    }

    /// Returns all values of a constant.
    fn values(&self, constant: Constant) -> Vec<f64> {
        let length = |v: &Triple| dot(*v, *v).sqrt();
        let (list, springs) = (&self.list, self.list.springs.iter());
        match constant {
            Constant::Gravity => vec![length(&list.gravity)],
            Constant::Stiffness => springs.map(|spring| spring.2).collect(),
            Constant::RestLength => springs.map(|spring| spring.3).collect(),
            Constant::Damping => springs.map(|spring| spring.4).collect(),
            Constant::Drag => vec![list.drag],
            Constant::Mass => list.mass.clone(),
            Constant::Start => list.velocities.iter().map(length).collect(),
            Constant::Springs | Constant::Velocities => vec![],
        }
    }

    /// Returns the changes of constants that change anything in this network, with the values of
    /// the scene.
    pub fn changes(&self) -> impl Iterator<Item = Mistake> {
        let all = CONSTANTS.iter().map(|&(constant, ..)| {
            let values = self.values(constant);
            let is_one = constant != Constant::Start && values.iter().all(|it| *it == values[0]);
            Mistake::Constant(Change {
                constant,
                factor: 1.0,
                own: values.first().copied().filter(|_| is_one),
            })
        });
        all.filter(|change| self.can_have(*change))
    }

    /// Returns whether a mistake changes anything in this network.
    pub fn can_have(&self, mistake: Mistake) -> bool {
        let list = &self.list;
        let any = |constant| self.values(constant).iter().any(|value| *value > 0.0);
        let (elastic, damps) = (!list.springs.is_empty(), any(Constant::Damping));
        let pulls = list.gravity.iter().any(|g| *g != 0.0);
        let has_unit_masses = list.mass.iter().all(|m| *m == 1.0);
        match mistake {
            Mistake::Constant(change) => match change.constant {
                Constant::Springs => damps,
                Constant::Mass => elastic || list.drag > 0.0,
                Constant::Velocities => true,
                constant => self.values(constant).iter().any(|value| *value != 0.0),
            },
            Mistake::GravityAsForce => pulls && !has_unit_masses,
            Mistake::StretchAsRatio => any(Constant::RestLength),
            Mistake::NotNormalised | Mistake::FirstEndOnly | Mistake::SecondEndOnly => elastic,
            Mistake::DampingAcross => damps,
            Mistake::DragPerMass => list.drag > 0.0 && !has_unit_masses,
            Mistake::UnitMasses => !has_unit_masses,
            Mistake::ForcesKept => elastic || pulls,
            Mistake::PinsMove => self.pinned.contains(&true),
            Mistake::NoShearSprings => self.kinds.contains(&SpringKind::Shear),
            Mistake::NoBendSprings => self.kinds.contains(&SpringKind::Bend),
        }
    }
}

/// Forces of a plain network, with a mistake or without.
pub struct Forces<'a> {
    plain: &'a Plain,
    mistake: Option<Mistake>,
    /// Drag is left out, for schemes that take it otherwise.
    pub without_drag: bool,
    /// The program computes in single precision.
    pub is_single: bool,
    /// Forces of earlier evaluations, which [`Mistake::ForcesKept`] never clears (N).
    kept: Vec<Triple>,
}

impl<'a> Forces<'a> {
    pub fn new(plain: &'a Plain, mistake: Option<Mistake>, is_single: bool) -> Self {
        Self {
            plain,
            mistake,
            without_drag: false,
            is_single,
            kept: vec![[0.0; 3]; plain.pinned.len()],
        }
    }

    /// Returns the value of a constant over that in the scene.
    pub fn factor(&self, constant: Constant) -> f64 {
        match self.mistake {
            Some(Mistake::Constant(change)) if change.constant == constant => change.factor,
            _ => 1.0,
        }
    }

    /// Rounds a number as the program does.
    pub fn rounded(&self, number: f64) -> f64 {
        if self.is_single { f64::from(number as f32) } else { number }
    }

    /// Returns whether a particle never moves.
    pub fn holds(&self, i: usize) -> bool {
        self.plain.pinned[i] && self.mistake != Some(Mistake::PinsMove)
    }

    fn mass(&self, i: usize) -> f64 {
        self.rounded(self.factor(Constant::Mass) * self.plain.list.mass[i])
    }

    /// Returns the rate at which drag slows a particle down (1/s).
    pub fn drag_rate(&self, i: usize) -> f64 {
        self.factor(Constant::Drag) * self.plain.list.drag / self.mass(i)
    }

    /// Accelerations (m/s2) of all particles, 0 for those that are held.
    pub fn accelerations(&mut self, x: &[Triple], v: &[Triple]) -> Vec<Triple> {
        let mut forces = std::mem::take(&mut self.kept);
        if self.mistake != Some(Mistake::ForcesKept) {
            forces.fill([0.0; 3]);
        }
        self.add_forces(x, v, &mut forces);
        let mass = |i: usize| match self.mistake {
            Some(Mistake::UnitMasses) => 1.0,
            _ => self.mass(i),
        };
        let of = |(i, force): (usize, &Triple)| {
            let held = self.holds(i).then_some([0.0; 3]);
            held.unwrap_or_else(|| force.map(|f| self.rounded(f / mass(i))))
        };
        let all = forces.iter().enumerate().map(of).collect();
        self.kept = forces;
        all
    }

    /// Adds the forces (N) of springs, gravity and drag.
    fn add_forces(&self, x: &[Triple], v: &[Triple], forces: &mut [Triple]) {
        let is = |mistake: Mistake| self.mistake == Some(mistake);
        let springs = self.factor(Constant::Springs);
        let stiffness = springs * self.factor(Constant::Stiffness);
        let damping = springs * self.factor(Constant::Damping);
        let rest_length = self.factor(Constant::RestLength);
        let springs = self.plain.list.springs.iter().zip(&self.plain.kinds);
        for (&(i, j, own_stiffness, own_length, own_damping), kind) in springs {
            if is(Mistake::NoShearSprings) && *kind == SpringKind::Shear
                || is(Mistake::NoBendSprings) && *kind == SpringKind::Bend
            {
                continue;
            }
            let apart: Triple = std::array::from_fn(|a| x[i][a] - x[j][a]);
            let length = self.rounded(dot(apart, apart).sqrt());
            if length == 0.0 {
                continue;
            }
            let along = apart.map(|d| d / length);
            let rest = self.rounded(rest_length * own_length);
            let mut pull = self.rounded(stiffness * own_stiffness) * (length - rest);
            if is(Mistake::StretchAsRatio) && rest > 0.0 {
                pull /= rest;
            }
            if is(Mistake::NotNormalised) {
                pull *= length;
            }
            let mut force = along.map(|u| pull * u);
            let faster: Triple = std::array::from_fn(|a| v[i][a] - v[j][a]);
            let rate = dot(faster, along);
            let across = is(Mistake::DampingAcross);
            for a in 0..3 {
                let damped = if across { faster[a] } else { rate * along[a] };
                force[a] += damping * own_damping * damped;
                if !is(Mistake::SecondEndOnly) {
                    forces[i][a] -= force[a];
                }
                if !is(Mistake::FirstEndOnly) {
                    forces[j][a] += force[a];
                }
            }
        }
        let gravity = self.factor(Constant::Gravity);
        for (i, force) in forces.iter_mut().enumerate() {
            let mass = self.mass(i);
            let as_force = is(Mistake::GravityAsForce);
            let weight = if as_force { 1.0 } else { mass };
            let mut drag = self.factor(Constant::Drag) * self.plain.list.drag;
            if self.without_drag {
                drag = 0.0;
            } else if is(Mistake::DragPerMass) {
                drag *= mass;
            }
            for a in 0..3 {
                let fall = self.rounded(gravity * self.plain.list.gravity[a]);
                force[a] += weight * fall - drag * v[i][a];
            }
        }
    }
}

fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
