//! First impact of a run: the times at which surfaces first touch, and at which nothing touches any
//! more.
//!
//! Both times are found on cubic polynomials through the positions and velocities of two frames.
//! They are functions of these states alone, the same for every method, so their errors fall with
//! the order of the method. A touch that begins and ends between two frames is not detected.

use crate::contact::ContactLayer;

/// Times of the first impact; one that has not begun or ended yet has the time of the state.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Impact {
    /// Time of the state (s).
    t: f64,
    /// Time at which surfaces touched first, and time at which nothing touched any more (s).
    times: [f64; 2],
}

impl Impact {
    /// Creates the impact of a run that starts at time t (s).
    pub fn at_start(t: f64) -> Self {
        Self { t, times: [t; 2] }
    }

    /// Returns the impact at time t (s), if nothing begins or ends until then.
    pub fn later(&self, t: f64) -> Self {
        let times = self.times.map(|time| if time < self.t { time } else { t });
        Self { t, times }
    }

    /// Returns the impact at time t (s), if nothing moves until then, and surfaces touch or do not.
    pub fn still(&self, t: f64, touch: bool) -> Self {
        let mut later = self.later(t);
        if touch {
            later.times[0] = later.times[0].min(self.t);
        }
        later
    }

    /// Returns the impact at time t (s). `ends` are the positions (m) and velocities (m/s) of the
    /// state before and now, and `touch` tells whether surfaces touch then and now.
    pub fn next(
        &self,
        layer: &ContactLayer,
        t: f64,
        ends: [[&[f64]; 2]; 2],
        touch: [bool; 2],
    ) -> Self {
        let mut next = self.still(t, touch[0]);
        let ended = next.times[1] < t;
        if touch[0] == touch[1] || ended {
            return next;
        }
        let mut x = vec![0.0; ends[0][0].len()];
        let (mut low, mut high) = (0.0, 1.0);
        // Until both times agree to double precision.
        for _ in 0..50 {
            let middle = f64::midpoint(low, high);
            between(ends, t - self.t, middle, &mut x);
            let at = self.t + middle * (t - self.t);
            if (layer.penetration(at, &x) > 0.0) == touch[0] {
                low = middle;
            } else {
                high = middle;
            }
        }
        next.times[usize::from(touch[0])] = self.t + low * (t - self.t);
        next
    }

    /// Returns the larger difference (s) between the times of two impacts.
    pub fn error_of(&self, other: &Self) -> f64 {
        let [begins, ends] = [0, 1].map(|k| (self.times[k] - other.times[k]).abs());
        begins.max(ends)
    }

    /// Applies a function to both times of two runs.
    pub fn extrapolate(coarse: &Self, fine: &Self, both: impl Fn(&f64, &f64) -> f64) -> Self {
        let times = [0, 1].map(|k| both(&coarse.times[k], &fine.times[k]));
        Self { t: fine.t, times }
    }
}

/// Writes the positions (m) at a fraction s of the time (s) between two states to x.
fn between([[xa, va], [xb, vb]]: [[&[f64]; 2]; 2], time: f64, s: f64, x: &mut [f64]) {
    let r = 1.0 - s;
    let [a, b] = [(1.0 + 2.0 * s) * r * r, (1.0 + 2.0 * r) * s * s];
    let [va_weight, vb_weight] = [s * r * r * time, -s * s * r * time];
    for (k, x) in x.iter_mut().enumerate() {
        *x = a * xa[k] + b * xb[k] + va_weight * va[k] + vb_weight * vb[k];
    }
}
