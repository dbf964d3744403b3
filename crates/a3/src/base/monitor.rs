//! The companion of long work, which says whether it may go on and is told how far it is.

use super::failure::Failure;

/// Companion of long work. Every function has a default, so that `()` watches nothing, and a
/// function that returns whether the work may go on is a monitor too.
pub trait Monitor: Sync {
    /// Returns whether the work may go on. It is asked many times a second, also from several
    /// threads at once; the work ends soon after it has returned false.
    fn go_on(&self) -> bool {
        true
    }

    /// Is told what is done now, such as the name of a method.
    fn stage(&self, _what: &str) {}

    /// Is told how much work there is in all, in a unit of its own. None of it is done yet.
    fn expect(&self, _work: f64) {}

    /// Is told that the preparations are over, and the work itself begins.
    fn start(&self) {}

    /// Is told that a part of the work is done.
    fn advance(&self, _work: f64) {}

    /// Is told that the work is over or interrupted.
    fn clear(&self) {}

    /// Is given a warning.
    fn warn(&self, _line: &str) {}

    /// Is given a remark on what was found.
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
