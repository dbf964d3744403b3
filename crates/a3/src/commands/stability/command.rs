//! The command `a3 stability`: measures the limits, prints the table, and draws the chart.

use std::path::{Path, PathBuf};

use a3_core::Scene;
use a3_core::stability::Mode;

use super::limits::Found;
use super::measure::{measure, nothing};
use super::{data, picture, table};
use crate::base::failure::Failure;
use crate::base::{interrupt, terminal};
use crate::cli::Stability;
use crate::commands::chart::{PICTURES, describe, methods, write_picture};
use crate::files::output;
use crate::files::setup::Request;

/// Measures, prints and draws what the command line asks for.
pub fn run(options: &Stability) -> Result<(), Failure> {
    interrupt::listen();
    let scene = Request::read(&options.what)?.scene()?;
    let methods = methods(&scene, &options.solvers)?;
    let picture = check_outputs(options, &scene)?;
    let found = measure(&scene, &methods)?;
    interrupt::write_on();
    if found.rows.is_empty() {
        return Err(nothing());
    }
    terminal::say(&table::text(&scene, &found))?;
    if let Some(data) = &options.data {
        output::write(data, data::json(&found.rows)?.as_bytes())?;
    }
    draw(options, &scene, &found, &picture)?;
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
fn check_outputs(options: &Stability, scene: &Scene) -> Result<PathBuf, Failure> {
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

/// Draws the chart, writes it to its file, and prints the path.
fn draw(options: &Stability, scene: &Scene, found: &Found, path: &Path) -> Result<(), Failure> {
    let title = format!("Where solvers fail: {}", describe(&options.what, scene));
    // By default a step is one radian of the fastest motion.
    let fastest = found.at_start.first().map_or(1.0, Mode::frequency);
    let h = options
        .step
        .unwrap_or_else(|| format!("{:.1e}", 1.0 / fastest).parse().unwrap_or(1.0));
    let (width, height) = options.size;
    let figure = picture::chart(title, &found.rows, &found.at_start, h)
        .draw(f64::from(width), f64::from(height))
        .map_err(Failure::usage)?;
    write_picture(path, &figure)?;
    terminal::say(&format!("chart: {}\n", path.display()))
}
