//! The command `a3 chart`: measures the runs, prints the tables, and draws the chart, in the file
//! that is asked for.

use std::path::PathBuf;

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, Scene};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::setup::Request;
use a3_files::{interrupt, terminal};
use a3_lab::chart::asked::{check_metric, methods};
use a3_lab::chart::data::{Data, Each};
use a3_lab::chart::{Chart, ChartOptions, Label};
use a3_lab::figure_file::PICTURES;
use a3_lab::motion;

use super::picture;
use crate::cli::{Chart as Options, WorkMeasure};

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Options) -> Result<(), Failure> {
    interrupt::listen();
    let asked = Asked::new(options)?;
    let mut data = Data::open(options.data.as_deref())?;
    data.each = options.each.as_deref().map(Each::new).transpose()?;
    let bar = Bar::new(1.0);
    let mut chart = asked.begin(data, &bar)?;
    chart.measure(&bar)?;
    interrupt::write_on();
    chart.save()?;
    chart.finish()?;
    asked.print(&chart)?;
    asked.draw(&chart)?;
    if chart.is_complete() {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}

/// Request of the command line, checked against the scene.
struct Asked<'a> {
    options: &'a Options,
    request: Request,
    scene: Scene,
    methods: Vec<&'static Method>,
    scope: Scope,
    picture: PathBuf,
}

impl<'a> Asked<'a> {
    /// Reads the scene, and checks the options against it.
    fn new(options: &'a Options) -> Result<Self, Failure> {
        let request = options.what.request()?;
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
            methods,
            scope: options
                .scope
                .given()
                .checked(&scene.model)
                .map_err(Failure::usage)?,
            picture,
            scene,
            request,
        })
    }

    /// Finds the end of the runs, which are added to these data.
    fn begin(&self, data: Data, bar: &Bar) -> Result<Chart, Failure> {
        let (scene, options) = (&self.scene, self.options);
        let name = self.request.source.fingerprint(scene);
        let label = Label::asked(self.request.options.on, scene, name);
        let options = ChartOptions {
            until: options.until,
            error: Some(options.error),
            particle: options.scope.particle,
            at_end: options.scope.at_end,
            timed: options.work == WorkMeasure::Time,
            spread: options.spread,
            stiffness: options.stiffness.clone(),
        };
        Chart::begin(scene, &label, self.methods.clone(), &options, data, bar)
    }

    /// Prints the tables, advice where the reference is uncertain, and the error of the grid.
    fn print(&self, chart: &Chart) -> Result<(), Failure> {
        terminal::say(&(chart.table() + &chart.advice()))?;
        if chart.metric() == Metric::Position {
            self.print_grid_error(chart)?;
        }
        Ok(())
    }

    /// Prints the error of the scene's grid, unless `--no-model` was given.
    fn print_grid_error(&self, chart: &Chart) -> Result<(), Failure> {
        if self.options.no_model || !interrupt::go_on() {
            return Ok(());
        }
        let frames = chart.frames();
        let mut known = motion::open(self.options.data.as_deref().map(motion::beside).as_deref())?;
        match motion::grid_error(&self.request, &self.scene, frames, self.scope, &mut known)? {
            Some(own) => terminal::say(&own.sentence()),
            None => Ok(()),
        }
    }

    /// Draws the chart, writes it to its file, and prints the path.
    fn draw(&self, chart: &Chart) -> Result<(), Failure> {
        let diagram = if self.options.solvers.is_empty() {
            chart.best_picture()
        } else {
            chart.picture()
        };
        let (width, height) = self.options.size;
        let figure = diagram.draw(f64::from(width), f64::from(height));
        let figure = figure.map_err(|why| {
            if chart.is_complete() {
                Failure::usage(why)
            } else {
                Failure::Interrupted(format!("interrupted: {why}"))
            }
        })?;
        picture::finish(&self.picture, &figure, self.options.open)
    }
}
