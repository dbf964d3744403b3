//! Constraints of a network, and the hand that draws what they hold.

use nalgebra::Vector3;

use super::{Hand, Network};
use crate::constraints::Constraint;
use crate::error::Error;
use crate::path::Path;

impl Network {
    /// Holds particles by one more constraint, by forces: a state that breaks it is drawn back to it.
    ///
    /// # Errors
    /// There is no such particle, both ends of a rod are the same, or a number makes no sense.
    pub fn add_constraint(&mut self, constraint: Constraint) -> Result<(), Error> {
        let (first, second) = constraint.ends();
        self.check_particle(first)?;
        self.check_particle(second.unwrap_or(first))?;
        self.constraints.add(constraint)
    }

    /// The constraints, their directions of length 1.
    #[must_use]
    pub fn constraints(&self) -> &[Constraint] {
        self.constraints.list()
    }

    /// Whether constraints hold particle i.
    #[must_use]
    pub fn is_held(&self, i: usize) -> bool {
        self.constraints()
            .iter()
            .any(|c| c.ends().0 == i || c.ends().1 == Some(i))
    }

    /// Draws particle i, which constraints hold, to a path, by a spring of that frequency (1/s): they stay as they are, which
    /// a pin would tear.
    pub(crate) fn draw(&mut self, particle: usize, path: Path, frequency: f64) {
        self.hand = Some(Hand {
            particle,
            path,
            frequency,
        });
    }

    /// Ends that.
    pub(crate) fn let_go(&mut self) {
        self.hand = None;
    }

    /// The rods attached to particle i: the other end and the length (m) of each.
    pub fn rods_of(&self, i: usize) -> impl Iterator<Item = (usize, f64)> {
        self.constraints().iter().filter_map(move |c| match *c {
            Constraint::Rod { i: a, j: b, length } if a == i || b == i => Some((a + b - i, length)),
            _ => None,
        })
    }

    /// How far the positions x are from what the constraints ask for: the largest |C| (m). `None` without constraints.
    #[must_use]
    pub fn constraint_error(&self, x: &[f64]) -> Option<f64> {
        self.constraints.error(x)
    }

    /// Takes errors of the constraints back like a critically damped spring of this natural frequency w (1/s), C'' = -w2 C -
    /// 2 w C'. It is 10 unless set: gone within a second, and slow for any step that shows motion at all. Explicit
    /// methods need steps well below 1 / w.
    ///
    /// # Errors
    /// w is not a finite number above 0.
    pub fn set_feedback(&mut self, w: f64) -> Result<(), Error> {
        self.constraints.set_feedback(w)
    }

    pub(super) fn is_constrained(&self) -> bool {
        !self.constraints.list().is_empty()
    }

    /// Adds the forces of the constraints, if there are any, to all others: among them that of a hand.
    pub(super) fn hold(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        if self.is_constrained() {
            if let Some(hand) = &self.hand {
                let (n, place, w) = (self.particles(), hand.path.at(t), hand.frequency);
                for axis in 0..3 {
                    let k = axis * n + hand.particle;
                    let pull = w * w * (x[k] - place.position[axis])
                        + 2.0 * w * (v[k] - place.velocity[axis]);
                    f[k] -= self.masses[hand.particle] * pull;
                }
            }
            let pin = |i: usize| {
                let pin = self.pins_of(i..i + 1).first();
                pin.map_or_else(Vector3::zeros, |pin| pin.path.at(t).acceleration)
            };
            self.constraints
                .add_forces(&self.inverse_masses, pin, [x, v], f);
        }
    }
}
