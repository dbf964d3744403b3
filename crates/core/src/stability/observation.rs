//! Limit of the step, as runs have shown it.

/// Limit of the step that runs have shown.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Longest step that held (s).
    pub held: f64,
    /// Shortest step that failed (s); infinite if none did. Where it is shorter than the longest
    /// that held, some steps between them hold and some fail.
    pub failed: f64,
    /// Number of runs that the search took.
    pub runs: u32,
}

/// Largest ratio of the shortest step that failed to the longest that held, at a sharp limit.
const SHARP: f64 = 1.1;

impl Observation {
    /// Whether no run failed: the longest step that was tried held.
    #[must_use]
    pub fn is_open(&self) -> bool {
        self.failed.is_infinite()
    }

    /// Whether all shorter steps that were tried held and all longer ones failed.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        (1.0..SHARP).contains(&(self.failed / self.held))
    }

    /// Step below which all that were tried held, and step above which all failed (s).
    #[must_use]
    pub fn interval(&self) -> [f64; 2] {
        [self.held.min(self.failed), self.held.max(self.failed)]
    }
}
