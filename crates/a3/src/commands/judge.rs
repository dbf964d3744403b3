//! The command `a3 judge`: reads the files, judges each, and prints what it found.

use std::path::Path;

use a3_core::Scene;
use a3_core::accuracy::Horizon;
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::states::{States, read};
use a3_files::{interrupt, terminal};
use a3_lab::chart::{Label, describe};
use a3_lab::figure_file::{PICTURES, write_picture};
use a3_lab::judge::judgement::{Course, Judgement, judge};
use a3_lab::judge::picture;
use a3_lab::judge::plain::Plain;
use a3_lab::judge::summary::Record;
use a3_lab::judge::trial::Way;
use a3_lab::judge::truth::Truth;
use a3_lab::judge::value::{look_ahead as horizon_of, stopped};
use a3_lab::judge::words::{is_resolved, is_within, orders, text, too_large};

use crate::cli::Judge;

/// Judges the files that the command line names.
pub fn run(options: &Judge) -> Result<(), Failure> {
    interrupt::listen();
    let scene = scene(options)?;
    let mut refused = vec![];
    let files = files(options, &scene, &mut refused)?;
    let bar = Bar::new(files.len() as f64);
    let horizon = look_ahead(options, &scene, &files, &bar)?;
    let judged = judge_all(options, &scene, &horizon, &files, &mut refused, &bar)?;
    print(options, &scene, &horizon, &judged)?;
    if let Some(path) = &options.chart {
        let until = judged.iter().map(|(_, judgement)| judgement.until);
        let until = until.fold(0.0, f64::max);
        let label = Label::asked(options.what.options().on, &scene, scene.name.clone());
        let (chart, complete) =
            picture::chart(&label, &scene, horizon.motion, until, &judged, &bar)?;
        let (width, height) = options.size;
        let figure = chart.draw(f64::from(width), f64::from(height));
        write_picture(path, &figure.map_err(Failure::usage)?)?;
        bar.pause(|| terminal::say(&format!("chart: {}\n", path.display())))?;
        if !complete {
            return Err(Failure::Interrupted(
                "interrupted: the chart has what was measured until then".into(),
            ));
        }
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
    if let Some(path) = options
        .summary
        .as_deref()
        .filter(|path| *path != Path::new("-"))
    {
        output::check(path, &["json"])?;
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

/// Finds how long errors mean something on the scene, up to the last state of the files.
fn look_ahead(
    options: &Judge,
    scene: &Scene,
    files: &[(String, States)],
    bar: &Bar,
) -> Result<Horizon, Failure> {
    bar.say("looking ahead  ");
    let ends = files.iter().filter_map(|(_, states)| states.times.last());
    let last = ends.fold(0.0, |last: f64, end| last.max(*end));
    horizon_of(scene, last, options.until, bar)
}

/// Judges all files.
fn judge_all(
    options: &Judge,
    scene: &Scene,
    horizon: &Horizon,
    files: &[(String, States)],
    refused: &mut Vec<Failure>,
    bar: &Bar,
) -> Result<Vec<(String, Judgement)>, Failure> {
    let plain = Plain::of(scene).ok();
    let course = Course {
        monitor: bar,
        scene,
        plain: plain.as_ref(),
        until: horizon.until,
        step: options.step,
    };
    let mut truth = Truth::new(scene, horizon, bar);
    let mut judged = vec![];
    for (name, states) in files {
        bar.say(&format!("{name}  "));
        match judge(&course, &mut truth, states) {
            Ok(Some(judgement)) => judged.push((name.clone(), judgement)),
            Ok(None) => return Err(stopped()),
            Err(Failure::Usage(why)) => {
                let why = Failure::usage(format!("{name}: {why}"));
                refuse(options, why, refused)?;
            }
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
fn print(
    options: &Judge,
    scene: &Scene,
    horizon: &Horizon,
    judged: &[(String, Judgement)],
) -> Result<(), Failure> {
    if let Some(path) = &options.summary {
        let records: Vec<_> = judged
            .iter()
            .map(|(name, judgement)| Record::of(name, judgement, options.within))
            .collect();
        let json = serde_json::to_string_pretty(&records).map_err(Failure::run)? + "\n";
        if path == Path::new("-") {
            return terminal::send(&json);
        }
        output::write(path, json.as_bytes())?;
    }
    let name = describe(options.what.options().on, scene);
    if judged
        .iter()
        .any(|(_, judgement)| judgement.judged < judgement.states)
        && options.until.is_none()
    {
        terminal::say(&format!(
            "{name}: errors grow by themselves e-fold every {:.2} s (Lyapunov time); judged up to {} s\n",
            horizon.lyapunov, horizon.until
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
    let mut ways: Vec<_> = judged.iter().map(|(_, judgement)| way(judgement)).collect();
    ways.dedup();
    let of = |chosen: &Option<Way>| {
        let own = judged
            .iter()
            .filter(|(_, judgement)| way(judgement) == *chosen);
        let runs = own.filter(|(_, judgement)| is_resolved(judgement));
        let runs = runs.filter_map(|(name, judgement)| {
            Some((&**name, judgement.step?, judgement.worst.error))
        });
        orders(&runs.collect::<Vec<_>>())
    };
    let once = |k: &usize| !ways[..*k].contains(&ways[*k]);
    (0..ways.len()).filter(once).map(|k| of(&ways[k])).collect()
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
    let missed: Vec<_> = judged
        .iter()
        .filter(|(_, judgement)| !is_within(judgement, within))
        .collect();
    match &missed[..] {
        [] => Ok(()),
        [(name, judgement)] => Err(Failure::run(format!(
            "{name}: {}",
            too_large(judgement, within)
        ))),
        several => Err(Failure::run(format!(
            "{} of {} files err by more than {within:e} m",
            several.len(),
            judged.len()
        ))),
    }
}
