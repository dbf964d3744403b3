//! Pictures of commands: written to their file, named, and shown if that is asked for; and the
//! error of a scene's grid.

use std::path::{Path, PathBuf};

use a3_core::Scene;
use a3_core::accuracy::{Frames, Scope};
use a3_files::failure::Failure;
use a3_files::setup::Request;
use a3_files::{interrupt, output, terminal};
use a3_lab::motion;
use a3_plot::Figure;

/// Extensions of the picture formats.
pub const PICTURES: &[&str] = &["svg", "pdf", "png"];

/// Writes a figure as SVG, PDF or PNG, by the extension of the path.
pub fn write_picture(path: &Path, figure: &Figure) -> Result<(), Failure> {
    if output::ends_in(path, "png") {
        output::write(path, &figure.png(1.0).map_err(Failure::run)?)
    } else if output::ends_in(path, "pdf") {
        output::write(path, &figure.pdf())
    } else {
        output::write(path, figure.svg().as_bytes())
    }
}

/// Returns the path of the chart of a command, `given` or by the name of the scene, which can be
/// written.
pub fn path(given: Option<&Path>, command: &str, scene: &Scene) -> Result<PathBuf, Failure> {
    let scene = output::part_of_name(&scene.name);
    let default = || format!("a3-{command}-{scene}.svg").into();
    let path = given.map_or_else(default, Path::to_owned);
    output::check(&path, PICTURES)?;
    Ok(path)
}

/// Writes a chart to its file, prints the path, and, if `open`, shows it in the desktop's viewer.
pub fn finish(path: &Path, figure: &Figure, open: bool) -> Result<(), Failure> {
    write_picture(path, figure)?;
    terminal::say(&format!("chart: {}\n", path.display()))?;
    if !open {
        return Ok(());
    }
    // A viewer may read a relative path as the address of a web page.
    let whole = std::path::absolute(path).map_err(Failure::run)?;
    open::that_detached(whole).map_err(|_| {
        let path = path.display();
        Failure::run(format!("{path}: it is written, but no viewer opens it"))
    })
}

/// Fails if not all that a chart shows was measured.
pub fn check_complete(complete: bool) -> Result<(), Failure> {
    let why = "interrupted: the chart has what was measured until then";
    let stopped = || Failure::Interrupted(why.into());
    complete.then_some(()).ok_or_else(stopped)
}

/// Prints the error of a scene's grids at these frames, if it is larger than `least` (m), or in any
/// case without that. What is measured is kept beside the file of a chart's data.
pub fn print_grid_error(
    request: &Request,
    scene: &Scene,
    (frames, scope): (Frames, Scope),
    data: Option<&Path>,
    least: Option<f64>,
) -> Result<(), Failure> {
    if !interrupt::go_on() {
        return Ok(());
    }
    let mut known = motion::open(data.map(motion::beside).as_deref())?;
    match motion::grid_error(request, scene, frames, scope, &mut known)? {
        Some(own) if least.is_none_or(|least| own.error > least) => terminal::say(&own.sentence()),
        _ => Ok(()),
    }
}
