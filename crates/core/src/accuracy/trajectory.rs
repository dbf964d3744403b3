//! States of a reference at the frames and between them, which errors are taken from.

use super::Frames;
use super::errors::{Errors, Scope, Snapshot};
use crate::scene::Model;

/// Number of frames through which a state between them is interpolated.
const NODES: u64 = 4;

/// States at each frame.
pub(super) struct Trajectory {
    pub snapshots: Vec<Snapshot>,
    /// Largest mean square speed in the scope (m2/s2).
    square_speed: f64,
}

impl Trajectory {
    pub fn new(snapshots: Vec<Snapshot>, scope: Scope) -> Self {
        let speeds = snapshots.iter().map(|s| s.square_speed(scope));
        Self {
            square_speed: speeds.fold(f64::MIN_POSITIVE, f64::max),
            snapshots,
        }
    }

    /// Errors of a snapshot at frame k, counted from 1.
    pub fn errors(&self, k: u64, other: &Snapshot, scope: Scope) -> Errors {
        self.errors_of(&self.snapshots[k as usize - 1], other, scope)
    }

    /// Errors of the state y of a model at time t (s) between frames: those of contact are
    /// infinite, since they are not known there.
    pub fn errors_between(
        &self,
        (start, frames): (&Snapshot, Frames),
        (model, t, y): (&Model, f64, &[f64]),
        scope: Scope,
    ) -> Errors {
        let before = (t / frames.spacing()) as u64;
        let first = before
            .saturating_sub(1)
            .min((frames.count + 1).saturating_sub(NODES));
        let known: Vec<_> = (first..=frames.count)
            .take(NODES as usize)
            .map(|k| match k {
                0 => (0.0, start),
                k => (frames.time(k), &self.snapshots[k as usize - 1]),
            })
            .collect();
        let exact = Snapshot::interpolated(model, &known, t);
        Errors {
            penetration: f64::INFINITY,
            impact: f64::INFINITY,
            ..self.errors_of(&exact, &Snapshot::between_frames(model, t, y), scope)
        }
    }

    fn errors_of(&self, exact: &Snapshot, other: &Snapshot, scope: Scope) -> Errors {
        let errors = exact.errors_of(other, scope);
        Errors {
            phase: errors.phase / self.square_speed,
            ..errors
        }
    }
}
