//! Judgements in words.

use super::judgement::{Drift, Judgement};
use super::search::Agreement;
use super::start::Difference;
use super::trial::Start;

/// Number of times whose errors are printed.
const TIMES: usize = 5;
/// Largest number of methods that are named beside the one that a file agrees with.
const MAX_OTHERS: usize = 3;
/// Least error that a reference can tell from 0, over its own.
const RESOLVED: f64 = 10.0;

/// The judgement of a file in lines, under its name.
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
        line(
            "momentum",
            format!("off by {worst:.1e} kg m/s at worst, at {} s", short(time)),
        );
    }
    for (key, text) in method(judgement) {
        line(key, text);
    }
    if let Some(within) = within {
        line(
            "within",
            match is_within(judgement, within) {
                true => format!("yes: {:.1e} m of {within:e} m", judgement.worst.error),
                false => format!("no: {}", too_large(judgement, within)),
            },
        );
    }
    lines.join("\n") + "\n"
}

/// Whether all states of a file err by at most `within` (m).
pub fn is_within(judgement: &Judgement, within: f64) -> bool {
    judgement.worst.error <= within && judgement.not_finite_at.is_none()
}

/// Says by how much a file misses `within` (m).
pub fn too_large(judgement: &Judgement, within: f64) -> String {
    match judgement.not_finite_at {
        Some(t) if judgement.worst.error <= within => {
            format!("its numbers are not finite from {} s on", short(t))
        }
        _ => format!(
            "it errs by {:.1e} m at worst, more than {within:e} m",
            judgement.worst.error
        ),
    }
}

/// The order of a program between runs with other steps: name, step (s) and error (m) of each.
pub fn orders(runs: &[(String, f64, f64)]) -> String {
    let mut runs = runs.to_vec();
    runs.sort_by(|a, b| b.1.total_cmp(&a.1));
    let pairs = runs.windows(2).filter(|pair| pair[0].1 > pair[1].1 * 1.001);
    let line = |pair: &[(String, f64, f64)]| {
        let [(a, long, coarse), (b, short_step, fine)] = pair else {
            return String::new();
        };
        let order = (coarse / fine).ln() / (long / short_step).ln();
        format!(
            "order {order:.2} from {a} ({} s) to {b} ({} s)\n",
            short(*long),
            short(*short_step)
        )
    };
    pairs.map(line).collect()
}

/// Whether an error is large enough to tell an order by.
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
    let until = short(judgement.until);
    let mut text = format!("{judged} states to {until} s, {kind}");
    if judged < states {
        text += &format!("; {} later ones are not judged", states - judged);
    }
    if let Some(t) = judgement.not_finite_at {
        text += &format!("; its numbers are not finite from {} s on", short(t));
    }
    text
}

/// Says how a first state differs from the start of the scene.
pub fn difference(start: &Difference) -> String {
    match start {
        Difference::Later(t) => {
            format!("its first state is at {} s, so that of the scene is not compared", short(*t))
        }
        Difference::Order => {
            "its particles are those of the scene in another order: a3 scenes --print NAME --list tells theirs".into()
        }
        Difference::Unit(unit) => format!("its positions are in {unit}: they must be in m"),
        Difference::Axes => "y and z are exchanged: in a3, y is up".into(),
        Difference::Positions(count, (i, far)) => format!(
            "{count} particles do not start where the scene does: particle {i} is {far:.1e} m away"
        ),
        Difference::Velocities(i, far) => format!(
            "the velocities are not those of the scene: that of particle {i} differs by {far:.1e} m/s"
        ),
    }
}

fn error(judgement: &Judgement) -> String {
    let worst = judgement.worst;
    let mut text = format!("{:.1e} m at worst, at {} s", worst.error, short(worst.time));
    if !is_resolved(judgement) {
        text += &format!(
            ": no more than the reference can tell, which is known to {:.0e} m",
            judgement.floor
        );
    } else if worst.distance > worst.error * 1.001 {
        text += &format!(
            "; particle {} is farthest, {:.1e} m from its place",
            worst.particle, worst.distance
        );
    }
    text
}

