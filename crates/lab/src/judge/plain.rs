//! Masses and springs alone, with the forces of a course's program. They share no code with the
//! solvers, and make the usual mistakes on request.

use a3_core::{Scene, SpringKind};
use a3_scenes::List;

use super::constant::{Change, Constant, Mistake};

/// Vector of a particle.
type Triple = [f64; 3];

/// Spring of a plain network.
struct PlainSpring {
    ends: [usize; 2],
    stiffness: f64,
    rest_length: f64,
    damping: f64,
    kind: SpringKind,
}

/// Masses and springs, with the state at the start.
pub struct Plain {
    mass: Vec<f64>,
    pinned: Vec<bool>,
    springs: Vec<PlainSpring>,
    gravity: Triple,
    drag: f64,
    pub start: [Vec<Triple>; 2],
}

impl Plain {
    /// Returns the masses and springs of a scene, without its obstacles.
    ///
    /// # Errors
    /// The scene has other parts.
    pub fn of(scene: &Scene) -> Result<Self, String> {
        let list = List::in_flight(scene)?;
        let network = scene.model.network().into_iter();
        let kinds = network.flat_map(|network| network.springs().map(|spring| spring.kind));
        let springs = list.springs.iter().zip(kinds);
        let springs = springs.map(
            |(&(i, j, stiffness, rest_length, damping), kind)| PlainSpring {
                ends: [i, j],
                stiffness,
                rest_length,
                damping,
                kind,
            },
        );
        Ok(Self {
            pinned: (0..list.mass.len())
                .map(|i| list.pinned.contains(&i))
                .collect(),
            springs: springs.collect(),
            gravity: list.gravity,
            drag: list.drag,
            start: [list.positions, list.velocities],
            mass: list.mass,
        })
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.mass.len()
    }

    /// Returns whether forces depend on velocities.
    pub fn is_damped(&self) -> bool {
        self.drag > 0.0 || self.springs.iter().any(|spring| spring.damping > 0.0)
    }

    /// Returns whether there is drag.
    pub fn has_drag(&self) -> bool {
        self.drag > 0.0
    }

    /// Returns all values of a constant.
    fn values(&self, constant: Constant) -> Box<dyn Iterator<Item = f64> + '_> {
        let springs = self.springs.iter();
        let length = |v: &Triple| dot(*v, *v).sqrt();
        match constant {
            Constant::Gravity => Box::new([length(&self.gravity)].into_iter()),
            Constant::Stiffness => Box::new(springs.map(|spring| spring.stiffness)),
            Constant::RestLength => Box::new(springs.map(|spring| spring.rest_length)),
            Constant::Damping => Box::new(springs.map(|spring| spring.damping)),
            Constant::Drag => Box::new([self.drag].into_iter()),
            Constant::Mass => Box::new(self.mass.iter().copied()),
            Constant::Start => Box::new(self.start[1].iter().map(length)),
            Constant::Springs | Constant::Velocities => Box::new([].into_iter()),
        }
    }

    /// Returns the changes of constants that change anything in this network, with the values of
    /// the scene.
    pub fn changes(&self) -> Vec<Mistake> {
        let of = |constant| {
            let mut values = self.values(constant);
            let first = values.next();
            let is_one = constant != Constant::Start && values.all(|value| Some(value) == first);
            let own = first.filter(|_| is_one);
            Mistake::Constant(Change {
                constant,
                factor: 1.0,
                own,
            })
        };
        let all = Constant::ALL.into_iter().map(of);
        all.filter(|change| self.can_have(*change)).collect()
    }

    /// Returns whether a mistake changes anything in this network.
    pub fn can_have(&self, mistake: Mistake) -> bool {
        let pulls = self.gravity.iter().any(|g| *g != 0.0);
        let has_unit_masses = self.mass.iter().all(|m| *m == 1.0);
        let damps = self.springs.iter().any(|spring| spring.damping > 0.0);
        let has = |kind| self.springs.iter().any(|spring| spring.kind == kind);
        let (elastic, stretches) = (
            !self.springs.is_empty(),
            self.springs.iter().any(|spring| spring.rest_length > 0.0),
        );
        match mistake {
            Mistake::Constant(change) => match change.constant {
                Constant::Springs => damps,
                Constant::Mass => elastic || self.drag > 0.0,
                Constant::Velocities => true,
                constant => self.values(constant).any(|value| value != 0.0),
            },
            Mistake::GravityAsForce => pulls && !has_unit_masses,
            Mistake::StretchAsRatio => stretches,
            Mistake::NotNormalised | Mistake::FirstEndOnly | Mistake::SecondEndOnly => elastic,
            Mistake::DampingAcross => damps,
            Mistake::DragPerMass => self.drag > 0.0 && !has_unit_masses,
            Mistake::UnitMasses => !has_unit_masses,
            Mistake::ForcesKept => elastic || pulls,
            Mistake::PinsMove => self.pinned.contains(&true),
            Mistake::NoShearSprings => has(SpringKind::Shear),
            Mistake::NoBendSprings => has(SpringKind::Bend),
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
            kept: vec![[0.0; 3]; plain.particles()],
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
        if self.is_single {
            f64::from(number as f32)
        } else {
            number
        }
    }

    /// Returns whether a particle never moves.
    pub fn holds(&self, i: usize) -> bool {
        self.plain.pinned[i] && self.mistake != Some(Mistake::PinsMove)
    }

    fn mass(&self, i: usize) -> f64 {
        self.rounded(self.factor(Constant::Mass) * self.plain.mass[i])
    }

    /// Returns the rate at which drag slows a particle down (1/s).
    pub fn drag_rate(&self, i: usize) -> f64 {
        self.factor(Constant::Drag) * self.plain.drag / self.mass(i)
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
            if self.holds(i) {
                [0.0; 3]
            } else {
                force.map(|f| self.rounded(f / mass(i)))
            }
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
        for spring in &self.plain.springs {
            let [i, j] = spring.ends;
            if is(Mistake::NoShearSprings) && spring.kind == SpringKind::Shear
                || is(Mistake::NoBendSprings) && spring.kind == SpringKind::Bend
            {
                continue;
            }
            let apart: Triple = std::array::from_fn(|a| x[i][a] - x[j][a]);
            let length = self.rounded(dot(apart, apart).sqrt());
            if length == 0.0 {
                continue;
            }
            let along = apart.map(|d| d / length);
            let rest = self.rounded(rest_length * spring.rest_length);
            let mut pull = self.rounded(stiffness * spring.stiffness) * (length - rest);
            if is(Mistake::StretchAsRatio) && rest > 0.0 {
                pull /= rest;
            }
            if is(Mistake::NotNormalised) {
                pull *= length;
            }
            let mut force = along.map(|u| pull * u);
            let faster: Triple = std::array::from_fn(|a| v[i][a] - v[j][a]);
            let rate = dot(faster, along);
            for a in 0..3 {
                force[a] += damping
                    * spring.damping
                    * if is(Mistake::DampingAcross) {
                        faster[a]
                    } else {
                        rate * along[a]
                    };
            }
            for a in 0..3 {
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
            let weight = if is(Mistake::GravityAsForce) {
                1.0
            } else {
                mass
            };
            let mut drag = self.factor(Constant::Drag) * self.plain.drag;
            if self.without_drag {
                drag = 0.0;
            } else if is(Mistake::DragPerMass) {
                drag *= mass;
            }
            for a in 0..3 {
                let fall = self.rounded(gravity * self.plain.gravity[a]);
                force[a] += weight * fall - drag * v[i][a];
            }
        }
    }
}

fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
