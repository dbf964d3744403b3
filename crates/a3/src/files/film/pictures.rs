//! A film as numbered pictures.

use super::format::Film;
use crate::base::failure::Failure;
use crate::files::frames::Sequence;
use crate::files::output;

/// A film as numbered pictures.
pub struct Pictures {
    sequence: Sequence,
    size: (u32, u32),
    /// Number of pictures so far.
    count: usize,
}

impl Pictures {
    /// Creates a film of pictures of this size (px).
    pub fn new(sequence: Sequence, size: (u32, u32)) -> Self {
        Self {
            sequence,
            size,
            count: 0,
        }
    }
}

impl Film for Pictures {
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure> {
        let file = self.sequence.file(self.count);
        self.count += 1;
        output::write(&file, &output::png(pixels, self.size)?)
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        Ok(())
    }
}
