//! Errors of files in words.

use std::fmt::Write;

use super::finding::lines_of;
use super::judgement::{Drift, Judgement};
use super::quantity::{amount, seconds};
use super::rows::Difference;

/// Number of times whose errors are printed.
const TIMES: usize = 5;
/// Least error that a reference can tell from 0, over its own.
const RESOLVED: f64 = 10.0;
/// Order below which errors do not fall with the step.
const MIN_ORDER: f64 = 0.5;

/// Returns the judgement of a file in lines, under its name.
pub fn text(name: &str, judgement: &Judgement, within: Option<f64>) -> String {
    let mut lines = vec![format!("{name}: {}", states(judgement))];
    let mut line = |key: &str, text: String| lines.push(format!("  {key:<9} {text}"));
    if let Some(start) = &judgement.start {
        line("start", difference(start));
    }
    line("error", error(judgement));
    if judgement.errors.len() > TIMES {
        line("in time", in_time(judgement));
    }
    if let Some(energy) = judgement.energy {
        line("energy", energy_words(energy, judgement.kinetic));
    }
    if let Some(Drift { worst, time, .. }) = judgement.momentum {
        let (worst, time) = (amount(worst), seconds(time));
        line(
            "momentum",
            format!("off by {worst} kg m/s at worst, at {time}"),
        );
    }
    for (key, text) in lines_of(judgement) {
        line(key, text);
    }
    if let Some(within) = within {
        let error = amount(judgement.worst.error);
        line(
            "within",
            if is_within(judgement, within) {
                format!("yes: {error} m of {within} m")
            } else {
                format!("no: {}", too_large(judgement, within))
            },
        );
    }
    lines.join("\n") + "\n"
}

/// Returns whether all states of a file err by at most `within` (m).
pub fn is_within(judgement: &Judgement, within: f64) -> bool {
    judgement.worst.error <= within && judgement.not_finite_at.is_none()
}

/// Says by how much a file misses `within` (m).
pub fn too_large(judgement: &Judgement, within: f64) -> String {
    let error = judgement.worst.error;
    match judgement.not_finite_at {
        Some(t) if error <= within => {
            format!("its numbers are not finite from {} on", seconds(t))
        }
        _ => format!(
            "it errs by {} m at worst, more than {within} m",
            amount(error)
        ),
    }
}

/// Returns the order of a program between runs with other steps: name, step (s) and error (m) of
/// each.
pub fn orders(runs: &[(&str, f64, f64)]) -> String {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| b.1.total_cmp(&a.1));
    let line = |pair: &[(&str, f64, f64)]| {
        let &[(a, long, coarse), (b, brief, fine)] = pair else {
            return None;
        };
        let order = (coarse / fine).ln() / (long / brief).ln();
        let why = if order < MIN_ORDER {
            ": the error does not fall with the step, so it is not that of the method"
        } else {
            ""
        };
        let steps = format!("{a} ({}) to {b} ({})", seconds(long), seconds(brief));
        (long > 1.001 * brief).then(|| format!("order {order:.2} from {steps}{why}\n"))
    };
    runs.windows(2).filter_map(line).collect()
}

/// Returns whether an error is large enough to tell an order by.
pub fn is_resolved(judgement: &Judgement) -> bool {
    judgement.worst.error > RESOLVED * judgement.floor
}

fn states(judgement: &Judgement) -> String {
    let Judgement { states, judged, .. } = judgement;
    let kind = if judgement.has_velocities {
        "with velocities"
    } else {
        "positions only"
    };
    let mut text = format!("{judged} states to {}, {kind}", seconds(judgement.until));
    if judgement.every > 1 {
        _ = write!(text, "; one of {} is compared", judgement.every);
    }
    if judged < states {
        _ = write!(text, "; {} later ones are not judged", states - judged);
    }
    if let Some(t) = judgement.not_finite_at {
        _ = write!(text, "; its numbers are not finite from {} on", seconds(t));
    }
    text
}

/// Says how a first state differs from the start of the scene.
pub fn difference(start: &Difference) -> String {
    match start {
        Difference::Later(t) => {
            format!("its first state is at {}: that of the scene is at 0 s", seconds(*t))
        }
        Difference::Order => {
            "its particles are those of the scene in another order: see a3 scenes --print NAME --list".into()
        }
        Difference::Unit(unit) => format!("its positions are in {unit}: they must be in m"),
        Difference::Axes => "y and z are exchanged: in a3, y is up, and z points to the viewer".into(),
        Difference::Positions(count, (i, far)) => format!(
            "{count} {} not where the scene starts: particle {i} is {} m away",
            if *count == 1 { "particle is" } else { "particles are" },
            amount(*far)
        ),
        Difference::Velocities(i, far) => format!(
            "the velocities are not those of the scene: that of particle {i} differs by {} m/s",
            amount(*far)
        ),
    }
}

fn error(judgement: &Judgement) -> String {
    let worst = judgement.worst;
    let mut text = format!(
        "{} m at worst, at {}",
        amount(worst.error),
        seconds(worst.time)
    );
    if !is_resolved(judgement) {
        let floor = judgement.floor;
        _ = write!(
            text,
            ": as good as exact, for the reference itself is known to {floor:.0e} m"
        );
    } else if worst.distance > worst.error * 1.001 {
        _ = write!(
            text,
            "; particle {} is farthest, {} m from its place",
            worst.particle,
            amount(worst.distance)
        );
    }
    text
}

fn in_time(judgement: &Judgement) -> String {
    let last = judgement.errors.len() - 1;
    let at = |k: usize| {
        let (time, error) = judgement.errors[k * last / TIMES];
        format!("{} m at {}", amount(error), seconds(time))
    };
    (1..=TIMES).map(at).collect::<Vec<_>>().join(", ")
}

fn energy_words(Drift { worst, time, end }: Drift, kinetic: f64) -> String {
    let sign = if end < 0.0 { "too little" } else { "too much" };
    let share = if kinetic > 0.0 {
        let percent = amount(100.0 * end.abs() / kinetic);
        format!(", {percent} % of the largest kinetic energy")
    } else {
        String::new()
    };
    format!(
        "off by {} J at worst, at {}; {} J {sign} at the end{share}",
        amount(worst),
        seconds(time),
        amount(end.abs())
    )
}
