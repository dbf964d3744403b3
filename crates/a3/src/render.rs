//! `a3 render`: pictures and films without a window.

use crate::cli::Render;
use crate::failure::Failure;
use crate::painter::Painter;
use crate::show::{self, Show};
use crate::{begin, film, output, progress, setup, verdict};

/// Endings of pictures and films.
const ENDINGS: &[&str] = &["png", "gif", "mp4"];

/// Runs the simulation and writes its picture or its film.
pub fn run(options: &Render) -> Result<(), Failure> {
    let (path, size) = (&options.output, options.size);
    output::check_ending(path, ENDINGS)?;
    let (mut simulation, presentation) = setup::simulation(&options.run)?;
    begin::check_particle(&simulation, options.springs_of)?;
    begin::check_drawing(&simulation, options.manner, false)?;
    output::check(path, ENDINGS)?;
    // There may be no ffmpeg, and the device may not support pictures of this size: both are
    // checked before the work begins.
    let film = film::begin(options)?;
    let mut show = Show::new(presentation, options.manner.of(options.springs_of));
    show.transparent = options.transparent;
    let mut painter = Painter::new(&show, &simulation, size)?;
    if let Some(i) = options.springs_of {
        output::say(&show::list_springs_of(&simulation, i))?;
    }
    if let Some(film) = film {
        return film::shoot(&mut simulation, &mut show, &mut painter, film, path);
    }
    let end = options.run.end()?;
    progress::advance(&mut simulation, end, |simulation| {
        show.follow(simulation);
    })
    .and_then(|()| simulation.conclude())
    .map_err(|error| verdict::lost(&simulation, &error, "", end))?;
    verdict::warn(&simulation);
    let pixels = painter.draw(&mut show, &simulation)?;
    output::write(path, &output::png(&pixels, size)?)
}
