//! `a3 choose`: the cheapest solver for an error, or the most accurate one for a budget.

use std::fmt::Write;

use a3_core::accuracy::{Candidate, Frames, Metric, Reference, choose, ladder, measure};
use a3_core::{Control, Method, Scene};

use crate::chart::measure::time;
use crate::chart::{describe, look_ahead, methods};
use crate::cli::{Choose, What};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{interrupt, list, output, setup};

/// Simulated time of a frame (s).
const FRAME: f64 = 1.0 / 60.0;

/// Finds and prints what the command line asks for.
pub fn run(options: &Choose) -> Result<(), Failure> {
    interrupt::listen();
    let stopped = || Failure::Interrupted("interrupted: nothing was chosen".into());
    let scene = setup::scene(&options.what)?;
    let until = look_ahead(&scene, options.until, 1.0)?.ok_or_else(stopped)?;
    let reference = Reference::new(&scene, Frames::new(until), &interrupt::go_on)
        .map_err(|e| Failure::run(format!("the reference could not be computed: {e}")))?
        .ok_or_else(stopped)?;
    let (found, goal) = match (options.error, options.budget) {
        (Some(error), _) => {
            let floor = reference.floor.position;
            if error < 10.0 * floor {
                return Err(Failure::usage(format!(
                    "the reference of this scene over {until} s is itself known to {floor:.0e} m only: ask for an \
                     error of at least {:.0e}",
                    10.0 * floor
                )));
            }
            let found = choose(
                &scene,
                &reference,
                Metric::Position,
                error,
                &interrupt::go_on,
            )
            .map_err(Failure::run)?
            .ok_or_else(stopped)?;
            let found = found.into_iter().take(3).map(|candidate| {
                let cost = milliseconds(&scene, &candidate, &reference)?.ok_or_else(stopped)?;
                Ok((candidate, cost))
            });
            (
                found.collect::<Result<Vec<_>, Failure>>()?,
                format!("an error of {error:e} m"),
            )
        }
        (None, Some(budget)) => (
            within(&scene, &reference, budget)?.ok_or_else(stopped)?,
            format!("{budget} ms per frame"),
        ),
        (None, None) => return Err(Failure::usage("give --error or --budget")),
    };
    let Some((best, _)) = found.first() else {
        return Err(Failure::run(format!(
            "no solver meets {goal} on {}: {}",
            scene.name,
            if options.error.is_some() {
                "ask for a larger error"
            } else {
                "ask for a larger budget"
            }
        )));
    };
    output::say(&report(&options.what, &scene, until, &goal, &found))?;
    output::say(&format!(
        "run it:  {}\n",
        command(&options.what, best.method, best.control)
    ))
}

/// Computing time of a frame (ms), averaged over the whole run. `None` if it was interrupted.
fn milliseconds(
    scene: &Scene,
    candidate: &Candidate,
    reference: &Reference,
) -> Result<Option<f64>, Failure> {
    let time = time(
        scene,
        candidate.method,
        candidate.control,
        &reference.frames,
    )?;
    Ok(time.map(|time| 1e3 * time.as_secs_f64() * FRAME / reference.frames.until))
}

/// The three most accurate methods, each at its most accurate step or tolerance whose frames take
/// no longer than the budget (ms). `None` if it was interrupted.
fn within(
    scene: &Scene,
    reference: &Reference,
    budget: f64,
) -> Result<Option<Vec<(Candidate, f64)>>, Failure> {
    let mut found = vec![];
    let methods = methods(scene, &[])?;
    let bar = Bar::new(methods.len() as f64);
    for method in methods {
        bar.say(format!("{:<10} ", method.name));
        let mut best: Option<(Candidate, f64)> = None;
        for control in ladder(scene, method, &reference.frames, 1_000_000).map_err(Failure::run)? {
            let outcome = measure(scene, method, control, reference, &interrupt::go_on)
                .map_err(Failure::run)?;
            let Some(outcome) = outcome else {
                return Ok(None);
            };
            let candidate = Candidate {
                method,
                control,
                outcome,
            };
            let Some(cost) = milliseconds(scene, &candidate, reference)? else {
                return Ok(None);
            };
            if cost > budget {
                break;
            }
            let error = |c: &Candidate| c.outcome.errors.position;
            if outcome.lost.is_none()
                && best
                    .as_ref()
                    .is_none_or(|(best, _)| error(&candidate) < error(best))
            {
                best = Some((candidate, cost));
            }
            if error(&candidate) < 10.0 * reference.floor.position {
                break;
            }
        }
        found.extend(best);
        bar.advance(1.0);
    }
    bar.clear();
    found.sort_by(|(a, _), (b, _)| {
        let error = |c: &Candidate| c.outcome.errors.position;
        error(a).total_cmp(&error(b))
    });
    found.truncate(3);
    Ok(Some(found))
}

/// The table of candidates and their costs (ms).
fn report(
    what: &What,
    scene: &Scene,
    until: f64,
    goal: &str,
    found: &[(Candidate, f64)],
) -> String {
    let mut rows = vec![
        [
            "",
            "solver",
            " setting",
            " error (m)",
            " evaluations/s",
            " ms/frame",
        ]
        .map(String::from)
        .to_vec(),
    ];
    for (k, (c, cost)) in found.iter().enumerate() {
        rows.push(vec![
            ["best", "runner-up", "then"][k.min(2)].into(),
            c.method.title.into(),
            match c.control {
                Control::Step(step) => format!("step {} s", typed(step)),
                Control::Tolerance(tolerance) => format!("tolerance {}", typed(tolerance)),
            },
            format!("{:.1e}", c.outcome.errors.position),
            format!("{:.0}", c.outcome.work.total() / until),
            format!("{cost:.3}"),
        ]);
    }
    format!(
        "{} for {until} s, {goal}:\n{}",
        describe(what, scene),
        list::table(&rows)
    )
}

/// A step or a tolerance as it would be typed: to four digits, rounded down, so that the run is no
/// coarser.
fn typed(value: f64) -> String {
    let power = 10f64.powi(3 - value.log10().floor() as i32);
    let rounded = (value * power * (1.0 + 1e-12)).floor() / power;
    if rounded < 1e-3 {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// The command line that runs the scene with a method at a step or a tolerance.
fn command(what: &What, method: &Method, control: Control) -> String {
    let mut words = format!("a3 {} {}", method.letter, typed(control.value()));
    if what.scene.typed != "cloth" {
        let _ = write!(words, " --scene {}", what.scene.typed);
    }
    if let Some(grid) = what.grid {
        let _ = write!(words, " --grid {}x{}", grid.rows(), grid.cols());
    }
    for (on, option) in [(what.wind, " --wind"), (what.swing, " --swing")] {
        if on {
            words += option;
        }
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_typed_short_and_never_coarser() {
        for (value, expected) in [
            (1.0 / 60.0, "0.01666"),
            (0.01, "0.01"),
            (1.0 / 120.0, "0.008333"),
            (1.7783e-5, "1.778e-5"),
            (0.5, "0.5"),
        ] {
            assert_eq!(typed(value), expected);
        }
    }
}
