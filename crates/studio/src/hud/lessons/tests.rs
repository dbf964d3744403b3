//! The lessons in the window: their answers are true, and a user can go through them.

use a3_files::lessons::{ALL, Answer};
use egui::Pos2;

use super::super::window::Window;
use super::PANE;
use crate::begin;
use crate::session::PanelKey::{self, Down, Left, Right, Toggle, Up};
use crate::session::{Action, RunAction, Session, TextKey, session};
use crate::session::{action_beside, apply, is_typing};

/// Height of the bar (points).
const BAR: f32 = 48.0;

/// What a question asks for, by lesson and step.
const ASKED: [(usize, usize, Asked); 15] = [
    (1, 2, Asked::Radius),
    (1, 3, Asked::Radius),
    (2, 1, Asked::Energy),
    (2, 2, Asked::Steps),
    (3, 1, Asked::Limit),
    (3, 2, Asked::Steps),
    (4, 1, Asked::Gain(500.0, 2000.0)),
    (4, 2, Asked::Ratio),
    (5, 2, Asked::Energy),
    (6, 2, Asked::Energy),
    (7, 1, Asked::Ratio),
    (7, 2, Asked::Gain(2.0, 3.0)),
    (7, 3, Asked::Gain(1000.0, 1e5)),
    (8, 1, Asked::Energy),
    (8, 2, Asked::Energy),
];

/// A quantity of the runs of a step, at its end.
#[derive(Clone, Copy)]
enum Asked {
    /// Distance of the point from the origin (m).
    Radius,
    /// Energy (J).
    Energy,
    /// Number of the step at which the run blows up.
    Steps,
    /// The largest stable step (ms).
    Limit,
    /// The error of the left run over that of the right one.
    Ratio,
    /// That ratio, which is between these.
    Gain(f64, f64),
}

impl Asked {
    fn measure(self, session: &mut Session) -> f64 {
        let errors = |session: &Session| {
            let errors = session.runs.panes.iter().map(|pane| pane.error.unwrap());
            let errors: Vec<_> = errors.collect();
            errors[0] / errors[1]
        };
        session.read_state();
        let run = session.runs.first();
        match self {
            Self::Radius => run.position(0).norm(),
            Self::Energy => run.energy().unwrap().total(),
            Self::Steps => run.blow_up().unwrap().step as f64,
            Self::Limit => 1e3 * session.runs.panes[0].limit.limit.unwrap().step,
            Self::Ratio | Self::Gain(..) => errors(session),
        }
    }
}

/// Each step begins, and a3 computes the number that is its answer.
#[test]
fn the_answers_are_what_the_runs_say() {
    for (k, lesson) in ALL.iter().enumerate() {
        for (n, step) in lesson.steps.iter().enumerate() {
            let mut session = begin::step(step).unwrap_or_else(|why| panic!("{}: {why}", step.run));
            let place = (k + 1, n + 1);
            let asked = ASKED.iter().find(|(k, n, _)| (*k, *n) == place);
            let number = matches!(step.question.answer, Answer::Number { .. });
            let Some((.., asked)) = asked else {
                assert!(!number, "{place:?}");
                continue;
            };
            if !matches!(asked, Asked::Limit) {
                session.run_to(step.until.unwrap_or(20.0));
            }
            let found = asked.measure(&mut session);
            match (&step.question.answer, asked) {
                (Answer::Number { value, within, .. }, _) => {
                    // The display rounds, too.
                    let near = (found - value).abs() <= 0.5 * within * value.abs();
                    assert!(near, "{place:?}: {found}, not {value}");
                }
                (_, Asked::Gain(from, to)) => {
                    assert!((*from..=*to).contains(&found), "{place:?}: {found}");
                }
                _ => panic!("{place:?} asks for no number"),
            }
        }
    }
}

/// The answers that are choices, where a run decides them.
#[test]
fn the_right_choices_are_what_happens() {
    let of = |lesson: usize, step: usize, time: f64| {
        let mut session = begin::step(&ALL[lesson - 1].steps[step - 1]).unwrap();
        session.run_to(time);
        session
    };
    let energy = |session: &Session, pane: usize| {
        let run = &session.runs.panes[pane].simulation;
        run.energy().unwrap().total()
    };
    let radius = |session: &Session, k: usize| session.runs.panes[k].simulation.position(0).norm();
    let spiral = of(1, 1, 20.0);
    assert!(radius(&spiral, 0) > 1.5 && (radius(&spiral, 1) - 1.0).abs() < 1e-5);
    assert!(of(2, 3, 20.0).runs.any_alive());
    assert!(!of(3, 3, 10.0).runs.any_alive());
    let coarse = of(4, 3, 3.0);
    assert!(coarse.runs.panes[0].error > coarse.runs.panes[1].error);
    let rest = -9.81 - 9.81 * 9.81 / 200.0;
    let long = of(5, 1, 60.0);
    assert!((energy(&long, 0) - rest).abs() < 1e-3 && energy(&long, 1) > rest + 0.05);
    let three = of(6, 1, 10.0);
    assert!((energy(&three, 0) - rest).abs() < 1e-3);
    assert!((energy(&three, 1) + 9.81).abs() < 0.004 && (energy(&three, 2) + 9.81).abs() < 1e-9);
    assert!((energy(&of(6, 3, 5.0), 0) - rest).abs() < 1e-3);
    assert!((energy(&of(8, 3, 10.0), 0) + 4.9723).abs() < 2e-4);
}

