//! The substitute for a window without a display: ten simulated seconds, a line for each of them,
//! and a final picture.

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::{progress, terminal, verdict};
use a3_render::{Gpu, Offscreen};

use crate::compare::{self, SIZE};
use crate::session::{Pane, Session};

/// Simulated time of the run (s).
const SIMULATED_SECONDS: u32 = 10;

/// Warns that there is no window because of `why`, then simulates and draws without one. Fails if
/// the run blows up or a file cannot be written.
pub fn run(why: &str, mut session: Session) -> Result<(), Failure> {
    terminal::warn(&format!(
        "{why}: simulating {SIMULATED_SECONDS} seconds without a window."
    ));
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
    let Pane {
        simulation, show, ..
    } = pane;
    terminal::say("  time [s]   energy [J]   lowest [m]   stretch\n")?;
    terminal::say(&line(simulation))?;
    for second in 1..=SIMULATED_SECONDS {
        progress::advance(simulation, f64::from(second), |simulation| {
            show.follow(simulation);
        })
        .and_then(|()| {
            if second == SIMULATED_SECONDS {
                simulation.conclude()
            } else {
                Ok(())
            }
        })
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
