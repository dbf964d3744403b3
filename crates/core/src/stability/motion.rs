//! Scenes in motion: modes along an accurate run, the largest step with which a method's runs stay
//! bounded, and the largest with which they are accurate.
//!
//! A run is *bounded* while its energy exceeds the true one by no more than a few times that of the
//! motion. Near the limit of a symplectic method, the energy of a mode oscillates up to many times
//! its mean, but never grows: this multiple is known (`Growth::swing`) and allowed. A run is
//! *accurate* while its error is below a hundredth of the motion.

use std::cell::RefCell;

use super::limit::{GROWTH, Growth, HORIZON, largest_step};
use super::mode::{Mode, Observation, sort};
use super::search::{Budget, MAX_RUN_WORK, bisect, sharpen, steps, take_checked};
use super::spectrum::spectrum;
use super::stiffness::{accurate, is_stiff};
use crate::control::Control;
use crate::error::Error;
use crate::failure::succeeded;
use crate::integrators::Method;
use crate::network::Network;
use crate::random::SplitMix;
use crate::scene::{Model, Scene};
use crate::simulation::Simulation;

/// Times at which the modes of a scene in motion are computed, as fractions of [`HORIZON`].
const MOMENTS: [f64; 8] = [0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.7, 1.0];
/// Largest number of equal intervals of [`HORIZON`] at whose ends the true motion is stored.
const MAX_INTERVALS: usize = 10_000;
/// Largest number of coordinates that are stored.
const MAX_COORDINATES: usize = 4_000_000;
/// Tolerance of the accurate run.
const TOLERANCE: f64 = 1e-7;
/// Distance of a second accurate run at the start, over the scene's radius.
const SEPARATION: f64 = 1e-7;
/// Growth of that distance up to which errors are compared: beyond it, the motion itself amplifies
/// them.
const MAX_AMPLIFICATION: f64 = 100.0;
/// Largest excess of a bounded run's energy over the true one, as a multiple of the motion's own.
const MAX_EXCESS: f64 = 4.0;
/// Largest factor by which that excess is extended for modes whose energy oscillates.
const MAX_SWING: f64 = 100.0;
/// Relative precision of the largest steps found by runs.
const PRECISION: f64 = 0.02;
/// Largest error of an accurate run, over the size of the motion.
const MAX_ERROR_SHARE: f64 = 0.01;
/// Ratio of two steps, of which one is accurate and one is not, at which the search ends.
const MAX_STEP_RATIO: f64 = 1.1;
/// Approximate number of times at which the error of a run is measured.
const CHECKS: u64 = 100;
/// Largest [work](Model::work) of the accurate run, which ends there.
const MAX_TRUE_WORK: f64 = 5e7;
/// Largest [work](Model::work) of the long runs, which are shortened if necessary.
const MAX_LONG_WORK: f64 = 5e6;
/// Length of the runs that check whether a limit is sharp, as a multiple of that of the others.
const LONG_RUN_FACTOR: u64 = 10;

/// True motion of a scene from its start, by an accurate run of [`HORIZON`].
#[derive(Clone)]
pub struct Motion {
    scene: Scene,
    /// Modes at several times of the motion, in one list, fastest first: stretched and folded
    /// springs have other modes than those at the start.
    pub modes: Vec<Mode>,
    /// Time (s) until which errors are meaningful: [`HORIZON`], or the time at which a small
    /// difference at the start has grown a hundredfold.
    pub predictable: f64,
    /// Largest root mean square distance of the particles from their start (m) within the
    /// predictable time.
    size: f64,
    /// Largest total energy, and the excess over it at which a run is not bounded (J); for a
    /// first-order scene, the largest norm of its state, and the excess over that.
    most: [f64; 2],
    /// Interval (s) between the stored states.
    interval: f64,
    /// Positions (m) and velocities (m/s) at the ends of these intervals, within the predictable
    /// time.
    states: Vec<(Vec<f64>, Vec<f64>)>,
}

