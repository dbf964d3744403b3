//! `a3 choose`: the cheapest solver for an error, or the most accurate one for a budget.

use std::fmt::Write;

use a3_core::accuracy::{
    Candidate, Frames, Metric, Precision, Reference, SetBy, choose, ladder, measure,
};
use a3_core::stability::spectrum;
use a3_core::{Control, Method, Scene};

use crate::chart::measure::words;
use crate::chart::single::{precision, reference, time};
use crate::chart::table::fraction;
use crate::chart::{
    check_contact, check_motion, describe, look_ahead, methods, metric, scope, unit,
};
use crate::cli::{Choose, What, WorkMeasure};
use crate::failure::Failure;
use crate::progress::Bar;
use crate::{interrupt, list, output, setup};

/// Error that is asked for over the uncertainty of the reference: at least, and where the reference
/// is fine enough.
const MARGIN: (f64, f64) = (3.0, 100.0);
/// Number of candidates that are shown.
const SHOWN: usize = 3;
/// Simulated time of a frame (s).
const FRAME: f64 = 1.0 / 60.0;

/// Finds and prints what the command line asks for.
pub fn run(options: &Choose) -> Result<(), Failure> {
    interrupt::listen();
    let stopped = || Failure::Interrupted("interrupted: nothing was chosen".into());
    let scene = setup::scene(&options.what)?;
    let metric = metric(options.of, &scene)?;
    let scope = scope(&options.scope, &scene)?;
    let methods = methods(&scene, &[])?.len();
    let bar = Bar::new(methods as f64);
    bar.say("looking ahead  ".into());
    let horizon = look_ahead(&scene, options.until, 1.0, &bar)?.ok_or_else(stopped)?;
    check_motion(&scene, &horizon)?;
    let until = horizon.until;
    bar.say("reference  ".into());
    let precision = match options.error {
        Some(error) => Precision {
            metric,
            uncertainty: error / MARGIN.1,
            max_work: f64::INFINITY,
        },
        None => precision(&scene, horizon.motion),
    };
    let reference = reference(&scene, Frames::new(until), scope, precision)?.ok_or_else(stopped)?;
    check_contact(metric, metric.of(&reference.still), until)?;
    let (found, goal) = match (options.error, options.budget) {
        (Some(error), _) => (
            cheapest(&scene, &reference, (metric, error), options.work, &bar)?
                .ok_or_else(stopped)?,
            format!("an error of {error:e} {} ({})", unit(metric), words(scope)),
        ),
        (None, Some(budget)) => (
            within(&scene, &reference, metric, budget, &bar)?.ok_or_else(stopped)?,
            format!("{budget} ms per frame"),
        ),
        (None, None) => return Err(Failure::usage("give --error or --budget")),
    };
    let Some((best, _)) = found.first() else {
        let what = if options.error.is_some() {
            format!(
                "no solver meets {goal} on {}: ask for a larger error",
                scene.name
            )
        } else {
            format!(
                "within {goal}, no solver's error on {} is smaller than the motion: ask for a larger budget",
                scene.name
            )
        };
        return Err(Failure::run(what));
    };
    let floor = metric.of(&reference.floor);
    let note = if options.error.is_some() {
        set_by(best)
    } else if metric.of(&best.outcome.errors) < MARGIN.1 * floor {
        let unit = unit(metric);
        format!(
            "the reference, known to {floor:.0e} {unit}, is the limit, not the budget: finer runs were not tried\n"
        )
    } else {
        String::new()
    };
    let table = report(&options.what, &scene, until, &goal, (metric, &found));
    output::say(&(table + &note))?;
    output::say(&format!(
        "run it:  {}\n",
        command(&options.what, best.method, best.control, until)
    ))
}

