//! The lessons in the window: what is open, and the answers so far.

use std::collections::BTreeMap;

use a3_files::lessons::{ALL, Answer, Lesson, Step};

use super::action::{LessonRequest, PanelKey};
use super::list::TextKey;

/// The pane of lessons, and the progress in them since the program began.
#[derive(Default)]
pub struct Lessons {
    /// The chosen lesson, which keys open.
    pub chosen: usize,
    /// The step of the chosen lesson that is shown; `None` for the list of lessons.
    pub step: Option<usize>,
    /// The marked choice, which Enter gives as the answer.
    pub marked: usize,
    /// Whether keys are letters of the number that is asked for.
    pub typing: bool,
    /// Answers by lesson and step.
    given: BTreeMap<(usize, usize), Given>,
}

/// The answer of the user to a question.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Given {
    /// The choice that was last made.
    pub choice: Option<usize>,
    /// The number that is typed.
    pub typed: String,
    /// Whether the last answer was right; `None` while there is none.
    pub right: Option<bool>,
    /// Whether the step is done: a right answer was given, or the answer was shown.
    pub done: bool,
    /// Number of wrong answers.
    pub wrong: u32,
}

impl Lessons {
    /// Returns the lesson and the step that are shown.
    pub fn shown(&self) -> Option<(&'static Lesson, &'static Step)> {
        let lesson = ALL.get(self.chosen)?;
        Some((lesson, lesson.steps.get(self.step?)?))
    }

    /// Returns the answer to the question that is shown.
    pub fn given(&self) -> Given {
        let step = self.step.map(|step| (self.chosen, step));
        let given = step.and_then(|step| self.given.get(&step));
        given.cloned().unwrap_or_default()
    }

    /// Returns the answer to the question that is shown, for a change.
    fn given_mut(&mut self) -> Option<&mut Given> {
        let step = (self.chosen, self.step?);
        Some(self.given.entry(step).or_default())
    }

    /// Carries out a request, and returns whether the run of the step that is shown begins then.
    /// What is typed next replaces the text so far if that `is_marked`.
    pub fn apply(&mut self, request: LessonRequest, is_marked: &mut bool) -> bool {
        let was_marked = std::mem::take(is_marked);
        self.typing &= matches!(request, LessonRequest::Letter(_));
        match request {
            LessonRequest::Contents => self.step = None,
            LessonRequest::Choose(lesson) => self.chosen = lesson,
            LessonRequest::Open(lesson, step) => {
                (self.chosen, self.step, self.marked) = (lesson, Some(step), 0);
                return true;
            }
            LessonRequest::Again => return true,
            LessonRequest::Mark(choice) => self.marked = choice,
            LessonRequest::Answer(choice) => {
                self.marked = choice;
                self.choose(choice);
            }
            LessonRequest::Type(typing) => {
                self.typing = typing && !self.given().done;
                *is_marked = self.typing;
            }
            LessonRequest::Letter(letter) => {
                self.type_letter(letter, was_marked);
            }
            LessonRequest::Check => self.check(),
            LessonRequest::Reveal => self.reveal(),
        }
        false
    }

    /// Handles a key while a number is typed.
    pub fn type_key(&mut self, key: TextKey, is_marked: &mut bool) {
        let request = match key {
            TextKey::Type(letter) => LessonRequest::Letter(Some(letter)),
            TextKey::Erase => LessonRequest::Letter(None),
            TextKey::Accept => LessonRequest::Check,
            TextKey::Cancel => LessonRequest::Type(false),
            TextKey::MarkAll => return *is_marked = true,
            TextKey::Move(_) => return,
        };
        self.apply(request, is_marked);
    }

    /// Returns the request of the step after the one that is shown: the next one of the lesson, the
    /// first of the next lesson, or the list.
    pub fn next(&self) -> LessonRequest {
        let (lesson, step) = (self.chosen, self.step.unwrap_or(0) + 1);
        if ALL.get(lesson).is_some_and(|it| step < it.steps.len()) {
            LessonRequest::Open(lesson, step)
        } else if lesson + 1 < ALL.len() {
            LessonRequest::Open(lesson + 1, 0)
        } else {
            LessonRequest::Contents
        }
    }

    /// Returns the request of the step before the one that is shown, or the list before the first
    /// one.
    pub fn previous(&self) -> LessonRequest {
        match self.step {
            Some(step @ 1..) => LessonRequest::Open(self.chosen, step - 1),
            _ => LessonRequest::Contents,
        }
    }

    /// Returns the request of a key.
    pub fn request(&self, key: PanelKey) -> Option<LessonRequest> {
        let moved = |at: usize, count: usize| match key {
            PanelKey::Up => at.checked_sub(1).unwrap_or(count - 1),
            _ => (at + 1) % count,
        };
        let Some((_, step)) = self.shown() else {
            return Some(match key {
                PanelKey::Up | PanelKey::Down => {
                    LessonRequest::Choose(moved(self.chosen, ALL.len()))
                }
                PanelKey::Left => LessonRequest::Contents,
                PanelKey::Right | PanelKey::Toggle => {
                    LessonRequest::Open(self.chosen, self.next_step(self.chosen))
                }
            });
        };
        let done = self.given().done;
        Some(match (key, &step.question.answer) {
            (PanelKey::Left, _) => self.previous(),
            (PanelKey::Right, _) => self.next(),
            (PanelKey::Toggle, _) if done => self.next(),
            (PanelKey::Toggle, Answer::Choice { .. }) => LessonRequest::Answer(self.marked),
            (PanelKey::Toggle, Answer::Number { .. }) => LessonRequest::Type(true),
            (PanelKey::Up | PanelKey::Down, Answer::Choice { choices, .. }) => {
                LessonRequest::Mark(moved(self.marked, choices.len()))
            }
            (PanelKey::Up | PanelKey::Down, Answer::Number { .. }) => return None,
        })
    }

