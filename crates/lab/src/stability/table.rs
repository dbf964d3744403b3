//! The limits of all methods: as a table, in milliseconds, and as JSON, in seconds.

use std::fmt::Write;

use a3_core::stability::{Limit, Mode, Observation};
use a3_files::failure::Failure;
use a3_files::report::{Report, headings, table};
use serde::Serialize;

use super::measure::{MethodLimits, Stability};
use crate::chart::table::short;

/// Writes a step (s) in ms, to three digits.
pub fn step(seconds: f64) -> String {
    let ms = 1e3 * seconds;
    match ms {
        _ if ms.is_infinite() => "any".into(),
        0.0 => "0".into(),
        _ if ms < 0.009_95 => format!("{ms:.1e}"),
        _ if ms < 0.999_5 => format!("{ms:.3}"),
        _ => short(ms),
    }
}

/// Writes the largest step at which no mode grows (ms).
fn bounded(limit: Option<Limit>) -> String {
    match limit {
        None => "-".into(),
        Some(limit) if limit.bounded == 0.0 => "none".into(),
        Some(limit) => step(limit.bounded),
    }
}

/// Writes an observed limit (ms): a step, or the interval in which some steps hold and some fail.
pub fn observation(seen: Option<Observation>) -> String {
    seen.map_or("-".into(), |seen| {
        if seen.is_open() {
            return format!(">{}", step(seen.held));
        }
        match seen.interval().map(step) {
            [low, high] if is_interval(&seen) && low != high => format!("{low}\u{2013}{high}"),
            _ => step(seen.held),
        }
    })
}

/// Creates the table of all limits, below the fastest motion and above the meaning of the columns.
pub fn report(found: &Stability) -> Report {
    let rows = &found.limits;
    let mut cells = headings("solver| at rest| tenfold| observed| moving| accurate");
    for row in rows {
        cells.push(vec![
            row.method.name.to_owned(),
            bounded(row.rest),
            row.rest.map_or("-".into(), |limit| step(limit.step)),
            observation(row.seen_at_rest),
            observation(row.bounded),
            row.accurate.map_or("-".into(), step),
        ]);
    }
    let motion = |modes: &[Mode]| {
        found.fastest(modes).map(|mode| {
            let (frequency, damping) = (mode.frequency(), mode.damping_ratio());
            format!("{frequency:.1} rad/s, damping ratio {damping:.3}")
        })
    };
    let start = match motion(&found.at_start) {
        Some(motion) => format!("fastest motion {motion}"),
        None if found.at_start.is_empty() => "no motion known".into(),
        None => "no motion back and forth".into(),
    };
    let mut head = format!("{}: {start} at the start", found.name);
    if let Some(rest) = &found.at_rest {
        let rest = motion(rest).unwrap_or("none".into());
        let below = " ".repeat(found.name.chars().count() + 2);
        let _ = write!(head, ",\n{below}{rest} at rest");
    }
    if let Some(rate) = found.feedback {
        let _ = write!(head, "; errors of constraints decay at {rate:.1} / s");
    }
    head += "\n\nlargest step (ms), that of the fixed step for adaptive solvers\n";
    let predictable = format!(
        "errors stay below a hundredth of the motion in the first {:.2} s",
        found.predictable
    );
    let mut meanings = vec![
        ("at rest", "nothing grows without end, by all modes"),
        (
            "tenfold",
            "a disturbance at rest grows tenfold in 10 s, or in 1000 steps if that is longer",
        ),
        ("observed", "the same, as runs show"),
        ("moving", "nothing grows without end, as runs show"),
        ("accurate", &predictable),
    ];
    if any_observed(rows, is_interval) {
        meanings.push(("a\u{2013}b", INTERVAL));
    }
    if any_observed(rows, Observation::is_open) {
        meanings.push((">", "no longer step was tried"));
    }
    let short = rows.iter().filter(|row| row.is_short);
    let names: Vec<_> = short.map(|row| row.method.name).collect();
    let why = format!(
        "the runs were shorter than 10 s, or too few to tell more, because they take long: {}",
        names.join(", ")
    );
    if !names.is_empty() {
        meanings.push(("short", &why));
    }
    let meanings = meanings.iter().map(|(word, meaning)| vec![(*word).into(), (*meaning).into()]);
    let foot = table(&meanings.collect::<Vec<_>>());
    Report { head, rows: cells, foot }
}

