//! The time until which the errors of a comparison are meaningful, found in the background.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use a3_core::Scene;
use a3_core::accuracy::horizon;

/// A search, on its own thread, for the time past which errors say little: small differences have
/// grown 10,000 times by then.
#[derive(Default)]
pub struct Predictability {
    /// The time (s) once it is known; infinite if the scene is not chaotic.
    until: Arc<OnceLock<f64>>,
    ended: Arc<AtomicBool>,
    search: Option<JoinHandle<()>>,
}

impl Predictability {
    /// Starts the search in a scene. Without threads, nothing is found.
    pub fn new(scene: Scene) -> Self {
        let mut this = Self::default();
        let (until, ended) = (this.until.clone(), this.ended.clone());
        let search = move || {
            let go_on = || !ended.load(Ordering::Relaxed);
            if let Ok(Some(found)) = horizon(&scene, f64::INFINITY, &go_on) {
                let is_chaotic = found.lyapunov.is_finite();
                let _ = until.set(if is_chaotic {
                    found.until
                } else {
                    f64::INFINITY
                });
            }
        };
        this.search = thread::Builder::new().spawn(search).ok();
        this
    }

    /// Returns the time past which errors say little (s), if the scene is chaotic and the search
    /// has ended.
    pub fn until(&self) -> Option<f64> {
        self.until.get().copied().filter(|until| until.is_finite())
    }

    /// Waits for the end of the search.
    pub fn wait(&mut self) {
        if let Some(search) = self.search.take() {
            let _ = search.join();
        }
    }
}

impl Drop for Predictability {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}
