//! The lessons of the folder `lessons`, carried in the program: printed as text, or followed step
//! by step in the window.
//!
//! What the window takes from the page of a lesson. Below the heading `## In the window`, each
//! `### Title` begins a step, whose paragraphs have these forms:
//!
//! * `` Run: `a3 e 0.05 --scene simple`, to 20 s. `` is the command line that the window follows,
//!   and the time at which it pauses, if there is one. Scenes are those of the program, and the
//!   blocks of TOML in the lessons, whose first lines begin with their names.
//! * `**Question.** ...` is the question, and a list after it has the choices.
//! * In the `<details>`, the bold words that come first are the right choice, or a number with its
//!   unit and `(within 2 %)`. The rest of the paragraph says why. Then come the replies to wrong
//!   answers: `- *Choice.* Reply`, and for numbers `- *Otherwise.* Reply`.
//! * Every other paragraph says what to look at.

mod plain;

use std::io::{self, IsTerminal};
use std::sync::LazyLock;

use plain::{Piece, pieces};

use super::failure::Failure;
use super::platform::terminal;

/// Number of lessons.
pub const LESSONS: u8 = 8;

macro_rules! carried {
    ($($name:literal),* $(,)?) => {
        [$(include_str!(concat!("../../lessons/", $name))),*]
    };
}

/// The pages: the index, then the lessons in their order.
static PAGES: [&str; LESSONS as usize + 1] = carried![
    "README.md",
    "1-euler-spirals.md",
    "2-heun-without-damping.md",
    "3-stiffness-and-the-step.md",
    "4-order-and-cost.md",
    "5-symplectic-or-not.md",
    "6-implicit-methods.md",
    "7-contact-and-order.md",
    "8-how-fine-a-cloth.md",
];

/// The lessons in their order, read from their pages.
pub static ALL: LazyLock<Vec<Lesson>> = LazyLock::new(|| {
    let pages = PAGES[1..].iter().enumerate();
    pages.map(|(k, page)| Lesson::read(page, PAGES[0], k + 1)).collect()
});

/// Prints a lesson, or the index, as text. An answer comes at once if `answers`, and else, in a
/// terminal, after the key Enter.
pub fn print(lesson: Option<u8>, answers: bool) -> Result<(), Failure> {
    let number = lesson.unwrap_or(0);
    let waits = io::stdin().is_terminal() && io::stdout().is_terminal();
    for (k, piece) in pieces(PAGES[usize::from(number)]).into_iter().enumerate() {
        if k > 0 {
            terminal::say("\n")?;
        }
        match piece {
            Piece::Answer(_) if !answers && !waits => {
                terminal::say(&format!("Answer: a3 lessons {number} --answers\n"))?;
            }
            Piece::Answer(text) if !answers => {
                terminal::say("Press Enter for the answer.")?;
                // Without an answer to that, the text follows at once.
                let _ = io::stdin().read_line(&mut String::new());
                terminal::say(&text)?;
            }
            Piece::Text(text) | Piece::Answer(text) => terminal::say(&text)?,
        }
    }
    Ok(())
}

/// Returns the text of the scene that a lesson describes under a name, such as `spring.toml`.
pub fn scene(name: &str) -> Option<&'static str> {
    PAGES.iter().find_map(|page| scene_in(page, name))
}

/// A lesson, in steps.
pub struct Lesson {
    pub title: String,
    /// What the lesson shows, as the index says it.
    pub about: String,
    pub steps: Vec<Step>,
}

/// A step of a lesson: a run to look at, and a question about it.
pub struct Step {
    pub title: String,
    /// Command line of the run.
    pub run: String,
    /// Time at which the run pauses (s), if there is one.
    pub until: Option<f64>,
    /// What to look at, in paragraphs.
    pub look: Vec<String>,
    pub question: Question,
}

/// A question and its answer.
pub struct Question {
    pub words: String,
    pub answer: Answer,
    /// Why the answer is right.
    pub why: String,
}

/// The answer to a question.
pub enum Answer {
    /// One of several choices.
    Choice { choices: Vec<Choice>, right: usize },
    /// A number.
    Number {
        value: f64,
        unit: String,
        /// Largest error of an accepted answer, as a share of the value.
        within: f64,
        /// Reply to a wrong number.
        hint: String,
    },
}

/// A choice, with the reply to it if it is wrong.
pub struct Choice {
    pub words: String,
    pub reply: Option<String>,
}

impl Lesson {
    /// Reads the lesson of a number from its page, and what it shows from the index. A step that
    /// lacks a part is left out.
    pub(super) fn read(page: &str, index: &str, number: usize) -> Self {
        let title = page.lines().next().unwrap_or_default();
        let title = title.trim_start_matches(['#', ' ']);
        let title = title.split_once(". ").map_or(title, |(_, title)| title);
        let row = format!("| {number} | ");
        let row = index.lines().find(|line| line.starts_with(&row));
        let about = row.and_then(|row| row.trim_end_matches(['|', ' ']).rsplit_once("| "));
        let (_, steps) = page.split_once("\n## In the window\n").unwrap_or_default();
        Self {
            title: title.into(),
            about: about.map_or("", |(_, about)| about).into(),
            steps: steps.split("\n### ").skip(1).filter_map(Step::read).collect(),
        }
    }
}

