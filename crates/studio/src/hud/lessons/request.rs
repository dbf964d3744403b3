//! What keys and requests do in the lessons.

use a3_files::lessons::{ALL, Answer};

use super::super::panel::PanelKey;
use super::place::is_shown;
use crate::begin;
use crate::session::{LessonRequest, Session, TextKey, replace};

/// Carries out a request, and returns whether that changed the scene.
pub fn apply(session: &mut Session, request: LessonRequest) -> bool {
    let is_marked = std::mem::take(&mut session.panel.all_marked);
    let lessons = &mut session.panel.lessons;
    lessons.typing &= matches!(request, LessonRequest::Letter(_));
    match request {
        LessonRequest::Close => lessons.open = false,
        LessonRequest::Contents => lessons.step = None,
        LessonRequest::Choose(lesson) => lessons.chosen = lesson,
        LessonRequest::Open(lesson, step) => {
            (lessons.chosen, lessons.step, lessons.marked) = (lesson, Some(step), 0);
            return begin(session);
        }
        LessonRequest::Again => return begin(session),
        LessonRequest::Mark(choice) => lessons.marked = choice,
        LessonRequest::Answer(choice) => {
            lessons.marked = choice;
            lessons.choose(choice);
        }
        LessonRequest::Type(typing) => {
            lessons.typing = typing && !lessons.given().done;
            session.panel.all_marked = lessons.typing;
        }
        LessonRequest::Letter(letter) => {
            lessons.type_letter(letter, is_marked);
        }
        LessonRequest::Check => lessons.check(),
        LessonRequest::Reveal => lessons.reveal(),
    }
    false
}

/// Begins the run of the step that is shown, and returns whether that was possible.
fn begin(session: &mut Session) -> bool {
    let Some((_, step)) = session.panel.lessons.shown() else {
        return false;
    };
    match begin::step(step) {
        Ok(next) => replace(session, next),
        Err(why) => {
            session.readings.warn(why.to_string());
            return false;
        }
    }
    true
}

/// Returns the request of the step after the one that is shown: the next one of the lesson, the
/// first of the next lesson, or the list.
pub fn next(session: &Session) -> LessonRequest {
    let lessons = &session.panel.lessons;
    let (lesson, step) = (lessons.chosen, lessons.step.unwrap_or(0) + 1);
    if ALL.get(lesson).is_some_and(|it| step < it.steps.len()) {
        LessonRequest::Open(lesson, step)
    } else if lesson + 1 < ALL.len() {
        LessonRequest::Open(lesson + 1, 0)
    } else {
        LessonRequest::Contents
    }
}

/// Returns the request of the step before the one that is shown, or the list before the first one.
pub fn previous(session: &Session) -> LessonRequest {
    let lessons = &session.panel.lessons;
    match lessons.step {
        Some(step @ 1..) => LessonRequest::Open(lessons.chosen, step - 1),
        _ => LessonRequest::Contents,
    }
}

/// Returns the request of a key, if the lessons are visible.
pub fn request(session: &Session, key: PanelKey) -> Option<LessonRequest> {
    let lessons = &session.panel.lessons;
    if !is_shown(session) {
        return None;
    }
    let moved = |at: usize, count: usize| match key {
        PanelKey::Up => at.checked_sub(1).unwrap_or(count - 1),
        _ => (at + 1) % count,
    };
    let Some((_, step)) = lessons.shown() else {
        return Some(match key {
            PanelKey::Up | PanelKey::Down => {
                LessonRequest::Choose(moved(lessons.chosen, ALL.len()))
            }
            PanelKey::Left => LessonRequest::Contents,
            PanelKey::Right | PanelKey::Toggle => {
                LessonRequest::Open(lessons.chosen, lessons.next_step(lessons.chosen))
            }
        });
    };
    let done = lessons.given().done;
    Some(match (key, &step.question.answer) {
        (PanelKey::Left, _) => previous(session),
        (PanelKey::Right, _) => next(session),
        (PanelKey::Toggle, _) if done => next(session),
        (PanelKey::Toggle, Answer::Choice { .. }) => LessonRequest::Answer(lessons.marked),
        (PanelKey::Toggle, Answer::Number { .. }) => LessonRequest::Type(true),
        (PanelKey::Up | PanelKey::Down, Answer::Choice { choices, .. }) => {
            LessonRequest::Mark(moved(lessons.marked, choices.len()))
        }
        (PanelKey::Up | PanelKey::Down, Answer::Number { .. }) => return None,
    })
}

/// Handles a key while a number is typed, and returns whether one is.
pub fn press_text(session: &mut Session, key: TextKey) -> bool {
    if !is_shown(session) || !session.panel.lessons.typing {
        return false;
    }
    let request = match key {
        TextKey::Type(letter) => LessonRequest::Letter(Some(letter)),
        TextKey::Erase => LessonRequest::Letter(None),
        TextKey::Accept => LessonRequest::Check,
        TextKey::Cancel => LessonRequest::Type(false),
        TextKey::MarkAll => {
            session.panel.all_marked = true;
            return true;
        }
        TextKey::Move(_) => return true,
    };
    apply(session, request);
    true
}
