//! The table of keys by their purpose, with their actions, from which the help is made.

use super::action::{Action, RunAction, WindowAction};

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
                if IS_PAGE {
                    "close the help"
                } else {
                    "close the help; quit"
                },
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
    bindings()
        .find(|binding| binding.keys.contains(&name.as_str()))
        .map(|binding| binding.action)
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
