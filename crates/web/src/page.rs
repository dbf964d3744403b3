//! The program as a web page: the window in a canvas. The query of the address (after its question
//! mark) is a command line without the program's name, with parameters, so that a link shows a run,
//! or a lesson.

use std::panic;
use std::path::Path;

use a3_core::Simulation;
use a3_files::browser::{self, files};
use a3_files::failure::Failure;
use a3_files::progress;
use a3_files::scene_file::Hash;
use a3_studio::address::Address;
use a3_studio::session::{LessonRequest, RunAction, apply, read};
use a3_studio::{Event, Settings, begin, send, spawn};
use wasm_bindgen::prelude::wasm_bindgen;
use web_time::Instant;

/// Starts the run that the address describes, or shows on the page why that is not possible.
#[wasm_bindgen]
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
    let opening = read(&address.words)?;
    let mut session = begin::session(&opening)?;
    let settings = if opening.no_settings || address.embedded {
        None
    } else {
        Settings::read().map_err(|why| browser::log(&why)).ok()
    };
    session.panel.hidden = address.hidden;
    if let Some(names) = address.scenes {
        session.scenes.offer(names);
    }
    if let Some((lesson, step)) = address.lesson {
        session.panel.beside = Some(RunAction::Lessons);
        apply(&mut session, LessonRequest::Open(lesson, step), 0);
    }
    spawn(session, &opening, settings)
}

/// Takes steps of the run that a command line describes, as fast as possible. Returns a hash
/// (FNV-1a) of the bits of positions and velocities, and the time of a step (µs), or an error
/// message.
#[wasm_bindgen]
pub fn run_steps(words: &str, steps: u32) -> String {
    let words: Vec<_> = words.split_whitespace().map(str::to_owned).collect();
    let session = read(&words).and_then(|opening| begin::session(&opening));
    let session = session.map_err(|failure| failure.to_string());
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
#[wasm_bindgen]
pub fn say(words: &str) {
    send(Event::Say(words.into()));
}

/// Stores a file that the scenes of the page may name.
#[wasm_bindgen]
pub fn keep_file(name: &str, bytes: &[u8]) {
    files::keep(Path::new(name), bytes);
}

/// Opens a file that was dropped on the page.
#[wasm_bindgen]
pub fn open_file(name: &str, bytes: &[u8]) {
    files::keep(Path::new(name), bytes);
    send(Event::Open(name.into()));
}
