//! The command: measures, prints and draws.

use a3_core::stability::Mode;

use super::measure::{Found, measure, nothing};
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
    let path = match &options.output {
        Some(path) => path.clone(),
        None => format!("a3-stability-{}.svg", output::part_of_name(&scene.name)).into(),
    };
    output::check(&path, PICTURES)?;
    if let Some(data) = &options.data {
        output::check(data, &["json"])?;
    }
    let Found {
        rows,
        motion,
        hanging,
        at_start,
    } = measure(&scene, &methods)?;
    interrupt::write_on();
    if rows.is_empty() {
        return Err(nothing());
    }
    terminal::say(&table::text(
        &scene,
        &rows,
        &motion,
        &at_start,
        hanging.as_ref(),
    ))?;
    let title = format!("Where solvers fail: {}", describe(&options.what, &scene));
    // By default a step is one radian of the fastest motion.
    let fastest = at_start.first().map_or(1.0, Mode::frequency);
    let h = options
        .step
        .unwrap_or_else(|| format!("{:.1e}", 1.0 / fastest).parse().unwrap_or(1.0));
    if let Some(data) = &options.data {
        output::write(data, data::json(&rows)?.as_bytes())?;
    }
    let figure = picture::chart(title, &rows, &at_start, h)
        .draw(f64::from(options.size.0), f64::from(options.size.1))
        .map_err(Failure::usage)?;
    write_picture(&path, &figure)?;
    terminal::say(&format!("chart: {}\n", path.display()))?;
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
