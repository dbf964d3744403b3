//! Opening `a3` and `a3 compare` in a window, or running them without one if there is no display.

use std::path::PathBuf;

use crate::base::failure::Failure;
use crate::base::terminal;
use crate::cli::{Compare, Look, WindowOptions};
use crate::draw::show;
use crate::files::output;
use crate::window::app::{self, End};
use crate::window::session::{Answerer, Session};
use crate::window::settings::Settings;
use crate::window::{begin, headless, keep};

/// Opens the window on one run, until it is closed. `answerer` answers questions about the scene.
/// Fails if an option does not fit, or with the failure that closed the window.
pub fn run(options: &WindowOptions, answerer: Answerer) -> Result<(), Failure> {
    let mut session = begin::window(options)?;
    session.measuring.answerer = Some(answerer);
    // The scene, its meshes and their buffers.
    let files = if options.watch {
        output::files_read()
    } else {
        vec![]
    };
    if let Some(path) = &options.resume {
        keep::load(&mut session, path)?;
    }
    if let Some(i) = options.springs_of {
        terminal::say(&show::list_springs_of(session.runs.first(), i))?;
    }
    open(session, &options.look, files)
}

/// Opens the window on several runs, until it is closed. Fails as [`run`] does.
pub fn compare(options: &Compare, answerer: Answerer) -> Result<(), Failure> {
    let mut session = begin::comparison(options)?;
    session.measuring.answerer = Some(answerer);
    open(session, &options.look, vec![])
}

fn open(session: Session, look: &Look, files: Vec<PathBuf>) -> Result<(), Failure> {
    let settings = if look.no_config {
        None
    } else {
        // A file of another program or version is not overwritten.
        Settings::read().map_err(|why| terminal::warn(&why)).ok()
    };
    match app::open(session, look, files, settings)? {
        End::Closed => Ok(()),
        End::NoWindow(why, session) => headless::run(&why, *session),
    }
}
