//! What a user asks for by a key or the mouse: an action of one of the parts of a session. And the
//! table of keys by their purpose, from which the help is made.

use super::dial::Turn;
use super::editor::{Measure, Tool};
use super::list::TextKey;
use super::measuring::Question;
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

/// A row of the table: keys, their action, and its description in the help.
pub struct Binding {
    pub keys: &'static [&'static str],
    pub action: Action,
    pub help: &'static str,
}

const fn run(keys: &'static [&'static str], action: RunAction, help: &'static str) -> Binding {
    let action = Action::Run(action);
    Binding { keys, action, help }
}

const fn window(
    keys: &'static [&'static str],
    action: WindowAction,
    help: &'static str,
) -> Binding {
    let action = Action::Window(action);
    Binding { keys, action, help }
}

/// Keys that serve one purpose.
pub struct Group {
    pub purpose: &'static str,
    pub bindings: &'static [Binding],
}

/// All keys except the digits, which choose solvers in the order of their table.
pub static GROUPS: [Group; 8] = [
    Group {
        purpose: "Run",
        bindings: &[
            run(&["Space"], RunAction::Pause, "play, or pause"),
            run(&["."], RunAction::Step, "one step, or one frame on"),
            run(&[","], RunAction::Scrub(-1), "one frame back"),
            run(&["<"], RunAction::Scrub(-10), "ten frames back"),
            run(&[">"], RunAction::Scrub(10), "ten frames on"),
            run(&["[", "("], RunAction::Slower, "slow motion"),
            run(&["]", ")"], RunAction::Faster, "faster again"),
            run(&["+", "="], RunAction::LongerStep, "longer step"),
            run(&["-"], RunAction::ShorterStep, "shorter step"),
            run(&["r"], RunAction::Reset, "start again"),
        ],
    },
    Group {
        purpose: "Choose",
        bindings: &[
            run(&["o"], RunAction::Scenes, "a scene, from a list"),
            run(&["t", "PgDn"], RunAction::NextScene, "next scene"),
            run(&["PgUp"], RunAction::PreviousScene, "previous scene"),
            run(&["e"], RunAction::Solvers, "a solver, from a list"),
        ],
    },
    Group {
        purpose: "Change",
        bindings: &[
            run(&["Tab"], RunAction::Panel, "tune and plot"),
            run(&["F2"], RunAction::Edit, "throw, add, join, delete"),
            window(&["F4"], WindowAction::Throw, "throw a ball; Shift, heavy"),
            run(&["d"], RunAction::Wind, "wind"),
            run(&["s"], RunAction::Swing, "swing the pins"),
            run(&["x"], RunAction::Touch, "self-collision"),
            run(&["Del"], RunAction::FreeAll, "release all pins"),
            window(&["z"], WindowAction::Undo, "undo; with Shift, redo"),
        ],
    },
    Group {
        purpose: "Show",
        bindings: &[
            run(&["w"], RunAction::Wireframe, "surface, wires, springs"),
            run(&["v"], RunAction::Colour, "colour by values"),
            run(&["a"], RunAction::Arrows, "arrows"),
        ],
    },
    Group {
        purpose: "Look",
        bindings: &[
            run(&["c"], RunAction::Camera, "reset the camera"),
            run(&["g"], RunAction::SeeAll, "see all"),
            run(&["b"], RunAction::NextView, "front, side, top"),
            run(&["i"], RunAction::Projection, "perspective or parallel"),
            window(&["j"], WindowAction::Follow, "follow a particle"),
        ],
    },
    Group {
        purpose: "Measure",
        bindings: &[
            run(&["q"], RunAction::Measure, "chart, limits, choice, parts"),
            run(&["F3"], RunAction::Plots, "plot particles, springs"),
        ],
    },
    Group {
        purpose: "Keep",
        bindings: &[
            window(&["p"], WindowAction::Picture, "save a picture"),
            window(&["m"], WindowAction::Record, "film, or stop"),
            window(&["n"], WindowAction::FilmLast, "film the last seconds"),
            run(&["f"], RunAction::WriteScene, "write a scene file"),
            window(&["u"], WindowAction::WritePlots, "write the plots as CSV"),
            window(&["y"], WindowAction::CommandLine, "copy the command line"),
            window(&["k"], WindowAction::SaveRun, "save the run"),
            window(&["l"], WindowAction::LoadRun, "load the saved run"),
        ],
    },
    Group {
        purpose: "Window",
        bindings: &[
            window(&["F11"], WindowAction::FullScreen, "full screen"),
            run(&["F1"], RunAction::Lessons, "lessons"),
            run(&["h", "?"], RunAction::Help, "this help"),
            window(
                &["Esc"],
                WindowAction::Quit,
                if IS_PAGE { "close the help" } else { "close the help; quit" },
            ),
        ],
    },
];

/// Actions of the mouse, for the help: a gesture, and its effect.
pub static MOUSE: &[(&str, &str)] = &[
    ("left, on the scene", "pull or push"),
    ("left, elsewhere", "turn"),
    ("right or middle", "move"),
    ("right click", "pin, or release"),
    ("Shift and left", "pin all in a box"),
    ("Shift and right", "release all in a box"),
    ("double click", "list springs; plot (F3)"),
    ("wheel", "zoom to the pointer"),
];

/// Actions of fingers, for the help.
pub static FINGERS: &[(&str, &str)] = &[
    ("on the scene", "pull or push"),
    ("elsewhere", "turn"),
    ("two fingers", "move and zoom"),
    ("long press", "pin, or release"),
    ("double tap", "list springs"),
];

/// Whether this is the window in a page.
pub const IS_PAGE: bool = cfg!(target_arch = "wasm32");

/// Returns whether an action does anything here: a page measures nothing, and makes no films.
pub fn is_here(action: Action) -> bool {
    let left_out = [
        Action::Run(RunAction::Measure),
        Action::Window(WindowAction::Record),
        Action::Window(WindowAction::FilmLast),
    ];
    !IS_PAGE || !left_out.contains(&action)
}

/// Returns all keys except the digits.
pub fn bindings() -> impl Iterator<Item = &'static Binding> {
    GROUPS.iter().flat_map(|group| group.bindings)
}

/// Returns the action of a key by its name. Upper and lower case are the same.
pub fn action(name: &str) -> Option<Action> {
    let mut letters = name.chars();
    let name = match (letters.next(), letters.next()) {
        (Some(letter), None) => letter.to_lowercase().collect(),
        _ => name.to_owned(),
    };
    // 1 to 9, then 0, as on the keyboard.
    if let Ok(digit @ 0..=9) = name.parse::<usize>() {
        return Some(Action::Run(RunAction::Solver((digit + 9) % 10)));
    }
    bindings().find(|binding| binding.keys.contains(&name.as_str())).map(|binding| binding.action)
}

#[cfg(test)]
mod tests {
    use std::collections::HashSet;

    use super::*;

    #[test]
    fn no_key_does_two_things_and_every_key_is_found() {
        let mut seen = HashSet::new();
        for binding in bindings() {
            for &key in binding.keys {
                assert!(seen.insert(key), "{key} twice");
                assert_eq!(action(key), Some(binding.action));
            }
        }
        assert_eq!(action("T"), Some(Action::Run(RunAction::NextScene)));
        assert_eq!(action("3"), Some(Action::Run(RunAction::Solver(2))));
        assert_eq!(action("0"), Some(Action::Run(RunAction::Solver(9))));
        assert_eq!(action("10"), None);
        assert_eq!(action("F5"), None);
    }
}
