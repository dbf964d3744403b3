//! Largest step of a method on a whole linearised system, by its own steps. Splitting methods carry
//! drag in drifts and the damping of springs in kicks: where damping mixes shapes, their steps do
//! not keep modes apart, and no eigenvalue of the motion tells how they grow.

use nalgebra::Vector3;

use super::limit::{GROWTH, tenfold_time};
use crate::columns::columns_mut;
use crate::coupling::Coupling;
use crate::elements::flow_each;
use crate::error::Error;
use crate::integrators::{Integrator, Method};
use crate::path::Place;
use crate::random::SplitMix;
use crate::system::{Linearized, Mechanics, Splitting, kick_reads_velocity, place_pins};

/// Numbers of steps after which growth is seen, and has to be seen again.
const SEEN: [usize; 2] = [1000, 4000];
/// Number of steps in each of two intervals whose largest states are compared, at the middle and at
/// the end.
const INTERVAL: usize = 100;
/// Length of x from which a system is large.
const LARGE: usize = 300;
/// Number of steps from one look to the next outside these intervals.
const LOOK: usize = 20;
/// Growth between both that is told from the swing of a state that does not grow.
const LEAST: f64 = 1.5;
/// Growth since the beginning that ends the steps: no state swings so much.
const ENOUGH: f64 = 1e8;
/// Ratio of the steps that are tried, from a fraction of the expected limit to a multiple of it:
/// methods of several kicks may fail in a narrow interval of steps and hold again.
const RATIO: f64 = 1.04;
const RANGE: [f64; 2] = [0.25, 32.0];
/// Ratio of two steps that both fail beyond a limit: a narrower interval is a resonance, which no
/// run meets.
const WIDTH: f64 = 1.005;
/// First fraction in a large system, whose steps take long.
const NEAR: f64 = 0.98;
/// Relative precision of the limit.
const PRECISION: f64 = 2e-3;

/// Mechanical system to first order in the distance from positions at which it rests.
pub(super) struct AtRest<'a> {
    mechanics: &'a dyn Linearized,
    x: &'a [f64],
    zero: Vec<f64>,
}

impl<'a> AtRest<'a> {
    pub fn new(mechanics: &'a dyn Linearized, x: &'a [f64]) -> Self {
        Self {
            mechanics,
            x,
            zero: vec![0.0; x.len()],
        }
    }

    /// Largest step of a method, from an expected one (s), where the fastest motion has this
    /// angular frequency (rad/s). It is infinite where no step in reach fails. `None` where the
    /// shortest fail, too: then the motion grows by itself.
    ///
    /// # Errors
    /// The method does not support the system.
    pub fn largest_step(
        &self,
        method: &Method,
        guess: f64,
        fastest: f64,
    ) -> Result<Option<f64>, Error> {
        let mut integrator = method.integrator(self)?;
        // What swings slowly has not grown after more steps.
        let mut grows = |h: f64| {
            SEEN.into_iter().all(|steps| {
                let growth = self.growth(&mut *integrator, (h, steps), fastest);
                growth.ln() * tenfold_time(h) > h * GROWTH.ln()
            })
        };
        let mut fails = |h: f64| grows(h) && grows(WIDTH * h);
        let longest = RANGE[1] * guess;
        let near = self.x.len() > LARGE;
        let mut low = if near { NEAR } else { RANGE[0] } * guess;
        while fails(low) {
            low *= if near { 1.0 / RATIO } else { RANGE[0] };
            if low < 1e-4 * guess {
                return Ok(None);
            }
        }
        let mut high = low * RATIO;
        while !fails(high) {
            (low, high) = (high, high * RATIO);
            if low > longest {
                return Ok(Some(f64::INFINITY));
            }
        }
        if near && (low..high).contains(&guess) {
            return Ok(Some(guess));
        }
        while high > (1.0 + PRECISION) * low {
            let middle = (low * high).sqrt();
            *(if fails(middle) { &mut high } else { &mut low }) = middle;
        }
        Ok(Some(low))
    }

