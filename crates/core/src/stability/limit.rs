//! Largest steps by linear theory, at which no mode grows, and at which none grows tenfold. A mode
//! is a system that any method can step.

use nalgebra::Vector3;

use super::mode::Mode;
use crate::columns::columns_mut;
use crate::coupling::{AxialCoupling, Coupling};
use crate::elements::Flow;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::{Integrator, Method};
use crate::path::Place;
use crate::spring::SpringLaw;
use crate::system::{Compliant, Linearized, Mechanics, Splitting, place_pins};

/// Shortest time (s) in which, at the step that counts as the limit, no mode may grow more than
/// [`GROWTH`] times.
pub const HORIZON: f64 = 10.0;
/// Least number of steps in which no mode may grow more than [`GROWTH`] times at that step.
pub const STEPS: f64 = 1000.0;
/// Growth beyond which a step counts as unstable.
pub const GROWTH: f64 = 10.0;

/// Growth of a mode in a step, less 1, that may be rounding.
const ROUNDING: f64 = 1e-12;
/// Largest growth, less 1, just above the first growing step, at which growth counts as beginning
/// smoothly.
const MAX_SMOOTH_GROWTH: f64 = 1e-6;
/// Least ratio of both steps of a limit that counts as sharp.
const MIN_SHARP_RATIO: f64 = 0.98;

/// Largest steps of a method by the modes of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    /// Largest step (s) up to which no mode grows at all: 0 if a mode grows at every step, infinite
    /// if none grows at any.
    pub bounded: f64,
    /// Step (s) at which a mode grows [`GROWTH`] times in the time of [`tenfold_time`]; infinite
    /// where none does. Modes grow more slowly between `bounded` and this step.
    pub step: f64,
    /// Index of the mode that sets `step`.
    pub mode: usize,
}

impl Limit {
    /// Returns whether modes grow fast as soon as they grow at all: both steps are nearly the same.
    #[must_use]
    pub fn is_sharp(&self) -> bool {
        self.step.is_infinite() || self.bounded > MIN_SHARP_RATIO * self.step
    }
}

/// Returns the time (s) in which no mode may grow more than [`GROWTH`] times in steps of h (s): the
/// longer of [`HORIZON`] and [`STEPS`] steps.
#[must_use]
pub fn tenfold_time(h: f64) -> f64 {
    HORIZON.max(STEPS * h)
}

/// Finds the largest steps of a method with which no mode grows, and with which none grows tenfold;
/// all shorter steps are as good. Modes that fall, buckle or flutter with any method are left out.
/// `None` if no mode is left, or if the method takes no steps.
///
/// # Errors
/// The method does not support a mechanical system with drag and damping as in these modes.
pub fn largest_step(method: &Method, modes: &[Mode]) -> Result<Option<Limit>, Error> {
    let mut limit: Option<Limit> = None;
    if method.is_foreign() {
        return Ok(limit);
    }
    let judged = modes.iter().map(Mode::judged).enumerate();
    for (k, mode) in judged.filter_map(|(k, mode)| Some((k, mode?))) {
        let mut growth = Growth::new(method, mode)?;
        // Rate of the fastest motion, by stiffness or by damping.
        let rate = mode.frequency().max(mode.drag + mode.damping);
        let so_far =
            limit.unwrap_or(Limit { bounded: f64::INFINITY, step: f64::INFINITY, mode: k });
        // The search is fine for the first mode. Other modes rarely lower the limit.
        let ratio = if limit.is_none() { 1.05 } else { 1.25 };
        let tenfold = |h: f64| growth.of_step(h).ln() * tenfold_time(h) > h * GROWTH.ln();
        let longest = so_far.step.min(1e4 / rate);
        let found = first(tenfold, 1e-3 / rate, longest, ratio);
        let (step, mode) = found.map_or((so_far.step, so_far.mode), |step| (step, k));
        let bounded = if step.is_finite() {
            let longest = so_far.bounded.min(step);
            beginning(&mut growth, rate, longest, ratio).map_or(longest, |bounded| {
                // Growth at very short steps only is rounding of the damping.
                if bounded < 1e-4 * step { 0.0 } else { bounded }
            })
        } else {
            f64::INFINITY
        };
        growth.check()?;
        limit = Some(Limit { bounded, step, mode });
    }
    Ok(limit)
}

/// Finds the largest h below which `fails` is false, from trials at `h`, at steps that grow by
/// `ratio` up to `longest`, and at `longest`; `None` if none fails.
fn first(mut fails: impl FnMut(f64) -> bool, mut h: f64, longest: f64, ratio: f64) -> Option<f64> {
    let mut below = 0.0;
    while h < longest && !fails(h) {
        below = h;
        h *= ratio;
    }
    let above = h.min(longest);
    (h < longest || fails(longest)).then(|| between(fails, [below, above]))
}

