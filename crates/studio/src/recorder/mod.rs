//! Films of a session: of its last seconds, or live from now on. At most one film frame is drawn
//! after each frame of the window, and a thread encodes the film frames.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::{self, JoinHandle};

use a3_core::{Checkpoint, Simulation};
use a3_files::failure::Failure;
use a3_media::film::{self, Film};
use a3_render::{Camera, Gpu, Offscreen};

use crate::hud::Studio;
use crate::session::{FilmProgress, Pane, Readings, Session};

/// Size of the window's picture (px), and its pixels per point.
type Picture = ((u32, u32), f32);

/// A film in the making.
pub struct Recorder {
    studio: Studio,
    encoder: Encoder,
    path: PathBuf,
    /// Pixels per point.
    scale: f32,
    source: Source,
    /// Number of frames drawn so far.
    drawn: usize,
    /// Frames in a second.
    rate: f64,
}

/// The source of the frames.
enum Source {
    /// The session: `next` is the time of the next frame on its clock (s), `interval` the time
    /// between two frames of the film (s).
    Session { next: f64, interval: f64 },
    /// Moments of the timeline, restored into copies of the runs.
    Past {
        panes: Vec<Pane>,
        camera: Camera,
        moments: std::vec::IntoIter<Vec<Option<Checkpoint>>>,
        count: usize,
    },
}

impl Recorder {
    /// Creates a live film of the session, whose picture in the window has a size (px) and a number
    /// of pixels per point. Fails if its file or its picture cannot be created.
    pub fn from_now(gpu: &Gpu, session: &Session, picture: Picture) -> Result<Self, Failure> {
        let interval = 1.0 / session.panel.film.rate();
        let next = session.runs.clock;
        Self::new(gpu, session, picture, Source::Session { next, interval })
    }

    /// Creates a film of the last seconds, as many as the panel sets. Fails if the timeline has
    /// fewer than two moments, or as [`Self::from_now`] does.
    pub fn of_past(gpu: &Gpu, session: &Session, picture: Picture) -> Result<Self, Failure> {
        let (seconds, interval) = (session.panel.film_seconds, 1.0 / session.panel.film.rate());
        let moments = session.timeline.last(seconds, interval);
        if moments.len() < 2 {
            return Err(Failure::run("There is nothing to film yet."));
        }
        let copy = |pane: &Pane| {
            let run = &pane.simulation;
            let mut copy = Simulation::new(run.scene().clone(), run.method(), run.control())?;
            // A diverged run has no moments: its copy shows its last state.
            copy.restore(&run.moment())?;
            Ok(Pane::new(copy, pane.show.clone()))
        };
        let panes: Result<_, a3_core::Error> = session.runs.panes.iter().map(copy).collect();
        let source = Source::Past {
            panes: panes.map_err(Failure::run)?,
            camera: session.view.camera,
            count: moments.len(),
            moments: moments.into_iter(),
        };
        Self::new(gpu, session, picture, source)
    }

    fn new(
        gpu: &Gpu,
        session: &Session,
        (size, scale): Picture,
        source: Source,
    ) -> Result<Self, Failure> {
        let ending = session.panel.film;
        let within = ending.fit(size);
        let (path, film) = film::begin_new(&session.runs.first().scene().name, ending, within)?;
        let offscreen = Offscreen::new(gpu, within).map_err(Failure::run)?;
        Ok(Self {
            studio: Studio::new(gpu, offscreen, &session.runs.panes),
            encoder: Encoder::new(film),
            path,
            scale: scale * within.1 as f32 / size.1 as f32,
            source,
            drawn: 0,
            rate: ending.rate(),
        })
    }

    /// Returns whether the film is live.
    pub fn is_live(&self) -> bool {
        matches!(self.source, Source::Session { .. })
    }

    /// Returns the real time (s) by which the session may advance in a window frame of `real` (s):
    /// a live film stops it at the next frame of the film, and does not advance it while the
    /// encoder is full.
    pub fn time_to_advance(&self, session: &Session, real: f64) -> f64 {
        match self.source {
            Source::Session { .. } if !self.encoder.has_room() => 0.0,
            Source::Session { next, .. } => {
                let left = (next - session.runs.clock).max(0.0);
                real.min(left * 2f64.powi(session.readings.slowness))
            }
            Source::Past { .. } => real,
        }
    }