    /// Growth of the energy's root in a step of h (s), from a state that contains all motion, after
    /// so many steps: at least 1, infinite where a step fails.
    fn growth(
        &self,
        integrator: &mut dyn Integrator,
        (h, steps): (f64, usize),
        fastest: f64,
    ) -> f64 {
        let w = self.mechanics.inverse_masses();
        let n = self.x.len();
        let mut random = SplitMix(6);
        let mut y: Vec<_> = (0..2 * n)
            .map(|k| {
                let size = w[k % w.len()].sqrt() / if k < n { fastest } else { 1.0 };
                size * random.between(-1.0, 1.0)
            })
            .collect();
        let mut scratch = vec![0.0; n];
        let begun = self.size(&y, &mut scratch).ln();
        // Logarithms of what the state was divided by, and of its largest sizes.
        let (mut scaled, mut largest) = (0.0, [f64::NEG_INFINITY; 2]);
        for k in 1..=steps {
            if integrator.step(self, 0.0, h, &mut y).is_err() {
                return f64::INFINITY;
            }
            let ends = [steps / 2, steps].map(|end| k + INTERVAL > end && k <= end);
            if k % LOOK != 0 && !ends.contains(&true) {
                continue;
            }
            let now = self.size(&y, &mut scratch);
            if !now.is_finite() {
                return f64::INFINITY;
            }
            if now == 0.0 {
                return 1.0;
            }
            let grown = scaled + now.ln() - begun;
            if grown > ENOUGH.ln() {
                return (grown / k as f64).exp();
            }
            for (largest, seen) in largest.iter_mut().zip(ends) {
                if seen {
                    *largest = largest.max(grown);
                }
            }
            if !(1e-50..1e50).contains(&now) {
                scaled += now.ln();
                for y in &mut y {
                    *y /= now;
                }
            }
        }
        let grown = largest[1] - largest[0];
        if grown < LEAST.ln() {
            return 1.0;
        }
        (grown / (steps / 2) as f64).exp()
    }

    /// Root of twice the energy of a state (J^1/2). Slow motion does not grow by it, how far it
    /// goes.
    fn size(&self, y: &[f64], scratch: &mut [f64]) -> f64 {
        let w = self.mechanics.inverse_masses();
        let (dx, dv) = y.split_at(self.x.len());
        self.force_differential(0.0, self.x, &self.zero, dx, &self.zero, scratch);
        let parts = dx.iter().zip(dv).zip(scratch).enumerate();
        let parts = parts.map(|(k, ((dx, dv), df))| match w[k % w.len()] {
            0.0 => 0.0,
            w => dv * dv / w - dx * *df,
        });
        parts.sum::<f64>().abs().sqrt()
    }
}

impl Mechanics for AtRest<'_> {
    fn inverse_masses(&self) -> &[f64] {
        self.mechanics.inverse_masses()
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.force_differential(t, self.x, &self.zero, x, v, f);
    }

    fn drag_coefficient(&self) -> f64 {
        self.mechanics.drag_coefficient()
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        for (k, w) in self.inverse_masses().iter().enumerate() {
            if *w == 0.0 {
                visit(k, Place::still(Vector3::zeros()));
            }
        }
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        Some(self)
    }
}

impl Splitting for AtRest<'_> {
    fn kick_forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        let drag = self.drag_coefficient();
        self.forces(t, x, v, f);
        for (f, v) in f.iter_mut().zip(v) {
            *f += drag * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        kick_reads_velocity(self.mechanics)
    }

    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let (drag, w) = (self.drag_coefficient(), self.inverse_masses());
        flow_each(drag, Vector3::zeros(), w, h, columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for AtRest<'_> {
    fn force_differential(
        &self,
        t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        self.mechanics
            .force_differential(t, self.x, &self.zero, dx, dv, df);
    }

    fn couplings(&self, t: f64, _x: &[f64], clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        self.mechanics.couplings(t, self.x, clamped, visit);
    }
}
