//! Films: pictures of a run, frame by frame, as a GIF, an MP4 or numbered files.

mod gif;
mod mp4;
mod palette;

use std::path::{Path, PathBuf};

use a3_core::Simulation;

use crate::cli::Render;
use crate::failure::Failure;
use crate::frames::{FrameTimes, Sequence};
use crate::painter::Painter;
use crate::progress::{self, Bar};
use crate::session::Ending;
use crate::show::Show;
use crate::{interrupt, output, verdict};

/// Default frames a second: of a GIF, whose delays are whole hundredths of a second, and of others.
const RATE: (f64, f64) = (25.0, 30.0);

/// A film in the making. Its frames are rows from the top, four bytes a pixel.
pub trait Film: Send {
    /// Adds a frame.
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure>;

    /// Completes the film after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}

/// A film, and the times of its frames.
pub type TimedFilm = (FrameTimes, Box<dyn Film>);

/// A film as numbered pictures.
struct Pictures {
    sequence: Sequence,
    size: (u32, u32),
    /// The number of pictures so far.
    count: usize,
}

impl Film for Pictures {
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure> {
        let file = self.sequence.file(self.count);
        self.count += 1;
        output::write(&file, &output::png(pixels, self.size)?)
    }

    fn finish(self: Box<Self>) -> Result<(), Failure> {
        Ok(())
    }
}

/// The film that was asked for, or `None` for a single picture. Impossible films are refused here,
/// before any work is done.
pub fn begin(options: &Render) -> Result<Option<TimedFilm>, Failure> {
    let (path, size) = (options.output.as_path(), options.size);
    let until = options.run.end()?;
    let frames = |rate| FrameTimes::new(options.from.unwrap_or(0.0), until, rate);
    let rate = options.fps.unwrap_or(RATE.1);
    let ends_in = |ending| output::ends_in(path, ending);
    if ends_in("gif") {
        let asked = options.fps.unwrap_or(RATE.0);
        let delay = gif::delay(asked);
        let rate = 100.0 / delay;
        let frames = frames(rate)?;
        let gif = gif::Gif::new(path, size, delay, options.transparent)?;
        if (rate - asked).abs() > 1e-9 {
            output::warn(&format!(
                "the delays of a GIF are whole hundredths of a second, at least 2: the film has {rate:.4} frames per second, not {asked}"
            ));
        }
        return Ok(Some((frames, Box::new(gif))));
    }
    if ends_in("mp4") {
        if options.transparent {
            return Err(Failure::usage(
                "an MP4 cannot be transparent: use a .gif, a .png or a sequence such as film-####.png",
            ));
        }
        return Ok(Some((
            frames(rate)?,
            Box::new(mp4::Mp4::new(path, size, rate)?),
        )));
    }
    if let Some(sequence) = Sequence::of(path) {
        let frames = frames(rate)?;
        sequence.check(frames.count)?;
        let pictures = Pictures {
            sequence,
            size,
            count: 0,
        };
        return Ok(Some((frames, Box::new(pictures))));
    }
    if options.fps.is_some() || options.from.is_some() {
        return Err(Failure::usage(
            "--fps and --from are for films: .gif, .mp4, or a sequence such as film-####.png",
        ));
    }
    Ok(None)
}

/// A film of this size (px) in the working folder, under the first name that is free, and that
/// name.
pub fn begin_new(
    scene: &str,
    ending: Ending,
    size: (u32, u32),
) -> Result<(PathBuf, Box<dyn Film>), Failure> {
    let rate = ending.rate();
    let path = output::free_name(scene, ending.of_files())?;
    let film: Box<dyn Film> = match ending {
        Ending::Gif => Box::new(gif::Gif::new(&path, size, gif::delay(rate), false)?),
        Ending::Mp4 => Box::new(mp4::Mp4::new(&path, size, rate)?),
        Ending::Png => {
            let numbered = Failure::run(format!("{}: no # for numbers", path.display()));
            let sequence = Sequence::of(&path).ok_or(numbered)?;
            Box::new(Pictures {
                sequence,
                size,
                count: 0,
            })
        }
    };
    Ok((path, film))
}

/// Films the run. If it blows up or is interrupted, the frames so far are kept.
pub fn shoot(
    simulation: &mut Simulation,
    show: &mut Show,
    painter: &mut Painter,
    (frames, mut film): TimedFilm,
    path: &Path,
) -> Result<(), Failure> {
    interrupt::listen();
    let bar = Bar::new(frames.count as f64);
    bar.say(format!("up to t = {} s ", frames.from));
    let mut shot = 0;
    let mut end = Ok(true);
    for time in frames.times() {
        end = progress::march(simulation, time, |simulation| {
            show.follow(simulation);
            interrupt::go_on()
        });
        if end == Ok(true) && shot + 1 == frames.count {
            end = simulation.conclude().map(|()| true);
        }
        if end != Ok(true) {
            break;
        }
        if shot == 0 {
            bar.start();
        }
        film.add(&painter.draw(show, simulation)?)?;
        shot += 1;
        bar.say(format!("frame {shot} of {} ", frames.count));
        bar.advance(1.0);
    }
    bar.clear();
    let kept = if shot == 0 {
        "nothing was filmed".to_owned()
    } else {
        interrupt::write_on();
        film.finish()?;
        format!(
            "{} has the first {shot} of {} frames",
            path.display(),
            frames.count
        )
    };
    match end {
        Ok(true) => {
            verdict::warn(simulation);
            Ok(())
        }
        Ok(false) => Err(Failure::Interrupted(format!("interrupted: {kept}"))),
        Err(error) => Err(verdict::lost(simulation, &error, &kept, frames.until)),
    }
}
