//! The monitor of long work: it decides whether the work may go on, and receives its progress.

use super::failure::Failure;

/// Monitor of long work. Every function has a default, so that `()` watches nothing, and a
/// function that returns whether the work may go on is a monitor too.
pub trait Monitor: Sync {
    /// Returns whether the work may go on. It is asked many times a second, also from several
    /// threads at once; the work ends soon after it has returned false.
    fn go_on(&self) -> bool {
        true
    }

    /// Receives the name of the present stage, such as that of a method.
    fn stage(&self, _what: &str) {}

    /// Receives the total amount of work, in a unit of its own. None of it is done yet.
    fn expect(&self, _work: f64) {}

    /// Marks the end of the preparations: the work itself begins.
    fn start(&self) {}

    /// Receives the amount of work that was done since the last call.
    fn advance(&self, _work: f64) {}

    /// Marks the end or the interruption of the work.
    fn clear(&self) {}

    /// Receives a warning.
    fn warn(&self, _line: &str) {}

    /// Receives a remark on a result.
    ///
    /// # Errors
    /// It could not be written.
    fn note(&self, _line: &str) -> Result<(), Failure> {
        Ok(())
    }
}

impl Monitor for () {}

impl<F: Fn() -> bool + Sync> Monitor for F {
    fn go_on(&self) -> bool {
        self()
    }
}
