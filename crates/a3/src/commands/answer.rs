//! Answers to the questions of the window, by the functions of the commands.

use a3_core::accuracy::Scope;

use super::chart::{ChartOptions, chart, describe};
use super::choose::{self, ChooseOptions, Goal};
use super::simplify::{self, SimplifyOptions};
use super::stability::stability;
use crate::base::failure::Failure;
use crate::base::monitor::Monitor;
use crate::window::session::{Answer, Diagram, Question, Task};

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
    let options = ChartOptions {
        timed: task.timed,
        ..ChartOptions::default()
    };
    let chart = chart(&task.request.scene()?, &[], &options, monitor)?;
    let (report, diagram) = chart.best();
    let runs = chart.runs_in(&diagram);
    Ok(Answer {
        report,
        diagram: Some(Diagram {
            chart: diagram,
            runs,
        }),
        complete: chart.is_complete(),
        ..Answer::default()
    })
}

fn of_stability(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let found = stability(&task.request.scene()?, &[], monitor)?;
    Ok(Answer {
        report: found.reasons(),
        complete: found.complete,
        ..Answer::default()
    })
}

fn of_choice(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let scene = task.request.scene()?;
    let goal = Goal::Error(task.error);
    let options = ChooseOptions {
        timed: task.timed,
        ..ChooseOptions::new(goal)
    };
    let choice = choose::choose(&scene, &[], &options, monitor)?;
    let what = &task.request.options;
    let offers = choice.found.iter().map(|it| (it.method, it.control));
    Ok(Answer {
        report: choose::report(what, &scene, (goal, Scope::default()), &choice),
        offers: offers.collect(),
        complete: true,
        ..Answer::default()
    })
}

fn of_simplification(task: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
    let request = &task.request;
    let title = describe(&request.options, &request.scene()?);
    let options = SimplifyOptions::new(task.error);
    let found = simplify::measure(request, &title, &options, monitor)?;
    let lean = found.lean.as_ref();
    let is_leaner = lean.filter(|lean| !lean.parts.is_empty() || lean.factor != 1.0);
    Ok(Answer {
        lean: is_leaner.map(|lean| lean.scene.clone()),
        complete: lean.is_some(),
        report: found.report,
        ..Answer::default()
    })
}
