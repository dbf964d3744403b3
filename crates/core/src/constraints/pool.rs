//! Scratch for evaluations of the same constraints, on any thread.

use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::solve::Scratch;

/// Scratch for one evaluation at a time; concurrent ones use fresh scratch. It is not part of its
/// owner's value: a clone has new scratch of the same size.
#[derive(Default)]
pub(super) struct Pool(Mutex<Scratch>);

impl Pool {
    fn lock(&self) -> MutexGuard<'_, Scratch> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes room for `rows` equations, which move `moved` particles and rotations.
    pub fn reserve(&mut self, rows: usize, moved: usize) {
        self.lock().reserve(rows, moved);
    }

    /// Lends the scratch.
    pub fn lend<T>(&self, run: impl FnOnce(&mut Scratch) -> T) -> T {
        match self.0.try_lock() {
            Ok(mut scratch) => run(&mut scratch),
            Err(_) => run(&mut Scratch::default()),
        }
    }
}

impl fmt::Debug for Pool {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("Pool")
    }
}

impl Clone for Pool {
    fn clone(&self) -> Self {
        let (mut pool, own) = (Self::default(), self.lock());
        pool.reserve(own.rows.capacity(), own.weights.capacity());
        pool
    }
}
