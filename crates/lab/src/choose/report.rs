//! The answer of a choice in words, and the command line that runs it.

use std::fmt::Write;

use a3_core::accuracy::{Metric, Scope, SetBy};
use a3_core::{Control, Disturbances, Method, Scene};
use a3_files::report::{Report, headings};
use a3_files::setup::{Request, SceneOptions};

use super::value::{Choice, Chosen, ENOUGH_MARGIN, Goal, describe_goal};
use crate::chart::table::fraction;
use crate::chart::{describe, unit};
use crate::motion::words as scope_in_words;

/// Error that is shown at any time, over the one at 60 frames a second, from which on it is told.
const MAX_RATIO: f64 = 1.05;

/// Largest numerator of a step that is written as a fraction.
const MAX_NUMERATOR: f64 = 100.0;

/// Says why the best candidate's step or tolerance is not larger.
fn set_by(best: &Chosen) -> String {
    let what = match best.control {
        Control::Step(_) => "step",
        Control::Tolerance(_) => "tolerance",
    };
    let (by, why) = match best.set_by {
        SetBy::Accuracy => ("accuracy", "with a larger one the error is too large"),
        SetBy::Stability => ("stability", "with a larger one the run is unstable"),
        SetBy::Nothing => ("nothing", "no larger one was tried"),
    };
    format!("{by} limits the {what}: {why}\n")
}

/// Says where the error of the best run holds, if it does not hold at all times.
#[must_use]
pub fn holds(goal: Goal, choice: &Choice) -> String {
    let best = choice.best();
    let most = match goal {
        Goal::Error(error) => error,
        Goal::Budget(_) => MAX_RATIO * best.error,
    };
    let [at_ends, anywhere] = choice.shown;
    if anywhere <= most {
        return String::new();
    }
    let is_plain = choice.metric == Metric::State;
    let frames = if is_plain { "240 times" } else { "60 frames a second" };
    let place = match best.control {
        Control::Tolerance(_) => format!("at {frames}; between them"),
        Control::Step(_) if at_ends <= most => "at the ends of steps; between them".into(),
        Control::Step(_) => format!(
            "at {frames}, interpolated through the ends of three steps or at the nearest end; elsewhere"
        ),
    };
    let shown = if is_plain { "as runs" } else { "as films, data and the window" };
    let unit = unit(choice.metric);
    format!("the error holds {place}, {shown} show them, it is up to {anywhere:.1e} {unit}\n")
}

/// Creates the table of candidates, with the computing times of their frames (ms). Below it is what
/// limits the best one.
pub fn report(on: Disturbances, scene: &Scene, goal: (Goal, Scope), choice: &Choice) -> Report {
    let (metric, until) = (choice.metric, choice.until);
    let unit = unit(metric);
    let columns = format!("|solver| setting| error ({unit})| evaluations/s| time/frame");
    let mut rows = headings(&columns);
    for (k, c) in choice.found.iter().enumerate() {
        let cost = c.milliseconds;
        rows.push(vec![
            ["best", "runner-up", "then"][k.min(2)].into(),
            c.method.title.into(),
            match c.control {
                Control::Step(_) => format!("step {} s", typed(c.control)),
                Control::Tolerance(_) => format!("tolerance {}", typed(c.control)),
            },
            format!("{:.1e}", c.error),
            format!("{:.0}", c.work / until),
            if cost < 0.1 { format!("{:.2} µs", 1e3 * cost) } else { format!("{cost:.2} ms") },
        ]);
    }
    let (goal, scope) = goal;
    let holds = holds(goal, choice);
    let foot = match goal {
        Goal::Error(_) => set_by(choice.best()),
        Goal::Budget(_) if choice.best().error < ENOUGH_MARGIN * choice.floor => {
            let floor = choice.floor;
            format!(
                "the reference, known to {floor:.0e} {unit}, is the limit, not the budget: finer runs were not tried\n"
            )
        }
        Goal::Budget(_) => String::new(),
    };
    let goal = describe_goal(goal, metric, &scope_in_words(scope, &scene.model));
    Report {
        head: format!("{} for {until} s, {goal}:\n", describe(on, scene)),
        rows,
        foot: foot + &holds,
    }
}

/// Writes a step or a tolerance for a command line. A step is exact: a fraction if it has too many
/// decimals. A tolerance has four digits and is rounded down, so that the run is no less accurate.
fn typed(control: Control) -> String {
    let value = control.value();
    if let Control::Step(step) = control {
        let short = format!("{step}");
        if short.len() <= 6 {
            return short;
        }
        return fraction(step, MAX_NUMERATOR).unwrap_or(short);
    }
    let power = 10f64.powi(3 - value.log10().floor() as i32);
    let rounded = (value * power * (1.0 + 1e-12)).floor() / power;
    if rounded < 1e-3 { format!("{rounded:e}") } else { format!("{rounded}") }
}

/// Writes the command line that runs the scene with a method at a step or a tolerance.
pub fn command(request: &Request, method: &Method, control: Control) -> String {
    let solver = method.letter.map(String::from);
    let solver = solver.unwrap_or_else(|| method.name.into());
    let mut words = format!("a3 {solver} {}", typed(control));
    let (typed, SceneOptions { grid, on }) = (&request.source.typed, request.options);
    if typed != "cloth" {
        let _ = write!(words, " --scene {typed}");
    }
    if let Some(grid) = grid {
        let _ = write!(words, " --grid {}x{}", grid.rows(), grid.cols());
    }
    let options = [" --wind", " --swing", " --self-collision"];
    let given = [on.wind, on.swing, on.contact].into_iter().zip(options);
    words.extend(given.filter_map(|(on, option)| on.then_some(option)));
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_typed_short_and_never_coarser() {
        for (value, expected) in [
            (1.0 / 60.0, "1/60"),
            (0.01, "0.01"),
            (3.0 / 291.0, "1/97"),
            (3.0 / 292.0, "3/292"),
            (3.0 / 4.5, "2/3"),
            (0.5, "0.5"),
        ] {
            assert_eq!(typed(Control::Step(value)), expected);
        }
        assert_eq!(typed(Control::Step(0.3 / 37.0)), "3/370");
        assert_eq!(typed(Control::Tolerance(1.7783e-5)), "1.778e-5");
        assert_eq!(typed(Control::Tolerance(0.1)), "0.1");
    }
}
