//! What a window is to open with, and the words of a command line that say it, from a link, a
//! lesson, a test or the window itself: those of the program, but for the picture of a comparison
//! and the help.

use std::iter::Peekable;
use std::path::PathBuf;
use std::slice::Iter;

use a3_core::{Method, StepLimits};
use a3_files::arguments::{
    absolute, grid, max_step, particle, solver, solver_and_step, step, threads,
};
use a3_files::failure::Failure;
use a3_files::setup::{SceneOptions, check_count};
use a3_media::show::{Arrows, Manner, Quantity, style};
use a3_scenes::nearest;

/// A scene, its runs, and the first look of the window.
#[derive(Default)]
#[expect(clippy::struct_excessive_bools, reason = "each is an option")]
pub struct Opening {
    /// The scene's name or file.
    pub scene: String,
    /// Options of the scene.
    pub options: SceneOptions,
    /// Solver of each run, `None` for the scene's own, and its step or tolerance, `None` for the
    /// solver's own.
    pub methods: Vec<(Option<&'static Method>, Option<f64>)>,
    /// Limits of adaptive steps.
    pub limits: StepLimits,
    /// Whether surfaces pass through one another and themselves.
    pub no_contact: bool,
    /// How the runs are drawn.
    pub manner: Manner,
    /// Whether the background is light, whatever the settings say.
    pub light: bool,
    /// Whether the runs are paused.
    pub paused: bool,
    /// Whether the window neither reads nor writes its settings.
    pub no_settings: bool,
    /// Whether the scene's file is loaded again whenever it is saved.
    pub watch: bool,
    /// Checkpoint from which the run continues.
    pub resume: Option<PathBuf>,
    /// Whether the window writes what is on the screen as lines of text.
    pub status: bool,
}

/// Names of the options.
const OPTIONS: &str = "--scene --grid --wind --swing --self-collision --threads --absolute \
    --max-step --springs-of --wireframe --springs --orthographic --dark --light --colour --arrows \
    --no-config --no-self-collision --paused --status --watch --resume";

/// The words that are still to be read, and the option that is being read.
struct Words<'a> {
    rest: Peekable<Iter<'a, String>>,
    option: &'a str,
    /// What follows the option's equals sign.
    value: Option<&'a str>,
}

impl Words<'_> {
    /// Reads the value of the option.
    fn read<T>(&mut self, parse: impl Fn(&str) -> Result<T, String>) -> Result<T, Failure> {
        let option = self.option;
        let is_value = |word: &&String| is_plain(word) || option == "--grid";
        let mut next = || self.rest.next_if(is_value).map(String::as_str);
        let text = self.value.or_else(&mut next);
        let text = text.ok_or_else(|| Failure::usage(format!("`{option}` needs a value")))?;
        parse(text).map_err(|why| Failure::usage(format!("`{option} {text}`: {why}")))
    }

    /// Reads the name of a choice.
    fn choose<T: Copy>(
        &mut self,
        all: &[T],
        name_of: fn(T) -> &'static str,
    ) -> Result<Option<T>, Failure> {
        self.read(|text| {
            let found = all.iter().copied().find(|choice| name_of(*choice) == text);
            let names: Vec<_> = all.iter().copied().map(name_of).collect();
            let list = names.join(", ");
            found.map(Some).ok_or_else(|| match nearest(text, names) {
                Some(name) => format!("did you mean {name}? The choices are {list}"),
                None => format!("the choices are {list}"),
            })
        })
    }

    /// Reads an option that has no value.
    fn flag(&self) -> Result<bool, Failure> {
        let refuse = |value| format!("`{}` takes no value: leave out {value}", self.option);
        self.value.map_or(Ok(true), |it| Err(Failure::usage(refuse(it))))
    }
}

/// Returns whether a word is no option.
fn is_plain(word: &str) -> bool {
    !word.starts_with('-') || word == "-" || word.parse::<f64>().is_ok()
}

