//! Springs: their kinds, their laws and their ends.

use crate::error::{Error, at_least};

/// The purpose of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringKind {
    /// A spring that holds neighbours together; drawn in the wireframe.
    Structural,
    /// A spring that keeps a cell square.
    Shear,
    /// A spring that keeps a row straight.
    #[doc(alias = "flex")]
    Bend,
}

/// The law of a spring of length L and rate of stretch L': it pulls with k (L - r) + c L'.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringLaw {
    /// Stiffness k (N/m).
    pub stiffness: f64,
    /// Rest length r (m).
    pub rest_length: f64,
    /// Damping c along the spring (N s/m).
    pub damping: f64,
}

impl SpringLaw {
    /// A law of stiffness k (N/m), rest length r (m) and damping c (N s/m).
    ///
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

    /// Multiplies stiffness and damping.
    pub(crate) fn scale(&mut self, stiffness: f64, damping: f64) {
        self.stiffness *= stiffness;
        self.damping *= damping;
    }
}

/// One spring between particles i and j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Its purpose.
    pub kind: SpringKind,
    /// Particle at one end.
    pub i: usize,
    /// Particle at the other end.
    pub j: usize,
    /// Its law.
    pub law: SpringLaw,
}
