//! What a user asks for by a key or the mouse: an action of one of the parts of a session.

use super::dial::Turn;
use super::editor::{Measure, Tool};
use super::list::TextKey;
use super::question::Question;
use super::traces::{PlotFile, PlotRequest};

/// What a user asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    Run(RunAction),
    Window(WindowAction),
    /// Change the panel, a knob, the open list, the tools, or the moment.
    Panel(PanelRequest),
    /// Ask something about the scene, or use an answer.
    Measure(MeasureRequest),
    /// Go on in a lesson.
    Learn(LessonRequest),
    /// Change the plots.
    Plot(PlotRequest),
    /// Type the value of a knob, or the answer to a question.
    Type(TextKey),
}

macro_rules! parts {
    ($($part:ident: $action:ty),*) => {
        $(impl From<$action> for Action {
            fn from(action: $action) -> Self {
                Self::$part(action)
            }
        })*
    };
}

parts!(
    Run: RunAction,
    Window: WindowAction,
    Panel: PanelRequest,
    Measure: MeasureRequest,
    Learn: LessonRequest,
    Plot: PlotRequest,
    Type: TextKey
);

/// An action on the runs or on their view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RunAction {
    NextScene,
    PreviousScene,
    /// Open the list of scenes, or close it.
    Scenes,
    /// Open the list of solvers, or close it.
    Solvers,
    Reset,
    Swing,
    /// Draw in the next style: surface, wireframe, or all springs.
    Wireframe,
    /// Colour by the next quantity, or by none.
    Colour,
    /// Draw the next arrows, or none.
    Arrows,
    Wind,
    /// Turn self-collision on or off.
    Touch,
    Pause,
    Step,
    /// Choose a solver, by its number in the table of methods.
    Solver(usize),
    LongerStep,
    ShorterStep,
    Slower,
    Faster,
    /// Go forward by a number of moments of the timeline, or back if it is negative.
    Scrub(isize),
    /// Reset the camera.
    Camera,
    /// Release all pins.
    FreeAll,
    /// Switch between perspective and orthographic projection.
    Projection,
    /// Move the camera, without turning it, so that all particles are visible.
    SeeAll,
    /// Look from the next direction: front, right, or above.
    NextView,
    Panel,
    /// Show questions about the scene and their answers, or hide them.
    Measure,
    Lessons,
    /// Show the plots of the picked particles, bodies and springs, or hide them.
    Plots,
    /// Show the tools that edit the scene, or hide them.
    Edit,
    WriteScene,
    Help,
}

/// An action that needs the window: its pointer, its panel, the system around it, or files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum WindowAction {
    Undo,
    Redo,
    /// Throw a ball to the pointer.
    Throw,
    /// Follow the particle under the pointer.
    Follow,
    Picture,
    /// Write the samples of the plots as CSV.
    WritePlots,
    /// Write a table or a picture of what is plotted.
    WritePlot(PlotFile),
    /// Start a live film, or complete it.
    Record,
    /// Film the last seconds.
    FilmLast,
    /// Copy the command line that opens the present run and picture.
    CommandLine,
    /// Save the run as a checkpoint.
    SaveRun,
    /// Load the last checkpoint.
    LoadRun,
    FullScreen,
    /// Close the help; without it, ask whether to quit.
    Quit,
    /// Close the window.
    Close,
    /// Close the question whether to quit.
    Stay,
}

/// A request of the mouse to the panel, the open list or the timeline.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PanelRequest {
    /// Choose a row, by its number in the table of knobs.
    ChooseRow(usize),
    /// Start to type a value for the knob of a number.
    Type(usize),
    /// Turn the knob of a number.
    Turn(usize, Turn),
    /// Accept the entry of a number in the open list.
    TakeEntry(usize),
    /// Close the list.
    CloseList,
    /// Go to a share of the timeline.
    GoTo(f32),
    /// Choose a solver for another pane beside that of a number.
    AddPane(usize),
    /// Remove the pane of a number.
    RemovePane(usize),
    /// Reset all runs, and give that of a pane, which blew up, what would have held.
    RunAgain(usize),
    /// Choose a tool.
    Tool(Tool),
    /// Set a quantity of what the tools add.
    SetMeasure(Measure, f64),
}

/// A request of the mouse or of a key about questions and answers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MeasureRequest {
    /// Show a question.
    Ask(Question),
    /// Measure the answer, or stop that.
    Toggle,
    /// Show and measure which solver and step serve best.
    Choose,
    /// Allow a tenth or the tenfold of the error.
    Error { finer: bool },
    /// Measure computing times, or evaluations.
    Timed(bool),
    /// Measure from the beginning of the scene, or from its present state.
    FromStart(bool),
    /// Use the method and setting of a row of the answer.
    Use(usize),
    /// Run the method and setting of a row of the answer beside the present one.
    RowBeside(usize),
    /// Run the method and setting of a point of the diagram beside the present one.
    RunBeside { curve: usize, run: usize },
    /// Write the leanest scene to a file, and show it.
    OpenLean,
}

/// A request to the pane of lessons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LessonRequest {
    /// Show the list of lessons.
    Contents,
    /// Choose a lesson in the list.
    Choose(usize),
    /// Show a step of a lesson, and begin its run.
    Open(usize, usize),
    /// Begin the run of the step again.
    Again,
    /// Mark a choice, for the keys.
    Mark(usize),
    /// Give a choice as the answer.
    Answer(usize),
    /// Take keys as letters of the number, or no longer.
    Type(bool),
    /// Type a letter of the number, or erase the last one.
    Letter(Option<char>),
    /// Check the number.
    Check,
    /// Show the right answer.
    Reveal,
}

/// A key of what is open beside the picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PanelKey {
    /// Chooses the row above.
    Up,
    /// Chooses the row below.
    Down,
    /// Turns the knob down.
    Left,
    /// Turns the knob up.
    Right,
    /// Toggles a switch; turns another knob to the scene's own value.
    Toggle,
}
