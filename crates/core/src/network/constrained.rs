//! Constraints of a network, and the hand that attracts what they hold.

use nalgebra::Vector3;

use super::Network;
use crate::constraints::Constraint;
use crate::elements::{Attraction, Element};
use crate::error::Error;
use crate::path::Path;

impl Network {
    /// Adds a constraint, which is held by forces: a state that breaks it is drawn back to it.
    ///
    /// # Errors
    /// There is no such particle, or it is a point of a rigid body; both ends of a rod are the
    /// same; or a number makes no sense.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.check_particle(first)?;
        self.check_particle(second.unwrap_or(first))?;
        for i in [first, second.unwrap_or(first)] {
            if self.is_carried(i) {
                return Err(Error::Invalid(format!(
                    "a constraint cannot hold particle {i}, a point of a rigid body: join the \
                     body by a spring, or hold its centre"
                )));
            }
        }
        self.constraints.add(constraint)
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

    pub(super) fn is_constrained(&self) -> bool {
        !self.constraints.all().is_empty()
    }

    /// Adds the forces of the constraints, if there are any, to all others.
    pub(super) fn hold(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        if self.is_constrained() {
            let pin = |i: usize| {
                let pin = self.pins_of(i..i + 1).first();
                pin.map_or_else(Vector3::zeros, |pin| pin.path.at(t).acceleration)
            };
            self.constraints
                .add_forces(&self.inverse_masses, pin, [x, v], f);
        }
    }
}
