//! Largest step that runs have shown to hold.

/// Limit of the step, found by runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Longest step that held (s).
    pub held: f64,
    /// Shortest step that failed (s); infinite if none did. If it is shorter than the longest that
    /// held, some steps between them hold and some fail.
    pub failed: f64,
    /// Number of runs that the search took.
    pub runs: u32,
}

/// Largest ratio of the shortest step that failed to the longest that held, for a sharp limit.
const MAX_SHARP_RATIO: f64 = 1.1;

impl Observation {
    /// Returns whether no run failed: even the longest trial step held.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.failed.is_infinite()
    }

    /// Returns whether all shorter trial steps held and all longer ones failed.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        (1.0..MAX_SHARP_RATIO).contains(&(self.failed / self.held))
    }

    /// Returns the step below which all trials held, and the step above which all failed (s).
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        [self.held.min(self.failed), self.held.max(self.failed)]
    }
}
