//! The fast path of implicit methods on a system, and hints for their choices.

use crate::coupling::{Coupling, Diagonal, Matrix};

/// Price of an iteration of conjugate gradients, in evaluations of the system's forces. It was
/// measured on cloth of 20 x 20 to 128 x 128 particles and on chains.
pub(crate) const ITERATION: f64 = 2.4;

/// Products with the matrix of an implicit step, for the first [`Coupling::Axial`] ones of a
/// system's [couplings](crate::Linearized::couplings). Each method treats as many of these.
pub trait Products {
    /// Writes the product of the matrix with p to `out`: that of the masses and of these couplings.
    /// Returns the number of these couplings.
    fn multiply(&self, matrix: &Matrix, p: &[f64], out: &mut [f64]) -> usize;

    /// Adds the blocks that these couplings contribute to the diagonal of the matrix. Returns the
    /// number of these couplings.
    fn add_diagonal(&self, matrix: &Matrix, diagonal: &mut Diagonal) -> usize;

    /// Visits all other couplings.
    fn other_couplings(&self, t: f64, x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling));
}

/// Numbers by which methods choose how to solve with the forces of a system.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverHints {
    /// Length (m) of a motion in which forces may begin and end again, as those of contact do. An
    /// iteration of Newton's method moves particles no farther. Infinite by default.
    pub reach: f64,
    /// Time of an evaluation of the forces coupling by coupling, over the time of the system's own
    /// evaluation. Prices of linear algebra are relative to the former. 1 by default.
    pub speed: f64,
    /// Cost of the assembly of the matrix, in evaluations of the forces. 4 by default.
    pub assembly: f64,
    /// Cost of an iteration of conjugate gradients with damping alone, in evaluations of the
    /// forces. 2.4 by default.
    pub iteration: f64,
}

impl Default for SolverHints {
    fn default() -> Self {
        Self { reach: f64::INFINITY, speed: 1.0, assembly: 4.0, iteration: ITERATION }
    }
}

impl SolverHints {
    /// Returns whether the same particles are coupled at all x, because no force begins and ends
    /// within its reach. If not, no factorisation is tried, because the pattern of each would have
    /// to be analysed.
    pub(crate) fn pattern_is_fixed(&self) -> bool {
        self.reach.is_infinite()
    }
}
