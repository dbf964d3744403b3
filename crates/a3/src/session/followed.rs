//! What the camera goes along with.

/// A particle that the camera goes along with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Number of its pane.
    pub pane: usize,
    pub particle: usize,
    /// Where it was seen last (m).
    pub at: [f32; 3],
}
