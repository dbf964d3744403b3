//! The command `a3 choose`: chooses, and says the answer in words.

use a3_core::Scene;
use a3_core::accuracy::{Frames, Metric, Scope};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::setup::Request;
use a3_files::{interrupt, terminal};
use a3_lab::chart::{check_metric, methods};
use a3_lab::choose::{Choice, ChooseOptions, Goal, choose, command, report};
use a3_lab::motion::{grid_error, open};

use crate::cli::{Choose, WorkMeasure};

/// Finds and prints the solvers that the command line asks for.
pub fn run(options: &Choose) -> Result<(), Failure> {
    interrupt::listen();
    let asked = Asked::new(options)?;
    let methods = methods(&asked.scene, &[])?;
    let bar = Bar::new(methods.len() as f64);
    let choice = choose(&asked.scene, &methods, &asked.wanted, &bar)?;
    asked.print(&choice)
}

/// Request of the command line, checked against the scene.
struct Asked<'a> {
    options: &'a Choose,
    request: Request,
    scene: Scene,
    scope: Scope,
    wanted: ChooseOptions,
}

impl<'a> Asked<'a> {
    /// Reads the scene, and checks the options against it.
    fn new(options: &'a Choose) -> Result<Self, Failure> {
        let request = options.what.request()?;
        let scene = request.scene()?;
        check_metric(options.of, &scene)?;
        let goal = match (options.error, options.budget) {
            (Some(error), _) => Goal::Error(error),
            (None, Some(budget)) => Goal::Budget(budget),
            (None, None) => return Err(Failure::usage("give --error or --budget")),
        };
        Ok(Self {
            options,
            request,
            scope: options
                .scope
                .given()
                .checked(&scene.model)
                .map_err(Failure::usage)?,
            scene,
            wanted: ChooseOptions {
                goal,
                metric: Some(options.of),
                until: options.until,
                particle: options.scope.particle,
                at_end: options.scope.at_end,
                timed: options.work == WorkMeasure::Time,
            },
        })
    }

    /// Prints the candidates, and the command line that runs the best one.
    fn print(&self, choice: &Choice) -> Result<(), Failure> {
        let (best, request, goal) = (choice.best(), &self.request, self.wanted.goal);
        let report = report(request.options.on, &self.scene, (goal, self.scope), choice);
        terminal::say(&report.text())?;
        let line = command(request, best.method, best.control);
        terminal::say(&format!("run it:  {line}\n"))?;
        self.print_grid_error(choice)
    }

    /// Prints the error of the scene's grid, if it is larger than that of the solver.
    fn print_grid_error(&self, choice: &Choice) -> Result<(), Failure> {
        if self.options.no_model || choice.metric != Metric::Position {
            return Ok(());
        }
        let frames = Frames::new(choice.until);
        let mut known = open(None)?;
        match grid_error(&self.request, &self.scene, frames, self.scope, &mut known)? {
            Some(own) if own.error > choice.best().error => terminal::say(&own.sentence()),
            _ => Ok(()),
        }
    }
}
