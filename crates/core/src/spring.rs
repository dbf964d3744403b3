//! Springs: what they are for, how they answer, and where they are, one by one or in families.

use std::ops::Range;

use crate::error::{Error, at_least};

/// What a spring is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringKind {
    /// Holds neighbours together; drawn in the wireframe.
    Structural,
    /// Keeps a cell square.
    Shear,
    /// Keeps a row straight.
    #[doc(alias = "flex")]
    Bend,
}

/// How a spring answers to its length L and rate of stretch L': pulls with k (L - r) + c L'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLaw {
    /// k (N/m).
    pub stiffness: f64,
    /// r (m).
    pub rest_length: f64,
    /// c, along the spring (N s/m).
    pub damping: f64,
}

impl SpringLaw {
    /// # Errors
    /// A number is negative or not finite.
    pub fn new(stiffness: f64, rest_length: f64, damping: f64) -> Result<Self, Error> {
        at_least(0.0, "a spring's stiffness", stiffness)?;
        at_least(0.0, "a spring's rest length", rest_length)?;
        at_least(0.0, "a spring's damping", damping)?;
        Ok(Self {
            stiffness,
            rest_length,
            damping,
        })
    }
}

/// One spring between particles i and j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// What it is for.
    pub kind: SpringKind,
    /// One end.
    pub i: usize,
    /// The other end.
    pub j: usize,
    /// How it answers.
    pub law: SpringLaw,
}

/// Springs of one law from each particle p of the `runs` to p + `offset`: on a grid, contiguous loads.
#[derive(Clone, Debug, PartialEq)]
pub struct SpringFamily {
    /// What they are for.
    pub kind: SpringKind,
    /// How they answer.
    pub law: SpringLaw,
    /// From one end of a spring to the other.
    pub offset: usize,
    /// First ends.
    pub runs: Vec<Range<usize>>,
}

impl SpringFamily {
    /// Number of springs.
    #[must_use]
    pub fn len(&self) -> usize {
        self.runs.iter().map(ExactSizeIterator::len).sum()
    }

    /// Whether there is none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Each spring by itself.
    pub fn springs(&self) -> impl Iterator<Item = Spring> {
        let Self {
            kind, law, offset, ..
        } = *self;
        self.runs.iter().cloned().flatten().map(move |i| Spring {
            kind,
            i,
            j: i + offset,
            law,
        })
    }
}
