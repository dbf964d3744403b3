//! How long the errors of a comparison mean something, found beside the runs.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use a3_core::Scene;
use a3_core::accuracy::horizon;

/// Search, on a thread of its own, for the time past which errors say little.
#[derive(Default)]
pub struct Predictability {
    /// The time (s), infinite where there is none, once it is known.
    until: Arc<OnceLock<f64>>,
    ended: Arc<AtomicBool>,
    search: Option<JoinHandle<()>>,
}

impl Predictability {
    /// Begins to search in a scene. Where there are no threads, nothing is found.
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

    /// The time past which errors say little (s), if there is one and it is known by now.
    pub fn until(&self) -> Option<f64> {
        self.until.get().copied().filter(|until| until.is_finite())
    }

    /// Waits until the search has ended.
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