/// The cheapest methods for an error, with the computing times of their frames (ms). `None` if it
/// was interrupted.
fn cheapest(
    scene: &Scene,
    reference: &Reference,
    (metric, error): (Metric, f64),
    work: WorkMeasure,
    bar: &Bar,
) -> Result<Option<Vec<(Candidate, f64)>>, Failure> {
    let (floor, still) = (metric.of(&reference.floor), metric.of(&reference.still));
    let (unit, until) = (unit(metric), reference.frames.until);
    if error < MARGIN.0 * floor {
        return Err(Failure::usage(format!(
            "the reference of this scene over {until} s is itself known to {floor:.0e} {unit} only: ask for an error \
             of at least {:.0e}",
            MARGIN.0 * floor
        )));
    }
    if metric == Metric::Position && error > still {
        bar.warn(&format!(
            "warning: nothing moves further than {still:.0e} m in {until} s: an error of {error:e} m says nothing"
        ));
    }
    bar.start();
    let mut begun = 0;
    let begin = |method: &'static Method| {
        bar.say(format!("{:<10} ", method.name));
        bar.advance(f64::from(u8::from(begun > 0)));
        begun += 1;
    };
    let found = choose(scene, reference, metric, error, &interrupt::go_on, begin);
    bar.clear();
    let Some(mut found) = found.map_err(Failure::run)? else {
        return Ok(None);
    };
    let by_time = work == WorkMeasure::Time;
    if !by_time {
        found.truncate(SHOWN);
    }
    let timed = found.into_iter().map(|candidate| {
        let cost = milliseconds(scene, &candidate, reference)?;
        Ok(cost.map(|cost| (candidate, cost)))
    });
    let mut timed = timed.collect::<Result<Option<Vec<_>>, Failure>>()?;
    if let Some(timed) = timed.as_mut().filter(|_| by_time) {
        timed.sort_by(|(_, a), (_, b)| a.total_cmp(b));
        timed.truncate(SHOWN);
    }
    Ok(timed)
}

/// Sentence on what keeps the best candidate's step or tolerance from being larger.
fn set_by(best: &Candidate) -> String {
    let what = if best.control.step().is_some() {
        "step"
    } else {
        "tolerance"
    };
    match best.set_by {
        SetBy::Accuracy => format!("accuracy sets the {what}: a larger one misses the error\n"),
        SetBy::Stability => format!("stability sets the {what}: the run grows with a larger one\n"),
        SetBy::Nothing => format!("nothing sets the {what}: no larger one was tried\n"),
    }
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
        None,
    )?;
    Ok(time.map(|time| 1e3 * time.as_secs_f64() * FRAME / reference.frames.until))
}

/// The three most accurate methods, each at its most accurate step or tolerance whose frames take
/// no longer than the budget (ms). `None` if it was interrupted.
fn within(
    scene: &Scene,
    reference: &Reference,
    metric: Metric,
    budget: f64,
    bar: &Bar,
) -> Result<Option<Vec<(Candidate, f64)>>, Failure> {
    let mut found = vec![];
    let modes = spectrum(scene.model.system(), 0.0, &scene.state);
    let error = |c: &Candidate| metric.of(&c.outcome.errors);
    let conserved = matches!(metric, Metric::Energy | Metric::Momentum | Metric::Phase);
    let most = if conserved {
        f64::INFINITY
    } else {
        metric.of(&reference.still)
    };
    bar.start();
    for method in methods(scene, &[])? {
        bar.say(format!("{:<10} ", method.name));
        let mut best: Option<(Candidate, f64)> = None;
        for control in ladder(&modes, method, &reference.frames, 1_000_000).map_err(Failure::run)? {
            let outcome = measure(scene, method, control, reference, &interrupt::go_on)
                .map_err(Failure::run)?;
            let Some(outcome) = outcome else {
                return Ok(None);
            };
            let candidate = Candidate {
                method,
                control,
                outcome,
                set_by: SetBy::Accuracy,
            };
            let Some(cost) = milliseconds(scene, &candidate, reference)? else {
                return Ok(None);
            };
            if cost > budget {
                break;
            }
            // An error larger than the motion says nothing.
            if outcome.lost.is_none()
                && error(&candidate) < most
                && best
                    .as_ref()
                    .is_none_or(|(best, _)| error(&candidate) < error(best))
            {
                best = Some((candidate, cost));
            }
            if error(&candidate) < MARGIN.1 * metric.of(&reference.floor) {
                break;
            }
        }
        found.extend(best);
        bar.advance(1.0);
    }
    bar.clear();
    found.sort_by(|(a, _), (b, _)| error(a).total_cmp(&error(b)));
    found.truncate(SHOWN);
    Ok(Some(found))
}