/// Finds the largest h at which `fails` is false, between a step at which it is and one at which it
/// is not.
fn between(mut fails: impl FnMut(f64) -> bool, [mut low, mut high]: [f64; 2]) -> f64 {
    for _ in 0..50 {
        let middle = f64::midpoint(low, high);
        if fails(middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}

/// Finds the step (s) from which on a mode of this rate (1/s) grows: 0 if it grows at every step,
/// `None` if it does not grow up to `longest` (s).
///
/// Growth of an undamped mode by a method of high order begins so smoothly that rounding hides it
/// at short steps. Such a mode grows at every step, unless it decays at a shorter one.
fn beginning(growth: &mut Growth, rate: f64, longest: f64, ratio: f64) -> Option<f64> {
    let mut start = 1e-3 / rate;
    // Lightly damped modes decay at very short steps only.
    while start > 1e-8 / rate && growth.of_step(start) > 1.0 + ROUNDING {
        start *= 0.1;
    }
    let mut decays = false;
    let grows = |h: f64| {
        let excess = growth.of_step(h) - 1.0;
        decays |= excess < -ROUNDING;
        excess > ROUNDING
    };
    let begins = first(grows, start, longest, ratio)?;
    let hidden = !decays && growth.of_step(begins * 1.05) - 1.0 < MAX_SMOOTH_GROWTH;
    Some(if hidden { 0.0 } else { begins })
}

/// Growth of a mode in one step of a method.
///
/// Explicit Euler lets an undamped mode of frequency w grow by the root of 1 + (h w)^2 in a step,
/// and symplectic Euler not at all up to h w = 2:
///
/// ```
/// use a3_core::integrators;
/// use a3_core::stability::{Growth, Mode};
///
/// let mode = Mode { stiffness: 4.0, ..Mode::default() };
/// let growth = |name: &str, h: f64| -> Result<f64, a3_core::Error> {
///     let method = integrators::find(name).unwrap();
///     Ok(Growth::new(method, mode)?.of_step(h))
/// };
/// assert!((growth("euler", 0.1)? - 1.04_f64.sqrt()).abs() < 1e-15);
/// assert!((growth("symplectic", 0.99)? - 1.0).abs() < 1e-12);
/// assert!(growth("symplectic", 1.01)? > 1.3);
/// # Ok::<(), a3_core::Error>(())
/// ```
pub struct Growth {
    system: Tied,
    integrator: Box<dyn Integrator>,
    /// Failure of a callback in a step, if there was one.
    failure: Option<Error>,
}

impl Growth {
    /// Creates the growth of `mode` by `method`.
    ///
    /// # Errors
    /// The method does not support damped springs, which damp the mode.
    pub fn new(method: &Method, mode: Mode) -> Result<Self, Error> {
        let system = Tied { mode, is_linearized: !method.plain_only() };
        let integrator = method.integrator(&system)?;
        Ok(Self { system, integrator, failure: None })
    }

    /// Checks that no callback has failed in a step.
    ///
    /// # Errors
    /// That failure.
    pub(super) fn check(&mut self) -> Result<(), Error> {
        self.failure.take().map_or(Ok(()), Err)
    }

    /// Returns the matrix of a step of h (s) on x times the frequency and on v: a, b, c, d, row by
    /// row. `None` if the step fails.
    fn matrix(&mut self, h: f64) -> Option<[f64; 4]> {
        let mut y = [0.0; 18];
        // Particle 0 starts with x = 1, particle 1 with v = `unit`: v is scaled by the frequency,
        // so that x and v have similar magnitudes.
        let unit = self.system.mode.frequency().max(1e-3);
        (y[0], y[10]) = (1.0, unit);
        let stepped = self.integrator.step(&self.system, 0.0, h, &mut y);
        let stepped = succeeded(stepped).unwrap_or_else(|failure| {
            self.failure = Some(failure);
            false
        });
        let matrix = [y[0], y[1], y[9] / unit, y[10] / unit];
        (stepped && matrix.iter().all(|m| m.is_finite())).then_some(matrix)
    }

    /// Returns the spectral radius of the matrix of a step of h (s); for a Runge-Kutta method, the
    /// larger |R(h l)| of both eigenvalues l. It is infinite if the step fails.
    pub fn of_step(&mut self, h: f64) -> f64 {
        let Some([a, b, c, d]) = self.matrix(h) else {
            return f64::INFINITY;
        };
        let (half_trace, determinant) = (0.5 * (a + d), a * d - b * c);
        let square = half_trace * half_trace - determinant;
        let radius =
            if square < 0.0 { determinant.sqrt() } else { half_trace.abs() + square.sqrt() };
        if radius.is_nan() { f64::INFINITY } else { radius }
    }

    /// Returns the ratio of the largest to the smallest energy of a mode in steps of h (s), without
    /// growth and decay, and relative to that of the exact motion.
    ///
    /// Steps move (x w, v) round an ellipse, c x^2 + (d - a) x v - b v^2 = const. The result is the
    /// squared ratio of its axes over that of the exact motion, (1 + z) / (1 - z) with the damping
    /// ratio z. It is 1 for a Runge-Kutta method; for Verlet's method without damping it is
    /// 1 / (1 - (h w)^2 / 4), which is unbounded at the limit. The result is also 1 if the step
    /// fails or its matrix has real eigenvalues.
    pub fn swing(&mut self, h: f64) -> f64 {
        let Some([a, b, c, d]) = self.matrix(h) else {
            return 1.0;
        };
        let determinant = -b * c - 0.25 * (d - a).powi(2);
        if determinant <= 0.0 {
            return 1.0;
        }
        let half = 0.5 * (c - b).abs();
        let root = (half * half - determinant).max(0.0).sqrt();
        let Mode { drag, damping, .. } = self.system.mode;
        let ratio = 0.5 * (drag + damping) / self.system.mode.frequency();
        let own = ((1.0 + ratio) / (1.0 - ratio)).max(1.0);
        ((half + root) / (half - root) / own).max(1.0)
    }
}

/// Mode as a mechanical system along one axis: particles 0 and 1, of unit mass, are each tied to
/// particle 2, which is pinned at the origin.
struct Tied {
    mode: Mode,
    /// Whether it offers the differential of its forces.
    is_linearized: bool,
}

impl Mechanics for Tied {
    fn inverse_masses(&self) -> &[f64] {
        &[1.0, 1.0, 0.0]
    }

    fn forces(&self, t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        self.kick_forces(t, x, v, f);
        for (f, v) in f.iter_mut().zip(v) {
            *f -= self.mode.drag * v;
        }
    }

    fn drag_coefficient(&self) -> f64 {
        self.mode.drag
    }

    fn pins(&self, _t: f64, visit: &mut dyn FnMut(usize, Place)) {
        visit(2, Place::still(Vector3::zeros()));
    }

    fn splitting(&self) -> Option<&dyn Splitting> {
        Some(self)
    }

    fn linearized(&self) -> Option<&dyn Linearized> {
        self.is_linearized.then_some(self as &dyn Linearized)
    }

    fn compliant(&self) -> Option<&dyn Compliant> {
        Some(self)
    }
}

impl Compliant for Tied {
    fn springs(&self, visit: &mut dyn FnMut([usize; 2], SpringLaw)) {
        let law = SpringLaw {
            stiffness: self.mode.stiffness,
            rest_length: 0.0,
            damping: self.mode.damping,
        };
        visit([0, 2], law);
        visit([1, 2], law);
    }

    fn other_forces(&self, _t: f64, _x: &[f64], _v: &[f64], f: &mut [f64]) {
        f.fill(0.0);
    }
}

impl Splitting for Tied {
    fn kick_forces(&self, _t: f64, x: &[f64], v: &[f64], f: &mut [f64]) {
        for ((f, x), v) in f.iter_mut().zip(x).zip(v) {
            *f = -self.mode.stiffness * x - self.mode.damping * v;
        }
    }

    fn kick_reads_velocity(&self) -> bool {
        self.mode.reads_velocity || self.mode.damping != 0.0
    }

    fn drift(&self, t: f64, h: f64, x: &mut [f64], v: &mut [f64]) {
        let flow = Flow::new(self.mode.drag, Vector3::zeros(), 1.0, h);
        flow.apply(columns_mut(x), columns_mut(v));
        place_pins(self, t + h, x, v);
    }
}

impl Linearized for Tied {
    fn force_differential(
        &self,
        t: f64,
        _x: &[f64],
        _v: &[f64],
        dx: &[f64],
        dv: &[f64],
        df: &mut [f64],
    ) {
        self.forces(t, dx, dv, df);
    }

    fn couplings(&self, _t: f64, _x: &[f64], _clamped: bool, visit: &mut dyn FnMut(Coupling)) {
        for i in 0..2 {
            visit(Coupling::Axial(AxialCoupling {
                i,
                j: 2,
                direction: [1.0, 0.0, 0.0],
                along: self.mode.stiffness,
                across: self.mode.stiffness,
                damping: self.mode.damping,
            }));
        }
    }
}
