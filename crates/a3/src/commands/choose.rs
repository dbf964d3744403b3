//! The command `a3 choose`: chooses, and says the answer in words.

use a3_core::accuracy::{Frames, Metric};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::{interrupt, terminal};
use a3_lab::chart::{check_metric, methods};
use a3_lab::choose::{ChooseOptions, Goal, choose, command, report};

use super::picture;
use crate::cli::{Choose, WorkMeasure};

/// Finds and prints the solvers that the command line asks for, the command line that runs the best
/// one, and the error of the scene's grid, if it is larger than that of the solver.
pub fn run(options: &Choose) -> Result<(), Failure> {
    interrupt::listen();
    let request = options.what.request()?;
    let scene = request.scene()?;
    check_metric(options.of, &scene)?;
    let goal = match (options.error, options.budget) {
        (Some(error), _) => Goal::Error(error),
        (None, Some(budget)) => Goal::Budget(budget),
        (None, None) => return Err(Failure::usage("give --error or --budget")),
    };
    let scope = options.scope.given().checked(&scene.model);
    let scope = scope.map_err(Failure::usage)?;
    let wanted = ChooseOptions {
        goal,
        metric: Some(options.of),
        until: options.until,
        particle: options.scope.particle,
        at_end: options.scope.at_end,
        timed: options.work == WorkMeasure::Time,
    };
    let methods = methods(&scene, &[])?;
    let bar = Bar::new(methods.len() as f64);
    let choice = choose(&scene, &methods, &wanted, &bar)?;
    let best = choice.best();
    let report = report(request.options.on, &scene, (goal, scope), &choice);
    terminal::say(&report.text())?;
    let line = command(&request, best.method, best.control);
    terminal::say(&format!("run it:  {line}\n"))?;
    if options.no_model || choice.metric != Metric::Position {
        return Ok(());
    }
    let of = (Frames::new(choice.until), scope);
    picture::print_grid_error(&request, &scene, of, None, Some(best.error))
}
