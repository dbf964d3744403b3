//! The program as a web page: the window in a canvas. The query of the address (after its question
//! mark) is a command line without the program's name, with parameters, so that a link shows a run,
//! or a lesson.

use std::panic;
use std::path::Path;

use a3_core::Simulation;
use clap::Parser;
use web_time::Instant;

use crate::base::browser::{self, files};
use crate::base::failure::Failure;
use crate::base::progress;
use crate::cli::{self, Cli, Command};
use crate::files::scene_file::Hash;
use crate::window::address::Address;
use crate::window::app;
use crate::window::begin;
use crate::window::hud::lessons;
use crate::window::session::LessonRequest;
use crate::window::settings::Settings;

/// Starts the run that the address describes, or shows on the page why that is not possible.
pub fn start() {
    panic::set_hook(Box::new(|panic| {
        browser::log(&panic.to_string());
        browser::show("a3 has failed; the console of the browser says where. Load the page again.");
    }));
    if let Err(failure) = begin() {
        browser::show(&failure.to_string());
    }
}

fn begin() -> Result<(), Failure> {
    let address = Address::read(browser::words())?;
    let words = ["a3".to_owned()].into_iter().chain(address.words);
    let options = Cli::try_parse_from(words).map_err(|error| match cli::explain(&error, &[]) {
        Err(failure) => failure,
        Ok(()) => Failure::usage(error),
    })?;
    let (mut session, look) = match options.command {
        None => (begin::window(&options.window)?, options.window.look),
        Some(Command::Compare(options)) => (begin::comparison(&options)?, options.look),
        Some(_) => {
            return Err(Failure::usage(
                "a page has no command except compare: the other commands need the program",
            ));
        }
    };
    let settings = if look.no_config || address.embedded {
        None
    } else {
        Settings::read().map_err(|why| browser::log(&why)).ok()
    };
    session.panel.hidden = address.hidden;
    if let Some(names) = address.scenes {
        session.scenes.offer(names);
    }
    if let Some((lesson, step)) = address.lesson {
        session.panel.lessons.open = true;
        lessons::apply(&mut session, LessonRequest::Open(lesson, step));
    }
    app::spawn(session, &look, settings)
}

/// Takes steps of the run that a command line describes, as fast as possible. Returns a hash
/// (FNV-1a) of the bits of positions and velocities, and the time of a step (µs), or an error
/// message.
#[must_use]
pub fn run_steps(words: &str, steps: u32) -> String {
    let words = ["a3"].into_iter().chain(words.split_whitespace());
    let session = Cli::try_parse_from(words)
        .map_err(|why| why.to_string())
        .and_then(|cli| begin::window(&cli.window).map_err(|failure| failure.to_string()));
    let begun = Instant::now();
    let run = session.and_then(|session| {
        let first = session.runs.first();
        let mut run = Simulation::new(first.scene().clone(), first.method(), first.control())
            .map_err(|why| why.to_string())?;
        let until = f64::from(steps) * first.control().value();
        progress::advance(&mut run, until, |_| {}).map_err(|why| why.to_string())?;
        Ok(run)
    });
    let each = 1e6 * begun.elapsed().as_secs_f64() / f64::from(steps);
    match run {
        Ok(run) => {
            let mut hash = Hash::default();
            let velocities = run.velocities();
            let n = run.particles();
            for i in 0..n {
                hash.add(run.position(i).iter().flat_map(|x| x.to_le_bytes()));
            }
            for k in (0..n).flat_map(|i| [i, n + i, 2 * n + i]) {
                hash.add(velocities.get(k).into_iter().flat_map(|v| v.to_le_bytes()));
            }
            format!("{:016x} {each:.1}", hash.value())
        }
        Err(why) => why,
    }
}

/// Shows a message of the page.
pub fn say(words: &str) {
    app::send(app::Event::Say(words.into()));
}

/// Stores a file that the scenes of the page may name.
pub fn keep_file(name: &str, bytes: &[u8]) {
    files::keep(Path::new(name), bytes);
}

/// Opens a file that was dropped on the page.
pub fn open_file(name: &str, bytes: &[u8]) {
    files::keep(Path::new(name), bytes);
    app::send(app::Event::Open(name.into()));
}
