//! The actions of keys.

/// An action of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Run(RunAction),
    Window(WindowAction),
}

/// An action on the runs or on their view.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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
    /// Show plots of what is picked, or hide them.
    Plots,
    /// Show the tools that edit the scene, or hide them.
    Edit,
    WriteScene,
    Help,
}

/// An action that needs the window: its pointer, its panel, the system around it, or files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowAction {
    Undo,
    Redo,
    /// Follow the particle under the pointer.
    Follow,
    Picture,
    /// Write the samples of the plots as CSV.
    WritePlots,
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
