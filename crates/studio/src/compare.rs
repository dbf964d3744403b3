//! `a3 compare --output`: several methods side by side in a picture.

use std::path::Path;

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::terminal;
use a3_media::painter;
use a3_render::{Gpu, Offscreen};

use crate::begin;
use crate::hud::{Studio, digits};
use crate::session::{Opening, Pane, Session};

/// Default size of a picture (px).
pub const SIZE: (u32, u32) = (1280, 720);

/// Runs the methods until a time (s), and writes their picture of a size (px) and their table.
/// Fails if an option does not fit, the graphics device cannot draw the picture, or a file cannot
/// be written.
pub fn run(
    opening: &Opening,
    path: &Path,
    until: f64,
    size: Option<(u32, u32)>,
) -> Result<(), Failure> {
    let mut session = begin::session(opening)?;
    if opening.paused {
        return Err(Failure::usage(
            "a picture cannot begin paused: leave out --paused, or --output",
        ));
    }
    output::check(path, &["png"])?;
    let gpu = pollster::block_on(Gpu::headless()).map_err(Failure::run)?;
    // The device may not support this size, so check it before the runs.
    let offscreen = Offscreen::new(&gpu, size.unwrap_or(SIZE)).map_err(Failure::usage)?;
    session.run_to(until);
    terminal::say(&table(&session))?;
    output::write(path, &picture(&gpu, offscreen, &mut session)?)
}

/// Returns a table of the methods with the same readings as the picture.
pub fn table(session: &Session) -> String {
    let head =
        "  solver        setting   time [s]    error [m]   evaluations/s   computing [ms/s]\n";
    let lines = session.runs.panes.iter().map(line);
    let readings = &session.readings;
    let why = readings.no_error.map(|why| format!("no errors: {why}\n"));
    let past = |until: &f64| session.runs.first().time() > *until;
    let chaos = readings.predictable.filter(past).map(|until| {
        format!("errors past {until} s say little: small differences have grown 10,000 times\n")
    });
    let rest = lines.chain(why).chain(chaos);
    [head.to_owned()].into_iter().chain(rest).collect()
}

/// Returns the table row of a pane.
fn line(pane: &Pane) -> String {
    let run = &pane.simulation;
    let start = format!("  {:<10}   {:>8}", run.method().name, run.control().value());
    if let Some(blow_up) = run.blow_up() {
        return format!("{start}   {blow_up}\n");
    }
    let number = |number: Option<f64>| number.map_or("-".into(), digits);
    format!(
        "{start}   {:>8.2}   {:>10}   {:>13}   {:>16}\n",
        run.time(),
        number(pane.error),
        number(pane.cost.map(|cost| cost.evaluations)),
        number(pane.cost.map(|cost| cost.computing)),
    )
}

/// Draws the present state of the session as PNG. Fails if drawing or encoding does.
pub fn picture(gpu: &Gpu, offscreen: Offscreen, session: &mut Session) -> Result<Vec<u8>, Failure> {
    let size = offscreen.size();
    // Do not shrink text below its normal size: it would be illegible.
    let scale = painter::scale(size).max(1.0);
    let (panes, readings) = (&mut session.runs.panes, &session.readings);
    let mut studio = Studio::new(gpu, offscreen, panes);
    let pixels = studio.draw(gpu, panes, session.view.camera, scale, readings)?;
    output::png(&pixels, size)
}
