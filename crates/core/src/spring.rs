//! Springs: what they are for, how they answer, and where they are.

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
