//! The command `a3 chart`: measures the runs, prints the tables, and draws the chart.

use std::path::PathBuf;

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, Scene};

use super::asked::{check_metric, methods, scope};
use super::data::Data;
use super::each::Each;
use super::files::{PICTURES, write_picture};
use super::horizon::{check_motion, look_ahead};
use super::measure::{Measured, Study, stiffened};
use super::{picture, table};
use crate::base::failure::Failure;
use crate::base::progress::Bar;
use crate::base::{interrupt, terminal};
use crate::cli::{Chart, WorkMeasure};
use crate::commands::motion;
use crate::files::output;
use crate::files::setup::Request;

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Chart) -> Result<(), Failure> {
    interrupt::listen();
    let asked = Asked::new(options)?;
    let mut data = Data::open(options.data.as_deref())?;
    data.each = options.each.as_deref().map(Each::new).transpose()?;
    let bar = Bar::new(1.0);
    let mut studies = asked.studies(&bar)?;
    let complete = measure(&mut studies, &mut data, &bar)?;
    studies.retain(|study| study.records(&data).next().is_some());
    if studies.is_empty() {
        return Err(nothing());
    }
    asked.print(&studies, &data)?;
    asked.draw(&studies, &data, complete)?;
    if complete {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}

/// Request of the command line, checked against the scene.
struct Asked<'a> {
    options: &'a Chart,
    request: Request,
    scene: Scene,
    /// Name of the scene with a hash of its files, for the data.
    name: String,
    methods: Vec<&'static Method>,
    metric: Metric,
    scope: Scope,
    picture: PathBuf,
}

impl<'a> Asked<'a> {
    /// Reads the scene, and checks the options against it.
    fn new(options: &'a Chart) -> Result<Self, Failure> {
        let request = Request::read(&options.what)?;
        let scene = request.scene()?;
        let methods = methods(&scene, &options.solvers)?;
        let picture = match &options.output {
            Some(path) => path.clone(),
            None => format!("a3-chart-{}.svg", output::part_of_name(&scene.name)).into(),
        };
        output::check(&picture, PICTURES)?;
        check_metric(options.error, &scene)?;
        Ok(Self {
            options,
            name: request.source.fingerprint(&scene),
            methods,
            metric: options.error,
            scope: scope(&options.scope, &scene)?,
            picture,
            scene,
            request,
        })
    }

    /// Whether the chart shows computing times, and not work.
    fn timed(&self) -> bool {
        self.options.work == WorkMeasure::Time
    }

    /// Creates a study for each stiffness. All end at the shortest of their horizons.
    fn studies(&self, bar: &Bar) -> Result<Vec<Study<'_>>, Failure> {
        let mut scenes = vec![];
        let mut until = self.options.until;
        for &factor in &self.options.stiffness {
            bar.say("looking ahead  ".into());
            let scene = stiffened(&self.scene, factor)?;
            let Some(found) = look_ahead(&scene, self.options.until, factor, bar)? else {
                continue;
            };
            check_motion(&scene, &found)?;
            until = Some(until.map_or(found.until, |until: f64| until.min(found.until)));
            scenes.push((factor, scene, found.motion));
        }
        let until = until.ok_or_else(nothing)?;
        let measured = Measured {
            timed: self.timed(),
            spread: self.options.spread,
        };
        let studies = scenes.into_iter().map(|(factor, scene, motion)| {
            let of = (self.metric, self.scope, motion);
            let named = (&*self.name, &self.options.what);
            Study::new(scene, named, factor, until, &self.methods, of, measured)
        });
        Ok(studies.collect())
    }

    /// Prints the tables, advice where the reference is uncertain, and the error of the grid.
    fn print(&self, studies: &[Study], data: &Data) -> Result<(), Failure> {
        let (methods, metric, timed) = (&self.methods, self.metric, self.timed());
        terminal::say(&table::text(studies, data, methods, metric, timed))?;
        if metric == Metric::Position {
            for advice in studies.iter().filter_map(table::advice) {
                terminal::say(&advice)?;
            }
            self.print_grid_error(studies)?;
        }
        Ok(())
    }

    /// Prints the error of the scene's grid, unless `--no-model` was given.
    fn print_grid_error(&self, studies: &[Study]) -> Result<(), Failure> {
        if self.options.no_model || !interrupt::go_on() {
            return Ok(());
        }
        let frames = studies[0].frames;
        let mut known = motion::open(self.options.data.as_deref().map(motion::beside).as_deref())?;
        match motion::grid_error(&self.request, &self.scene, frames, self.scope, &mut known)? {
            Some(own) => terminal::say(&own.sentence()),
            None => Ok(()),
        }
    }

    /// Draws the chart, writes it to its file, and prints the path.
    fn draw(&self, studies: &[Study], data: &Data, complete: bool) -> Result<(), Failure> {
        let (methods, metric, timed) = (&self.methods, self.metric, self.timed());
        let mut chart = picture::chart(studies, data, methods, metric, timed, &self.options.what);
        if self.options.solvers.is_empty() {
            picture::keep_best(&mut chart, methods, &self.scene);
        }
        let (width, height) = self.options.size;
        let figure = chart.draw(f64::from(width), f64::from(height));
        let figure = figure.map_err(|why| {
            if complete {
                Failure::usage(why)
            } else {
                Failure::Interrupted(format!("interrupted: {why}"))
            }
        })?;
        write_picture(&self.picture, &figure)?;
        terminal::say(&format!("chart: {}\n", self.picture.display()))
    }
}

/// Measures the runs that the data lack, and saves the data. Returns whether all were measured;
/// `false` if the command was interrupted.
fn measure(studies: &mut [Study], data: &mut Data, bar: &Bar) -> Result<bool, Failure> {
    let mut expected = 0.0;
    for study in &*studies {
        expected += study.expected()?;
    }
    bar.expect(expected);
    let mut complete = true;
    for study in studies {
        if !study.run(data, bar)? {
            complete = false;
            break;
        }
    }
    bar.clear();
    interrupt::write_on();
    data.runs.save()?;
    if let Some(each) = data.each.take() {
        each.finish()?;
    }
    Ok(complete)
}

/// Creates the failure of a command that was interrupted before its first run ended.
fn nothing() -> Failure {
    Failure::Interrupted("interrupted before anything was measured".into())
}
