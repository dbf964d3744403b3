//! What keys do.

/// An action of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
    Run(RunAction),
    Window(WindowAction),
}

/// An action on the runs and on how they are seen.
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
    /// Draw the surface, the wireframe, or all springs.
    Wireframe,
    /// Colour by the next quantity, or by none.
    Colour,
    /// Draw the next arrows, or none.
    Arrows,
    Wind,
    /// Let surfaces touch one another and themselves, or pass through.
    Touch,
    Pause,
    Step,
    /// Choose a solver, by its number in the table of methods.
    Solver(usize),
    LongerStep,
    ShorterStep,
    Slower,
    Faster,
    /// Go so many kept frames on, or back if it is negative.
    Scrub(isize),
    Camera,
    /// Let go of all pins.
    FreeAll,
    /// Perspective or orthographic.
    Projection,
    /// See all particles, from the same side.
    SeeAll,
    /// See from the front, from the side, or from above.
    NextView,
    Panel,
    WriteScene,
    Help,
}

/// An action that needs the window: its pointer, its panel, the system around it, or files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WindowAction {
    Undo,
    /// Do again what was undone.
    Redo,
    /// Follow what is under the pointer.
    Follow,
    Picture,
    /// Write what the plots show as CSV.
    WritePlots,
    /// Film from now on, or complete that film.
    Record,
    /// Film the last seconds.
    FilmLast,
    /// Copy the command line that makes what is shown.
    CommandLine,
    /// Keep the run in a file.
    SaveRun,
    /// Go on from the last such file.
    LoadRun,
    /// Fill the screen, or a window again.
    FullScreen,
    /// Open the lessons.
    Lessons,
    Quit,
}
