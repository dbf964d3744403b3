//! The command `a3 choose`: finds the end of the runs, computes a reference, searches, and prints.

use a3_core::Scene;
use a3_core::accuracy::{Candidate, Frames, Metric, Precision, Reference, Scope};

use super::search::{ENOUGH_MARGIN, cheapest, within};
use super::words::{command, report, set_by};
use crate::base::failure::Failure;
use crate::base::progress::Bar;
use crate::base::{interrupt, terminal};
use crate::cli::Choose;
use crate::commands::chart::single::{precision, reference};
use crate::commands::chart::{
    check_contact, check_metric, check_motion, look_ahead, methods, scope, unit,
};
use crate::commands::motion::{grid_error, open, words};
use crate::files::setup::Request;

/// Finds and prints the solvers that the command line asks for.
pub fn run(options: &Choose) -> Result<(), Failure> {
    interrupt::listen();
    let asked = Asked::new(options)?;
    let bar = Bar::new(methods(&asked.scene, &[])?.len() as f64);
    let reference = asked.reference(&bar)?;
    let found = asked.search(&reference, &bar)?;
    asked.print(&reference, &found)
}

/// Demand on the solver.
enum Goal {
    /// Largest error, in the unit of the metric.
    Error(f64),
    /// Longest computing time of a frame (ms).
    Budget(f64),
}

/// Request of the command line, checked against the scene.
struct Asked<'a> {
    options: &'a Choose,
    request: Request,
    scene: Scene,
    metric: Metric,
    scope: Scope,
    goal: Goal,
}

impl<'a> Asked<'a> {
    /// Reads the scene, and checks the options against it.
    fn new(options: &'a Choose) -> Result<Self, Failure> {
        let request = Request::read(&options.what)?;
        let scene = request.scene()?;
        check_metric(options.of, &scene)?;
        Ok(Self {
            options,
            request,
            metric: options.of,
            scope: scope(&options.scope, &scene)?,
            scene,
            goal: match (options.error, options.budget) {
                (Some(error), _) => Goal::Error(error),
                (None, Some(budget)) => Goal::Budget(budget),
                (None, None) => return Err(Failure::usage("give --error or --budget")),
            },
        })
    }

    /// Computes the reference, up to the end of the runs and as precisely as the goal needs.
    fn reference(&self, bar: &Bar) -> Result<Reference, Failure> {
        let scene = &self.scene;
        bar.say("looking ahead  ".into());
        let horizon = look_ahead(scene, self.options.until, 1.0, bar)?.ok_or_else(stopped)?;
        check_motion(scene, &horizon)?;
        let frames = Frames::new(horizon.until);
        bar.say("reference  ".into());
        let precision = match self.goal {
            Goal::Error(error) => Precision {
                metric: self.metric,
                uncertainty: error / ENOUGH_MARGIN,
                max_work: f64::INFINITY,
            },
            Goal::Budget(_) => precision(scene, horizon.motion),
        };
        let reference = reference(scene, frames, self.scope, precision)?.ok_or_else(stopped)?;
        check_contact(self.metric, self.metric.of(&reference.still), frames.until)?;
        Ok(reference)
    }

    /// Finds the best candidates, with the computing times of their frames (ms).
    fn search(&self, reference: &Reference, bar: &Bar) -> Result<Vec<(Candidate, f64)>, Failure> {
        let (scene, metric) = (&self.scene, self.metric);
        let found = match self.goal {
            Goal::Error(error) => {
                cheapest(scene, reference, (metric, error), self.options.work, bar)?
            }
            Goal::Budget(budget) => within(scene, reference, metric, budget, bar)?,
        };
        let found = found.ok_or_else(stopped)?;
        if !found.is_empty() {
            return Ok(found);
        }
        let (goal, name) = (self.goal(), &scene.name);
        Err(Failure::run(match self.goal {
            Goal::Error(_) => {
                format!("no solver meets {goal} on {name}: ask for a larger error")
            }
            Goal::Budget(_) => format!(
                "within {goal}, no solver's error on {name} is smaller than the motion: ask for a larger budget"
            ),
        }))
    }

    /// Describes the goal in words.
    fn goal(&self) -> String {
        match self.goal {
            Goal::Error(error) => format!(
                "an error of {error:e} {} ({})",
                unit(self.metric),
                words(self.scope)
            ),
            Goal::Budget(budget) => format!("{budget} ms per frame"),
        }
    }

    /// Prints the candidates, and the command line that runs the best one.
    fn print(&self, reference: &Reference, found: &[(Candidate, f64)]) -> Result<(), Failure> {
        let (best, _) = &found[0];
        let (what, until) = (&self.options.what, reference.frames.until);
        let floor = self.metric.of(&reference.floor);
        let note = match self.goal {
            Goal::Error(_) => set_by(best),
            Goal::Budget(_) if self.metric.of(&best.outcome.errors) < ENOUGH_MARGIN * floor => {
                format!(
                    "the reference, known to {floor:.0e} {}, is the limit, not the budget: finer runs were not tried\n",
                    unit(self.metric)
                )
            }
            Goal::Budget(_) => String::new(),
        };
        let table = report(what, &self.scene, until, &self.goal(), (self.metric, found));
        terminal::say(&(table + &note))?;
        let line = command(what, best.method, best.control, until);
        terminal::say(&format!("run it:  {line}\n"))?;
        self.print_grid_error(best, reference.frames)
    }
}

impl Asked<'_> {
    /// Prints the error of the scene's grid, if it is larger than that of the solver.
    fn print_grid_error(&self, best: &Candidate, frames: Frames) -> Result<(), Failure> {
        if self.options.no_model || self.metric != Metric::Position {
            return Ok(());
        }
        let mut known = open(None)?;
        match grid_error(&self.request, &self.scene, frames, self.scope, &mut known)? {
            Some(own) if own.error > best.outcome.errors.position => terminal::say(&own.sentence()),
            _ => Ok(()),
        }
    }
}

/// Creates the failure of a search that was interrupted.
fn stopped() -> Failure {
    Failure::Interrupted("interrupted: nothing was chosen".into())
}
