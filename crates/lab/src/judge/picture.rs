//! The chart of all solvers on the scene, with the files in it.

use std::path::Path;

use a3_core::Scene;
use a3_core::accuracy::{Metric, Scope};
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_plot::{Mark, WorkPrecision};

use super::judgement::Judgement;
use crate::chart::data::Data;
use crate::chart::measure::{Measured, Study};
use crate::chart::{Label, methods, picture};

/// Measures all solvers until `until` (s), in a scene that moves by `motion` (m), and returns their
/// chart with the files, and whether all was measured.
pub fn chart(
    label: &Label,
    scene: &Scene,
    motion: f64,
    until: f64,
    files: &[(String, Judgement)],
    bar: &Bar,
) -> Result<(WorkPrecision, bool), Failure> {
    let timed = files
        .iter()
        .any(|(_, judgement)| judgement.seconds.is_some());
    let (all, metric) = (methods(scene, &[])?, Metric::Position);
    let of = (metric, Scope::default(), motion);
    let measured = Measured {
        timed,
        spread: false,
    };
    let mut study = Study::new(scene.clone(), label, 1.0, until, &all, of, measured);
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
    Ok((chart, complete))
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
