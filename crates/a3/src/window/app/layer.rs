//! A separate layer for the text on software adapters. They may take as long for the text as for
//! the picture, so the text is not drawn in every frame.

use a3_render::{Gpu, Transfer};
use web_time::{Duration, Instant};

/// Longest time for which a drawn text is reused: numbers cannot be read faster.
const MAX_TEXT_AGE: Duration = Duration::from_millis(100);

/// The layer, and the time when its text must be drawn again.
pub struct Layer {
    pub texture: Transfer,
    due: Option<Instant>,
}

impl Layer {
    /// Creates a layer over a surface, if the adapter needs one.
    pub fn new(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Self> {
        let size = (config.width, config.height);
        gpu.is_software().then(|| Self {
            texture: Transfer::layer(gpu, size, config.format),
            due: None,
        })
    }

    /// Has the text drawn again in the next frame.
    pub fn invalidate(&mut self) {
        self.due = None;
    }

    /// Returns the time for which the text can be reused, if it can.
    pub fn time_left(&self) -> Option<Duration> {
        let left = self.due?.saturating_duration_since(Instant::now());
        (!left.is_zero()).then_some(left)
    }

    /// Notes that the text was drawn, and must be drawn again after `again`, or after
    /// `MAX_TEXT_AGE` if that is sooner.
    pub fn drawn(&mut self, again: Option<Duration>) {
        self.due =
            Some(Instant::now() + again.map_or(MAX_TEXT_AGE, |delay| delay.min(MAX_TEXT_AGE)));
    }
}
