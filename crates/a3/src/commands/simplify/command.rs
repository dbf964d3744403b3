//! The command `a3 simplify`: measures the models, and assembles the leanest scene.

use std::path::Path;

use a3_core::accuracy::Frames;

use super::chart::chart;
use super::lean::{Answer, LeanModel, MAX_TIME_RATIO, Solved, assemble, solve, time_in_turns};
use super::models::{Model, Models, measure_all};
use super::table;
use crate::base::failure::Failure;
use crate::base::progress::Bar;
use crate::base::{interrupt, terminal};
use crate::cli::{Quantity, Simplify};
use crate::commands::chart::table::words;
use crate::commands::chart::{PICTURES, check_motion, describe, look_ahead, scope, write_picture};
use crate::commands::motion::{Compared, open};
use crate::files::output;
use crate::files::setup::Request;

/// Method that is often the cheapest, and is tried first.
const OFTEN_CHEAPEST: &str = "verlet";

/// Measures models of a scene, prints them, and writes the leanest.
pub fn run(options: &Simplify) -> Result<(), Failure> {
    interrupt::listen();
    let request = request(options)?;
    let mut known = open(options.data.as_deref())?;
    let bar = Bar::new(1.0);
    let models = whole(options, &request, &bar)?;
    let (mut all, why) = models.all();
    let complete = measure_all(&models, &mut all, &mut known, &bar)?;
    let answer = if complete {
        leanest(&models, &all, options.error, &bar)?
    } else {
        None
    };
    if let (Some(answer), Some(path)) = (&answer, &options.chart) {
        draw(path, options, &models, answer, &bar)?;
    }
    bar.clear();
    interrupt::write_on();
    print(options, &models, &all, why.as_deref(), answer.as_ref())?;
    match (answer, &options.output) {
        (Some(answer), Some(path)) => write(path, &models, &answer),
        (Some(_), None) => Ok(()),
        (None, _) => Err(Failure::Interrupted(
            "interrupted: the table has what was measured until then".into(),
        )),
    }
}

/// Draws the chart of models, and says where it is.
fn draw(
    path: &Path,
    options: &Simplify,
    models: &Models,
    answer: &Answer,
    bar: &Bar,
) -> Result<(), Failure> {
    let title = format!("Models: {}", describe(&options.what, &models.scene));
    let Some(chart) = chart(models, &answer.whole, title, bar)? else {
        return bar.pause(|| terminal::say("no chart: the scene has one grid only\n"));
    };
    let (width, height) = options.size;
    let figure = chart.draw(f64::from(width), f64::from(height));
    write_picture(path, &figure.map_err(Failure::usage)?)?;
    bar.pause(|| terminal::say(&format!("chart: {}\n", path.display())))
}

/// Reads the scene, with the options of the command line in its description, and checks that the
/// leanest scene can be written.
fn request(options: &Simplify) -> Result<Request, Failure> {
    let given = Request::read(&options.what)?;
    // This refuses options that the scene does not support.
    given.scene()?;
    let request = given.described();
    if let Some(path) = &options.chart {
        output::check(path, PICTURES)?;
    }
    if let Some(path) = &options.output {
        output::check(path, &["toml"])?;
        if path.exists() {
            return Err(Failure::usage(format!(
                "{}: there is such a file already: give the scene another name",
                path.display()
            )));
        }
        check_folder(path, &request)?;
    }
    Ok(request)
}

/// Checks that a scene with meshes in files is written to its own folder, because these files are
/// found relative to it.
fn check_folder(path: &Path, request: &Request) -> Result<(), Failure> {
    let description = &request.source.description;
    let parts = description.body.iter().flat_map(|body| &body.parts);
    let has_files = !description.mesh.is_empty()
        || !description.obstacle.is_empty()
        || description.solid.iter().any(|solid| solid.file.is_some())
        || parts.into_iter().any(|part| part.file.is_some());
    let folder = |path: &Path| path.parent().map(Path::to_path_buf).unwrap_or_default();
    let own = request
        .source
        .path
        .as_deref()
        .map(folder)
        .unwrap_or_default();
    if has_files && folder(path) != own {
        return Err(Failure::usage(format!(
            "{}: the scene has meshes in files beside it: write the lean scene to the folder {}",
            path.display(),
            if own.as_os_str().is_empty() {
                ".".into()
            } else {
                own.display().to_string()
            }
        )));
    }
    Ok(())
}

/// Integrates the whole scene accurately, up to the end of the runs. Returns its models, which are
/// not measured yet.
fn whole<'a>(options: &Simplify, request: &'a Request, bar: &Bar) -> Result<Models<'a>, Failure> {
    let scene = request.scene()?;
    if scene.model.network().is_none() {
        return Err(Failure::usage(format!(
            "the scene {} is a single equation: there is nothing to leave out",
            scene.name
        )));
    }
    let (error, quantity) = (options.error, options.of);
    let scope = scope(&options.scope, &scene)?;
    if scope.particle.is_some() && quantity != Quantity::Position {
        return Err(Failure::usage(
            "--particle: only positions are those of a particle",
        ));
    }
    bar.say("looking ahead  ".into());
    let horizon = look_ahead(&scene, options.until, 1.0, bar)?.ok_or_else(stopped)?;
    check_motion(&scene, &horizon)?;
    bar.say("whole scene  ".into());
    let compared = Compared {
        quantity,
        frames: Frames::new(horizon.until),
        scope,
    };
    let models = Models::new(request, scene, compared, error)?.ok_or_else(stopped)?;
    let motion = compared.way(&models.whole);
    if error > motion {
        bar.warn(&format!(
            "warning: {} by no more than {motion:.0e} {unit} in {} s: an error of {error:e} {unit} says nothing",
            changing(quantity),
            compared.frames.until,
            unit = compared.unit(),
        ));
    }
    Ok(models)
}

