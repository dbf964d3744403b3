//! References that have states at the times of files.

use a3_core::Scene;
use a3_core::accuracy::{Frames, Horizon, Reference, Scope};
use a3_core::stability::{Mode, spectrum};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;

use super::grid::gcd;
use super::rows::Rows;
use crate::chart::measure::{precision, reference};

/// Largest number of coordinates in all frames of a reference.
const MAX_NUMBERS: f64 = 2e6;
/// Number of frames in a radian of the fastest mode, between which states are interpolated: eight
/// data in four frames then err by 1e-12 of its amplitude.
const FRAMES_PER_RADIAN: f64 = 10.0;
/// Least number of frames in a second.
const MIN_RATE: f64 = 60.0;
/// Largest error of a time at which it is that of a frame, relative to it.
const TOLERANCE: f64 = 1e-9;

/// The motion of a scene, as it is known.
pub struct Truth<'a> {
    scene: &'a Scene,
    monitor: &'a dyn Monitor,
    /// Largest distance of the particles from where they start (m).
    motion: f64,
    references: Vec<Reference>,
}

impl<'a> Truth<'a> {
    pub fn new(scene: &'a Scene, horizon: &Horizon, monitor: &'a dyn Monitor) -> Self {
        Self {
            scene,
            monitor,
            motion: horizon.motion,
            references: vec![],
        }
    }

    /// Returns the reference with states at the times of rows. `None` if the monitor stopped it.
    pub fn at(&mut self, rows: &Rows) -> Result<Option<&Reference>, Failure> {
        let known = self.references.iter().position(|known| serves(known, rows));
        if let Some(known) = known {
            return Ok(Some(&self.references[known]));
        }
        let frames = self.frames(rows).map_err(Failure::usage)?;
        let precision = precision(self.scene, self.motion);
        let Some(made) = reference(
            &|| self.monitor.go_on(),
            self.scene,
            frames,
            Scope::default(),
            precision,
        )?
        else {
            return Ok(None);
        };
        self.references.push(made);
        Ok(self.references.last())
    }

    /// Frames at the times of rows or, if there is no such grid, so close together that states
    /// between them are interpolated accurately.
    fn frames(&self, rows: &Rows) -> Result<Frames, String> {
        let until = rows.until();
        let most = MAX_NUMBERS / (3.0 * self.scene.model.particles().max(1) as f64);
        if let Some(grid) = &rows.grid {
            let part = grid.numbers.iter().copied().fold(0, gcd);
            let last = grid.numbers[grid.numbers.len() - 1];
            let count = last / part.max(1);
            if count as f64 <= most {
                return Ok(Frames { until, count });
            }
        }
        let modes = spectrum(self.scene.model.system(), 0.0, &self.scene.state);
        let fastest = modes.first().map_or(0.0, Mode::frequency);
        let rate = (FRAMES_PER_RADIAN * fastest).max(MIN_RATE);
        let count = (rate * until).ceil().max(4.0);
        if count > most {
            return Err(if rows.grid.is_some() {
                format!(
                    "{until} s of it are too many states of {} particles: write fewer, or judge less with --until",
                    self.scene.model.particles()
                )
            } else {
                format!(
                    "its times are not equally spaced, and {until} s are too long to interpolate between them: write \
                     states at equal distances, or judge less with --until"
                )
            });
        }
        Ok(Frames {
            until,
            count: count as u64,
        })
    }
}

/// Returns whether a reference has states at the times of rows.
fn serves(reference: &Reference, rows: &Rows) -> bool {
    let all = rows.times.iter();
    all.into_iter().all(|t| frame_at(reference, *t).is_some())
}

/// Returns the time (s) of the frame at a time t (s).
pub fn frame_at(reference: &Reference, t: f64) -> Option<f64> {
    let frames = &reference.frames;
    let k = (t / frames.spacing()).round() as u64;
    let time = (k <= frames.count).then(|| frames.time(k))?;
    ((t - time).abs() <= TOLERANCE * t).then_some(time)
}
