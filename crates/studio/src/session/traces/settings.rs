//! The settings of plots, and what a user asks of them.

use a3_core::{Simulation, Vector3};
use a3_scenes::Splice;

use super::pick::{Pick, Variable};
use super::series::Trigger;

/// Simulated times that plots can show (s).
pub const SPANS: [f64; 3] = [5.0, 20.0, 60.0];

/// What is on the axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Variables over time.
    #[default]
    Time,
    /// A variable over another one.
    Phase,
    /// The same, at the points of a Poincaré section alone.
    Section,
}

impl Mode {
    /// All modes, in the order of their buttons.
    pub const ALL: [Self; 3] = [Self::Time, Self::Phase, Self::Section];

    /// Returns the name of the mode.
    pub fn name(self) -> &'static str {
        match self {
            Self::Time => "over time",
            Self::Phase => "phase plane",
            Self::Section => "section",
        }
    }

    /// Returns the mode `by` places after this one, or before it if `by` is negative.
    pub fn neighbour(self, by: isize) -> Self {
        let count = Self::ALL.len() as isize;
        Self::ALL[(self as isize + by).rem_euclid(count) as usize]
    }
}

/// A variable of one thing that is plotted, or of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Quantity {
    /// The thing; `None` for each.
    pub of: Option<Pick>,
    pub variable: Variable,
}

impl Quantity {
    /// Creates the quantity of each thing.
    pub fn of_each(variable: Variable) -> Self {
        Self { of: None, variable }
    }

    /// Returns the short name.
    pub fn name(self) -> String {
        let [name, of] = [self.variable.name().into(), self.owner()];
        name + &of
    }

    /// Returns the name with the unit, as on an axis.
    pub fn label(self) -> String {
        let ([_, name, unit], of) = (self.variable.words(), self.owner());
        match unit {
            "" => format!("{name}{of}"),
            unit => format!("{name}{of} ({unit})"),
        }
    }

    /// Says of which thing this is, if it is of one.
    fn owner(self) -> String {
        self.of.map_or(String::new(), |pick| format!(" of {}", pick.name()))
    }
}

/// The settings of plots.
pub struct PlotSettings {
    pub mode: Mode,
    /// The variables that are shown over time.
    pub shown: Vec<Variable>,
    /// What is on the horizontal and on the vertical axis otherwise, as it was chosen.
    axes: [Quantity; 2],
    /// The name of the scene in which the axes were chosen, whose things they are of.
    scene: String,
    /// Simulated time that is shown (s).
    pub span: f64,
    /// The ends of the ruler that are chosen so far, if there is one.
    pub ruler: Option<Vec<RulerEnd>>,
    /// Whether the formulas of what is computed are shown.
    pub formulas: bool,
}

impl PlotSettings {
    /// Returns whether the mouse draws the ruler: an end is missing.
    pub fn is_ruling(&self) -> bool {
        self.ruler.as_ref().is_some_and(|ends| ends.len() < 2)
    }

    /// Returns what was chosen for the axes, in a scene: of each if that was in another one.
    pub fn axes_in(&self, scene: &str) -> [Quantity; 2] {
        let of = |it: Quantity| it.of.filter(|_| self.scene == scene);
        self.axes.map(|it| Quantity { of: of(it), ..it })
    }

    /// Puts quantities of things in a scene on the axes.
    pub fn take_axes(&mut self, axes: [Quantity; 2], scene: &str) {
        self.axes = axes;
        scene.clone_into(&mut self.scene);
    }

    /// Chooses the next end of the ruler.
    pub fn begin_end(&mut self, end: RulerEnd) {
        self.ruler.get_or_insert_default().push(end);
    }

    /// Moves the second end of the ruler, while the mouse drags it.
    pub fn move_end(&mut self, end: RulerEnd) {
        let ends = self.ruler.get_or_insert_default();
        ends.truncate(1);
        ends.push(end);
    }

    /// Keeps axes and the ends of the ruler at the same things by the numbers of particles and
    /// rigid bodies since an edit. If one was removed, the ruler is, too.
    pub fn renumber(&mut self, [particles, bodies]: [Splice; 2]) {
        for axis in &mut self.axes {
            axis.of = axis.of.and_then(|of| of.renumbered([particles, bodies]));
        }
        let now = |end: &RulerEnd| match *end {
            RulerEnd::Particle(i) => particles.number(i).map(RulerEnd::Particle),
            end @ RulerEnd::Point(_) => Some(end),
        };
        let ends = self.ruler.take();
        self.ruler = ends.and_then(|ends| ends.iter().map(now).collect());
    }
}

/// An end of the ruler.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RulerEnd {
    /// A particle, which the end follows.
    Particle(usize),
    /// A point at rest (m).
    Point(Vector3<f64>),
}

impl Default for PlotSettings {
    fn default() -> Self {
        Self {
            mode: Mode::Time,
            shown: vec![Variable::X, Variable::Y, Variable::Length, Variable::Force],
            axes: [Variable::X, Variable::VelocityX].map(Quantity::of_each),
            scene: String::new(),
            span: SPANS[1],
            ruler: None,
            formulas: false,
        }
    }
}

/// A file of what is plotted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlotFile {
    /// A table, as CSV.
    Table,
    /// A picture, as PNG, or as SVG on a page.
    Picture,
}

/// A request of the user to the pane of plots.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlotRequest {
    /// Plot something, or no longer.
    Toggle(Pick),
    /// Change what is on the axes.
    Mode(Mode),
    /// Show a variable over time, or no longer.
    Show(Variable),
    /// Put a quantity on the horizontal (0) or on the vertical axis (1).
    Axis(usize, Quantity),
    /// Take the points of the section at another event.
    Trigger(Trigger),
    /// Show another span of time (s).
    Span(f64),
    /// Forget all values so far.
    Clear,
    /// Draw a ruler in the picture, or remove it.
    Ruler,
    /// Show the formulas of what is computed, or no longer.
    Formulas,
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