/// Returns the quantity and its verb, as the subject of a sentence.
fn changing(quantity: Quantity) -> &'static str {
    match quantity {
        Quantity::Position => "the particles move",
        Quantity::Centre => "the centre of mass moves",
        Quantity::Energy => "the energy changes",
    }
}

/// Assembles the leanest scene, and finds the cheapest solvers for it and for the whole scene.
/// `None` if the command was interrupted.
fn leanest(
    models: &Models,
    all: &[Model],
    error: f64,
    bar: &Bar,
) -> Result<Option<Answer>, Failure> {
    bar.say("cheapest solver  ".into());
    let Some(mut whole) = solve(models, &LeanModel::whole(models), error, OFTEN_CHEAPEST)? else {
        return stop_or(format!(
            "no solver meets an error of {error:e} {} on the whole scene",
            models.compared.unit()
        ));
    };
    bar.say("leanest scene  ".into());
    let Some(model) = assemble(models, all, error)? else {
        return Ok(None);
    };
    let mut solved = if model.is_whole() {
        None
    } else {
        solve(models, &model, error, whole.method.name)?
    };
    if let Some(solved) = &mut solved {
        time_in_turns(models, &model, solved, &mut whole)?;
    }
    if !interrupt::go_on() {
        return Ok(None);
    }
    // The leanest scene has to save time, or to take no more work.
    let pays = |solved: &Solved| {
        solved.time <= MAX_TIME_RATIO * whole.time
            || model.factor == 1.0 && solved.work <= whole.work
    };
    let found = solved.filter(pays).map(|solved| (model, solved));
    let (model, solved) = found.unwrap_or_else(|| (LeanModel::whole(models), whole));
    Ok(Some(Answer {
        model,
        solved,
        whole,
    }))
}

/// Returns `None` if the command was interrupted, or else the failure.
fn stop_or<T>(why: String) -> Result<Option<T>, Failure> {
    if interrupt::go_on() {
        Err(Failure::run(why))
    } else {
        Ok(None)
    }
}

/// Prints the table of the models, the error of the grid, and the leanest scene.
fn print(
    options: &Simplify,
    models: &Models,
    all: &[Model],
    why: Option<&str>,
    answer: Option<&Answer>,
) -> Result<(), Failure> {
    let (scene, compared) = (&models.scene, models.compared);
    let motion = compared.way(&models.whole);
    let unit = compared.unit();
    terminal::say(&format!(
        "{} for {} s, an error of {:e} {unit}; {} by {motion:.1e} {unit}:\n",
        describe(&options.what, scene),
        compared.frames.until,
        options.error,
        changing(compared.quantity),
    ))?;
    let (method, control) = models.accurate;
    terminal::say(&format!(
        "each model is run by {} at {}, which is accurate to {:.0e} {unit} on the whole scene\n",
        method.title,
        words(control),
        models.uncertainty
    ))?;
    let lean = answer.map(|answer| &answer.model);
    if !all.is_empty() {
        terminal::say(&table::text(all, (motion, unit), options.error, lean))?;
    }
    let description = &models.request.source.description;
    let of_grid = table::of_grid(all, description);
    if let Some(of_grid) = of_grid.filter(|_| compared.quantity == Quantity::Position) {
        terminal::say(&of_grid)?;
    }
    if let Some(why) = why {
        terminal::say(&format!("the grid is not varied: {why}\n"))?;
    }
    match answer {
        Some(answer) => terminal::say(&table::of_lean(answer, unit)),
        None => Ok(()),
    }
}

/// Writes the leanest scene, with its solver and its step, to a file.
fn write(path: &Path, models: &Models, answer: &Answer) -> Result<(), Failure> {
    let mut description = answer.model.description.clone();
    description.solver = Some(answer.solved.method.name.into());
    description.step = Some(answer.solved.control.value());
    description
        .duration
        .get_or_insert(models.compared.frames.until);
    let text = description.to_toml().map_err(Failure::run)?;
    let head = format!(
        "# The scene {} without parts that change its motion by less than {:.1e} {}, by a3 {}.\n\n",
        models.scene.name.replace(char::is_control, " "),
        answer.solved.error,
        models.compared.unit(),
        env!("CARGO_PKG_VERSION")
    );
    output::write(path, (head + &text).as_bytes())?;
    terminal::say(&format!("scene: {}\n", path.display()))
}

/// Creates the failure of a command that was interrupted before any model was measured.
fn stopped() -> Failure {
    Failure::Interrupted("interrupted before anything was measured".into())
}