    /// Returns whether a step of a lesson is done.
    pub fn is_done(&self, lesson: usize, step: usize) -> bool {
        self.given.get(&(lesson, step)).is_some_and(|it| it.done)
    }

    /// Returns the first step of a lesson that is not done, or else its first step.
    pub fn next_step(&self, lesson: usize) -> usize {
        let steps = ALL.get(lesson).map_or(0, |lesson| lesson.steps.len());
        let next = (0..steps).find(|k| !self.is_done(lesson, *k));
        next.unwrap_or(0)
    }

    /// Checks a choice.
    pub fn choose(&mut self, choice: usize) {
        let Some((_, step)) = self.shown() else {
            return;
        };
        if let Answer::Choice { right, choices } = &step.question.answer
            && choice < choices.len()
        {
            self.answer(choice == *right, Some(choice));
        }
    }

    /// Types a letter of a number, or erases the last one if it is `None`; either replaces all, if
    /// that `is_marked`. Returns false if there is no number to type, or the letter is of none.
    pub fn type_letter(&mut self, letter: Option<char>, is_marked: bool) -> bool {
        let asked = self.shown().map(|(_, step)| &step.question.answer);
        let fits = letter.is_none_or(|it| it.is_ascii_digit() || "+-.,e".contains(it));
        if !matches!(asked, Some(Answer::Number { .. })) || !fits {
            return false;
        }
        let Some(given) = self.given_mut().filter(|given| !given.done) else {
            return false;
        };
        given.right = None;
        if is_marked {
            given.typed.clear();
        }
        match letter {
            // A comma is a decimal point, and no number needs more letters.
            Some(letter) if given.typed.len() < 12 => {
                given.typed.push(if letter == ',' { '.' } else { letter });
            }
            Some(_) => {}
            None => drop(given.typed.pop()),
        }
        true
    }

    /// Checks the typed number. An empty answer is ignored; one that is no number is marked as
    /// wrong, but not counted.
    pub fn check(&mut self) {
        let Some((_, step)) = self.shown() else {
            return;
        };
        let typed = self.given().typed;
        if let Answer::Number { value, within, .. } = step.question.answer
            && !typed.is_empty()
        {
            let Ok(number) = typed.parse::<f64>() else {
                if let Some(given) = self.given_mut() {
                    given.right = Some(false);
                }
                return;
            };
            self.answer((number - value).abs() <= within * value.abs(), None);
        }
    }

    /// Notes an answer.
    fn answer(&mut self, right: bool, choice: Option<usize>) {
        if let Some(given) = self.given_mut() {
            given.choice = choice;
            given.right = Some(right);
            given.done |= right;
            given.wrong += u32::from(!right);
        }
    }

    /// Gives the right answer in place of the user.
    pub fn reveal(&mut self) {
        let Some((_, step)) = self.shown() else {
            return;
        };
        if let Some(given) = self.given_mut() {
            match &step.question.answer {
                Answer::Choice { right, .. } => given.choice = Some(*right),
                Answer::Number { value, .. } => given.typed = value.to_string(),
            }
            (given.right, given.done) = (Some(true), true);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the place of the first question for a number, or of the first with choices.
    fn place(number: bool) -> (usize, usize) {
        let steps = ALL.iter().enumerate();
        let mut all = steps.flat_map(|(k, lesson)| (0..lesson.steps.len()).map(move |n| (k, n)));
        let is = |(k, n): &(usize, usize)| {
            let answer = &ALL[*k].steps[*n].question.answer;
            matches!(answer, Answer::Number { .. }) == number
        };
        all.find(is).unwrap()
    }

    fn at((lesson, step): (usize, usize)) -> Lessons {
        Lessons { chosen: lesson, step: Some(step), ..Lessons::default() }
    }

    #[test]
    fn a_choice_is_checked_and_a_right_answer_stays() {
        let place = place(false);
        let mut lessons = at(place);
        let Answer::Choice { choices, right } = &lessons.shown().unwrap().1.question.answer else {
            unreachable!();
        };
        let wrong = (right + 1) % choices.len();
        lessons.choose(wrong);
        assert_eq!((lessons.given().right, lessons.given().wrong), (Some(false), 1));
        assert_eq!(lessons.next_step(place.0), place.1);
        lessons.choose(*right);
        assert!(lessons.given().done && lessons.is_done(place.0, place.1));
        lessons.choose(99);
        lessons.choose(wrong);
        assert!(lessons.given().done && lessons.given().right == Some(false));
    }

    #[test]
    fn a_number_is_typed_and_checked_with_its_tolerance() {
        let mut lessons = at(place(true));
        let Answer::Number { value, within, .. } = lessons.shown().unwrap().1.question.answer
        else {
            unreachable!();
        };
        let try_number = |lessons: &mut Lessons, number: f64| {
            while !lessons.given().typed.is_empty() {
                lessons.type_letter(None, false);
            }
            for letter in format!("{number:.7}").replace('.', ",").chars() {
                assert!(lessons.type_letter(Some(letter), false));
            }
            lessons.check();
            lessons.given().right
        };
        assert!(!lessons.type_letter(Some('k'), false));
        lessons.check();
        assert_eq!(lessons.given(), Given::default());
        assert_eq!(try_number(&mut lessons, value * (1.0 + 1.1 * within)), Some(false));
        assert_eq!(try_number(&mut lessons, value * (1.0 + 0.9 * within)), Some(true));
        // What is done can no longer be typed over.
        assert!(lessons.given().done && !lessons.type_letter(Some('1'), false));
        let mut other = at(place(true));
        other.reveal();
        assert!(other.given().done && other.given().typed == value.to_string());
    }
}
