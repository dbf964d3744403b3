//! The command `a3 chart`: measures the runs, prints the tables, and draws the chart, in the file
//! that is asked for.

use a3_core::accuracy::Metric;
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::{interrupt, terminal};
use a3_lab::chart::asked::{check_metric, methods};
use a3_lab::chart::record::{Data, Each};
use a3_lab::chart::{Chart, ChartOptions, Label};

use super::picture;
use crate::cli::{Chart as Options, WorkMeasure};

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Options) -> Result<(), Failure> {
    interrupt::listen();
    let request = options.what.request()?;
    let scene = request.scene()?;
    let methods = methods(&scene, &options.solvers)?;
    let path = picture::path(options.output.as_deref(), "chart", &scene)?;
    check_metric(options.error, &scene)?;
    let scope = options.scope.given().checked(&scene.model);
    let scope = scope.map_err(Failure::usage)?;
    let mut data = Data::open(options.data.as_deref())?;
    data.each = options.each.as_deref().map(Each::new).transpose()?;
    let bar = Bar::new(1.0);
    let name = request.source.fingerprint(&scene);
    let label = Label::asked(request.options.on, &scene, name);
    let wanted = ChartOptions {
        until: options.until,
        error: Some(options.error),
        particle: options.scope.particle,
        at_end: options.scope.at_end,
        timed: options.work == WorkMeasure::Time,
        spread: options.spread,
        stiffness: options.stiffness.clone(),
    };
    let mut chart = Chart::begin(&scene, &label, methods, &wanted, data, &bar)?;
    chart.measure(&bar)?;
    interrupt::write_on();
    chart.save()?;
    chart.finish()?;
    terminal::say(&(chart.table() + &chart.advice()))?;
    if chart.metric() == Metric::Position && !options.no_model {
        let (of, data) = ((chart.frames(), scope), options.data.as_deref());
        picture::print_grid_error(&request, &scene, of, data, None)?;
    }
    let diagram = if options.solvers.is_empty() { chart.best_picture() } else { chart.picture() };
    let (width, height) = options.size;
    let figure = diagram.draw(f64::from(width), f64::from(height));
    let figure = figure.map_err(|why| {
        if chart.is_complete() {
            Failure::usage(why)
        } else {
            Failure::Interrupted(format!("interrupted: {why}"))
        }
    });
    picture::finish(&path, &figure?, options.open)?;
    picture::check_complete(chart.is_complete())
}