impl Motion {
    /// Computes the motion of a scene. Returns `None` soon after `go_on` returns false.
    ///
    /// # Errors
    /// The scene cannot be run.
    pub fn of(scene: &Scene, go_on: impl Fn() -> bool) -> Result<Option<Self>, Error> {
        let Some((is_stiff, _)) = is_stiff(scene, HORIZON, TOLERANCE, &go_on)? else {
            return Ok(None);
        };
        let accurate = accurate(is_stiff)?;
        let start = |scene| Simulation::new(scene, accurate, Control::Tolerance(TOLERANCE));
        let mut run = start(scene.clone())?;
        let n = scene.model.coordinates();
        let mut beside = start(disturbed(scene, SEPARATION * run.extent().1))?;
        let count = MAX_INTERVALS.min(MAX_COORDINATES / (2 * n)).max(50);
        let interval = HORIZON / count as f64;
        let mut moments = MOMENTS.map(|part| (part * count as f64).round() as usize).into_iter();
        let mut moment = moments.next();
        let first = distance(&run.state()[..n], &beside.state()[..n]);
        let mut motion = Self {
            scene: scene.clone(),
            modes: vec![],
            predictable: HORIZON,
            size: 0.0,
            most: [f64::NEG_INFINITY, 0.0],
            interval,
            states: vec![],
        };
        let mut kinetic: f64 = 0.0;
        for k in 0..=count {
            if !go_on() {
                return Ok(None);
            }
            let time = k as f64 * interval;
            let costs_too_much = run.work().total() * scene.model.work() > MAX_TRUE_WORK;
            if costs_too_much || !succeeded(run.advance_to(time))? {
                motion.predictable = motion.predictable.min(time - interval);
                break;
            }
            if moment == Some(k) {
                motion.modes.extend(spectrum(run.model().system(), time, run.state()));
                moment = moments.next();
            }
            let level = level(&run);
            motion.most[0] = motion.most[0].max(level);
            kinetic = kinetic.max(run.energy().map_or(level, |energy| energy.kinetic));
            if motion.predictable < HORIZON {
                // Only the energy and the modes are still needed.
                continue;
            }
            motion.states.push((run.state()[..n].to_vec(), run.velocities()));
            motion.size = motion.size.max(distance(&run.state()[..n], &scene.state[..n]));
            let apart = if succeeded(beside.advance_to(time))? {
                distance(&run.state()[..n], &beside.state()[..n])
            } else {
                f64::INFINITY
            };
            if apart > MAX_AMPLIFICATION * first {
                motion.predictable = time;
            }
        }
        // A scene at rest has no motion of its own to compare growth with.
        kinetic = kinetic.max(1e-6 * motion.most[0].abs()).max(f64::MIN_POSITIVE);
        motion.most[1] = match scene.model {
            Model::Network(_) => MAX_EXCESS * kinetic,
            Model::FirstOrder(_) | Model::Points(_) => (GROWTH - 1.0) * kinetic,
        };
        // The fastest set most limits.
        sort(&mut motion.modes);
        Ok(Some(motion))
    }

    /// Finds the largest step with which a method's runs from the start stay bounded.
    ///
    /// Runs last for [`HORIZON`] and [`STEPS`](super::STEPS) steps at least. The search begins at
    /// the limit of the modes. Runs ten times as long, with steps a tenth shorter and a tenth
    /// longer, check whether the limit is sharp, and so do runs with steps down to half of it. If
    /// it is not, or if that of the modes is not, runs from half the limit to twice it, and with
    /// steps down to half of the shortest that failed, find the interval in which some hold and
    /// some fail. `None` if the runs would take too long, and soon after `go_on` returns false.
    ///
    /// # Errors
    /// The method does not support the scene.
    pub fn bounded(
        &self,
        method: &'static Method,
        budget: &Budget,
        go_on: impl Fn() -> bool,
    ) -> Result<Option<Observation>, Error> {
        let work = self.scene.model.work();
        let limit = largest_step(method, &self.modes)?;
        let expected = limit.map_or(1.0, |limit| limit.step);
        let mut moving = vec![];
        for mode in self.modes.iter().filter(|m| m.returns() && expected.is_finite()) {
            moving.push(Growth::new(method, *mode)?);
        }
        let moving = RefCell::new(moving);
        let holds = |h: f64, times: u64| {
            let swing = |growth: &mut Growth| growth.swing(h);
            let swings = moving.borrow_mut().iter_mut().map(swing).fold(1.0, f64::max);
            let most = self.most[0] + self.most[1] * swings.min(MAX_SWING);
            let count = budget.room(method, &self.scene.model, steps(h, expected));
            let cost = count as f64 * work * f64::from(method.evaluations);
            let affordable = (MAX_LONG_WORK / cost).max(1.0) as u64;
            let run = Simulation::new(self.scene.clone(), method, Control::Step(h))?;
            let mut run = run.tolerate_gains();
            let held = take_checked(count * times.min(affordable.max(1)), |count| {
                let holds = budget.take(&mut run, count).filter(|_| go_on())?;
                Some(holds && level(&run) < most)
            });
            budget.check().map(|()| held)
        };
        let mut seen = bisect(expected, work, PRECISION, false, |h| holds(h, 1))?;
        let sharp = limit.is_none_or(|limit| limit.is_sharp());
        if let Some(seen) = seen.as_mut().filter(|seen| !seen.is_open() && !budget.limits()) {
            *seen = sharpen(*seen, sharp, (LONG_RUN_FACTOR, PRECISION), holds)?;
        }
        Ok(seen.filter(|_| go_on()))
    }