/// Reads the words that follow the name of the program.
///
/// # Errors
/// A word is wrong, or the command opens no window.
pub fn read(words: &[String]) -> Result<Opening, Failure> {
    let mut opening = Opening { scene: "cloth".into(), ..Opening::default() };
    let mut words = Words { rest: words.iter().peekable(), option: "", value: None };
    let compared = words.rest.next_if(|word| *word == "compare").is_some();
    let (mut plain, mut given) = (vec![], vec![]);
    while let Some(word) = words.rest.next() {
        if is_plain(word) {
            plain.push(word.as_str());
            continue;
        }
        if word == "--" {
            continue;
        }
        (words.option, words.value) = match word.split_once('=') {
            Some((option, value)) => (option, Some(value)),
            None => (word.as_str(), None),
        };
        if words.option == "--color" {
            words.option = "--colour";
        }
        if given.contains(&words.option) {
            let why = format!("`{}` is there twice: give it once", words.option);
            return Err(Failure::usage(why));
        }
        given.push(words.option);
        set(&mut opening, &mut words)?;
    }
    let is_given = |option| given.contains(&option);
    for (one, other) in [("--wireframe", "--springs"), ("--self-collision", "--no-self-collision")]
    {
        if is_given(one) && is_given(other) {
            let why = format!("give either `{one}` or `{other}`, not both");
            return Err(Failure::usage(why));
        }
    }
    opening.manner.style = style(is_given("--wireframe"), is_given("--springs"));
    let wrong = |word, why| Failure::usage(format!("`{word}`: {why}"));
    if compared {
        let mut alone = ["--springs-of", "--watch", "--resume"].into_iter();
        if let Some(option) = alone.find(|option| is_given(option)) {
            return Err(Failure::usage(format!("there is no option `{option}` here")));
        }
        check_count(plain.len())?;
        for word in plain {
            let (method, step) = solver_and_step(word).map_err(|why| wrong(word, why))?;
            opening.methods.push((Some(method), step));
        }
        return Ok(opening);
    }
    if opening.resume.is_some() && !plain.is_empty() {
        let why = "give either `SOLVER` or `--resume FILE.checkpoint`, not both";
        return Err(Failure::usage(why));
    }
    let mut plain = plain.into_iter();
    let method = plain.next().map(|word| {
        solver(word).map_err(|why| {
            wrong(word, format!("{why}; a link or a lesson has no command except compare"))
        })
    });
    let step = plain.next().map(|word| step(word).map_err(|why| wrong(word, why)));
    opening.methods.push((method.transpose()?, step.transpose()?));
    match plain.next() {
        Some(word) => Err(Failure::usage(format!("`{word}` is one word too many"))),
        None => Ok(opening),
    }
}

/// Sets what the option that is being read says.
fn set(opening: &mut Opening, words: &mut Words) -> Result<(), Failure> {
    let (options, manner) = (&mut opening.options, &mut opening.manner);
    match words.option {
        "--scene" => opening.scene = words.read(|name| Ok(name.to_owned()))?,
        "--grid" => options.grid = Some(words.read(grid)?),
        "--wind" => options.on.wind = words.flag()?,
        "--swing" => options.on.swing = words.flag()?,
        "--self-collision" => options.on.contact = words.flag()?,
        // These are the process's, which has its own by now, and a page has one.
        "--threads" => drop(words.read(threads)?),
        "--absolute" => opening.limits.absolute = Some(words.read(absolute)?),
        "--max-step" => opening.limits.max_step = Some(words.read(max_step)?),
        "--springs-of" => manner.springs_of = Some(words.read(particle)?),
        "--wireframe" | "--springs" => drop(words.flag()?),
        "--orthographic" => manner.orthographic = words.flag()?,
        // The last of these counts.
        "--dark" => (manner.dark, opening.light) = (words.flag()?, false),
        "--light" => (manner.dark, opening.light) = (false, words.flag()?),
        "--colour" => manner.colour = words.choose(&Quantity::ALL, Quantity::name)?,
        "--arrows" => manner.arrows = words.choose(&Arrows::ALL, Arrows::name)?,
        "--no-config" => opening.no_settings = words.flag()?,
        "--no-self-collision" => opening.no_contact = words.flag()?,
        "--paused" => opening.paused = words.flag()?,
        "--status" => opening.status = words.flag()?,
        "--watch" => opening.watch = words.flag()?,
        "--resume" => opening.resume = Some(words.read(|path| Ok(path.into()))?),
        option => {
            return Err(Failure::usage(match nearest(option, OPTIONS.split(' ')) {
                Some(name) => format!("there is no option `{option}`; did you mean {name}?"),
                None => format!("there is no option `{option}`"),
            }));
        }
    }
    Ok(())
}