/// Draws the lessons in a window of a size (points), and clicks on the text that begins with
/// `words`, if there is any. Returns the text, and the request.
fn draw(session: &Session, size: [f32; 2], words: Option<&str>) -> (String, Option<Action>) {
    let mut window = Window::new(size);
    let [right, below] = PANE.taken(size);
    let taken = [right, below + BAR];
    let draw = |ctx: &_| PANE.show(ctx, session);
    window.click(taken, Pos2::new(3.0, 3.0), draw);
    let mut at = None;
    for (said, rect, seen) in window.written() {
        let within = window.place.left() <= rect.left() && rect.right() <= seen.right();
        assert!(within, "{said:?} in {size:?}");
        let is_wanted = words.is_some_and(|words| said.starts_with(words));
        if is_wanted && seen.contains(rect.center()) {
            at = Some(rect.center());
        }
    }
    let action = at.and_then(|at| window.click(taken, at, draw));
    (window.words(), action)
}

#[test]
fn every_step_is_drawn_in_windows_and_on_phones() {
    let mut session = session(&["t", "0.01", "--paused"]);
    session.act(RunAction::Lessons, 0);
    for size in [[1000.0, 560.0], [1280.0, 800.0], [390.0, 844.0]] {
        session.readings.touch = size[0] < 500.0;
        let (said, _) = draw(&session, size, None);
        assert!(ALL.iter().all(|lesson| said.contains(&lesson.title)), "{said}");
        let [right, below] = PANE.taken(size);
        let picture = [size[0] - right, size[1] - below - BAR];
        assert!(picture.iter().all(|side| *side >= 390.0), "{picture:?}");
        for lesson in 0..ALL.len() {
            for step in 0..ALL[lesson].steps.len() {
                let lessons = &mut session.panel.lessons;
                (lessons.chosen, lessons.step) = (lesson, Some(step));
                lessons.reveal();
                let (said, _) = draw(&session, size, None);
                assert!(said.contains("Run again") && said.contains("Next"), "{said}");
                // On a phone, the reply is below the visible part of the pane, until one scrolls.
                let replied = said.contains("That is right.");
                assert!(replied || size[1] > 2.0 * size[0], "{said}");
            }
            session.panel.lessons.step = None;
        }
    }
}

#[test]
fn a_lesson_is_gone_through_by_clicks() {
    let mut session = session(&["t", "0.01", "--scene", "chain", "--paused"]);
    let size = [1280.0, 800.0];
    session.act(RunAction::Panel, 0);
    session.act(RunAction::Lessons, 0);
    assert!(session.shows(RunAction::Lessons));
    (session.pulled, session.panel.pane) = (true, 3);
    let mut click = |words: &str, changes: bool| {
        let (said, request) = draw(&session, size, Some(words));
        let request = request.unwrap_or_else(|| panic!("no {words} in {said}"));
        assert_eq!(apply(&mut session, request, 0), changes, "{request:?}");
        let lessons = &session.panel.lessons;
        (session.runs.panes.len(), session.runs.first().method().name, lessons.given())
    };
    assert_eq!(click("Euler spirals", true).0, 2);
    assert_eq!(click("It stays on", false).2.right, Some(false));
    assert!(click("It spirals out", false).2.done);
    assert_eq!((click("Next", true).0, click("Run again", true).1), (1, "euler"));
    click("your answer", false);
    assert!(session.panel.lessons.typing && session.pulled && session.panel.pane == 0);
    let mut answer = |begin: &[TextKey], number: &str| {
        if !session.panel.lessons.typing {
            let again = action_beside(&session, Toggle, false).unwrap();
            apply(&mut session, again, 0);
        }
        let letters = number.chars().map(TextKey::Type);
        for key in begin.iter().copied().chain(letters).chain([TextKey::Accept]) {
            assert!(is_typing(&session), "{number}");
            apply(&mut session, key, 0);
        }
        let (said, _) = draw(&session, size, None);
        (session.panel.lessons.given(), said)
    };
    // What is no number is no wrong answer either.
    let (given, said) = answer(&[], "1.51.65");
    assert!(given.wrong == 0 && said.contains("1.51.65 is no number."), "{said}");
    // An answer that is tried again replaces the one before, and so does one after Ctrl+A.
    assert_eq!(answer(&[], "2").0.typed, "2");
    assert_eq!(answer(&[TextKey::Type('7'), TextKey::MarkAll], "1,65").0.typed, "1.65");
    assert!(session.panel.lessons.given().done && !session.panel.lessons.typing);
    assert!(!is_typing(&session));
    // The scenes of before are still there, and so is the progress.
    session.act(RunAction::Panel, 0);
    assert!(session.shows(RunAction::Panel));
    session.act(RunAction::Lessons, 0);
    assert!(session.panel.lessons.is_done(0, 1) && session.panel.lessons.next_step(0) == 2);
}

#[test]
fn a_lesson_is_gone_through_by_keys() {
    let mut session = session(&["t", "0.01", "--paused"]);
    assert_eq!(action_beside(&session, Toggle, false), None);
    session.act(RunAction::Lessons, 0);
    let mut press = |keys: &[PanelKey]| {
        for key in keys {
            let request = action_beside(&session, *key, false).unwrap();
            apply(&mut session, request, 0);
        }
        let lessons = &session.panel.lessons;
        (lessons.chosen, lessons.step, lessons.given())
    };
    let (lesson, step, _) = press(&[Up, Down, Down, Toggle]);
    assert_eq!((lesson, step), (1, Some(0)));
    assert_eq!(press(&[Right, Right]).1, Some(2));
    // The second choice is the right one.
    assert!(press(&[Down, Toggle]).2.done);
    let (lesson, step, _) = press(&[Toggle]);
    assert_eq!((lesson, step), (2, Some(0)));
    assert_eq!(press(&[Left]).1, None);
    press(&[Toggle, Toggle]);
    assert!(session.panel.lessons.typing);
    assert_eq!(session.runs.first().scene().name, "chain");
}
