//! Pins: particles on prescribed paths, for good or up to a time.

use serde::{Deserialize, Serialize};

use crate::path::{Path, Place};

/// A pinned particle, its path, and the time at which it is let go.
///
/// ```
/// use a3_core::{Network, Path, Pin, Vector3};
///
/// let mut network = Network::new(vec![1.0; 2])?;
/// let path = Path::Still(Vector3::zeros());
/// network.pin_all(vec![Pin { until: Some(2.0), ..Pin::new(0, path) }])?;
/// assert!(network.all_pins().all(|pin| pin.holds_at(1.9) && !pin.holds_at(2.0)));
/// # Ok::<(), a3_core::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pin {
    /// Number of the particle.
    pub particle: usize,
    /// Path of the particle while it is held.
    pub path: Path,
    /// Time (s) from which on the particle is free, with the velocity that it had on its path just
    /// before; `None` if it is never let go.
    pub until: Option<f64>,
}

impl Pin {
    /// Creates a pin that never lets go.
    #[must_use]
    pub fn new(particle: usize, path: Path) -> Self {
        Self { particle, path, until: None }
    }

    /// Returns whether the particle is held at time t (s).
    #[must_use]
    pub fn holds_at(&self, t: f64) -> bool {
        self.until.is_none_or(|until| t < until)
    }

    /// Returns the place of the particle at time t (s) while it is held; where it is let go, that
    /// just before: a path may end at the same time, and be at rest from then on.
    #[must_use]
    pub fn at(&self, t: f64) -> Place {
        let last = self.until.map_or(f64::INFINITY, f64::next_down);
        self.path.at(t.min(last))
    }

    /// Returns the times (s) at which its motion begins or ends, and at which it lets go.
    pub(crate) fn known_times(&self) -> impl Iterator<Item = f64> {
        let until = self.until.unwrap_or(f64::INFINITY);
        let of_path = self.path.known_times().into_iter();
        of_path.filter(move |t| *t < until).chain([until])
    }
}
