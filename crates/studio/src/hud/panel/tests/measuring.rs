//! Measuring the parts of a scene, and their rows.

use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::report::Report;

use super::screen::{Screen, opened, part, toggle, type_key};
use crate::hud::panel::PANE;
use crate::session::panel::{measured, measuring_row, numbers, set_part};
use crate::session::{Answer, PanelKey, Question, RunAction, Session, Task};

/// Answers that gravity is needed and that nothing else is.
fn answer(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    monitor.note("a remark")?;
    assert_eq!(task.question, Question::Simplify);
    let rows = a3_scenes::parts(&task.request.source.description).into_iter();
    let rows = rows.map(|part| {
        let verdict = match &*part.name {
            "gravity" => "needed",
            _ => "changes little, saves little",
        };
        [&*part.name, "1.2e-1", "23 %", "> 999 %", verdict].map(String::from).to_vec()
    });
    Ok(Answer { report: Report { rows: rows.collect(), ..Report::default() }, ..Answer::default() })
}

/// Measures the parts by the key of their row.
fn measure(session: &mut Session) {
    session.measuring.answerer = Some(answer);
    session.panel.row = measuring_row();
    type_key(session, PanelKey::Toggle, false);
    while session.measuring.progress().is_some() {
        std::thread::sleep(std::time::Duration::from_millis(2));
        session.measuring.update();
    }
}

#[test]
fn parts_have_the_verdicts_of_the_question_until_another_scene() {
    let mut session = opened(&["r", "0.005", "--scene", "mit"]);
    assert!(!numbers(&session).contains(&measuring_row()), "nothing answers");
    measure(&mut session);
    let [gravity, bend] = ["gravity", "bend springs"].map(|name| part(&session, name));
    let verdict = |session: &Session, k| measured(session, k).map(|row| row[4].clone());
    assert_eq!(verdict(&session, gravity).unwrap(), "needed");
    // What was measured of a part stays while it is left out.
    toggle(&mut session, "bend springs");
    assert!(verdict(&session, bend).unwrap().starts_with("changes little"));
    session.act(RunAction::NextScene, 0);
    assert_eq!(verdict(&session, 0), None);
}

/// The rows say what was measured, at any width of the panel, and nothing is cut off.
#[test]
fn rows_of_parts_fit() {
    let mut session = opened(&["r", "0.005", "--scene", "ball-on-cloth"]);
    measure(&mut session);
    for k in 0..session.tuning.parts.len() {
        let _ = set_part(&mut session, k, false);
    }
    for size in [[1280.0, 720.0], [800.0, 600.0], [2300.0, 1200.0], [500.0, 200.0]] {
        let mut screen = Screen::new(size);
        let texts = screen.written(&session);
        let edge = size[0] - PANE.taken(size)[0];
        let panel = texts.iter().filter(|(_, rect, _)| rect.left() > edge);
        for (words, rect, seen) in panel.clone() {
            // In a low window, rows scroll.
            let across = seen.x_range();
            assert!(
                across.contains(rect.left()) && across.contains(rect.right()),
                "{words} in {size:?}"
            );
            assert!(rect.right() < size[0] - 8.0, "{words} in {size:?}");
        }
        let said = |what: &str| panel.clone().any(|(words, ..)| words.contains(what));
        assert!(
            said("measure again") && said("needed: changes 1.2e-1 m, saves > 999 %"),
            "{size:?}"
        );
    }
}
