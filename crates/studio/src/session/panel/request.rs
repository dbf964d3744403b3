//! The rows of the panel, and what keys and mouse do there and in the open list.

use a3_scenes::{Edit, MATERIALS, Material};

use super::knobs::{KNOBS, Knob, is_left_out};
use super::parts;
use super::undo::edit;
use super::values::pane;
use crate::session::{Dial, MeasureRequest, PanelKey, PanelRequest, Question, Session};
use crate::session::{TextKey, Topic, Turn, asking};

/// Returns the knobs that apply to the panel's pane, with their numbers in the table.
pub fn rows(session: &Session) -> Vec<(usize, &'static Knob, Dial)> {
    let at = pane(session);
    let rows = KNOBS.iter().enumerate();
    rows.filter_map(|(k, knob)| {
        let mut dial = (knob.read)(session, at)?;
        if is_left_out(session, knob.name) {
            dial.words = "left out".into();
        }
        Some((k, knob, dial))
    })
    .collect()
}

/// Returns the number of the row that measures the parts, after those of the knobs.
pub fn measuring_row() -> usize {
    KNOBS.len()
}

/// Returns the number of the row of a part.
pub fn part_row(part: usize) -> usize {
    measuring_row() + 1 + part
}

/// Returns whether the panel shows the parts of the scene: the chosen row is among them.
pub fn shows_parts(session: &Session) -> bool {
    session.panel.row >= measuring_row() && !session.tuning.parts.is_empty()
}

/// Returns the numbers of all rows: of the knobs that apply, then of the parts.
pub fn numbers(session: &Session) -> Vec<usize> {
    let knobs = rows(session).into_iter().map(|(k, ..)| k);
    let count = session.tuning.parts.len();
    let can_measure = count > 0 && session.measuring.answerer.is_some();
    let measuring = can_measure.then(measuring_row);
    let parts = (0..count).map(part_row);
    knobs.chain(measuring).chain(parts).collect()
}

/// Returns the request of a key. With `other`, a knob turns by the other step of its scale.
pub fn request(session: &Session, key: PanelKey, other: bool) -> PanelRequest {
    let rows = numbers(session);
    // If the present scene lacks the chosen row, use the nearest one above it.
    let chosen = session.panel.row;
    let at = rows.iter().rposition(|k| *k <= chosen).unwrap_or(0);
    // From the first row, up to the last of the same page.
    let knobs = self::rows(session).len();
    let above = || at.checked_sub(1).unwrap_or(knobs.saturating_sub(1));
    let turn = match key {
        PanelKey::Up => return PanelRequest::ChooseRow(rows[above()]),
        PanelKey::Down => return PanelRequest::ChooseRow(rows[(at + 1) % rows.len()]),
        PanelKey::Left => Turn::By { up: false, other },
        PanelKey::Right => Turn::By { up: true, other },
        PanelKey::Toggle => Turn::Toggle,
    };
    PanelRequest::Turn(rows[at], turn)
}

/// Carries out a request, and returns whether that changed the scene.
pub fn apply(session: &mut Session, request: PanelRequest) -> bool {
    // Discard a value that was typed but not accepted.
    (session.panel.typed, session.panel.all_marked) = (None, false);
    match request {
        PanelRequest::Type(row) => {
            session.panel.row = row;
            session.panel.typed = Some(String::new());
        }
        PanelRequest::ChooseRow(row) => session.panel.row = row,
        PanelRequest::Turn(row, turn) => {
            session.panel.row = row;
            turn_row(session, pane(session), row, turn);
        }
        PanelRequest::TakeEntry(number) => return session.take_entry(number),
        PanelRequest::CloseList => session.list = None,
        PanelRequest::GoTo(share) => session.scrub_to(share),
        PanelRequest::AddPane(pane) => session.toggle_list(Topic::Beside { pane }),
        PanelRequest::RemovePane(pane) => return session.remove_pane(pane),
        PanelRequest::RunAgain(pane) => session.run_again(pane),
        PanelRequest::Tool(tool) => session.panel.editor.tool = tool,
        PanelRequest::SetMeasure(measure, value) => session.panel.editor.set(measure, value),
    }
    false
}

/// Turns the knob or the switch of a row.
fn turn_row(session: &mut Session, at: usize, row: usize, turn: Turn) {
    if let Some(knob) = KNOBS.get(row) {
        knob.turn(session, at, turn);
        if let Some(material) = session.panel.material.take().and_then(|k| MATERIALS.get(k)) {
            name_material(session, material);
        }
        return;
    }
    let Some(part) = row.checked_sub(part_row(0)) else {
        let measured = session.measuring.progress().map(|(question, ..)| question);
        if let Some(other) = measured.filter(|question| *question != Question::Simplify) {
            let why = format!("{} is being measured; key q shows it.", other.words());
            return session.readings.say(why);
        }
        asking::apply(session, MeasureRequest::Ask(Question::Simplify), at);
        asking::apply(session, MeasureRequest::Toggle, at);
        return;
    };
    parts::turn(session, part, turn);
}

/// Makes the bodies of the scene that can be of a material of it, while the motion goes on.
fn name_material(session: &mut Session, material: &Material) {
    let Material { name, about, .. } = material;
    let done = edit(session, &Edit::NameMaterial(name), &format!("material {name}"));
    let said = match done {
        Err(why) => why,
        Ok(()) => match session.runs.fit_steps() {
            None => format!("{name}: {about}."),
            Some(step) => format!("{name}: {about}. {step}"),
        },
    };
    session.readings.say(said);
}

/// Handles a key while a value is typed for the chosen row.
pub fn type_key(session: &mut Session, key: TextKey) {
    let Some(typed) = &mut session.panel.typed else {
        return;
    };
    if std::mem::take(&mut session.panel.all_marked)
        && matches!(key, TextKey::Type(_) | TextKey::Erase)
    {
        typed.clear();
    }
    match key {
        TextKey::Type(letter) => typed.push(letter),
        TextKey::MarkAll => session.panel.all_marked = true,
        TextKey::Erase => drop(typed.pop()),
        TextKey::Cancel => session.panel.typed = None,
        TextKey::Move(_) => {}
        TextKey::Accept => {
            let (typed, row) = (typed.clone(), session.panel.row);
            match value(session, row, &typed) {
                Ok(value) => {
                    apply(session, PanelRequest::Turn(row, Turn::Exactly(value)));
                }
                Err(why) => session.readings.say(format!("{}: {why}", KNOBS[row].name)),
            }
        }
    }
}

/// Parses a typed value: a number, or a fraction such as 1/60. Fails if it is neither, or outside
/// the scale.
fn value(session: &Session, row: usize, typed: &str) -> Result<f64, String> {
    let dial = (KNOBS[row].read)(session, pane(session));
    let [from, to] =
        dial.and_then(|dial| dial.scale.ends()).ok_or("this scene has no such value")?;
    if typed.contains(',') {
        let point = typed.replace(',', ".");
        return Err(format!("use a decimal point: {point}"));
    }
    let number = |text: &str| text.trim().parse::<f64>().ok();
    let value = match typed.split_once('/') {
        Some((above, below)) => number(above).zip(number(below)).map(|(a, b)| a / b),
        None => number(typed),
    };
    let value = value.filter(|value| (from..=to).contains(value));
    value.ok_or_else(|| format!("must be a number from {from} to {to}"))
}
