//! The work-precision diagram of the runs.

use std::fmt::Write;

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, Scene};
use a3_plot::{Curve, Measurement, Problem, WorkPrecision};

use super::data::Data;
use super::measure::Study;
use super::record::Record;
use super::words::unit;
use super::{style, table};

/// Largest error of a run that is drawn, over the error of a run in which nothing moves.
const MAX_ERROR_RATIO: f64 = 10.0;

/// Label of the vertical axis where work is shown, and not computing time.
pub const WORK: &str = "evaluations per simulated second, linear algebra included";

/// Creates the diagram, with a panel for each study.
pub fn chart(
    studies: &[Study],
    data: &Data,
    methods: &[&'static Method],
    metric: Metric,
    timed: bool,
    title: &str,
) -> WorkPrecision {
    let (until, scope) = (studies[0].frames.until, studies[0].scope());
    let problems = studies
        .iter()
        .map(|study| {
            let records: Vec<_> = study.records(data).collect();
            let beside: Vec<_> = study.beside(data).collect();
            let mut problem = problem(&records, &beside, methods, metric, timed);
            if studies.len() > 1 || study.stiffness() != 1.0 {
                problem.title = format!("stiffness × {}", study.stiffness());
            }
            problem
        })
        .collect();
    WorkPrecision {
        title: format!("Speed against accuracy: {title}"),
        subtitle: format!(
            "{until} s of motion; each point is a run with another step or tolerance{}",
            if studies
                .iter()
                .any(|study| study.beside(data).next().is_some())
            {
                "; bands: errors at tolerances within 4 %"
            } else {
                ""
            }
        ),
        x_label: x_label(metric, scope),
        y_label: if timed {
            "computing time per simulated second (s)"
        } else {
            WORK
        }
        .into(),
        problems,
        foot: foot(methods) + turning(&studies[0].scene, methods),
        held: "held by impulses".into(),
    }
}

/// Letters of the solvers whose steps turn rigid bodies by a composition of order 6.
const TURNING: [char; 3] = ['s', 'v', 'p'];

/// Keeps the curves of the methods that are cheapest for some error in some panel, of those that
/// the course teaches, and of own methods.
pub fn keep_best(chart: &mut WorkPrecision, methods: &[&'static Method], scene: &Scene) {
    let mut kept: Vec<_> = methods
        .iter()
        .map(|m| m.is_own() || style::is_of_course(m))
        .collect();
    for problem in &chart.problems {
        for [curve, _] in problem.front() {
            kept[curve] = true;
        }
    }
    let left_out = kept.iter().filter(|kept| !**kept).count();
    if left_out == 0 {
        return;
    }
    for problem in &mut chart.problems {
        let mut kept = kept.iter();
        problem
            .curves
            .retain(|_| kept.next().is_some_and(|kept| *kept));
    }
    let drawn = methods.iter().zip(&kept);
    let drawn: Vec<_> = drawn.filter_map(|(m, kept)| kept.then_some(*m)).collect();
    let styles = style::together(&drawn);
    for problem in &mut chart.problems {
        for (curve, style) in problem.curves.iter_mut().zip(&styles) {
            curve.style = *style;
        }
    }
    chart.foot = foot(&drawn) + turning(scene, &drawn);
    let _ = write!(
        chart.subtitle,
        "; {left_out} more solvers, cheapest nowhere, are in the table"
    );
}

/// Explains below the chart how errors are measured, and which methods soften the springs.
pub fn foot(methods: &[&'static Method]) -> String {
    let errors = "Errors are true ones, against DOP853 at two tolerances and a method of another \
                  family. Those below ten times their disagreement are shaded.";
    if methods.iter().any(|method| method.needs_springs()) {
        format!(
            "{errors} Methods with a number of iterations stop before implicit Euler is solved: \
             in long steps their springs are softer than the scene's."
        )
    } else {
        errors.into()
    }
}

/// Returns a note on the methods that turn rigid bodies more accurately than their order says, if
/// the chart has both.
fn turning(scene: &Scene, methods: &[&'static Method]) -> &'static str {
    let has_bodies = scene
        .model
        .network()
        .is_some_and(|network| !network.bodies().is_empty());
    if has_bodies
        && methods.iter().any(|method| {
            method
                .letter
                .is_some_and(|letter| TURNING.contains(&letter))
        })
    {
        " Symplectic Euler, Verlet and PEFRL turn bodies by a composition of order 6, whatever \
         their own order: in free flight their errors fall with it."
    } else {
        ""
    }
}

/// Returns the label of the horizontal axis.
pub fn x_label(metric: Metric, scope: Scope) -> String {
    let what = match (metric, scope.particle) {
        (Metric::Position, None) => "RMS error of the positions".to_owned(),
        (Metric::Position, Some(i)) => format!("error of the position of particle {i}"),
        (Metric::State, _) => "RMS error of the state".to_owned(),
        (Metric::Energy, _) => "error of the energy".to_owned(),
        (Metric::Strain, _) => "RMS error of the springs' stretch".to_owned(),
        (Metric::Momentum, _) => "error of the momentum".to_owned(),
        (Metric::Penetration, _) => "error of the penetration".to_owned(),
        (Metric::Impact, _) => "error of the times of the first impact".to_owned(),
        (Metric::Phase, None) => "error of the phase".to_owned(),
        (Metric::Phase, Some(i)) => format!("error of the phase of particle {i}"),
    };
    let unit = unit(metric);
    if scope.at_end {
        format!("{what} at the end ({unit})")
    } else {
        format!("largest {what} ({unit})")
    }
}

/// Returns the smallest and the largest error of a run and its neighbours in tolerance; `None`
/// without neighbours.
fn spread(run: &Record, beside: &[&Record], metric: Metric) -> Option<[f64; 2]> {
    let own = run.error(metric);
    let is_near = |r: &&&Record| r.solver == run.solver && r.beside == Some(run.setting);
    let errors = beside.iter().filter(is_near).map(|r| r.error(metric));
    errors.fold(None, |ends, error| {
        let [min, max] = ends.unwrap_or([own, own]);
        Some([min.min(error), max.max(error)])
    })
}

/// Returns the runs of a method that its curve has, in the order of the curve.
pub fn drawn<'a>(all: &[&'a Record], method: &Method, metric: Metric) -> Vec<&'a Record> {
    let mut records: Vec<_> = all
        .iter()
        .copied()
        .filter(|r| r.solver == method.name)
        .filter(|r| r.lost_at.is_some() || r.error(metric) <= MAX_ERROR_RATIO * r.still(metric))
        .collect();
    records.sort_by(|a, b| b.setting.total_cmp(&a.setting));
    records
}

/// Creates the panel of a scene's runs, without a title. The errors of the runs at neighbouring
/// tolerances become bands.
pub fn problem(
    all: &[&Record],
    beside: &[&Record],
    methods: &[&'static Method],
    metric: Metric,
    timed: bool,
) -> Problem {
    let styles = style::together(methods);
    let curves = methods.iter().zip(styles).map(|(method, style)| {
        let records = drawn(all, method, metric);
        // A run that blew up is drawn at the work that it would have taken until the end. It was
        // not timed: its computing time is estimated from the other runs of the method.
        let price = records
            .iter()
            .filter_map(|r| Some(r.seconds? / r.work))
            .fold(f64::INFINITY, f64::min);
        let run = |r: &&Record| {
            let whole = |work: f64| r.lost_at.map_or(work, |at| work * r.until / at);
            let work = if timed {
                r.seconds.unwrap_or(whole(r.work) * price)
            } else {
                whole(r.work)
            };
            Measurement {
                error: r.error(metric),
                work: work / r.until,
                lost: r.lost_at.is_some(),
                held: r.is_held(),
                label: Some(table::words(method.control(r.setting))),
                spread: spread(r, beside, metric),
            }
        };
        Curve {
            style,
            name: method.title.to_owned(),
            runs: records.iter().map(run).collect(),
        }
    });
    let resolved = all.iter().map(|r| r.resolved(metric)).reduce(f64::max);
    let still = all
        .iter()
        .map(|r| r.still(metric))
        .fold(f64::INFINITY, f64::min);
    Problem {
        curves: curves.collect(),
        resolved,
        still: Some(still).filter(|still| still.is_finite()),
        ..Problem::default()
    }
}
