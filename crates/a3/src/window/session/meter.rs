//! A meter of the frame rate, the time per frame, and the speed of the simulation.

use web_time::{Duration, Instant};

/// Real time between two readings (s).
const READING_SECONDS: f32 = 0.5;

/// Frames and times since the last reading.
pub struct Meter {
    begun: Instant,
    frames: u32,
    /// Simulated time (s).
    simulated: f64,
    /// Computing time of steps.
    simulating: Duration,
    /// Time spent on drawing.
    drawing: Duration,
}

/// Means over the frames since the last reading.
pub struct Rates {
    /// Frames per second.
    pub rate: f32,
    /// Simulated time over real time.
    pub factor: f32,
    /// Time a frame spends on steps (ms).
    pub simulating: f32,
    /// Time a frame spends on drawing (ms).
    pub drawing: f32,
}

impl Meter {
    /// Creates a meter that starts now.
    pub fn new() -> Self {
        Self {
            begun: Instant::now(),
            frames: 0,
            simulated: 0.0,
            simulating: Duration::ZERO,
            drawing: Duration::ZERO,
        }
    }

    /// Counts steps that took `simulating` and advanced the runs by `simulated` (s).
    pub fn count_steps(&mut self, simulated: f64, simulating: Duration) {
        self.simulated += simulated;
        self.simulating += simulating;
    }

    /// Counts a frame, and returns a reading twice a second.
    pub fn count_frame(&mut self, drawing: Duration) -> Option<Rates> {
        self.frames += 1;
        self.drawing += drawing;
        let elapsed = self.begun.elapsed().as_secs_f32();
        if elapsed < READING_SECONDS {
            return None;
        }
        let done = std::mem::replace(self, Self::new());
        let frames = done.frames as f32;
        Some(Rates {
            rate: frames / elapsed,
            factor: done.simulated as f32 / elapsed,
            simulating: done.simulating.as_secs_f32() * 1e3 / frames,
            drawing: done.drawing.as_secs_f32() * 1e3 / frames,
        })
    }
}