    /// Draws the next frame if it is due and the encoder has room. Returns whether more frames
    /// follow. Fails if the device cannot draw.
    pub fn draw_next(&mut self, gpu: &Gpu, session: &mut Session) -> Result<bool, Failure> {
        // The thread ends early only after a failure.
        if self.encoder.thread.is_finished() {
            return Ok(false);
        }
        if !self.encoder.has_room() {
            return Ok(true);
        }
        let readings = Readings::default();
        let pixels = match &mut self.source {
            Source::Session { next, interval } => {
                let apart = *interval * 0.5f64.powi(session.readings.slowness);
                // After going back or a reset, film the state that is shown.
                if session.runs.clock < *next - apart - 1e-9 {
                    *next = session.runs.clock;
                }
                if session.runs.clock < *next - 1e-9 {
                    return Ok(true);
                }
                *next += apart;
                let camera = session.view.camera;
                let panes = &mut session.runs.panes;
                self.studio.draw(gpu, panes, camera, self.scale, &readings)?
            }
            Source::Past { panes, camera, moments, .. } => {
                let Some(moment) = moments.next() else {
                    return Ok(false);
                };
                for (pane, moment) in panes.iter_mut().zip(&moment) {
                    // The checkpoint is of this scene, so it fits.
                    let _ = moment.as_ref().map(|moment| pane.simulation.restore(moment));
                    let energy = pane.simulation.energy();
                    pane.energy = energy.map(|energy| energy.total());
                }
                self.studio.draw(gpu, panes, *camera, self.scale, &readings)?
            }
        };
        self.encoder.add(pixels);
        self.drawn += 1;
        Ok(true)
    }

    /// Returns the progress of the film.
    pub fn progress(&self) -> FilmProgress {
        let path = self.path.display();
        let said = match &self.source {
            Source::Session { .. } => {
                let seconds = self.drawn as f64 / self.rate;
                format!("recording {path}: {seconds:.1} s")
            }
            Source::Past { count, .. } => {
                format!("writing {path}: {} %", 100 * self.drawn / count)
            }
        };
        FilmProgress { live: self.is_live(), said }
    }

    /// Completes the film, and returns a message about it. Fails if it could not be written.
    pub fn finish(self) -> Result<String, Failure> {
        let (path, seconds) = (self.path.display(), self.drawn as f64 / self.rate);
        if self.drawn == 0 {
            return Ok(format!("{path}: nothing was filmed"));
        }
        self.encoder.finish()?;
        Ok(format!("wrote {path}: {} frames, {seconds:.1} s", self.drawn))
    }
}

/// Largest number of frames that wait or are being encoded.
const MAX_WAITING_FRAMES: usize = 8;

/// An encoder of frames, on its own thread, in the order in which they are added.
pub struct Encoder {
    frames: Sender<Vec<u8>>,
    /// Number of frames that wait or are being encoded.
    waiting: Arc<AtomicUsize>,
    thread: JoinHandle<Result<(), Failure>>,
}

impl Encoder {
    pub fn new(mut film: Box<dyn Film + Send>) -> Self {
        let (frames, taken) = channel::<Vec<u8>>();
        let waiting = Arc::new(AtomicUsize::new(0));
        let encoded = waiting.clone();
        let thread = thread::spawn(move || {
            for pixels in taken {
                film.add(&pixels)?;
                encoded.fetch_sub(1, Ordering::Relaxed);
            }
            film.finish()
        });
        Self { frames, waiting, thread }
    }

    /// Returns whether fewer frames wait than the limit.
    pub fn has_room(&self) -> bool {
        self.waiting.load(Ordering::Relaxed) < MAX_WAITING_FRAMES
    }

    /// Adds a frame: rows from the top, four bytes per pixel. Frames after a failure are dropped.
    pub fn add(&self, pixels: Vec<u8>) {
        self.waiting.fetch_add(1, Ordering::Relaxed);
        let _ = self.frames.send(pixels);
    }

    /// Waits until all frames are encoded and the film is complete. Fails if the encoder did.
    pub fn finish(self) -> Result<(), Failure> {
        drop(self.frames);
        let ended = self.thread.join();
        ended.unwrap_or_else(|_| Err(Failure::run("the film could not be encoded")))
    }
}
