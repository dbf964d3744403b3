//! The command `a3 judge`: reads the files, judges each, and prints what it found.

use std::path::Path;

use a3_core::Scene;
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::states::{States, read};
use a3_files::{interrupt, terminal};
use a3_lab::chart::{Label, describe};
use a3_lab::judge::judgement::Judgement;
use a3_lab::judge::picture::chart;
use a3_lab::judge::trial::Course;
use a3_lab::judge::value::Record;
use a3_lab::judge::words::{is_resolved, is_within, orders, text, too_large};

use super::picture::{self, PICTURES, write_picture};
use crate::cli::Judge;

/// Judges the files that the command line names.
pub fn run(options: &Judge) -> Result<(), Failure> {
    interrupt::listen();
    let scene = scene(options)?;
    let mut refused = vec![];
    let files = files(options, &scene, &mut refused)?;
    let bar = Bar::new(files.len() as f64);
    bar.say("looking ahead  ");
    let ends = files.iter().filter_map(|(_, states)| states.times.last());
    let last = ends.fold(0.0, |last: f64, end| last.max(*end));
    let mut course = Course::new(&scene, last, options.until, options.step, &bar)?;
    let judged = judge_all(options, &mut course, &files, &mut refused, &bar)?;
    print(options, &course, &judged)?;
    if let Some(path) = &options.chart {
        let label = Label::asked(options.what.options().on, &scene, scene.name.clone());
        let (chart, complete) = chart(&label, &course, &judged, &bar)?;
        let (width, height) = options.size;
        let figure = chart.draw(f64::from(width), f64::from(height));
        write_picture(path, &figure.map_err(Failure::usage)?)?;
        bar.pause(|| terminal::say(&format!("chart: {}\n", path.display())))?;
        picture::check_complete(complete)?;
    }
    bar.clear();
    verdict(options, &judged, refused.len())
}

/// Builds the scene, and checks the outputs.
fn scene(options: &Judge) -> Result<Scene, Failure> {
    let scene = options.what.request()?.scene()?;
    if !options.seconds.is_empty() && options.seconds.len() != options.files.len() {
        return Err(Failure::usage(format!(
            "--seconds has {} computing times for {} files: give one for each",
            options.seconds.len(),
            options.files.len()
        )));
    }
    if let Some(path) = &options.chart {
        output::check(path, PICTURES)?;
    }
    match options.summary.as_deref() {
        Some(path) if path != Path::new("-") => output::check(path, &["json"])?,
        _ => {}
    }
    Ok(scene)
}

/// Reads the files. One that is refused is reported, and those beside it are judged.
fn files(
    options: &Judge,
    scene: &Scene,
    refused: &mut Vec<Failure>,
) -> Result<Vec<(String, States)>, Failure> {
    let mut files = vec![];
    for (k, path) in options.files.iter().enumerate() {
        match read(path, scene.model.particles()) {
            Ok(mut states) => {
                states.seconds = options.seconds.get(k).copied().or(states.seconds);
                files.push((path.display().to_string(), states));
            }
            Err(error) => refuse(options, error.into(), refused)?,
        }
    }
    if files.is_empty() {
        return Err(none());
    }
    Ok(files)
}

/// Reports a file that is refused. The only file is the failure of the command.
fn refuse(options: &Judge, why: Failure, refused: &mut Vec<Failure>) -> Result<(), Failure> {
    if options.files.len() == 1 {
        return Err(why);
    }
    terminal::warn(&format!("error: {why}"));
    refused.push(why);
    Ok(())
}

fn none() -> Failure {
    Failure::usage("no file could be judged")
}

/// Judges all files.
fn judge_all(
    options: &Judge,
    course: &mut Course,
    files: &[(String, States)],
    refused: &mut Vec<Failure>,
    bar: &Bar,
) -> Result<Vec<(String, Judgement)>, Failure> {
    let mut judged = vec![];
    for (name, states) in files {
        bar.say(&format!("{name}  "));
        match course.judge(name, states) {
            Ok(judgement) => judged.push((name.clone(), judgement)),
            Err(why @ Failure::Usage(_)) => refuse(options, why, refused)?,
            Err(failure) => return Err(failure),
        }
        bar.advance(1.0);
    }
    bar.clear();
    if judged.is_empty() {
        return Err(none());
    }
    Ok(judged)
}

/// Prints the judgements, or writes them as JSON.
fn print(options: &Judge, course: &Course, judged: &[(String, Judgement)]) -> Result<(), Failure> {
    if let Some(path) = &options.summary {
        let records = judged.iter();
        let records = records.map(|(name, it)| Record::of(name, it, options.within));
        let records: Vec<_> = records.collect();
        let json = serde_json::to_string_pretty(&records).map_err(Failure::run)? + "\n";
        if path == Path::new("-") {
            return terminal::send(&json);
        }
        output::write(path, json.as_bytes())?;
    }
    let is_cut = |(_, judgement): &(_, Judgement)| judgement.judged < judgement.states;
    if options.until.is_none() && judged.iter().any(is_cut) {
        let name = describe(options.what.options().on, course.scene);
        let (lyapunov, until) = (course.horizon.lyapunov, course.horizon.until);
        terminal::say(&format!(
            "{name}: errors grow by themselves e-fold every {lyapunov:.2} s (Lyapunov time); judged up to {until} s\n"
        ))?;
    }
    for (k, (name, judgement)) in judged.iter().enumerate() {
        let gap = if k == 0 { "" } else { "\n" };
        terminal::say(&format!("{gap}{}", text(name, judgement, options.within)))?;
    }
    let orders = program_orders(judged);
    if orders.is_empty() {
        return Ok(());
    }
    terminal::say(&format!("\n{orders}"))
}

/// Returns the orders of the programs: files are of one if they agree with the same method, or with
/// none.
fn program_orders(judged: &[(String, Judgement)]) -> String {
    let way = |judgement: &Judgement| judgement.found.found.map(|found| found.trial.way);
    let ways: Vec<_> = judged.iter().map(|(_, judgement)| way(judgement)).collect();
    let of = |k: usize| {
        let own = judged.iter().zip(&ways).filter(|(_, way)| **way == ways[k]);
        let runs = own.filter(|((_, judgement), _)| is_resolved(judgement));
        let runs = runs.filter_map(|((name, judgement), _)| {
            Some((&**name, judgement.step?, judgement.worst.error))
        });
        orders(&runs.collect::<Vec<_>>())
    };
    let once = |k: &usize| !ways[..*k].contains(&ways[*k]);
    (0..ways.len()).filter(once).map(of).collect()
}

/// Fails if a file was refused, or errs by more than was asked for.
fn verdict(options: &Judge, judged: &[(String, Judgement)], refused: usize) -> Result<(), Failure> {
    if refused > 0 {
        return Err(Failure::usage(format!(
            "{refused} of {} files could not be judged",
            options.files.len()
        )));
    }
    let Some(within) = options.within else {
        return Ok(());
    };
    let is_missed = |(_, judgement): &&(_, _)| !is_within(judgement, within);
    let missed: Vec<_> = judged.iter().filter(is_missed).collect();
    Err(Failure::run(match &missed[..] {
        [] => return Ok(()),
        [(name, judgement)] => format!("{name}: {}", too_large(judgement, within)),
        several => {
            format!("{} of {} files err by more than {within:e} m", several.len(), judged.len())
        }
    }))
}
