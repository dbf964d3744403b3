//! The chart of all solvers on the scene, with the files in it.

use std::path::Path;

use a3_core::accuracy::{Metric, Scope};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_plot::{Mark, WorkPrecision};

use super::judgement::Judgement;
use super::trial::Course;
use crate::chart::measure::{Measured, Study};
use crate::chart::record::Data;
use crate::chart::{Chart, Label, methods};

/// Measures all solvers as long as files were judged, and returns their chart with the files, and
/// whether all was measured.
pub fn chart(
    label: &Label,
    course: &Course,
    files: &[(String, Judgement)],
    bar: &Bar,
) -> Result<(WorkPrecision, bool), Failure> {
    let (scene, motion) = (course.scene, course.horizon.motion);
    let until = files.iter().map(|(_, judgement)| judgement.until);
    let until = until.fold(0.0, f64::max);
    let timed = files.iter().any(|(_, it)| it.seconds.is_some());
    let (methods, metric) = (methods(scene, &[])?, Metric::Position);
    let of = (metric, Scope::default(), motion);
    let measured = Measured { timed, spread: false };
    let study = Study::new(scene.clone(), label, 1.0, until, &methods, of, measured);
    let mut measured = Chart {
        studies: vec![study],
        data: Data::open(None)?,
        methods,
        metric,
        timed,
        title: label.title.clone(),
        complete: false,
    };
    measured.measure(bar)?;
    let mut chart = measured.best_picture();
    let marks = if timed { "stars" } else { "lines" };
    chart.subtitle = format!(
        "{until} s of motion; each point is a run of a solver with another step or tolerance, and {marks} are the files"
    );
    for problem in &mut chart.problems {
        problem.marks = files.iter().map(|(name, it)| mark(name, it)).collect();
    }
    Ok((chart, measured.complete))
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
