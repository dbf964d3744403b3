//! Opening a window on one run or several. Without a display, its substitute: ten simulated
//! seconds, a line for each of them, and a final picture.

use std::path::PathBuf;

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::{output, progress, terminal, verdict};
use a3_media::show;
use a3_render::{Gpu, Offscreen};

use crate::app::{self, End};
use crate::compare::{self, SIZE};
use crate::session::{Answerer, Opening, Pane, Session};
use crate::settings::Settings;
use crate::{begin, keep};

/// Opens the window, until it is closed. `answerer` answers questions about the scene. Fails if an
/// option does not fit, or with the failure that closed the window.
pub fn open(opening: &Opening, answerer: Answerer) -> Result<(), Failure> {
    let mut session = begin::session(opening)?;
    session.measuring.answerer = Some(answerer);
    // The scene, its meshes and their buffers.
    let files: Vec<PathBuf> = if opening.watch { output::files_read() } else { vec![] };
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
    terminal::tell_notes();
    match app::open(session, opening, files, settings)? {
        End::Closed => Ok(()),
        End::NoWindow(why, session) => run_headless(&why, *session),
    }
}

/// Simulated time of the run (s).
const SIMULATED_SECONDS: u32 = 10;

/// Warns that there is no window because of `why`, then simulates and draws without one. Fails if
/// the run blows up or a file cannot be written.
fn run_headless(why: &str, mut session: Session) -> Result<(), Failure> {
    terminal::warn(&format!("{why}: simulating {SIMULATED_SECONDS} seconds without a window."));
    if let Some(said) = &session.readings.message {
        terminal::warn(said);
    }
    let scene = session.runs.first().scene().name.clone();
    if session.runs.panes.len() > 1 {
        session.run_to(f64::from(SIMULATED_SECONDS));
        terminal::say(&compare::table(&session))?;
    } else {
        simulate(&mut session.runs.panes[0])?;
    }
    match pollster::block_on(Gpu::headless()) {
        Ok(gpu) => {
            let offscreen = Offscreen::new(&gpu, SIZE).map_err(Failure::run)?;
            let picture = compare::picture(&gpu, offscreen, &mut session)?;
            let path = output::write_new("".as_ref(), &scene, "png", &picture)?;
            terminal::say(&format!("picture: {}\n", path.display()))?;
        }
        Err(why) => terminal::warn(&format!("no picture: {why}")),
    }
    Ok(())
}

/// Simulates, and prints a line for each simulated second.
fn simulate(pane: &mut Pane) -> Result<(), Failure> {
    let Pane { simulation, show, .. } = pane;
    terminal::say("  time [s]   energy [J]   lowest [m]   stretch\n")?;
    terminal::say(&line(simulation))?;
    for second in 1..=SIMULATED_SECONDS {
        progress::advance(simulation, f64::from(second), |simulation| {
            show.follow(simulation);
        })
        .and_then(|()| if second == SIMULATED_SECONDS { simulation.conclude() } else { Ok(()) })
        .map_err(|error| verdict::lost(simulation, &error, "", f64::from(SIMULATED_SECONDS)))?;
        terminal::say(&line(simulation))?;
    }
    verdict::warn(simulation);
    Ok(())
}

/// Returns the line for the present state.
fn line(simulation: &Simulation) -> String {
    let number = |value: Option<f64>, digits: usize| {
        value.map_or("-".into(), |value| format!("{value:.digits$}"))
    };
    format!(
        "  {:>8.2}   {:>10}   {:>10.4}   {:>7}\n",
        simulation.time(),
        number(simulation.energy().map(|energy| energy.total()), 4),
        simulation.lowest(),
        number(simulation.largest_stretch(), 3),
    )
}
