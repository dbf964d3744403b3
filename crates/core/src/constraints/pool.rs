//! Scratch that evaluations of the same constraints borrow, on any thread.

use std::fmt;
use std::sync::{Mutex, MutexGuard, PoisonError};

use super::solve::Scratch;

/// Scratch for one evaluation at a time; others that run meanwhile bring their own. It is no part
/// of the value of what owns it: a clone has scratch of the same size.
#[derive(Default)]
pub(super) struct Pool(Mutex<Scratch>);

impl Pool {
    fn lock(&self) -> MutexGuard<'_, Scratch> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes room for so many equations, and so many things that they move.
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
