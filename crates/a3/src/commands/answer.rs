//! Answers to the questions of the window, by the functions of the commands.

use a3_core::accuracy::Scope;

use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_lab::chart::{ChartOptions, chart};
use a3_lab::choose::{self, ChooseOptions, Goal};
use a3_lab::simplify::{SimplifyOptions, simplify};
use a3_lab::stability::stability;
use a3_studio::session::{Answer, Diagram, Question, Task};

/// Answers a question as its command does: with the same runs, and in the same words.
///
/// # Errors
/// Those of the command.
pub fn answer(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    match task.question {
        Question::Chart => of_chart(task, monitor),
        Question::Stability => of_stability(task, monitor),
        Question::Choose => of_choice(task, monitor),
        Question::Simplify => of_simplification(task, monitor),
    }
}

fn of_chart(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let options = ChartOptions { timed: task.timed, ..ChartOptions::default() };
    let chart = chart(&task.request.scene()?, &[], &options, monitor)?;
    let (report, diagram) = chart.best();
    let runs = chart.runs_in(&diagram);
    Ok(Answer {
        report,
        diagram: Some(Diagram { chart: diagram, runs }),
        complete: chart.is_complete(),
        ..Answer::default()
    })
}

fn of_stability(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let found = stability(&task.request.scene()?, &[], monitor)?;
    Ok(Answer { report: found.reasons(), complete: found.complete, ..Answer::default() })
}

fn of_choice(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let scene = task.request.scene()?;
    let goal = Goal::Error(task.error);
    let options = ChooseOptions { timed: task.timed, ..ChooseOptions::new(goal) };
    let choice = choose::choose(&scene, &[], &options, monitor)?;
    let offers = choice.found.iter().map(|it| (it.method, it.control));
    Ok(Answer {
        report: choose::report(task.request.options.on, &scene, (goal, Scope::default()), &choice),
        offers: offers.collect(),
        complete: true,
        ..Answer::default()
    })
}

fn of_simplification(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let options = SimplifyOptions::new(task.error);
    let found = simplify(&task.request, &options, monitor)?;
    let lean = found.lean.as_ref();
    let is_leaner = lean.filter(|lean| !lean.parts.is_empty() || lean.factor != 1.0);
    Ok(Answer {
        lean: is_leaner.map(|lean| lean.scene.clone()),
        complete: lean.is_some(),
        report: found.report,
        ..Answer::default()
    })
}

#[cfg(test)]
mod tests {
    use a3_core::accuracy::Metric;
    use a3_files::report::Report;
    use a3_lab::chart::unit;
    use a3_studio::begin;
    use a3_studio::session::{MeasureRequest, apply, asking::task, read};

    use super::*;

    fn answered(question: Question, words: &[&str]) -> Answer {
        let words: Vec<_> = words.iter().map(|word| (*word).to_owned()).collect();
        let opening = read(&words).unwrap();
        let mut session = begin::session(&opening).unwrap();
        apply(&mut session, MeasureRequest::Ask(question), 0);
        apply(&mut session, MeasureRequest::FromStart(true), 0);
        let (task, _) = task(&session, 0).unwrap();
        answer(&task, &()).unwrap()
    }

    /// Each point of the diagram has the setting of its run: the point's label says it, and runs
    /// with longer steps have larger errors.
    #[test]
    fn points_of_a_chart_have_the_settings_of_their_runs() {
        let found = answered(Question::Chart, &["t", "0.01", "--scene", "pendulum"]);
        let Diagram { chart, runs } = found.diagram.unwrap();
        let curves = &chart.problems[0].curves;
        assert!(found.complete && curves.len() > 4 && curves.len() == runs.len());
        for (curve, runs) in curves.iter().zip(&runs) {
            assert_eq!(curve.runs.len(), runs.len());
            for (point, (method, control)) in curve.runs.iter().zip(runs) {
                assert_eq!(method.title, curve.name);
                let words = a3_lab::chart::table::words(*control);
                assert_eq!(point.label.as_deref(), Some(&*words));
            }
        }
        // Classical Runge-Kutta has order 4.
        let rk4 = curves.iter().zip(&runs).find(|(_, runs)| runs[0].0.name == "rk4");
        let (curve, runs) = rk4.unwrap();
        let last = runs.len() - 1;
        let order = (curve.runs[last - 2].error / curve.runs[last].error).ln()
            / (runs[last - 2].1.value() / runs[last].1.value()).ln();
        assert!((order - 4.0).abs() < 0.3, "{order}");
    }

    /// The library's functions, which the commands call too, give the same words.
    #[test]
    fn answers_have_the_words_of_the_commands() {
        let words = ["t", "0.01", "--scene", "chain"];
        let found = answered(Question::Choose, &words);
        let scene = a3_files::setup::scene("chain").unwrap();
        let options = ChooseOptions::new(Goal::Error(1e-3));
        let choice = choose::choose(&scene, &[], &options, &()).unwrap();
        let best = choice.best();
        assert_eq!(found.offers[0], (best.method, best.control));
        let head = format!("chain for {} s, an error of 1e-3 m (all particles):\n", choice.until);
        assert_eq!((found.report.head, unit(Metric::Position)), (head, "m"));
        assert_eq!(found.report.rows.len(), found.offers.len() + 1);

        let found = answered(Question::Simplify, &words);
        let Report { head, rows, foot } = found.report;
        assert!(head.starts_with("chain for ") && head.contains("an error of 1e-3 m"));
        assert!(rows.iter().any(|row| row[0] == "gravity" && row[4] == "needed"));
        assert!(found.complete && foot.contains("nothing can be left out") == found.lean.is_none());
    }

    /// Euler's explicit method fails first by a motion at rest.
    #[test]
    fn limits_have_their_reasons() {
        let found =
            answered(Question::Stability, &["t", "0.01", "--scene", "cloth", "--grid", "5x5"]);
        let rows = &found.report.rows;
        assert_eq!(rows[0].len(), 4);
        assert!(rows.len() > 15 && found.complete);
        let row = |name: &str| rows.iter().find(|row| row[0] == name).unwrap();
        let stable = |name: &str| row(name)[1].trim_start_matches('>').parse::<f64>();
        assert!(stable("euler").unwrap() < stable("rk4").unwrap());
        assert!(rows[1..].iter().all(|row| !row[3].is_empty()));
        assert!(row("euler")[3].ends_with("grows at rest"), "{:?}", row("euler"));
    }
}
