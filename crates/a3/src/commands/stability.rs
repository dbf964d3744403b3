//! The command `a3 stability`: measures the limits, prints the table, and draws the chart.

use std::path::PathBuf;

use a3_core::Scene;
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::{interrupt, terminal};
use a3_lab::chart::{Label, methods};
use a3_lab::figure_file::PICTURES;
use a3_lab::stability::measure;

use super::picture;
use crate::cli::Stability as Options;

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Options) -> Result<(), Failure> {
    interrupt::listen();
    let request = options.what.request()?;
    let scene = request.scene()?;
    let methods = methods(&scene, &options.solvers)?;
    let path = check_outputs(options, &scene)?;
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
    if interrupt::go_on() {
        Ok(())
    } else {
        Err(Failure::Interrupted(
            "interrupted: the chart has what was measured until then".into(),
        ))
    }
}

/// Checks that the output files can be written. Returns the path of the picture.
fn check_outputs(options: &Options, scene: &Scene) -> Result<PathBuf, Failure> {
    let picture = match &options.output {
        Some(path) => path.clone(),
        None => format!("a3-stability-{}.svg", output::part_of_name(&scene.name)).into(),
    };
    output::check(&picture, PICTURES)?;
    if let Some(data) = &options.data {
        output::check(data, &["json"])?;
    }
    Ok(picture)
}
