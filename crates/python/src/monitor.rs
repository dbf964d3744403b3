//! The companion of long work, which another thread watches and can stop.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::prelude::*;

use super::function::Raised;

/// What is known of the work.
#[derive(Clone, Default)]
struct State {
    stage: String,
    expected: f64,
    done: f64,
    warnings: Vec<String>,
    /// Functions of Python that take part.
    raised: Vec<Raised>,
}

/// Companion of long work: the work runs in one thread, and another asks how far it is, and may
/// stop it.
#[pyclass(frozen, module = "a3_simulator._a3")]
#[derive(Default)]
pub struct Monitor {
    stopped: AtomicBool,
    state: Mutex<State>,
}

impl Monitor {
    /// Watches the functions of Python that take part.
    pub fn watch(&self, raised: &[Raised]) {
        self.change(|state| state.raised = raised.to_vec());
    }

    fn change(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

#[pymethods]
impl Monitor {
    #[new]
    fn new() -> Self {
        Self::default()
    }

    /// Asks the work to end.
    fn stop(&self) {
        self.stopped.store(true, Ordering::Relaxed);
    }

    /// Lists the threads that are in functions of Python now.
    fn threads(&self) -> Vec<u64> {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.raised.iter().flat_map(Raised::threads).collect()
    }

    /// Returns the stage of the work, the share of it that is done, from 0 to 1, and the warnings
    /// so far.
    fn look(&self) -> (String, f64, Vec<String>) {
        let state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        let share =
            if state.expected > 0.0 { (state.done / state.expected).clamp(0.0, 1.0) } else { 0.0 };
        (state.stage.clone(), share, state.warnings.clone())
    }
}

impl a3_files::monitor::Monitor for Monitor {
    fn go_on(&self) -> bool {
        !self.stopped.load(Ordering::Relaxed)
    }

    fn stage(&self, what: &str) {
        self.change(|state| what.trim().clone_into(&mut state.stage));
    }

    fn expect(&self, work: f64) {
        self.change(|state| (state.expected, state.done) = (work, 0.0));
    }

    fn advance(&self, work: f64) {
        self.change(|state| state.done += work);
    }

    fn warn(&self, line: &str) {
        self.change(|state| state.warnings.push(line.into()));
    }
}
