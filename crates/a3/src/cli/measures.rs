//! The measures of the error and of the cost of a run.

use clap::{Args, ValueEnum};

use super::values::particle;

/// Measure of the error.
#[derive(Clone, Copy, ValueEnum, PartialEq)]
pub enum ErrorMeasure {
    /// Positions, root mean square over the particles (m)
    Position,
    /// Total energy (J)
    Energy,
    /// Lengths of the springs over their rest lengths, root mean square
    Strain,
    /// Total momentum of the particles that are not pinned (kg m/s)
    Momentum,
    /// Time by which the motion is ahead or behind (s)
    Phase,
    /// Largest depth of a surface within the thickness of another, over that thickness
    Penetration,
    /// Times at which surfaces first touch, and at which nothing touches any more (s)
    Impact,
}

/// Particles and times at which errors are taken.
#[derive(Args)]
pub struct ErrorScope {
    /// Take the errors of position and phase from particle I alone
    #[arg(long, value_name = "I", value_parser = particle, allow_negative_numbers = true)]
    pub particle: Option<usize>,
    /// Take the error at the end, instead of the largest one during the run
    #[arg(long)]
    pub at_end: bool,
}

/// Measure of the cost.
#[derive(Clone, Copy, ValueEnum, PartialEq)]
pub enum WorkMeasure {
    /// Computing time on this machine
    #[value(alias = "seconds")]
    Time,
    /// Evaluations of the forces, the same on every machine
    Evaluations,
}
