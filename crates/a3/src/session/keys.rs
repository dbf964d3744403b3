//! The keys, in one table from which the help is made too.

/// Action of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Action {
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
    Undo,
    /// Do again what was undone.
    Redo,
    /// Perspective or orthographic.
    Projection,
    /// Follow what is under the pointer.
    Follow,
    /// See all particles, from the same side.
    SeeAll,
    /// See from the front, from the side, or from above.
    NextView,
    Picture,
    Panel,
    WriteScene,
    /// Write what the plots show as CSV.
    WritePlots,
    /// Film from now on, or complete that film.
    Record,
    /// Film the last seconds.
    FilmLast,
    /// Copy the command line that makes what is shown.
    CommandLine,
    /// Keep the run in a file.
    Keep,
    /// Go on from the last such file.
    TakeUp,
    Help,
    /// Fill the screen, or a window again.
    FullScreen,
    /// Open the lessons.
    Lessons,
    Quit,
}

/// A row of the table: keys, their action, and its name in the help.
pub struct Binding {
    pub keys: &'static [&'static str],
    pub action: Action,
    pub help: &'static str,
}

const fn bind(keys: &'static [&'static str], action: Action, help: &'static str) -> Binding {
    Binding { keys, action, help }
}

/// All keys but the digits, which stand for the solvers in the order of their table.
pub static KEYS: &[Binding] = &[
    bind(&["t", "PgDn"], Action::NextScene, "next scene"),
    bind(&["PgUp"], Action::PreviousScene, "previous scene"),
    bind(&["o"], Action::Scenes, "list of scenes"),
    bind(&["e"], Action::Solvers, "list of solvers"),
    bind(&["r"], Action::Reset, "reset"),
    bind(&["s"], Action::Swing, "swing the pins"),
    bind(&["w"], Action::Wireframe, "surface, wires, springs"),
    bind(&["v"], Action::Colour, "colour by values"),
    bind(&["a"], Action::Arrows, "arrows"),
    bind(&["d"], Action::Wind, "wind"),
    bind(&["x"], Action::Touch, "self-collision"),
    bind(&["Space"], Action::Pause, "pause"),
    bind(&["."], Action::Step, "one step, one frame on"),
    bind(&[","], Action::Scrub(-1), "one frame back"),
    bind(&["<"], Action::Scrub(-10), "ten frames back"),
    bind(&[">"], Action::Scrub(10), "ten frames on"),
    bind(&["[", "("], Action::Slower, "slow motion"),
    bind(&["]", ")"], Action::Faster, "faster again"),
    bind(&["+", "="], Action::LongerStep, "longer step"),
    bind(&["-"], Action::ShorterStep, "shorter step"),
    bind(&["c"], Action::Camera, "camera home"),
    bind(&["g"], Action::SeeAll, "see all"),
    bind(&["b"], Action::NextView, "front, side, top"),
    bind(&["z"], Action::Undo, "undo; Shift: redo"),
    bind(&["Del"], Action::FreeAll, "let go of all pins"),
    bind(&["i"], Action::Projection, "perspective or parallel"),
    bind(&["j"], Action::Follow, "follow a particle"),
    bind(&["p"], Action::Picture, "save a picture"),
    bind(&["Tab"], Action::Panel, "tune and plot"),
    bind(&["f"], Action::WriteScene, "write a scene file"),
    bind(&["u"], Action::WritePlots, "write the plots as CSV"),
    bind(&["m"], Action::Record, "record, or stop"),
    bind(&["n"], Action::FilmLast, "film the last seconds"),
    bind(&["y"], Action::CommandLine, "copy the command line"),
    bind(&["k"], Action::Keep, "keep the run in a file"),
    bind(&["l"], Action::TakeUp, "load what was kept"),
    bind(&["F11"], Action::FullScreen, "full screen"),
    bind(&["h", "?"], Action::Help, "this help"),
    bind(&["F1"], Action::Lessons, "lessons"),
    bind(&["Esc"], Action::Quit, "quit"),
];

/// Actions of the mouse, for the help.
pub static MOUSE: &[(&str, &str)] = &[
    ("left, on the scene", "pull"),
    ("left, elsewhere", "turn"),
    ("right or middle", "move"),
    ("right click", "pin, or let go"),
    ("Shift and left", "pin all in a box"),
    ("Shift and right", "let go of them"),
    ("double click", "list springs"),
    ("wheel", "zoom to the pointer"),
];

/// The action of a key by its name, if it has one. Letters mean the same in either case.
pub fn action(name: &str) -> Option<Action> {
    let mut letters = name.chars();
    let name = match (letters.next(), letters.next()) {
        (Some(letter), None) => letter.to_lowercase().collect(),
        _ => name.to_owned(),
    };
    // 1 to 9 and 0, as they lie on the keyboard.
    if let Ok(digit @ 0..=9) = name.parse::<usize>() {
        return Some(Action::Solver((digit + 9) % 10));
    }
    KEYS.iter()
        .find(|binding| binding.keys.contains(&name.as_str()))
        .map(|binding| binding.action)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn no_key_does_two_things_and_every_key_is_found() {
        let mut seen = HashSet::new();
        for binding in KEYS {
            for &key in binding.keys {
                assert!(seen.insert(key), "{key} twice");
                assert_eq!(action(key), Some(binding.action));
            }
        }
        assert_eq!(action("T"), Some(Action::NextScene));
        assert_eq!(action("3"), Some(Action::Solver(2)));
        assert_eq!(action("0"), Some(Action::Solver(9)));
        assert_eq!(action("10"), None);
        assert_eq!(action("F2"), None);
    }
}
