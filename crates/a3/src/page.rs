//! The program as a page of the web: the window in a canvas. What comes after the question mark of
//! the address is a command line without the program's name, so that a link shows a run.

use std::panic;
use std::path::Path;

use clap::Parser;

use crate::app;
use crate::begin;
use crate::browser::{self, files};
use crate::cli::{self, Cli, Command};
use crate::failure::Failure;
use crate::session::Action;
use crate::settings::Settings;

/// Begins what the address asks for; where that is not possible, the page says why.
pub fn start() {
    panic::set_hook(Box::new(|panic| {
        browser::log(&panic.to_string());
        browser::show("a3 has failed; the console of the browser says where. Load the page again.");
    }));
    if let Err(failure) = begin() {
        browser::show(&failure.message());
    }
}

fn begin() -> Result<(), Failure> {
    let words = ["a3".to_owned()].into_iter().chain(browser::words());
    let options = Cli::try_parse_from(words).map_err(|error| match cli::explain(&error) {
        Err(failure) => failure,
        Ok(()) => Failure::usage(error),
    })?;
    let (session, look) = match options.command {
        None => (begin::window(&options.window)?, options.window.look),
        Some(Command::Compare(options)) => (begin::comparison(&options)?, options.look),
        Some(_) => {
            return Err(Failure::usage(
                "a page has no commands but compare: the program has them",
            ));
        }
    };
    let settings = if look.no_config {
        None
    } else {
        Settings::read().map_err(|why| browser::log(&why)).ok()
    };
    app::spawn(session, look.status, settings)
}

/// Does what key Tab does, which leaves a page.
pub fn toggle_panel() {
    app::send(app::Event::Act(Action::Panel));
}

/// Opens a file that was dropped on the page.
pub fn open_file(name: &str, bytes: &[u8]) {
    files::keep(Path::new(name), bytes);
    app::send(app::Event::Open(name.into()));
}