impl Step {
    fn read(text: &str) -> Option<Self> {
        let (title, text) = text.split_once('\n')?;
        let (text, answer) = text.split_once("<details><summary>Answer</summary>")?;
        let (mut run, mut look, mut question, mut choices) = (None, vec![], None, vec![]);
        for block in text.split("\n\n").filter(|block| !block.trim().is_empty()) {
            let words = joined(block);
            if let Some(words) = words.strip_prefix("Run: `") {
                run = Some(words.split_once('`')?).map(|(run, rest)| (run.to_owned(), time(rest)));
            } else if let Some(words) = words.strip_prefix("**Question.** ") {
                question = Some(words.to_owned());
            } else if words.starts_with("- ") {
                choices = items(block);
            } else {
                look.push(words);
            }
        }
        let (run, until) = run?;
        Some(Self {
            title: title.trim().into(),
            run,
            until,
            look,
            question: Question::read(question?, choices, answer)?,
        })
    }
}

impl Question {
    fn read(words: String, choices: Vec<String>, answer: &str) -> Option<Self> {
        let (answer, _) = answer.split_once("</details>")?;
        let (paragraph, replies) = answer.trim().split_once("\n\n").unwrap_or((answer, ""));
        let paragraph = joined(paragraph);
        let (right, why) = paragraph.strip_prefix("**")?.split_once("**")?;
        let replies = items(replies);
        let reply = |to: &str| {
            let mark = format!("*{to}* ");
            let reply = replies.iter().find_map(|reply| reply.strip_prefix(&mark));
            reply.map(str::to_owned)
        };
        let mut why = why.trim();
        let answer = if choices.is_empty() {
            let (value, unit) = right.split_once(' ').unwrap_or((right, ""));
            let (within, rest) = why.strip_prefix("(within ")?.split_once(" %). ")?;
            why = rest;
            Answer::Number {
                value: value.parse().ok()?,
                unit: unit.into(),
                within: 0.01 * within.parse::<f64>().ok()?,
                hint: reply("Otherwise.")?,
            }
        } else {
            Answer::Choice {
                right: choices.iter().position(|choice| choice == right)?,
                choices: choices
                    .into_iter()
                    .map(|words| Choice { reply: reply(&words), words })
                    .collect(),
            }
        };
        Some(Self { words, answer, why: why.into() })
    }
}

/// Returns the text of a block of TOML in a page whose first line begins with a name.
fn scene_in<'a>(page: &'a str, name: &str) -> Option<&'a str> {
    let blocks = page.split("```").skip(1).step_by(2);
    let scenes = blocks.filter_map(|block| block.strip_prefix("toml\n"));
    let mut named = scenes.filter(|scene| {
        let first = scene.strip_prefix("# ").and_then(|it| it.strip_prefix(name));
        first.is_some_and(|rest| rest.starts_with(':'))
    });
    named.next()
}

/// Returns the time in words such as `, to 20 s.`.
fn time(words: &str) -> Option<f64> {
    words.strip_prefix(", to ")?.split(' ').next()?.parse().ok()
}

/// Joins the lines of a paragraph.
fn joined(block: &str) -> String {
    block.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Returns the items of a list.
fn items(block: &str) -> Vec<String> {
    let block = format!("\n{}", block.trim());
    block.split("\n- ").skip(1).map(joined).collect()
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    /// Every heading of a step in a page is a step of the lesson, and says all that it needs.
    #[test]
    fn every_step_of_every_page_is_read_whole() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/lessons");
        let files = fs::read_dir(folder).unwrap().map(|it| it.unwrap().path());
        let pages = files.filter(|path| path.is_file()).count();
        assert_eq!((pages, ALL.len()), (PAGES.len(), usize::from(LESSONS)));
        for (lesson, page) in ALL.iter().zip(&PAGES[1..]) {
            let title = &lesson.title;
            assert!(!title.is_empty() && !lesson.about.is_empty(), "{title}");
            assert_eq!(lesson.steps.len(), page.matches("\n### ").count());
            assert!(lesson.steps.len() >= 3, "{title}");
            for step in &lesson.steps {
                let (question, title) = (&step.question, &step.title);
                assert!(step.run.starts_with("a3 ") && !step.look.is_empty());
                assert!(question.words.ends_with('?'), "{title}");
                assert!(question.why.len() > 40, "{title}");
                match &question.answer {
                    Answer::Choice { choices, right } => {
                        assert!(*right < choices.len(), "{title}");
                        for (k, choice) in choices.iter().enumerate() {
                            assert_eq!(choice.reply.is_none(), k == *right, "{title}");
                        }
                    }
                    Answer::Number { within, hint, .. } => {
                        assert!(*within <= 0.05 && hint.len() > 20, "{title}");
                    }
                }
            }
        }
        // A name means one scene, in whichever lesson it is.
        for page in PAGES {
            for name in page.split("```toml\n# ").skip(1) {
                let name = name.split(':').next().unwrap();
                assert_eq!(scene_in(page, name), scene(name), "{name}");
            }
        }
    }
}
