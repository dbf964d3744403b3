//! Scratch that evaluations of the same constraints borrow, on any thread.

use std::sync::{Mutex, MutexGuard, PoisonError};

use super::solve::Scratch;

/// Scratch for one evaluation at a time; others that run meanwhile bring their own. It is no part
/// of the value of what owns it: a clone has scratch of the same size.
#[derive(Debug, Default)]
pub(super) struct Pool(Mutex<Scratch>);

impl Pool {
    fn lock(&self) -> MutexGuard<'_, Scratch> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Makes room for so many equations and particles.
    pub fn reserve(&mut self, rows: usize, particles: usize) {
        self.lock().reserve(rows, particles);
    }

    /// Lends the scratch.
    pub fn lend<T>(&self, run: impl FnOnce(&mut Scratch) -> T) -> T {
        match self.0.try_lock() {
            Ok(mut scratch) => run(&mut scratch),
            Err(_) => run(&mut Scratch::default()),
        }
    }
}

impl Clone for Pool {
    fn clone(&self) -> Self {
        let (mut pool, own) = (Self::default(), self.lock());
        pool.reserve(own.rows.capacity(), own.vectors.capacity());
        pool
    }
}
