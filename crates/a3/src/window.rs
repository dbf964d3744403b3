//! `a3` and `a3 compare` in a window; without a display, its job is done without one.

use std::path::PathBuf;

use crate::app::{self, End};
use crate::cli::{Compare, WindowOptions};
use crate::failure::Failure;
use crate::session::Session;
use crate::{headless, keep, output, setup, show};

/// Opens the window on one run.
pub fn run(options: &WindowOptions) -> Result<(), Failure> {
    let mut session = setup::window(options)?;
    // The scene, its meshes and their buffers.
    let files = if options.watch {
        output::files_read()
    } else {
        vec![]
    };
    if let Some(path) = &options.resume {
        keep::take_up(&mut session, path)?;
    }
    if let Some(i) = options.springs_of {
        output::say(&show::list_springs_of(session.first(), i))?;
    }
    open(session, options.look.status, files)
}

/// Opens the window on several runs.
pub fn compare(options: &Compare) -> Result<(), Failure> {
    open(setup::comparison(options)?, options.look.status, vec![])
}

fn open(session: Session, status: bool, files: Vec<PathBuf>) -> Result<(), Failure> {
    match app::open(session, status, files)? {
        End::Closed => Ok(()),
        End::NoWindow(why, session) => headless::run(&why, *session),
    }
}
