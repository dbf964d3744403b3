//! The command `a3 stability`: measures the limits, prints the table, and draws the chart.

use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::{interrupt, terminal};
use a3_lab::chart::{Label, methods};
use a3_lab::stability::measure;

use super::picture;
use crate::cli::Stability as Options;

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Options) -> Result<(), Failure> {
    interrupt::listen();
    let request = options.what.request()?;
    let scene = request.scene()?;
    let methods = methods(&scene, &options.solvers)?;
    let path = picture::path(options.output.as_deref(), "stability", &scene)?;
    if let Some(data) = &options.data {
        output::check(data, &["json"])?;
    }
    let label = Label::asked(request.options.on, &scene, scene.name.clone());
    let found = measure(&scene, &label, &methods, &Bar::new(1.0))?;
    interrupt::write_on();
    terminal::say(&found.table())?;
    if let Some(data) = &options.data {
        output::write(data, found.json()?.as_bytes())?;
    }
    let (width, height) = options.size;
    let figure = found.figure(options.step, width, height)?;
    picture::finish(&path, &figure, options.open)?;
    if let Some(data) = &options.data {
        terminal::say(&format!("data: {}\n", data.display()))?;
    }
    picture::check_complete(interrupt::go_on())
}
