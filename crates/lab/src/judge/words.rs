//! Judgements in words: the errors of files, and the method that each agrees with.

use std::fmt::Write;

use a3_files::rounding::short;

use super::judgement::{Drift, Judgement};
use super::rows::Difference;
use super::search::{Agreement, MIN_APART};
use super::trial::{Start, Trial};

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
        line("momentum", format!("off by {worst} kg m/s at worst, at {time}"));
    }
    for (key, text) in lines_of(judgement) {
        line(key, text);
    }
    if let Some(within) = within {
        let error = amount(judgement.worst.error);
        let met = is_within(judgement, within).then(|| format!("yes: {error} m of {within} m"));
        let missed = || format!("no: {}", too_large(judgement, within));
        line("within", met.unwrap_or_else(missed));
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
        Some(t) if error <= within => format!("its numbers are not finite from {} on", seconds(t)),
        _ => format!("it errs by {} m at worst, more than {within} m", amount(error)),
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
        let why = ": the error does not fall with the step, so it is not that of the method";
        let why = if order < MIN_ORDER { why } else { "" };
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
    let (states, judged, every) = (judgement.states, judgement.judged, judgement.every);
    let kinds = ["positions only", "with velocities"];
    let kind = kinds[usize::from(judgement.has_velocities)];
    let mut text = format!("{judged} states to {}, {kind}", seconds(judgement.until));
    if every > 1 {
        _ = write!(text, "; one of {every} is compared");
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
    let (worst, floor) = (judgement.worst, judgement.floor);
    let (error, time) = (amount(worst.error), seconds(worst.time));
    let more = if !is_resolved(judgement) {
        format!(": as good as exact, for the reference itself is known to {floor:.0e} m")
    } else if worst.distance > worst.error * 1.001 {
        let (i, distance) = (worst.particle, amount(worst.distance));
        format!("; particle {i} is farthest, {distance} m from its place")
    } else {
        String::new()
    };
    format!("{error} m at worst, at {time}{more}")
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
    let percent = amount(100.0 * end.abs() / kinetic);
    let share = format!(", {percent} % of the largest kinetic energy");
    let share = Some(share).filter(|_| kinetic > 0.0).unwrap_or_default();
    let (worst, time, end) = (amount(worst), seconds(time), amount(end.abs()));
    format!("off by {worst} J at worst, at {time}; {end} J {sign} at the end{share}")
}

/// Largest number of methods or mistakes that are named beside the one that a file agrees with.
const MAX_OTHERS: usize = 3;

/// Ratio of the distance that a file moves to that of the reference, above which it explodes.
const FAR: f64 = 10.0;

/// Says which method a file agrees with, in lines with their keys.
pub fn lines_of(judgement: &Judgement) -> Vec<(&'static str, String)> {
    match &judgement.found.found {
        Some(agreement) => found(judgement, agreement),
        None if judgement.was_searched => not_found(judgement),
        None => {
            let why = "its times are no multiples of a step: --step H compares it with all solvers";
            vec![("method", why.into())]
        }
    }
}

fn found(judgement: &Judgement, agreement: &Agreement) -> Vec<(&'static str, String)> {
    let compared = agreement.compared;
    let how = if compared.distance == 0.0 {
        "exactly".into()
    } else if compared.moved > FAR * judgement.motion {
        let share = compared.distance / compared.moved;
        format!("to {share:.0e} of the distance that it moves")
    } else {
        format!("to {:.0e} m", compared.distance)
    };
    let until = agreement.until.map(|t| format!(", until {}", seconds(t)));
    let until = until.unwrap_or_default();
    let mut lines = vec![("method", format!("agrees with {} {how}{until}", way(agreement)))];
    let points = agreement.trial.pace.points;
    if points > 1 {
        let text = format!(
            "1 of {points} is at the end of a step: others lie between steps, and are not compared"
        );
        lines.push(("rows", text));
    }
    lines.extend(others(agreement, &judgement.found.also));
    let mut questions: Vec<_> = vec![];
    let asked = [agreement].into_iter().chain(&judgement.found.also);
    for asked in asked.filter_map(question) {
        if !questions.contains(&asked) && questions.len() < MAX_OTHERS {
            questions.push(asked);
        }
    }
    lines.extend(questions.into_iter().map(|it| ("question", it)));
    if let Some([apart, speed]) = compared.velocities
        && agreement.until.is_none()
        && apart > MIN_APART * speed
    {
        let apart = amount(apart);
        let text = format!(
            "differs from that of the method by up to {apart} m/s: is it of the same time?"
        );
        lines.push(("velocity", text));
    }
    lines
}

/// Names others with which a file agrees as well: other mistakes, or other methods.
fn others(agreement: &Agreement, also: &[Agreement]) -> Option<(&'static str, String)> {
    let own = agreement.trial;
    let mut names: Vec<_> = vec![];
    for other in also.iter().map(|other| other.trial) {
        let name = match (own.way.mistake(), other.way.mistake()) {
            (Some(mistake), Some(other)) if mistake.words()[0] == other.words()[0] => continue,
            (Some(_), Some(other)) => format!("with {}", other.words()[0]),
            _ if other.way.title() != own.way.title() => other.way.title().to_owned(),
            _ => format!("the same{}", slips(&other)),
        };
        let is_same = other.way.title() == own.way.title() && slips(&other) == slips(&own);
        if !names.contains(&name) && !is_same {
            names.push(name);
        }
    }
    let more = names.len().saturating_sub(MAX_OTHERS);
    names.truncate(MAX_OTHERS);
    let more = (more > 0).then(|| format!(" and {more} more"));
    let (names, more) = (names.join("; "), more.unwrap_or_default());
    let text = format!("{names}{more}: which cannot be told apart here");
    (!names.is_empty()).then_some(("or", text))
}

fn not_found(judgement: &Judgement) -> Vec<(&'static str, String)> {
    let found = &judgement.found;
    let [longest, shortest] = found.steps;
    let steps = if longest == shortest {
        format!("a step of {}", seconds(longest))
    } else {
        format!("steps from {} to {}", seconds(longest), seconds(shortest))
    };
    let known = [": if its step is another, add --step", ""];
    let known = known[usize::from(judgement.has_known_step)];
    let mut lines = vec![("method", format!("agrees with no solver at {steps}{known}"))];
    let mut near = |key, near: &Agreement, only| {
        let away = amount(near.compared.distance);
        lines.push((key, format!("{} is {only}{away} m away at worst", way(near))));
    };
    if let Some(nearest) = &found.nearest {
        near("nearest", nearest, "");
    }
    if let Some(suspect) = &found.suspect {
        near("suspect", suspect, "only ");
        lines.extend(question(suspect).map(|question| ("question", question)));
    }
    lines
}

/// Returns a method with its step and its mistake.
fn way(agreement: &Agreement) -> String {
    let title = agreement.trial.way.title();
    // Methods that are called after people have no article.
    let middle = ["explicit trapezoid", "explicit midpoint", "implicit midpoint"];
    let has_article = middle.iter().any(|begin| title.starts_with(begin));
    let article = if has_article { "the " } else { "" };
    let precision = ["", " in single precision"][usize::from(agreement.is_single)];
    let slips = slips(&agreement.trial);
    let end = if slips.is_empty() { "" } else { "," };
    let step = seconds(agreement.step);
    format!("{article}{title} at {step}{precision}{slips}{end}")
}

/// Returns the differences from the method: a slip or a mistake, and the row at which the
/// comparison begins.
fn slips(trial: &Trial) -> String {
    let [slip, _] = trial.way.slip();
    let slip = slip.map(|slip| format!(", but with {slip}"));
    slip.unwrap_or_default() + since(trial.start)
}

/// Returns the slips of an agreement in words, if it has some.
pub fn mistake(agreement: &Agreement) -> Option<String> {
    let slips = slips(&agreement.trial);
    let words = [", ", "but ", "with "];
    let words = words.iter().fold(&*slips, |rest, word| rest.trim_start_matches(word));
    (!words.is_empty()).then(|| words.into())
}

/// Returns where the agreement begins.
fn since(start: Start) -> &'static str {
    match start {
        Start::Scene => "",
        Start::Row(0) => ", from its own first state on",
        Start::Row(_) => ", but for the first step",
        Start::Ahead => ", but a step later in each row",
        Start::Behind => ", but a step earlier in each row",
    }
}

/// Returns the question to the author of a program that agrees so.
pub fn question(agreement: &Agreement) -> Option<String> {
    let of_start = match agreement.trial.start {
        Start::Scene | Start::Row(0) => None,
        Start::Row(_) => Some("is a force, a position or a velocity of the first step an old one?"),
        Start::Ahead => Some("is the first row written after the first step?"),
        Start::Behind => Some("is the start written twice?"),
    };
    let [_, of_way] = agreement.trial.way.slip();
    of_way.or(of_start.map(String::from))
}

/// Returns a quantity with two digits, in plain decimals where these are few.
pub fn amount(value: f64) -> String {
    if value == 0.0 || (0.01..1000.0).contains(&value.abs()) {
        short(value, 2).to_string()
    } else {
        format!("{value:.1e}")
    }
}

/// Returns a time in seconds, with few digits.
pub fn seconds(time: f64) -> String {
    let time = short(time, 6);
    if (1e-3..1e6).contains(&time) || time == 0.0 {
        format!("{time} s")
    } else {
        format!("{time:e} s")
    }
}
