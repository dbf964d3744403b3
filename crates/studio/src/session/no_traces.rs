//! What is plotted, in the page: nothing, to keep it small.

use a3_core::{Simulation, Vector3};
use a3_scenes::Splice;

/// What is plotted of a run.
#[derive(Default)]
pub struct Traces {}

impl Traces {
    /// Returns whether nothing is plotted.
    pub fn is_empty(&self) -> bool {
        true
    }

    /// Returns the number of things that are plotted.
    pub fn len(&self) -> usize {
        0
    }

    /// Returns the same for another run.
    pub fn without_values(&self) -> Self {
        Self {}
    }

    /// Adds nothing.
    pub fn take(&mut self, _: &Simulation) {}

    /// Renumbers nothing.
    pub fn renumber(&mut self, _: [Splice; 2]) {}

    /// Drops nothing.
    pub fn drop_removed(&mut self, _: &Simulation, _: &Simulation, _: Splice) {}

    /// Forgets nothing.
    pub fn forget(&mut self) {}
}

/// The settings of plots.
#[derive(Default)]
pub struct PlotSettings {
    /// The ends of the ruler.
    pub ruler: Option<Vec<RulerEnd>>,
}

impl PlotSettings {
    /// Returns whether the mouse draws the ruler.
    pub fn is_ruling(&self) -> bool {
        false
    }

    /// Chooses no end.
    pub fn begin_end(&mut self, _: RulerEnd) {}

    /// Renumbers no end.
    pub fn renumber(&mut self, _: Splice) {}

    /// Moves no end.
    pub fn move_end(&mut self, _: RulerEnd) {}
}

/// An end of the ruler.
#[derive(Clone, Copy)]
pub enum RulerEnd {
    Particle(usize),
    Point(Vector3<f64>),
}

impl RulerEnd {
    /// Returns the place of the end in a run (m), if it has one.
    pub fn place(self, run: &Simulation) -> Option<Vector3<f64>> {
        match self {
            Self::Particle(i) => (i < run.particles()).then(|| run.position(i)),
            Self::Point(at) => Some(at),
        }
    }
}

/// A request of the user to the pane of plots: there is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlotRequest {}
