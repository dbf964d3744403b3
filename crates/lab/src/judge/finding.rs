//! The method that a file agrees with, in words.

use super::judgement::Judgement;
use super::quantity::{amount, seconds};
use super::search::{Agreement, MIN_APART};
use super::trial::{Start, Trial};

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
    let until = agreement
        .until
        .map(|until| format!(", until {}", seconds(until)));
    let text = format!(
        "agrees with {} {how}{}",
        way(agreement),
        until.unwrap_or_default()
    );
    let mut lines = vec![("method", text)];
    if agreement.trial.pace.points > 1 {
        let points = agreement.trial.pace.points;
        let text = format!(
            "1 of {points} is at the end of a step: others lie between steps, and are not compared"
        );
        lines.push(("rows", text));
    }
    lines.extend(others(agreement, &judgement.found.also));
    let mut questions: Vec<_> = vec![];
    for asked in [agreement]
        .into_iter()
        .chain(&judgement.found.also)
        .filter_map(question)
    {
        if !questions.contains(&asked) && questions.len() < MAX_OTHERS {
            questions.push(asked);
        }
    }
    let questions = questions.into_iter();
    lines.extend(questions.map(|question| ("question", question)));
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
            (Some(mistake), Some(other)) if mistake.words() == other.words() => continue,
            (Some(_), Some(other)) => format!("with {}", other.words()),
            _ if other.way.title() != own.way.title() => other.way.title().to_owned(),
            _ => format!("the same{}", slips(&other)),
        };
        if !names.contains(&name) && way_of(&other) != way_of(&own) {
            names.push(name);
        }
    }
    let more = names.len().saturating_sub(MAX_OTHERS);
    names.truncate(MAX_OTHERS);
    let more = if more > 0 {
        format!(" and {more} more")
    } else {
        String::new()
    };
    let same = "which cannot be told apart here";
    (!names.is_empty()).then(|| ("or", format!("{}{more}: {same}", names.join("; "))))
}

fn not_found(judgement: &Judgement) -> Vec<(&'static str, String)> {
    let found = &judgement.found;
    let [longest, shortest] = found.steps;
    let steps = if longest == shortest {
        format!("a step of {}", seconds(longest))
    } else {
        format!("steps from {} to {}", seconds(longest), seconds(shortest))
    };
    let known = if judgement.has_known_step {
        ""
    } else {
        ": if its step is another, add --step"
    };
    let mut lines = vec![("method", format!("agrees with no solver at {steps}{known}"))];
    let mut near = |key, near: &Agreement, only| {
        let away = amount(near.compared.distance);
        lines.push((
            key,
            format!("{} is {only}{away} m away at worst", way(near)),
        ));
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
    let trial = agreement.trial;
    let title = trial.way.title();
    // Methods that are called after people have no article.
    let has_article = [
        "explicit trapezoid",
        "explicit midpoint",
        "implicit midpoint",
    ];
    let article = if has_article.iter().any(|begin| title.starts_with(begin)) {
        "the "
    } else {
        ""
    };
    let precision = if agreement.is_single {
        " in single precision"
    } else {
        ""
    };
    let slips = slips(&trial);
    let end = if slips.is_empty() { "" } else { "," };
    let step = seconds(agreement.step);
    format!("{article}{title} at {step}{precision}{slips}{end}")
}

/// Returns the differences from the method: a slip or a mistake, and the row at which the
/// comparison begins.
fn slips(trial: &Trial) -> String {
    let slip = trial.way.slip().map(|slip| format!(", but with {slip}"));
    slip.unwrap_or_default() + since(trial.start)
}

/// Returns the slips of an agreement in words, if it has some.
pub fn mistake(agreement: &Agreement) -> Option<String> {
    let slips = slips(&agreement.trial);
    let words = slips.trim_start_matches(", ").trim_start_matches("but ");
    let words = words.trim_start_matches("with ");
    (!words.is_empty()).then(|| words.into())
}

/// Returns the method and where the comparison begins.
fn way_of(trial: &Trial) -> (&'static str, String) {
    (trial.way.title(), slips(trial))
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
    agreement
        .trial
        .way
        .question()
        .or(of_start.map(String::from))
}
