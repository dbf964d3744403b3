//! The command `a3 simplify`: measures the models, prints them, and writes the leanest scene.

use std::path::Path;

use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::setup::Request;
use a3_files::{interrupt, terminal};
use a3_lab::chart::describe;
use a3_lab::simplify::{Simplified, SimplifyOptions, measure};

use super::picture::{self, PICTURES};
use crate::cli::Simplify;

/// Measures models of a scene, prints them, and writes the leanest.
pub fn run(options: &Simplify) -> Result<(), Failure> {
    interrupt::listen();
    let given = options.what.request()?;
    // This refuses options that the scene does not support.
    let scene = given.scene()?;
    let title = describe(given.options.on, &scene);
    let default = || format!("a3-simplify-{}.svg", output::part_of_name(&scene.name)).into();
    let chart = options.chart.clone().or_else(|| options.open.then(default));
    let request = given.described();
    check_files(options, chart.as_deref(), &request)?;
    let bar = Bar::new(1.0);
    let asked = SimplifyOptions {
        error: options.error,
        of: options.of,
        until: options.until,
        particle: options.scope.particle,
        at_end: options.scope.at_end,
        data: options.data.clone(),
        chart: chart.is_some(),
    };
    let found = measure(&request, &title, &asked, &bar)?;
    bar.clear();
    interrupt::write_on();
    if let Some(path) = &chart {
        draw(path, options, &found)?;
    }
    terminal::say(&found.text())?;
    let Some(lean) = &found.lean else {
        let why = "interrupted: the table has what was measured until then";
        return Err(Failure::Interrupted(why.into()));
    };
    let Some(path) = &options.output else {
        return Ok(());
    };
    output::write(path, lean.scene.as_bytes())?;
    terminal::say(&format!("scene: {}\n", path.display()))
}

/// Draws the chart of models, and says where it is.
fn draw(path: &Path, options: &Simplify, found: &Simplified) -> Result<(), Failure> {
    let (width, height) = options.size;
    match found.figure(width, height)? {
        Some(figure) => picture::finish(path, &figure, options.open),
        None if found.lean.is_some() => terminal::say(
            "no chart: the scene has one grid only, or grids differ by more than the motion\n",
        ),
        None => Ok(()),
    }
}

/// Checks that the chart and the leanest scene can be written.
fn check_files(options: &Simplify, chart: Option<&Path>, request: &Request) -> Result<(), Failure> {
    if let Some(path) = chart {
        output::check(path, PICTURES)?;
    }
    if let Some(path) = &options.output {
        output::check(path, &["toml"])?;
        if path.exists() {
            return Err(Failure::usage(format!(
                "{}: there is such a file already: give the scene another name",
                path.display()
            )));
        }
        check_folder(path, request)?;
    }
    Ok(())
}

/// Checks that a scene with meshes in files is written to its own folder, because these files are
/// found relative to it.
fn check_folder(path: &Path, request: &Request) -> Result<(), Failure> {
    let description = &request.source.description;
    let parts = description.body.iter().flat_map(|body| &body.parts);
    let has_files = !description.mesh.is_empty()
        || !description.obstacle.is_empty()
        || description.solid.iter().any(|solid| solid.file.is_some())
        || parts.into_iter().any(|part| part.file.is_some());
    let folder = |path: &Path| path.parent().map(Path::to_path_buf).unwrap_or_default();
    let own = request.source.path.as_deref().map(folder);
    let own = own.unwrap_or_default();
    if !has_files || folder(path) == own {
        return Ok(());
    }
    let own = if own.as_os_str().is_empty() { Path::new(".") } else { &own };
    Err(Failure::usage(format!(
        "{}: the scene has meshes in files beside it: write the lean scene to the folder {}",
        path.display(),
        own.display()
    )))
}
