//! The chart of all solvers on the scene, with the files in it.

use std::path::Path;

use a3_core::Scene;
use a3_core::accuracy::{Metric, Scope};
use a3_plot::Mark;

use super::judgement::Judgement;
use crate::base::failure::Failure;
use crate::base::progress::Bar;
use crate::base::terminal;
use crate::cli::Judge;
use crate::commands::chart::data::Data;
use crate::commands::chart::measure::{Measured, Study};
use crate::commands::chart::{Label, methods, picture, write_picture};

/// Measures all solvers until `until` (s), draws them with the files, and says where the chart is.
pub fn draw(
    path: &Path,
    options: &Judge,
    (scene, motion, until): (&Scene, f64, f64),
    files: &[(String, Judgement)],
    bar: &Bar,
) -> Result<(), Failure> {
    let timed = files
        .iter()
        .any(|(_, judgement)| judgement.seconds.is_some());
    let (all, metric) = (methods(scene, &[])?, Metric::Position);
    let of = (metric, Scope::default(), motion);
    let measured = Measured {
        timed,
        spread: false,
    };
    let label = Label::asked(options.what.options().on, scene, scene.name.clone());
    let mut study = Study::new(scene.clone(), &label, 1.0, until, &all, of, measured);
    let mut data = Data::open(None)?;
    bar.expect(study.expected()?);
    let complete = study.run(&mut data, bar)?;
    let studies = [study];
    let mut chart = picture::chart(&studies, &data, &all, metric, timed, &label.title);
    picture::keep_best(&mut chart, &all, scene);
    let marks = if timed { "stars" } else { "lines" };
    chart.subtitle = format!(
        "{until} s of motion; each point is a run of a solver with another step or tolerance, and {marks} are the files"
    );
    for problem in &mut chart.problems {
        problem.marks = files
            .iter()
            .map(|(name, judgement)| mark(name, judgement))
            .collect();
    }
    let (width, height) = options.size;
    let figure = chart.draw(f64::from(width), f64::from(height));
    write_picture(path, &figure.map_err(Failure::usage)?)?;
    bar.pause(|| terminal::say(&format!("chart: {}\n", path.display())))?;
    if complete {
        return Ok(());
    }
    Err(Failure::Interrupted(
        "interrupted: the chart has what was measured until then".into(),
    ))
}

/// Returns the mark of a file: its error, its computing time per simulated second, and its name.
fn mark(name: &str, judgement: &Judgement) -> Mark {
    let stem = Path::new(name).file_stem().unwrap_or_default();
    Mark {
        error: judgement.worst.error,
        work: judgement.seconds.map(|seconds| seconds / judgement.until),
        name: stem.to_string_lossy().into_owned(),
    }
}
