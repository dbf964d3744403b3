//! The measures of the error and of the cost of a run.

use a3_core::accuracy::{Metric, Scope};
use a3_files::arguments::particle;
use clap::builder::TypedValueParser;
use clap::{Args, ValueEnum};

use super::values::choice;

/// Creates a parser of the metric of errors.
pub fn metric() -> impl TypedValueParser<Value = Metric> {
    choice(&Metric::OF_PARTICLES, |metric| {
        let help = match metric {
            Metric::Position => "Positions, root mean square over the particles (m)",
            Metric::State => "Numbers of a state without particles",
            Metric::Energy => "Total energy (J)",
            Metric::Strain => "Lengths of the springs over their rest lengths, root mean square",
            Metric::Momentum => "Total momentum of the particles that are not pinned (kg m/s)",
            Metric::Phase => "Time by which the motion is ahead or behind (s)",
            Metric::Penetration => {
                "Largest depth of a surface within the thickness of another, over that thickness"
            }
            Metric::Impact => {
                "Times at which surfaces first touch, and at which nothing touches any more (s)"
            }
        };
        (metric.name(), help)
    })
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

impl ErrorScope {
    /// Returns the particle and the times that were given.
    pub fn given(&self) -> Scope {
        Scope {
            particle: self.particle,
            at_end: self.at_end,
        }
    }
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
