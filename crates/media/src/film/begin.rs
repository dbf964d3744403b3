//! Creation of films, by the ending of the file: as numbered pictures, or in one file.

use std::path::{Path, PathBuf};

use a3_files::ending::Ending;
use a3_files::failure::Failure;
use a3_files::frames::{FrameTimes, Sequence};
use a3_files::output;
use a3_files::terminal;

use super::shoot::{Film, TimedFilm};
use super::{gif, mp4};

/// Default frames per second: of a GIF, whose delays are whole hundredths of a second, and of other
/// films.
const DEFAULT_RATES: (f64, f64) = (25.0, 30.0);

/// Options of a film or of a picture.
#[derive(Clone, Copy, Debug)]
pub struct FilmOptions<'a> {
    /// File, whose ending chooses the format.
    pub path: &'a Path,
    /// Width and height (px).
    pub size: (u32, u32),
    /// Frames per second, `None` for those of the format.
    pub rate: Option<f64>,
    /// Simulated time at which the film begins (s), `None` for 0.
    pub from: Option<f64>,
    /// Whether floor and background are left out.
    pub transparent: bool,
}

/// Creates the film that the options describe, which ends at the time `until` (s); `None` for a
/// single picture. Refuses impossible films before any work is done.
pub fn begin(options: FilmOptions, until: f64) -> Result<Option<TimedFilm>, Failure> {
    let FilmOptions { path, size, .. } = options;
    let frames = |rate| FrameTimes::new(options.from.unwrap_or(0.0), until, rate);
    let rate = options.rate.unwrap_or(DEFAULT_RATES.1);
    let ends_in = |ending| output::ends_in(path, ending);
    if ends_in("gif") {
        let asked = options.rate.unwrap_or(DEFAULT_RATES.0);
        let delay = gif::delay(asked);
        let rate = 100.0 / delay;
        let frames = frames(rate)?;
        let gif = gif::Gif::new(path, size, delay, options.transparent)?;
        if (rate - asked).abs() > 1e-9 {
            terminal::warn(&format!(
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
        return Ok(Some((frames(rate)?, Box::new(mp4::Mp4::new(path, size, rate)?))));
    }
    if let Some(sequence) = Sequence::of(path) {
        let frames = frames(rate)?;
        sequence.check(frames.count)?;
        let pictures = Pictures::new(sequence, size);
        return Ok(Some((frames, Box::new(pictures))));
    }
    if options.rate.is_some() || options.from.is_some() {
        return Err(Failure::usage(
            "--fps and --from are for films: .gif, .mp4, or a sequence such as film-####.png",
        ));
    }
    Ok(None)
}

/// Creates a film of this size (px) in the working folder. Returns it with its name, the first free
/// one.
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
            Box::new(Pictures::new(sequence, size))
        }
    };
    Ok((path, film))
}

/// A film as numbered pictures.
pub struct Pictures {
    sequence: Sequence,
    size: (u32, u32),
    /// Number of pictures so far.
    count: usize,
}

impl Pictures {
    /// Creates a film of pictures of this size (px).
    pub fn new(sequence: Sequence, size: (u32, u32)) -> Self {
        Self { sequence, size, count: 0 }
    }
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
