//! A thread that encodes frames.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Sender, channel};
use std::thread::{self, JoinHandle};

use a3_files::failure::Failure;
use a3_media::film::Film;

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
        Self {
            frames,
            waiting,
            thread,
        }
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

    /// Returns whether the thread has ended, which it does early only after a failure.
    pub fn has_failed(&self) -> bool {
        self.thread.is_finished()
    }

    /// Waits until all frames are encoded and the film is complete. Fails if the encoder did.
    pub fn finish(self) -> Result<(), Failure> {
        drop(self.frames);
        let ended = self.thread.join();
        ended.unwrap_or_else(|_| Err(Failure::run("the film could not be encoded")))
    }
}