/// The table of candidates and their costs (ms).
fn report(
    what: &What,
    scene: &Scene,
    until: f64,
    goal: &str,
    (metric, found): (Metric, &[(Candidate, f64)]),
) -> String {
    let error = format!(" error ({})", unit(metric));
    let mut rows = vec![
        [
            "",
            "solver",
            " setting",
            &*error,
            " evaluations/s",
            " time/frame",
        ]
        .map(String::from)
        .to_vec(),
    ];
    for (k, (c, cost)) in found.iter().enumerate() {
        rows.push(vec![
            ["best", "runner-up", "then"][k.min(2)].into(),
            c.method.title.into(),
            match c.control {
                Control::Step(_) => format!("step {} s", typed(c.control, until)),
                Control::Tolerance(_) => format!("tolerance {}", typed(c.control, until)),
            },
            format!("{:.1e}", metric.of(&c.outcome.errors)),
            format!("{:.0}", c.outcome.work.total() / until),
            if *cost < 0.1 {
                format!("{:.2} µs", 1e3 * cost)
            } else {
                format!("{cost:.2} ms")
            },
        ]);
    }
    format!(
        "{} for {until} s, {goal}:\n{}",
        describe(what, scene),
        list::table(&rows)
    )
}

/// A step or a tolerance as it would be typed: a step of a run of `until` (s) exactly, as a
/// fraction if a few digits do not tell it; a tolerance to four digits, rounded down, so that the
/// run is no coarser.
fn typed(control: Control, until: f64) -> String {
    let value = control.value();
    if let Control::Step(step) = control {
        let short = format!("{step}");
        if short.len() <= 6 {
            return short;
        }
        let count = (until / step).round();
        return fraction(step, until).unwrap_or_else(|| format!("{until}/{count}"));
    }
    let power = 10f64.powi(3 - value.log10().floor() as i32);
    let rounded = (value * power * (1.0 + 1e-12)).floor() / power;
    if rounded < 1e-3 {
        format!("{rounded:e}")
    } else {
        format!("{rounded}")
    }
}

/// The command line that runs the scene with a method at a step or a tolerance.
fn command(what: &What, method: &Method, control: Control, until: f64) -> String {
    let mut words = format!("a3 {} {}", method.letter, typed(control, until));
    if what.scene.typed != "cloth" {
        let _ = write!(words, " --scene {}", what.scene.typed);
    }
    if let Some(grid) = what.grid {
        let _ = write!(words, " --grid {}x{}", grid.rows(), grid.cols());
    }
    for (on, option) in [
        (what.wind, " --wind"),
        (what.swing, " --swing"),
        (what.self_collision, " --self-collision"),
    ] {
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
            (1.0 / 60.0, "1/60"),
            (0.01, "0.01"),
            (3.0 / 291.0, "1/97"),
            (3.0 / 292.0, "3/292"),
            (3.0 / 4.5, "2/3"),
            (0.5, "0.5"),
        ] {
            assert_eq!(typed(Control::Step(value), 3.0), expected);
        }
        assert_eq!(typed(Control::Step(0.3 / 37.0), 0.3), "0.3/37");
        assert_eq!(typed(Control::Tolerance(1.7783e-5), 3.0), "1.778e-5");
        assert_eq!(typed(Control::Tolerance(0.1), 3.0), "0.1");
    }
}
