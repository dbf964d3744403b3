//! Scratch memory that evaluations of the same value borrow, on any thread.

use std::fmt;
use std::mem::take;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Buffers that a value lends to its evaluations, so that a step allocates nothing. They are no
/// part of the value: a clone of it begins with empty ones.
#[derive(Default)]
pub(crate) struct Scratch<T>(Mutex<T>);

impl<T: Default> Scratch<T> {
    /// Lends the buffers to `work`. They are taken out for it, and no lock is held meanwhile: a
    /// concurrent evaluation gets empty ones, and so does the next one if `work` panics.
    pub fn lend<R>(&self, work: impl FnOnce(&mut T) -> R) -> R {
        let mut buffers = take(&mut *self.lock());
        let result = work(&mut buffers);
        *self.lock() = buffers;
        result
    }

    fn lock(&self) -> MutexGuard<'_, T> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<T: Default> Clone for Scratch<T> {
    fn clone(&self) -> Self {
        Self::default()
    }
}

impl<T> fmt::Debug for Scratch<T> {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Scratch")
    }
}

#[cfg(test)]
mod tests {
    use std::panic::{AssertUnwindSafe, catch_unwind};

    use super::*;

    fn len(scratch: &Scratch<Vec<u8>>) -> usize {
        scratch.lend(|buffer| buffer.len())
    }

    #[test]
    fn buffers_are_kept_from_one_evaluation_to_the_next() {
        let scratch = Scratch::<Vec<u8>>::default();
        scratch.lend(|buffer| buffer.resize(3, 0));
        assert_eq!(len(&scratch), 3);
        assert_eq!(len(&scratch.clone()), 0);
    }

    #[test]
    fn an_evaluation_within_another_gets_empty_buffers() {
        let scratch = Scratch::<Vec<u8>>::default();
        scratch.lend(|buffer| {
            buffer.resize(3, 0);
            assert_eq!(len(&scratch), 0);
        });
        assert_eq!(len(&scratch), 3);
    }

    #[test]
    fn a_panic_leaves_empty_buffers() {
        let scratch = Scratch::<Vec<u8>>::default();
        scratch.lend(|buffer| buffer.resize(3, 0));
        let panicking = || scratch.lend(|_| panic!("on purpose"));
        assert!(catch_unwind(AssertUnwindSafe(panicking)).is_err());
        assert_eq!(len(&scratch), 0);
    }
}
