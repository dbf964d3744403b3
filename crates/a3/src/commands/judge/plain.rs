//! Masses and springs alone, with the forces of a course's program. They share no code with the
//! solvers, and make the usual mistakes on request.

use a3_core::{Scene, SpringKind};
use a3_scenes::List;

use super::mistake::Mistake;

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
            Mistake::HalfGravity
            | Mistake::DoubleGravity
            | Mistake::NoGravity
            | Mistake::GravityUpwards => pulls,
            Mistake::GravityAsForce => pulls && !has_unit_masses,
            Mistake::RestLengthZero | Mistake::StretchAsRatio => stretches,
            Mistake::NotNormalised
            | Mistake::SpringsPush
            | Mistake::SpringsTwice
            | Mistake::FirstEndOnly
            | Mistake::SecondEndOnly => elastic,
            Mistake::NoSpringDamping | Mistake::DampingAcross => damps,
            Mistake::NoDrag => self.drag > 0.0,
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
    /// Forces of earlier evaluations, which [`Mistake::ForcesKept`] never clears (N).
    kept: Vec<Triple>,
}

impl<'a> Forces<'a> {
    pub fn new(plain: &'a Plain, mistake: Option<Mistake>) -> Self {
        Self {
            plain,
            mistake,
            without_drag: false,
            kept: vec![[0.0; 3]; plain.particles()],
        }
    }

    /// Returns whether a particle never moves.
    pub fn holds(&self, i: usize) -> bool {
        self.plain.pinned[i] && self.mistake != Some(Mistake::PinsMove)
    }

    /// Returns the rate at which drag slows a particle down (1/s).
    pub fn drag_rate(&self, i: usize) -> f64 {
        self.plain.drag / self.plain.mass[i]
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
            _ => self.plain.mass[i],
        };
        let of = |(i, force): (usize, &Triple)| {
            if self.holds(i) {
                [0.0; 3]
            } else {
                force.map(|f| f / mass(i))
            }
        };
        let all = forces.iter().enumerate().map(of).collect();
        self.kept = forces;
        all
    }

    /// Adds the forces (N) of springs, gravity and drag.
    fn add_forces(&self, x: &[Triple], v: &[Triple], forces: &mut [Triple]) {
        let is = |mistake: Mistake| self.mistake == Some(mistake);
        for spring in &self.plain.springs {
            let [i, j] = spring.ends;
            if is(Mistake::NoShearSprings) && spring.kind == SpringKind::Shear
                || is(Mistake::NoBendSprings) && spring.kind == SpringKind::Bend
            {
                continue;
            }
            let apart: Triple = std::array::from_fn(|a| x[i][a] - x[j][a]);
            let length = dot(apart, apart).sqrt();
            if length == 0.0 {
                continue;
            }
            let along = apart.map(|d| d / length);
            let rest = if is(Mistake::RestLengthZero) {
                0.0
            } else {
                spring.rest_length
            };
            let mut pull = spring.stiffness * (length - rest);
            if is(Mistake::StretchAsRatio) && rest > 0.0 {
                pull /= rest;
            }
            if is(Mistake::NotNormalised) {
                pull *= length;
            }
            if is(Mistake::SpringsTwice) {
                pull *= 2.0;
            }
            if is(Mistake::SpringsPush) {
                pull = -pull;
            }
            let mut force = along.map(|u| pull * u);
            let faster: Triple = std::array::from_fn(|a| v[i][a] - v[j][a]);
            if !is(Mistake::NoSpringDamping) {
                let rate = dot(faster, along);
                for a in 0..3 {
                    force[a] += spring.damping
                        * if is(Mistake::DampingAcross) {
                            faster[a]
                        } else {
                            rate * along[a]
                        };
                }
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
        let share = match self.mistake {
            Some(Mistake::HalfGravity) => 0.5,
            Some(Mistake::DoubleGravity) => 2.0,
            Some(Mistake::NoGravity) => 0.0,
            Some(Mistake::GravityUpwards) => -1.0,
            _ => 1.0,
        };
        for (i, force) in forces.iter_mut().enumerate() {
            let mass = self.plain.mass[i];
            let weight = if is(Mistake::GravityAsForce) {
                1.0
            } else {
                mass
            };
            let mut drag = self.plain.drag;
            if is(Mistake::NoDrag) || self.without_drag {
                drag = 0.0;
            } else if is(Mistake::DragPerMass) {
                drag *= mass;
            }
            for a in 0..3 {
                force[a] += share * weight * self.plain.gravity[a] - drag * v[i][a];
            }
        }
    }
}

fn dot(a: Triple, b: Triple) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
