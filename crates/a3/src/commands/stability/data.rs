//! The limits of all methods as JSON, in seconds.

use a3_core::stability::Observation;
use serde::Serialize;

use super::limits::MethodLimits;
use crate::base::failure::Failure;

/// Limits of a method (s). Null stands for a limit that is not known.
#[derive(Serialize)]
struct Row {
    solver: &'static str,
    rest_bounded: Option<Step>,
    rest_tenfold: Option<Step>,
    rest_observed: Option<Observed>,
    moving_bounded: Option<Observed>,
    moving_accurate: Option<f64>,
    /// Whether runs were shorter or fewer than they should be.
    short: bool,
}

/// A limit by the modes (s).
#[derive(Serialize)]
#[serde(untagged)]
enum Step {
    Seconds(f64),
    /// "any": every step is stable.
    Any(&'static str),
}

/// A limit that runs have shown (s).
#[derive(Serialize)]
struct Observed {
    longest_held: f64,
    /// Null where no step failed.
    shortest_failed: Option<f64>,
    sharp: bool,
}

/// The limits as a JSON array of objects, one a line.
pub fn json(rows: &[MethodLimits]) -> Result<String, Failure> {
    let row = |row: &MethodLimits| {
        serde_json::to_string(&Row {
            solver: row.method.name,
            rest_bounded: row.rest.map(|limit| step(limit.bounded)),
            rest_tenfold: row.rest.map(|limit| step(limit.step)),
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

fn step(seconds: f64) -> Step {
    if seconds.is_finite() {
        Step::Seconds(seconds)
    } else {
        Step::Any("any")
    }
}

fn observed(seen: Observation) -> Observed {
    Observed {
        longest_held: seen.held,
        shortest_failed: (!seen.is_open()).then_some(seen.failed),
        sharp: seen.is_sharp(),
    }
}
