//! Opening a window on one run or several, or running them without one if there is no display.

use std::path::PathBuf;

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::terminal;
use a3_media::show;

use crate::app::{self, End};
use crate::session::{Answerer, Opening};
use crate::settings::Settings;
use crate::{begin, headless, keep};

/// Opens the window, until it is closed. `answerer` answers questions about the scene. Fails if an
/// option does not fit, or with the failure that closed the window.
pub fn open(opening: &Opening, answerer: Answerer) -> Result<(), Failure> {
    let mut session = begin::session(opening)?;
    session.measuring.answerer = Some(answerer);
    // The scene, its meshes and their buffers.
    let files: Vec<PathBuf> = if opening.watch {
        output::files_read()
    } else {
        vec![]
    };
    if let Some(path) = &opening.resume {
        keep::load(&mut session, path)?;
    }
    if let Some(i) = opening.manner.springs_of {
        terminal::say(&show::list_springs_of(session.runs.first(), i))?;
    }
    let settings = if opening.no_settings {
        None
    } else {
        // A file of another program or version is not overwritten.
        Settings::read().map_err(|why| terminal::warn(&why)).ok()
    };
    match app::open(session, opening, files, settings)? {
        End::Closed => Ok(()),
        End::NoWindow(why, session) => headless::run(&why, *session),
    }
}
