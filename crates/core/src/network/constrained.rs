//! Constraints of a network, and the hand that attracts what they hold.

use nalgebra::Vector3;

use super::Network;
use crate::constraints::{Constraint, Constraints, Turning};
use crate::elements::{Attraction, Element};
use crate::error::{Error, Unmet};
use crate::path::Path;
use crate::rigid::Body;

/// Time in which a contradiction counts as one that is already there, over that in which errors are
/// taken back.
const SOON: f64 = 0.1;

impl Network {
    /// Adds a constraint, which is held by forces: a state that breaks it is drawn back to it.
    ///
    /// # Errors
    /// There is no such particle; both ends of a rod are the same; or a number makes no sense.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.check_particle(first)?;
        self.check_particle(second.unwrap_or(first))?;
        let (bodies, masses) = (&self.bodies, &self.masses);
        self.constraints
            .add(constraint, |i| carrier(bodies, masses, i))
    }

    /// The constraints, their directions of length 1.
    #[must_use]
    pub fn constraints(&self) -> &[Constraint] {
        self.constraints.all()
    }

    /// Whether constraints hold particle i.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        self.constraints()
            .iter()
            .any(|c| c.ends().0 == i || c.ends().1 == Some(i))
    }

    /// Attracts a particle that constraints hold to a path, by a spring of that natural frequency
    /// (1/s): a pin would tear the constraints.
    pub(crate) fn attract(&mut self, particle: usize, path: Path, frequency: f64) {
        self.let_go();
        let attraction = Attraction {
            particle,
            mass: self.mass_behind(particle),
            path,
            frequency,
        };
        self.insert(attraction.into());
    }

    /// Ends the attraction.
    pub(crate) fn let_go(&mut self) {
        self.replace(|element| matches!(element, Element::Attraction(_)), None);
    }

    /// The other end and the length (m) of each rod attached to particle i.
    pub fn rods_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        self.constraints().iter().filter_map(move |c| match *c {
            Constraint::Rod { i: a, j: b, length } if a == i || b == i => Some((a + b - i, length)),
            _ => None,
        })
    }

    /// The largest error |C| (m) of the constraints at x. `None` without constraints.
    #[must_use]
    pub fn constraint_error(&self, x: &[f64]) -> Option<f64> {
        self.constraints.error(x)
    }

    /// The constraint that is farthest from being met at x, in a scene of that radius (m).
    #[must_use]
    pub fn worst_constraint(&self, x: &[f64], radius: f64) -> Option<Unmet> {
        self.constraints.worst(x, radius)
    }

    /// A constraint that cannot be met near x (m) at time t (s), when pins are in their places, or
    /// soon after, because it contradicts others or the pins. Not known for those of rigid bodies.
    #[must_use]
    pub fn contradiction(&self, t: f64, x: &[f64], radius: f64) -> Option<Unmet> {
        let n = self.particles();
        let soon = SOON / self.constraints.baumgarte_frequency();
        [t, t + soon].into_iter().find_map(|t| {
            let mut x = x.to_vec();
            for (i, path) in self.pins() {
                let place = path.at(t).position;
                for axis in 0..3 {
                    x[axis * n + i] = place[axis];
                }
            }
            let masses = &self.inverse_masses;
            self.constraints.contradiction(masses, &mut x, radius)
        })
    }

    /// Whether the constraints at the state (x, v) at time t (s) are nearly singular, as those of a
    /// chain that is stretched straight between two pins: no force holds it there. Not known for
    /// those of rigid bodies. Writes the forces to f.
    pub(crate) fn is_nearly_singular(
        &self,
        t: f64,
        x: &[f64],
        v: &[f64],
        f: &mut Vec<f64>,
    ) -> bool {
        if !self.is_constrained() || !self.bodies.is_empty() {
            return false;
        }
        f.resize(x.len(), 0.0);
        self.other_forces(t, x, v, f);
        self.hold_particles(t, [x, v], f)
    }

    /// Sets the natural frequency w (1/s) with which errors of the constraints are taken back, like
    /// a critically damped spring, C'' = -w2 C - 2 w C' (Baumgarte). It is 10 unless set: errors
    /// are gone within a second, slowly for any step that shows motion at all. Explicit methods
    /// need steps well below 1 / w.
    ///
    /// # Errors
    /// w is not a finite number above 0.
    pub fn set_baumgarte_frequency(&mut self, w: f64) -> Result<(), Error> {
        self.constraints.set_baumgarte_frequency(w)
    }

    /// Rate at which a drift off a constraint is corrected (1/s); 0 if there is none.
    pub(super) fn correction_rate(&self) -> f64 {
        if self.is_constrained() {
            self.constraints.baumgarte_frequency()
        } else {
            0.0
        }
    }

    pub(crate) fn is_constrained(&self) -> bool {
        !self.constraints.all().is_empty()
    }

    /// Adds the constraints anew: other bodies carry what they hold.
    pub(super) fn renew_constraints(&mut self) -> Result<(), Error> {
        let mut constraints = Constraints::default();
        constraints.set_baumgarte_frequency(self.constraints.baumgarte_frequency())?;
        for constraint in self.constraints.all() {
            constraints.add(*constraint, |i| carrier(&self.bodies, &self.masses, i))?;
        }
        self.constraints = constraints;
        Ok(())
    }

    /// Adds the forces of the constraints, if there are any, to all others, where there are no
    /// rigid bodies: positions and velocities alone do not say how these turn. Returns whether the
    /// constraints are nearly singular.
    pub(super) fn hold_particles(&self, t: f64, state: [&[f64]; 2], f: &mut [f64]) -> bool {
        let none = |_, _: &[f64]| unreachable!("there are no bodies");
        self.bodies.is_empty() && self.hold(t, state, none, f)
    }

    /// Adds the forces of the constraints, if there are any, to all others. `bodies` gives how a
    /// body turns and the acceleration of its centre, under given forces. Returns whether the
    /// constraints are nearly singular.
    pub(super) fn hold(
        &self,
        t: f64,
        [x, v]: [&[f64]; 2],
        bodies: impl Fn(usize, &[f64]) -> (Turning, Vector3<f64>),
        f: &mut [f64],
    ) -> bool {
        if !self.is_constrained() {
            return false;
        }
        let motion = |i: usize, f: &[f64]| {
            let (n, w) = (self.particles(), self.inverse_masses[i]);
            let centered = || self.bodies.iter().position(|body| body.center() == i);
            let acceleration = if w == 0.0 {
                let pin = self.pins_of(i..i + 1).first();
                pin.map_or_else(Vector3::zeros, |pin| pin.path.at(t).acceleration)
            } else if let Some(k) = centered() {
                bodies(k, f).1
            } else {
                Vector3::new(f[i], f[n + i], f[2 * n + i]) * w
            };
            (w, acceleration)
        };
        self.constraints
            .add_forces(motion, |k, f| bodies(k, f).0, [x, v], f)
    }
}

/// Centre and number of the body that carries particle i.
fn carrier(bodies: &[Body], masses: &[f64], i: usize) -> Option<(usize, usize)> {
    let carried = masses[i] == 0.0;
    let k = carried.then(|| bodies.iter().position(|body| body.points().contains(&i)))??;
    Some((bodies[k].center(), k))
}
