//! The limits of all methods as JSON, in seconds.

use a3_core::stability::Observation;
use a3_files::failure::Failure;
use serde::Serialize;

use super::measure::MethodLimits;

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

/// Converts a limit by the modes (s), which is infinite if every step is stable.
fn step(seconds: f64) -> Step {
    if seconds.is_finite() {
        Step::Seconds(seconds)
    } else {
        Step::Any("any")
    }
}

/// Converts an observed limit.
fn observed(seen: Observation) -> Observed {
    Observed {
        longest_held: seen.held,
        shortest_failed: (!seen.is_open()).then_some(seen.failed),
        sharp: seen.is_sharp(),
    }
}
