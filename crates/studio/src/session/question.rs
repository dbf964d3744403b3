//! Questions about the scene in the window: how fast and how accurate its solvers are, where they
//! fail, which serves best, and what the scene can do without. And their answers.

use a3_core::{Control, Method};
use a3_plot::WorkPrecision;

use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::report::Report;
use a3_files::setup::Request;

/// A question about a scene, which a command answers too.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Question {
    /// How fast and how accurate is each solver?
    #[default]
    Chart,
    /// What is the largest stable step of each solver?
    Stability,
    /// Which solver is the cheapest for an error?
    Choose,
    /// What can be left out for an error?
    Simplify,
}

impl Question {
    /// All questions, in the order of their buttons.
    pub const ALL: [Self; 4] = [Self::Chart, Self::Stability, Self::Choose, Self::Simplify];

    /// Returns the question in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Chart => "Chart this scene",
            Self::Stability => "Where does it fail?",
            Self::Choose => "Which solver?",
            Self::Simplify => "What can be left out?",
        }
    }

    /// Returns the question `by` places after this one, or before it if `by` is negative.
    pub fn neighbour(self, by: isize) -> Self {
        let count = Self::ALL.len() as isize;
        Self::ALL[(self as isize + by).rem_euclid(count) as usize]
    }

    /// Says what the answer tells.
    pub fn about(self) -> &'static str {
        match self {
            Self::Chart => {
                "Runs every solver with longer and shorter steps, and measures the true error and the cost of each run. \
                 Click on a point of the chart to run that solver and step beside the present one."
            }
            Self::Stability => {
                "Finds the largest step with which each solver stays stable, at rest and in motion, and says what \
                 would grow beyond it."
            }
            Self::Choose => {
                "Finds the solver and the step that keep the error within a limit at the least cost."
            }
            Self::Simplify => {
                "Leaves out each part of the scene and changes its grid, and tells what can go for an error, and what \
                 that saves."
            }
        }
    }
}

/// A question with all that its answer depends on.
pub struct Task {
    pub question: Question,
    /// The scene.
    pub request: Request,
    /// Largest error of a choice or of a simpler scene (m).
    pub error: f64,
    /// Whether computing times are measured, instead of evaluations.
    pub timed: bool,
}

/// Function that answers a question, as a command does.
pub type Answerer = fn(&Task, &dyn Monitor) -> Result<Answer, Failure>;

/// A method with its step or tolerance.
pub type MethodSetting = (&'static Method, Control);

/// Answer to a question.
#[derive(Default)]
pub struct Answer {
    /// The answer as a table.
    pub report: Report,
    /// Method and setting of each row of the table after its heading, if the rows are a choice.
    pub offers: Vec<MethodSetting>,
    /// Speed against accuracy, if that was asked.
    pub diagram: Option<Diagram>,
    /// Scene file of the leanest scene, if it differs from the scene.
    pub lean: Option<String>,
    /// Remarks and warnings of the measurement.
    pub notes: Vec<String>,
    /// Whether all was measured; false if the measurement was stopped.
    pub complete: bool,
}

/// A work-precision diagram with a single panel.
pub struct Diagram {
    pub chart: WorkPrecision,
    /// Method and setting of each run, by curve.
    pub runs: Vec<Vec<MethodSetting>>,
}
