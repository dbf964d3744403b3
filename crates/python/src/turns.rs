//! A value that threads use in turns, in the order in which they ask for it.

use std::collections::VecDeque;
use std::ops::{Deref, DerefMut};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::{self, ThreadId};
use std::time::Duration;

use pyo3::prelude::*;

/// Time between two looks for Ctrl-C while a thread waits.
const PATIENCE: Duration = Duration::from_millis(50);

/// Value for one thread at a time.
pub struct Turns<T> {
    value: Mutex<T>,
    /// Threads that use the value or wait for it; the first one uses it.
    queue: Mutex<VecDeque<ThreadId>>,
    changed: Condvar,
}

/// Turn of a thread, which ends when it is dropped.
pub struct Turn<'a, T> {
    value: MutexGuard<'a, T>,
    _place: Place<'a, T>,
}

impl<T> Deref for Turn<'_, T> {
    type Target = T;

    fn deref(&self) -> &T {
        &self.value
    }
}

impl<T> DerefMut for Turn<'_, T> {
    fn deref_mut(&mut self) -> &mut T {
        &mut self.value
    }
}

/// Place of a thread in the queue.
struct Place<'a, T>(&'a Turns<T>);

impl<T: Send> Turns<T> {
    /// Creates the turns of a value.
    pub fn new(value: T) -> Self {
        Self { value: Mutex::new(value), queue: Mutex::default(), changed: Condvar::new() }
    }

    fn queue(&self) -> MutexGuard<'_, VecDeque<ThreadId>> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for the turn of this thread, without the global lock. `None` if the thread has its
    /// turn already.
    ///
    /// # Errors
    /// A signal, such as Ctrl-C, ended the wait.
    pub fn wait(&self, py: Python<'_>) -> PyResult<Option<Turn<'_, T>>> {
        let me = thread::current().id();
        let mut queue = self.queue();
        if queue.contains(&me) {
            return Ok(None);
        }
        queue.push_back(me);
        drop(queue);
        let place = Place(self);
        while self.queue().front() != Some(&me) {
            py.detach(|| {
                let queue = self.queue();
                if queue.front() != Some(&me) {
                    drop(self.changed.wait_timeout(queue, PATIENCE));
                }
            });
            py.check_signals()?;
        }
        Ok(Some(Turn {
            value: self.value.lock().unwrap_or_else(PoisonError::into_inner),
            _place: place,
        }))
    }
}

impl<T> Drop for Place<'_, T> {
    fn drop(&mut self) {
        let me = thread::current().id();
        let mut queue = self.0.queue.lock().unwrap_or_else(PoisonError::into_inner);
        queue.retain(|thread| *thread != me);
        drop(queue);
        self.0.changed.notify_all();
    }
}
