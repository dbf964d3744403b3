//! `a3 render`: pictures and films without a window.

use a3_files::failure::Failure;
use a3_files::output;
use a3_files::setup::Run;
use a3_files::{progress, terminal, verdict};
use a3_media::film::{self, FilmOptions};
use a3_media::painter::Painter;
use a3_media::show::{self, Show, check_drawing, check_particle};
use a3_studio::caption;

use crate::cli::Render;

/// Endings of pictures and films.
const ENDINGS: &[&str] = &["png", "gif", "mp4"];

/// Runs the simulation and writes its picture or its film.
pub fn run(options: &Render) -> Result<(), Failure> {
    let (path, size) = (&options.output, options.size);
    output::check_ending(path, ENDINGS)?;
    let Run { request, mut simulation, mut presentation, until } = options.run.prepare(None)?;
    let manner = options.manner.of(options.springs_of);
    check_particle(&simulation, manner.springs_of)?;
    check_drawing(&simulation, manner, false)?;
    output::check(path, ENDINGS)?;
    // There may be no ffmpeg, and the device may not support pictures of this size: both are
    // checked before the work begins.
    let film = film::begin(
        FilmOptions {
            path,
            size,
            rate: options.fps,
            from: options.from,
            transparent: options.transparent,
        },
        until,
    )?;
    let has_camera = request.source.description.camera.is_some();
    if !has_camera && let Ok(run) = simulation.anew(simulation.method(), simulation.control()) {
        show::see_motion(&mut presentation, run, until);
    }
    let mut show = Show::new(presentation, manner);
    show.transparent = options.transparent;
    let caption = caption(&show, size);
    let mut painter = Painter::new(&show, &simulation, size, caption)?;
    if let Some(i) = options.springs_of {
        terminal::say(&show::list_springs_of(&simulation, i))?;
    }
    if let Some(film) = film {
        return film::shoot(&mut simulation, &mut show, &mut painter, film, path);
    }
    progress::advance(&mut simulation, until, |simulation| {
        show.follow(simulation);
    })
    .and_then(|()| simulation.conclude())
    .map_err(|error| verdict::lost(&simulation, &error, "", until))?;
    verdict::warn(&simulation);
    let pixels = painter.draw(&mut show, &simulation)?;
    output::write(path, &output::png(&pixels, size)?)
}