    /// Finds the largest step (s) up to `longest` with which the error of a run is below a
    /// hundredth of the motion: the root mean square distance of the particles from their true
    /// positions, over the largest from their start, within the predictable time. If the budget is
    /// spent, the step is accurate, but may not be the largest. `None` if nothing moves, if the
    /// runs would take too long, and soon after `go_on` returns false.
    ///
    /// # Errors
    /// The method does not support the scene.
    pub fn accurate(
        &self,
        method: &'static Method,
        longest: f64,
        budget: &Budget,
        go_on: impl Fn() -> bool,
    ) -> Result<Option<f64>, Error> {
        // A step of a small scene, or one that solves equations, costs more than its particles.
        let implicit_factor = if method.is_implicit() { 30.0 } else { 1.0 };
        let work = self.scene.model.work().max(20.0);
        let shortest = self.predictable * work * implicit_factor / MAX_RUN_WORK;
        if self.size == 0.0 {
            return Ok(None);
        }
        let order = f64::from(method.order);
        // After any error beyond this, the next step is the same: a fifth.
        let most = 0.9 * 5f64.powf(order);
        let mut high = (longest.min(0.25 * self.predictable), f64::INFINITY);
        let mut low = high;
        loop {
            if low.0 < shortest || !go_on() {
                return Ok(None);
            }
            let Some(error) = self.error(method, low.0, most, budget)? else {
                return Ok(None);
            };
            low.1 = error;
            if low.1 <= 1.0 {
                break;
            }
            high = low;
            // The error is about a power of the step.
            low.0 *= (0.9 / low.1).powf(1.0 / order).clamp(0.2, 0.95);
        }
        while high.0 > MAX_STEP_RATIO * low.0 {
            // By the same power between two errors, but such that one more run may be the last.
            let gap = (high.0 / low.0).ln();
            let part = low.1.ln() / (low.1 / high.1).ln();
            let known = low.1 > 0.0 && high.1.is_finite();
            let part = if known { part } else { 0.5 };
            let edge = 0.99 * MAX_STEP_RATIO.ln();
            let middle = low.0 * (gap * part).clamp(edge, (gap - edge).max(edge)).exp();
            // The search ends if this run fails, however large its error is.
            let most = if middle <= MAX_STEP_RATIO * low.0 { 1.0 } else { most };
            let error = self.error(method, middle, most, budget)?;
            let Some(error) = error.filter(|_| go_on()) else {
                break;
            };
            *(if error <= 1.0 { &mut low } else { &mut high }) = (middle, error);
        }
        Ok(Some(low.0).filter(|_| go_on()))
    }

    /// Returns the largest error of a run in whole steps of about h (s) within the predictable
    /// time, over the allowed one; infinite if the run fails. The run ends once its error exceeds
    /// `most`. `None` if the budget is spent.
    fn error(
        &self,
        method: &'static Method,
        h: f64,
        most: f64,
        budget: &Budget,
    ) -> Result<Option<f64>, Error> {
        let count = (self.predictable / h).ceil().max(1.0);
        let h = self.predictable / count;
        let mut run = Simulation::new(self.scene.clone(), method, Control::Step(h))?;
        let (mut left, mut error) = (count as u64, 0.0f64);
        let stride = (left / CHECKS).max(1);
        while left > 0 && error <= most {
            let steps = stride.min(left);
            match budget.take(&mut run, steps) {
                None => return budget.check().map(|()| None),
                Some(false) => return Ok(Some(f64::INFINITY)),
                Some(true) => {}
            }
            left -= steps;
            let truth = self.at(run.time());
            let apart = distance(&run.state()[..truth.len()], &truth);
            error = error.max(apart / (MAX_ERROR_SHARE * self.size));
        }
        Ok(Some(error))
    }

    /// Returns the true positions (m) at a time (s), by a cubic polynomial between the stored
    /// states.
    fn at(&self, time: f64) -> Vec<f64> {
        let place = (time / self.interval).max(0.0);
        let k = (place as usize).min(self.states.len() - 2);
        let s = place - k as f64;
        let [(xa, va), (xb, vb)] = [k, k + 1].map(|k| &self.states[k]);
        let weights = [
            (1.0 + 2.0 * s) * (1.0 - s).powi(2),
            s * (1.0 - s).powi(2) * self.interval,
            s * s * (3.0 - 2.0 * s),
            s * s * (s - 1.0) * self.interval,
        ];
        (0..xa.len())
            .map(|i| {
                let values = [xa[i], va[i], xb[i], vb[i]];
                weights.iter().zip(values).map(|(w, y)| w * y).sum()
            })
            .collect()
    }
}

/// Returns the scene with its free particles displaced by up to this distance (m); without
/// particles, with its numbers changed by up to that.
fn disturbed(scene: &Scene, size: f64) -> Scene {
    let mut scene = scene.clone();
    let mut random = SplitMix(2);
    for k in 0..scene.model.coordinates() {
        let shift = size * random.between(-1.0, 1.0);
        let pinned = |network: &Network| network.is_pinned(k % network.particles());
        if !scene.model.network().is_some_and(pinned) {
            scene.state[k] += shift;
        }
    }
    scene
}

/// Returns the total energy of a run (J), or the norm of the state of a first-order scene.
fn level(run: &Simulation) -> f64 {
    let norm = || run.state().iter().map(|y| y * y).sum::<f64>().sqrt();
    run.energy().map_or_else(norm, |energy| energy.total())
}

/// Returns the root mean square distance of particles in two lists of positions (m).
fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares = a.iter().zip(b).map(|(a, b)| (a - b).powi(2));
    (3.0 * squares.sum::<f64>() / a.len() as f64).sqrt()
}
