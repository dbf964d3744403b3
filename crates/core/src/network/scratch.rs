//! Scratch for the evaluations of rigid bodies.

use std::sync::{Mutex, PoisonError};

/// Positions, velocities and forces of one evaluation, n x 3 each. It is no part of the value of
/// what owns it.
#[derive(Debug, Default)]
pub(super) struct Scratch(Mutex<[Vec<f64>; 3]>);

impl Clone for Scratch {
    fn clone(&self) -> Self {
        let own = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        Self(Mutex::new(own.clone()))
    }
}

impl Scratch {
    pub fn reserve(&mut self, n: usize) {
        let own = self.0.get_mut().unwrap_or_else(PoisonError::into_inner);
        *own = [(); 3].map(|()| vec![0.0; 3 * n]);
    }

    /// Lends the scratch; evaluations that run meanwhile bring their own.
    pub fn lend<T>(&self, n: usize, run: impl FnOnce(&mut [Vec<f64>; 3]) -> T) -> T {
        match self.0.try_lock() {
            Ok(mut scratch) => run(&mut scratch),
            Err(_) => run(&mut [(); 3].map(|()| vec![0.0; 3 * n])),
        }
    }
}
