//! Springs: their kinds, their force laws and their ends.

use crate::error::{Error, at_least};

/// Purpose of a spring.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SpringKind {
    /// Spring that holds neighbours together; drawn in the wireframe.
    Structural,
    /// Spring that keeps a cell square.
    Shear,
    /// Spring that keeps a row straight.
    #[doc(alias = "flex")]
    Bend,
}

/// Force law of a spring of length L (m) and rate of stretch L' (m/s): it pulls its ends together
/// with the force k (L - r) + c L' (N).
///
/// ```
/// use a3_core::SpringLaw;
///
/// let law = SpringLaw::new(50.0, 1.0, 0.1)?;
/// // Stretched to 1.2 m, it pulls by 10 N.
/// assert!((law.stiffness * (1.2 - law.rest_length) - 10.0).abs() < 1e-12);
/// assert!(SpringLaw::new(-50.0, 1.0, 0.1).is_err());
/// # Ok::<(), a3_core::Error>(())
/// ```
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
    /// Creates the law of stiffness k (N/m), rest length r (m) and damping c (N s/m).
    ///
    /// # Errors
    /// One of the numbers is negative or not finite.
    pub fn new(stiffness: f64, rest_length: f64, damping: f64) -> Result<Self, Error> {
        at_least(0.0, "a spring's stiffness", stiffness)?;
        at_least(0.0, "a spring's rest length", rest_length)?;
        at_least(0.0, "a spring's damping", damping)?;
        Ok(Self { stiffness, rest_length, damping })
    }

    /// Multiplies the stiffness and the damping by these factors.
    pub(crate) fn scale(&mut self, stiffness: f64, damping: f64) {
        self.stiffness *= stiffness;
        self.damping *= damping;
    }
}

/// Spring between particles i and j.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spring {
    /// Purpose of the spring.
    pub kind: SpringKind,
    /// Index of the particle at one end.
    pub i: usize,
    /// Index of the particle at the other end.
    pub j: usize,
    /// Force law of the spring.
    pub law: SpringLaw,
}
