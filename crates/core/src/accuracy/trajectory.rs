//! States of a reference at the frames and between them, against which errors are taken.

use super::frames::Frames;
use super::run::EnclosingStep;
use super::snapshot::{Errors, Scope, Snapshot};
use crate::scene::Model;

/// Number of frames through which a state between them is interpolated.
const NODES: u64 = 4;

/// States at each frame.
pub(super) struct Trajectory {
    pub snapshots: Vec<Snapshot>,
    /// Tolerance of their run.
    pub tolerance: f64,
    /// Largest mean square speed in the scope (m2/s2).
    square_speed: f64,
}

impl Trajectory {
    pub fn new(snapshots: Vec<Snapshot>, tolerance: f64, scope: Scope) -> Self {
        let speeds = snapshots.iter().map(|s| s.square_speed(scope));
        Self { square_speed: speeds.fold(f64::MIN_POSITIVE, f64::max), snapshots, tolerance }
    }

    /// Returns the errors of a snapshot at frame k, counted from 1.
    pub fn errors(&self, k: u64, other: &Snapshot, scope: Scope) -> Errors {
        self.errors_of(&self.snapshots[k as usize - 1], other, scope)
    }

    /// Returns a snapshot of a model at time t (s), interpolated.
    pub fn at(&self, start: (&Snapshot, Frames), model: &Model, t: f64) -> Snapshot {
        Snapshot::interpolated(model, &self.around(start, t), t)
    }

    /// Returns the coordinates of a model (m) and their rates of change (m/s) at time t (s).
    pub fn motion(&self, start: (&Snapshot, Frames), model: &Model, t: f64) -> [Vec<f64>; 2] {
        let (first, frames) = start;
        let k = (t / frames.spacing()).round() as u64;
        match k.min(frames.count) {
            0 if t <= 0.0 => first.motion(),
            k if k > 0 && t == frames.time(k) => self.snapshots[k as usize - 1].motion(),
            _ => self.at(start, model, t).motion(),
        }
    }

    /// Returns the errors at the nearest end of the step of a model that encloses frame k, counted
    /// from 1. Those of contact are unknown there, and infinite. The error of the positions is at
    /// least that of interpolating the frame from the exact states at both ends of the step.
    pub fn errors_between(
        &self,
        (start, frames): (&Snapshot, Frames),
        (model, k, step): (&Model, u64, &EnclosingStep),
        scope: Scope,
    ) -> Errors {
        let at = |t: f64| self.at((start, frames), model, t);
        let (t, y) = step.nearest;
        let mut errors = self.errors_of(&at(t), &Snapshot::between_frames(model, t, y), scope);
        if step.times[1] - step.times[0] > frames.spacing() {
            let [begin, end] = step.times.map(|t| (t, at(t)));
            let told = [(begin.0, &begin.1), (end.0, &end.1)];
            let told = Snapshot::interpolated(model, &told, frames.time(k));
            let told = self.errors(k, &told, scope);
            errors.position = errors.position.max(told.position);
            errors.state = errors.state.max(told.state);
        }
        Errors { penetration: f64::INFINITY, impact: f64::INFINITY, ..errors }
    }

    /// Returns the times (s) and snapshots of the frames nearest to a time t (s).
    fn around<'a>(
        &'a self,
        (start, frames): (&'a Snapshot, Frames),
        t: f64,
    ) -> Vec<(f64, &'a Snapshot)> {
        let before = (t / frames.spacing()) as u64;
        let last = (frames.count + 1).saturating_sub(NODES);
        let nearest = before.saturating_sub(1).min(last)..=frames.count;
        let known = nearest.take(NODES as usize).map(|k| match k {
            0 => (0.0, start),
            k => (frames.time(k), &self.snapshots[k as usize - 1]),
        });
        known.collect()
    }

    /// Returns the errors of a snapshot against another that is exact.
    pub fn errors_of(&self, exact: &Snapshot, other: &Snapshot, scope: Scope) -> Errors {
        let errors = exact.errors_of(other, scope);
        Errors { phase: errors.phase / self.square_speed, ..errors }
    }
}