/// Creates the table of the largest stable step of each method with its reason, and of the largest
/// accurate one.
pub fn reasons(found: &Stability) -> Report {
    let mut rows = headings("solver| stable| accurate|with longer steps");
    let modes = found.at_rest.as_deref().unwrap_or(&found.at_start);
    for row in &found.limits {
        let (stable, why) = reason(row, modes);
        rows.push(vec![row.method.name.into(), stable, row.accurate.map_or("-".into(), step), why]);
    }
    let Report { head, .. } = report(found);
    let head = head.split("\n\n").next().unwrap_or_default();
    Report {
        head: format!("{head}\n\nlargest steps (ms), fixed ones also for adaptive solvers\n"),
        rows,
        foot: format!(
            "stable: nothing grows without end; accurate: errors stay below a hundredth of the motion in the first {:.2} s\n",
            found.predictable
        ),
    }
}

/// Returns the largest stable step of a method (ms), and what happens beyond it. `modes` are those
/// by which its limit at rest was computed.
fn reason(row: &MethodLimits, modes: &[Mode]) -> (String, String) {
    let at_rest = row.rest.map_or(f64::INFINITY, |limit| limit.step);
    let moving = row.bounded.filter(|seen| seen.held < at_rest);
    if let Some(seen) = moving {
        let why = if seen.is_open() { "none was tried" } else { "it blows up in motion" };
        return (observation(row.bounded), why.into());
    }
    let Some(limit) = row.rest else {
        return ("-".into(), "it was not measured".into());
    };
    let mode = modes.get(limit.mode).filter(|_| at_rest.is_finite());
    let why = mode.map_or("nothing grows".into(), |mode| {
        let (frequency, damping) = (mode.frequency(), mode.drag + mode.damping);
        if damping > 2.0 * frequency {
            format!("damping of {damping:.0} / s grows at rest")
        } else {
            format!("{frequency:.0} rad/s grows at rest")
        }
    });
    (step(at_rest), why)
}

/// Meaning of an interval where the table shows one instead of a limit.
pub const INTERVAL: &str = "not sharp: the shortest step that failed in trials down to half of it, and the longest that held; holding steps lie between failing ones";

/// Returns whether any observed limit is of this kind.
pub fn any_observed(rows: &[MethodLimits], is: fn(&Observation) -> bool) -> bool {
    let observed = rows.iter().flat_map(|row| [row.seen_at_rest, row.bounded]);
    observed.flatten().any(|seen| is(&seen))
}

/// Returns whether a limit is not sharp, and so shown as an interval.
pub fn is_interval(seen: &Observation) -> bool {
    !seen.is_open() && !seen.is_sharp()
}

/// Limits of a method (s), as the object of a line. Null stands for a limit that is not known.
#[derive(Serialize)]
struct Row {
    solver: &'static str,
    /// Largest step at which no mode at rest grows.
    rest_bounded: Option<Step>,
    /// Step at which a mode at rest grows tenfold in the time that the table names.
    rest_tenfold: Option<Step>,
    /// The same, as runs have shown.
    rest_observed: Option<Observed>,
    /// Largest step with which runs from the start stay bounded.
    moving_bounded: Option<Observed>,
    /// Largest step of an accurate run.
    moving_accurate: Option<f64>,
    /// Whether the work limit made runs shorter or fewer than usual.
    short: bool,
}

/// Limit computed from the modes (s).
#[derive(Serialize)]
#[serde(untagged)]
enum Step {
    Seconds(f64),
    /// The word "any": every step is stable.
    Any(&'static str),
}

/// Limit observed in runs (s).
#[derive(Serialize)]
struct Observed {
    /// Longest step that held.
    longest_held: f64,
    /// Shortest step that failed; null if none did.
    shortest_failed: Option<f64>,
    /// Whether the shortest step that failed is just above the longest that held.
    sharp: bool,
}

/// Writes the limits as a JSON array of objects, one a line.
pub fn json(rows: &[MethodLimits]) -> Result<String, Failure> {
    let row = |row: &MethodLimits| {
        serde_json::to_string(&Row {
            solver: row.method.name,
            rest_bounded: row.rest.map(|limit| step_of(limit.bounded)),
            rest_tenfold: row.rest.map(|limit| step_of(limit.step)),
            rest_observed: row.seen_at_rest.map(observed),
            moving_bounded: row.bounded.map(observed),
            moving_accurate: row.accurate,
            short: row.is_short,
        })
    };
    let lines: Result<Vec<_>, _> = rows.iter().map(row).collect();
    let lines = lines.map_err(|e| Failure::run(e.to_string()))?;
    Ok(format!("[\n{}\n]\n", lines.join(",\n")))
}

/// Converts a limit by the modes (s), which is infinite if every step is stable.
fn step_of(seconds: f64) -> Step {
    if seconds.is_finite() { Step::Seconds(seconds) } else { Step::Any("any") }
}

/// Converts an observed limit.
fn observed(seen: Observation) -> Observed {
    Observed {
        longest_held: seen.held,
        shortest_failed: (!seen.is_open()).then_some(seen.failed),
        sharp: seen.is_sharp(),
    }
}
