//! The lessons of the folder `lessons`, carried in the program: printed as text, or followed step
//! by step in the window.

mod parse;
mod plain;

use std::io::{self, IsTerminal};
use std::sync::LazyLock;

pub use parse::{Answer, Choice, Lesson, Step};

use plain::{Piece, pieces};

use crate::failure::Failure;
use crate::terminal;

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
    pages
        .map(|(k, page)| Lesson::read(page, PAGES[0], k + 1))
        .collect()
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
    PAGES.iter().find_map(|page| parse::scene(page, name))
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
                assert_eq!(parse::scene(page, name), scene(name), "{name}");
            }
        }
    }
}
