//! Views of the models of this crate for methods: of rows of particles, and of rigid bodies.

use std::ops::Range;

use crate::measure::Measure;
use crate::rows::{Rows, Terms};

/// View of [`Rows`], of which other crates see only whether it is there.
#[derive(Clone, Copy)]
pub struct RowsView<'a>(pub(crate) &'a dyn Rows);

/// View of [`Rigid`], of which other crates see only whether it is there.
#[derive(Clone, Copy)]
pub struct RigidView<'a>(pub(crate) &'a dyn Rigid);

/// A system whose state y = [x | v | z] holds more than positions and velocities: the rotations and
/// the angular momenta of rigid bodies.
pub(crate) trait Rigid {
    /// Returns the length of the state.
    fn length(&self) -> usize;

    /// Writes y' = f(t, y) to `dydt`.
    fn rates(&self, t: f64, y: &[f64], dydt: &mut [f64]);

    /// Writes the rates of velocities and angular momenta by the forces of these terms to `rates`,
    /// and 0 for all the rest of y.
    fn kick(&self, t: f64, terms: Terms, y: &[f64], rates: &mut [f64]);

    /// Returns whether the forces of a kick depend on velocities.
    fn kick_reads_velocity(&self) -> bool;

    /// Moves y from t to t + h (s) by its motion without the forces of a kick.
    fn drift(&self, t: f64, h: f64, terms: Terms, y: &mut [f64]);

    /// Returns whether number k of the state is a position or a velocity of a point of a body: no f
    /// reads it, and [`place`](Self::place) writes it.
    fn is_carried(&self, k: usize) -> bool;

    /// Puts pins and the points of bodies in their places at time t (s).
    fn place(&self, t: f64, y: &mut [f64]);

    /// Moves y by the least distance, weighted by the masses, to where joints are met and stay so.
    fn project(&self, y: &mut [f64]);

    /// Visits the numbers of the state with their quantities, except those of the points of bodies.
    fn measures(&self, visit: &mut dyn FnMut(Range<usize>, Measure));
}
