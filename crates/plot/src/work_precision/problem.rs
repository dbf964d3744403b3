//! The data of a work-precision diagram.

use crate::style::CurveStyle;

/// The error and the work of one run of a method.
#[derive(Clone, Debug, Default)]
pub struct Measurement {
    /// The error, on the horizontal axis.
    pub error: f64,
    /// The work, on the vertical axis. A run without positive work is not drawn.
    pub work: f64,
    /// Whether the run blew up or failed. It is then drawn beside the chart, at its work.
    pub lost: bool,
    /// Whether something other than the method intervened in the run. Its marker is then half
    /// filled.
    pub held: bool,
    /// The step or the tolerance of the run, as text.
    pub label: Option<String>,
    /// The least and the largest error of runs like this one, drawn as a band.
    pub spread: Option<[f64; 2]>,
}

/// The runs of a method on a problem.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The style of the curve. A method has the same style on all problems.
    pub style: CurveStyle,
    /// The name of the method.
    pub name: String,
    /// The runs, in any order.
    pub runs: Vec<Measurement>,
}

/// A line through the diagram that no method draws, dashed and named in the legend.
#[derive(Clone, Debug)]
pub struct Guide {
    /// The meaning of the line.
    pub name: String,
    /// Its points: errors, and the work there.
    pub points: Vec<[f64; 2]>,
}

/// A problem that methods were run on: one panel of the diagram.
#[derive(Clone, Debug, Default)]
pub struct Problem {
    /// The title of the panel; none if it is empty.
    pub title: String,
    /// The title of the panel; may be empty.
    pub curves: Vec<Curve>,
    /// The resolution of the reference: the least error that it can distinguish from 0. Smaller
    /// errors are shaded.
    pub resolved: Option<f64>,
    /// The error of a run in which nothing moves, beyond which errors are meaningless: the front
    /// ends there.
    pub still: Option<f64>,
    /// A line through the panel.
    pub guide: Option<Guide>,
    /// Runs of other programs.
    pub marks: Vec<Mark>,
}

/// A run of another program, which is drawn with its name.
#[derive(Clone, Debug, Default)]
pub struct Mark {
    /// The error, on the horizontal axis.
    pub error: f64,
    /// The work, on the vertical axis; if it is not known, the error is drawn as a line.
    pub work: Option<f64>,
    /// The name of the run.
    pub name: String,
}

impl Mark {
    /// Returns whether the run has a place on the chart.
    pub(super) fn is_drawn(&self) -> bool {
        let has_place = |work: f64| work.is_finite() && work > 0.0;
        self.error.is_finite() && self.error > 0.0 && self.work.is_none_or(has_place)
    }
}

impl Measurement {
    /// Returns whether the run has a place on the chart. That of an error of 0 is at the left end.
    pub(super) fn is_drawn(&self) -> bool {
        self.work.is_finite() && self.work > 0.0
    }

    /// Returns whether the run is drawn beside the chart.
    #[must_use]
    pub fn is_lost(&self) -> bool {
        self.lost || !self.error.is_finite() || self.error < 0.0
    }
}

impl Curve {
    /// Returns the runs that a line joins, from the most accurate on: those that no other run of
    /// the method beats in both error and work. The steps of an adaptive method at its limit of
    /// stability cost about the same at any error, and a line through them would only go back and
    /// forth.
    #[must_use]
    pub fn joined(&self) -> Vec<&Measurement> {
        let unbeaten = unbeaten(std::slice::from_ref(self)).into_iter();
        unbeaten.map(|(_, run)| run).collect()
    }
}

impl Problem {
    /// Returns the least error that can be trusted, or 0 if that is not known.
    pub(super) fn trusted(&self) -> f64 {
        let known = self.resolved.filter(|resolved| resolved.is_finite());
        known.unwrap_or(0.0)
    }

    /// Returns the runs on the Pareto front, as indices of curve and run, from the smallest error
    /// up: those that no other run beats in both error and work. Runs with errors that the
    /// reference cannot tell from 0 are left out, but beat others.
    #[must_use]
    pub fn front(&self) -> Vec<[usize; 2]> {
        let runs = unbeaten(&self.curves).into_iter();
        runs.filter(|(_, run)| run.error > self.trusted())
            .filter(|(_, run)| self.still.is_none_or(|still| run.error <= still))
            .map(|(place, _)| place)
            .collect()
    }
}

/// Returns the runs of some curves that no other run of these beats in both error and work, each
/// with the indices of its curve and of itself, from the most accurate on.
fn unbeaten(curves: &[Curve]) -> Vec<([usize; 2], &Measurement)> {
    let mut runs = vec![];
    for (c, curve) in curves.iter().enumerate() {
        let drawn = curve.runs.iter().enumerate();
        let drawn = drawn.filter(|(_, run)| run.is_drawn() && !run.is_lost());
        runs.extend(drawn.map(|(r, run)| ([c, r], run)));
    }
    runs.sort_by(|(_, a), (_, b)| a.error.total_cmp(&b.error).then(a.work.total_cmp(&b.work)));
    let mut least = f64::INFINITY;
    runs.retain(|(_, run)| {
        let better = run.work < least;
        least = least.min(run.work);
        better
    });
    runs
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_front_is_what_nothing_beats() {
        let run = |error, work, lost| Measurement {
            error,
            work,
            lost,
            held: false,
            label: None,
            spread: None,
        };
        let curve = |runs| Curve { style: CurveStyle::default(), name: String::new(), runs };
        let problem = Problem {
            // The fourth run of the first is below the resolution, and its last blew up.
            curves: vec![
                curve(vec![
                    run(1e-2, 10.0, false),
                    run(1e-3, 40.0, false),
                    run(1e-4, 500.0, false),
                    run(1e-9, 600.0, false),
                    run(1e-5, 1.0, true),
                ]),
                curve(vec![
                    run(2e-2, 11.0, false),
                    run(1e-3, 30.0, false),
                    run(1e-5, 400.0, false),
                    run(f64::NAN, 1.0, false),
                ]),
            ],
            resolved: Some(1e-8),
            ..Problem::default()
        };
        assert_eq!(problem.front(), [[1, 2], [1, 1], [0, 0]]);
        let still = Some(5e-3);
        assert_eq!(Problem { still, ..problem }.front(), [[1, 2], [1, 1]]);
    }
}
