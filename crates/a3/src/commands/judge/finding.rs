//! The method that a file agrees with, in words.

use super::judgement::Judgement;
use super::quantity::{amount, seconds};
use super::search::{Agreement, MIN_APART};
use super::trial::Start;

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
    lines.extend(
        questions
            .into_iter()
            .map(|question| ("question", question.into())),
    );
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
            (Some(mistake), Some(other)) if mistake == other => continue,
            (Some(_), Some(other)) => format!("with {}", other.words()),
            _ if other.way.title() != own.way.title() => other.way.title().to_owned(),
            _ => format!("the same{}", since(other.start)),
        };
        if !names.contains(&name)
            && (other.way.title(), other.start) != (own.way.title(), own.start)
        {
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
    let mut lines = vec![("method", format!("agrees with no solver at {steps}"))];
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
        lines.extend(question(suspect).map(|question| ("question", question.into())));
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
    let mut text = format!("{article}{title} at {}", seconds(agreement.step));
    if let Some(mistake) = trial.way.mistake() {
        text.extend([", but with ", mistake.words(), ","]);
    }
    let since = since(trial.start);
    if !since.is_empty() {
        text.extend([since, ","]);
    }
    text
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
fn question(agreement: &Agreement) -> Option<&'static str> {
    agreement
        .trial
        .way
        .question()
        .or(match agreement.trial.start {
            Start::Scene | Start::Row(0) => None,
            Start::Row(_) => {
                Some("is a force, a position or a velocity of the first step an old one?")
            }
            Start::Ahead => Some("is the first row written after the first step?"),
            Start::Behind => Some("is the start written twice?"),
        })
}
