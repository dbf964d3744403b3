//! The interface of all film formats, and the filming of a run, from its first frame to its last.

use std::path::Path;

use a3_core::Simulation;
use a3_files::bar::Bar;
use a3_files::failure::Failure;
use a3_files::frames::FrameTimes;
use a3_files::progress;
use a3_files::{interrupt, verdict};

use crate::painter::Painter;
use crate::show::Show;

/// A film that is being written. Frames are rows from the top, four bytes a pixel.
pub trait Film: Send {
    /// Adds a frame.
    fn add(&mut self, pixels: &[u8]) -> Result<(), Failure>;

    /// Completes the film after its last frame.
    fn finish(self: Box<Self>) -> Result<(), Failure>;
}

/// A film, and the times of its frames.
pub type TimedFilm = (FrameTimes, Box<dyn Film>);

/// Films the run. If it blows up or is interrupted, the film keeps the frames so far.
pub fn shoot(
    simulation: &mut Simulation,
    show: &mut Show,
    painter: &mut Painter,
    (frames, mut film): TimedFilm,
    path: &Path,
) -> Result<(), Failure> {
    interrupt::listen();
    let bar = Bar::new(frames.count as f64);
    bar.say(&format!("up to t = {} s ", frames.from));
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
        bar.say(&format!("frame {shot} of {} ", frames.count));
        bar.advance(1.0);
    }
    bar.clear();
    let kept = if shot == 0 {
        "nothing was filmed".to_owned()
    } else {
        interrupt::write_on();
        film.finish()?;
        format!("{} has the first {shot} of {} frames", path.display(), frames.count)
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