fn in_time(judgement: &Judgement) -> String {
    let last = judgement.errors.len() - 1;
    let at = |k: usize| {
        let (time, error) = judgement.errors[k * last / TIMES];
        format!("{error:.1e} m at {} s", short(time))
    };
    (1..=TIMES).map(at).collect::<Vec<_>>().join(", ")
}

fn energy_words(Drift { worst, time, end }: Drift, kinetic: f64) -> String {
    let mut text = format!(
        "off by {worst:.1e} J at worst, at {} s; {end:+.1e} J at the end",
        short(time)
    );
    if kinetic > 0.0 {
        text += &format!(
            ", {:.1e} of the largest kinetic energy",
            end.abs() / kinetic
        );
    }
    text
}

/// Says which method a file agrees with, in lines with their keys.
fn method(judgement: &Judgement) -> Vec<(&'static str, String)> {
    let found = &judgement.found;
    let [longest, shortest] = found.steps.map(short);
    let Some(agreement) = &found.found else {
        if !judgement.was_searched {
            let why = "its times are no multiples of a step: --step H compares it with all solvers";
            return vec![("method", why.into())];
        }
        let steps = if longest == shortest {
            format!("a step of {longest} s")
        } else {
            format!("steps of {longest} to {shortest} s")
        };
        let mut lines = vec![("method", format!("agrees with none at {steps}"))];
        if let Some(nearest) = &found.nearest {
            let Agreement { compared, .. } = nearest;
            lines.push((
                "nearest",
                format!(
                    "{}, {:.1e} m away at worst",
                    way(nearest),
                    compared.distance
                ),
            ));
        }
        if let Some(suspect) = &found.suspect {
            let away = suspect.compared.distance;
            lines.push((
                "suspect",
                format!("{}, only {away:.1e} m away", way(suspect)),
            ));
            lines.extend(question(suspect).map(|question| ("question", question)));
        }
        return lines;
    };
    let mut text = format!(
        "agrees with {} to {:.0e} m",
        way(agreement),
        agreement.compared.distance
    );
    if let Some(until) = agreement.until {
        text += &format!(" until {} s, and then with none", short(until));
    }
    let mut lines = vec![("method", text)];
    if let [first, ..] = &found.also[..] {
        let others: Vec<_> = found
            .also
            .iter()
            .take(MAX_OTHERS)
            .map(|other| other.trial.way.title())
            .collect();
        let more = found.also.len() - others.len();
        let more = if more > 0 {
            format!(" and {more} more")
        } else {
            String::new()
        };
        let same = if first.step == agreement.step {
            ""
        } else {
            " at other steps"
        };
        lines.push(("also", format!("with {}{more}{same}", others.join(", "))));
    }
    lines.extend(question(agreement).map(|question| ("question", question)));
    if let Some(apart) = agreement.compared.velocities {
        let speed = agreement.compared.moved / judgement.until;
        if apart > 1e-6 * speed
            && agreement.until.is_none()
            && agreement.compared.distance < 1e-3 * apart * agreement.step
        {
            lines.push((
                "velocity",
                format!("differs from that method's by up to {apart:.1e} m/s"),
            ));
        }
    }
    lines
}

/// A method with its step and its mistake.
fn way(agreement: &Agreement) -> String {
    let trial = agreement.trial;
    let mut text = format!("{} at {} s", trial.way.title(), short(agreement.step));
    if let Some(mistake) = trial.way.mistake() {
        text += &format!(", but with {},", mistake.words());
    }
    match trial.start {
        Start::Scene => {}
        Start::Row(0) => text += ", from its own first state on,",
        Start::Row(_) => text += ", but for the first step,",
        Start::Ahead => text += ", but a step later in each row,",
        Start::Behind => text += ", but a step earlier in each row,",
    }
    text
}

/// Question to the author of a program that agrees so.
fn question(agreement: &Agreement) -> Option<String> {
    let of_start = match agreement.trial.start {
        Start::Scene | Start::Row(0) => None,
        Start::Row(_) => Some(
            "does the first step take a force, a position or a velocity from before the start?",
        ),
        Start::Ahead => Some("is the first row written after the first step?"),
        Start::Behind => Some("is the start written twice?"),
    };
    agreement.trial.way.question().or(of_start).map(Into::into)
}

/// A number with few digits.
fn short(value: f64) -> f64 {
    crate::base::rounding::short(value, 6)
}
