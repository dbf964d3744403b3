//! The query of a page's address: parameters such as `lesson=3.2`, and a command line.

use a3_files::failure::Failure;
use a3_files::lessons::ALL;

use super::session::Hidden;

/// The query of an address.
#[derive(Debug, Default, PartialEq)]
pub struct Address {
    /// The lesson and its step to begin with (from 0).
    pub lesson: Option<(usize, usize)>,
    /// Names of the scenes that may be shown; all if `None`.
    pub scenes: Option<Vec<String>>,
    pub hidden: Hidden,
    /// Whether the page is a frame in another one, and keeps no settings.
    pub embedded: bool,
    /// The words of the command line.
    pub words: Vec<String>,
}

impl Address {
    /// Reads the words of a query. Words that are no parameters are the command line.
    pub fn read(words: impl IntoIterator<Item = String>) -> Result<Self, Failure> {
        let mut address = Self::default();
        for word in words {
            match word.split_once('=') {
                Some(("lesson", at)) => address.lesson = Some(lesson(at)?),
                Some(("scenes", names)) => {
                    address.scenes = Some(names.split(',').map(str::to_owned).collect());
                }
                Some(("hide", parts)) => hide(&mut address.hidden, parts)?,
                Some(("embed", "1")) => address.embedded = true,
                _ => address.words.push(word),
            }
        }
        if let (Some([first, ..]), false) =
            (address.scenes.as_deref(), address.words.iter().any(|word| word == "--scene"))
        {
            address.words.extend(["--scene".into(), first.clone()]);
        }
        Ok(address)
    }
}

/// Reads the number of a lesson, and that of a step if there is one, as in `3` or `3.2`.
fn lesson(at: &str) -> Result<(usize, usize), Failure> {
    let (lesson, step) = at.split_once('.').unwrap_or((at, "1"));
    let number = |text: &str| text.parse::<usize>().ok()?.checked_sub(1);
    let found = number(lesson).zip(number(step));
    let found = found.filter(|(lesson, step)| {
        let lesson = ALL.get(*lesson);
        lesson.is_some_and(|lesson| *step < lesson.steps.len())
    });
    found.ok_or_else(|| {
        let count = ALL.len();
        Failure::usage(format!(
            "lesson={at}: there are {count} lessons in a few steps each, as in lesson=3 or lesson=3.2"
        ))
    })
}

/// Hides the parts that a list names.
fn hide(hidden: &mut Hidden, parts: &str) -> Result<(), Failure> {
    for part in parts.split(',') {
        match part {
            "panel" => hidden.panel = true,
            "solvers" => hidden.solvers = true,
            "lessons" => hidden.lessons = true,
            _ => {
                return Err(Failure::usage(format!(
                    "hide={part}: a page can hide panel, solvers and lessons, as in hide=panel,solvers"
                )));
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(query: &str) -> Result<Address, String> {
        Address::read(query.split_whitespace().map(str::to_owned)).map_err(|why| why.to_string())
    }

    #[test]
    fn parameters_stand_anywhere_beside_a_command_line() {
        let address = read("t lesson=2.3 0.01 scenes=mit,lab.toml hide=panel,lessons embed=1");
        let address = address.unwrap();
        assert_eq!(address.words, ["t", "0.01", "--scene", "mit"]);
        assert_eq!(address.lesson, Some((1, 2)));
        assert_eq!(address.scenes.unwrap(), ["mit", "lab.toml"]);
        assert!(address.hidden.panel && address.hidden.lessons && !address.hidden.solvers);
        assert!(address.embedded);
        let plain = read("t 0.01 --scene flag scenes=mit,flag").unwrap();
        assert_eq!(plain.words, ["t", "0.01", "--scene", "flag"]);
    }

    #[test]
    fn wrong_parameters_say_what_is_right() {
        for (query, right) in [
            ("lesson=99", "lesson=3.2"),
            ("lesson=1.99", "lesson=3.2"),
            ("lesson=0", "lesson=3.2"),
            ("hide=everything", "panel, solvers and lessons"),
        ] {
            let why = read(query).unwrap_err();
            assert!(why.contains(query) && why.contains(right), "{why}");
        }
    }
}
