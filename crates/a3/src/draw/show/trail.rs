//! The path of a particle so far.

use std::collections::VecDeque;

use a3_render::Line;

/// Largest number of points of a trail.
const MAX_POINTS: usize = 7200;
/// Width of the line (points).
const WIDTH: f32 = 2.2;

/// Points on the path of a particle (m), with their times (s).
#[derive(Clone, Default)]
pub struct Trail(VecDeque<(f64, [f32; 3])>);

impl Trail {
    /// Forgets all points.
    pub fn clear(&mut self) {
        self.0.clear();
    }

    /// Returns the points (m).
    #[cfg(test)]
    pub fn points(&self) -> impl Iterator<Item = &[f32; 3]> {
        self.0.iter().map(|(_, point)| point)
    }

    /// Adds the point (m) where the particle is at `time` (s). Points of later times are dropped,
    /// because the user may have gone back in time.
    pub fn add(&mut self, time: f64, point: [f32; 3]) {
        while self.0.back().is_some_and(|(last, _)| *last > time) {
            self.0.pop_back();
        }
        if self.0.back().map(|(_, last)| last) != Some(&point) {
            self.0.push_back((time, point));
        }
        if self.0.len() > MAX_POINTS {
            self.0.pop_front();
        }
    }

    /// Returns lines along the path up to `time` (s), the older the fainter.
    pub fn lines(&self, time: f64, [r, g, b, _]: [f32; 4]) -> impl Iterator<Item = Line> {
        let n = self.0.partition_point(|(then, _)| *then <= time);
        let points = move || self.0.iter().take(n).map(|(_, point)| *point);
        points()
            .zip(points().skip(1))
            .enumerate()
            .map(move |(k, (from, to))| {
                let age = 1.0 - (k + 1) as f32 / n as f32;
                Line::new(from, to, WIDTH, [r, g, b, 0.12 + 0.8 * (1.0 - age)])
            })
    }
}
