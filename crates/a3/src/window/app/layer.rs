//! Text on a layer of its own, for software adapters: they may take as long for text as for the
//! picture, so that it is not drawn anew in each frame.

use a3_render::{Gpu, Transfer};
use web_time::{Duration, Instant};

/// Time between two texts while nobody touches anything: faster than numbers can be read.
const MAX_TEXT_AGE: Duration = Duration::from_millis(100);

/// The layer, and when its text has to be drawn anew.
pub struct Layer {
    pub texture: Transfer,
    due: Option<Instant>,
}

impl Layer {
    /// A layer over a surface, if the adapter needs one.
    pub fn new(gpu: &Gpu, config: &wgpu::SurfaceConfiguration) -> Option<Self> {
        let size = (config.width, config.height);
        gpu.is_software().then(|| Self {
            texture: Transfer::layer(gpu, size, config.format),
            due: None,
        })
    }

    /// Has the text drawn anew in the next frame.
    pub fn invalidate(&mut self) {
        self.due = None;
    }

    /// How long the text may stay.
    pub fn time_left(&self) -> Option<Duration> {
        let left = self.due?.saturating_duration_since(Instant::now());
        (!left.is_zero()).then_some(left)
    }

    /// Notes that the text was drawn, and has to be drawn again after this time, if at all.
    pub fn drawn(&mut self, again: Option<Duration>) {
        self.due =
            Some(Instant::now() + again.map_or(MAX_TEXT_AGE, |delay| delay.min(MAX_TEXT_AGE)));
    }
}
