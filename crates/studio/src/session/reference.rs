//! The reference: a hidden, more accurate run, from which the errors of the panes are measured,
//! and the time until which these errors are meaningful, found in the background.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, OnceLock};
use std::thread::{self, JoinHandle};

use a3_core::accuracy::horizon;
use a3_core::{Control, Error, Method, Progress, Scene, Simulation, integrators};
use a3_files::failure::Failure;
use a3_files::progress;
use web_time::{Duration, Instant};

use super::pane::{ADAPTIVE_SLICE, Pane};

/// Largest number of consecutive frames for which the reference may be late; then it is stopped.
const MAX_LATE_FRAMES: u32 = 30;

/// A run of the panes' scene that is much more accurate, with the same interaction.
pub struct ReferenceRun {
    /// The run, even if it was stopped.
    pub simulation: Simulation,
    /// Search for the time until which errors are meaningful, from the initial state of the scene.
    predictability: Predictability,
    /// Number of consecutive frames in which the reference was late.
    late: u32,
    /// Reason why the reference was stopped, if it was.
    pub stopped: Option<&'static str>,
}

/// Returns the method and tolerance of the reference: 1e-10, or 1e-4 times the tightest tolerance
/// of the panes if that is less.
fn method_and_control(panes: &[Pane]) -> (&'static Method, Control) {
    let method = integrators::find("dop853").unwrap_or(&integrators::METHODS[0]);
    let tolerances = panes.iter().filter_map(|pane| pane.simulation.control().tolerance());
    let tightest = tolerances.fold(1e-6, f64::min);
    (method, Control::Tolerance((1e-4 * tightest).max(1e-13)))
}

impl ReferenceRun {
    /// Creates a reference for several panes in their initial state; `None` for a single pane.
    /// Fails if the scene cannot be simulated.
    pub fn new(panes: &[Pane]) -> Result<Option<Self>, Failure> {
        let [first, _, ..] = panes else {
            return Ok(None);
        };
        let (method, control) = method_and_control(panes);
        let run = &first.simulation;
        let mut scene = run.scene().clone();
        scene.limits.absolute = None;
        let predictability = Predictability::new(scene.clone());
        let mut simulation = Simulation::new(scene, method, control).map_err(Failure::run)?;
        let disturbed = simulation.set_disturbances(run.disturbances());
        disturbed.map_err(Failure::run)?;
        Ok(Some(Self { simulation, predictability, late: 0, stopped: None }))
    }

    /// Adapts the tolerance to changed methods or steps of the panes.
    pub fn adapt(&mut self, panes: &[Pane]) {
        let (method, control) = method_and_control(panes);
        // The method can integrate every scene, so this does not fail.
        if self.simulation.control() != control {
            let _ = self.simulation.set_method(method, control);
        }
    }

    /// Returns the run, unless it was stopped.
    pub fn run(&mut self) -> Option<&mut Simulation> {
        Some(&mut self.simulation).filter(|_| self.stopped.is_none())
    }

    /// Replaces the run by one of a changed scene with the same particles, which goes on from the
    /// same state, and returns the former run. The search for the time until which errors are
    /// meaningful starts again.
    pub fn exchange(&mut self, simulation: Simulation) -> Simulation {
        self.predictability = Predictability::new(simulation.scene().clone());
        std::mem::replace(&mut self.simulation, simulation)
    }

    /// Continues from the state of a run.
    pub fn continue_from(&mut self, run: &Simulation) -> Result<(), Failure> {
        continue_from(&mut self.simulation, run).map_err(Failure::run)
    }

    /// Returns the time past which errors say little (s), if one is known.
    pub fn predictable(&self) -> Option<f64> {
        self.predictability.until()
    }

    /// Resets the run to the initial state, and restarts it if it was stopped.
    pub fn reset(&mut self) {
        self.simulation.reset();
        (self.late, self.stopped) = (0, None);
    }

    /// Advances to exactly `time` (s) within `budget` of real time, and returns whether it got
    /// there.
    pub fn reach(&mut self, time: f64, budget: Duration) -> bool {
        let begun = Instant::now();
        let run = &mut self.simulation;
        let mut result = Ok(());
        while result.is_ok() && run.time() < time {
            if begun.elapsed() >= budget {
                return false;
            }
            result = run.advance_to((run.time() + ADAPTIVE_SLICE).min(time));
        }
        if result.is_err() {
            self.stop("the reference blew up");
        }
        self.stopped.is_none()
    }

    /// Stops the run: errors are unknown from now on.
    pub fn stop(&mut self, why: &'static str) {
        self.stopped = Some(why);
    }

    /// Catches up with the panes in the order of their times, within `budget` of real time, and
    /// measures their errors. The rest is left for the next frame; a reference that is late for too
    /// many frames is stopped.
    pub fn follow(&mut self, panes: &mut [Pane], budget: Duration) {
        if self.stopped.is_none() {
            let begun = Instant::now();
            let mut runs: Vec<_> = panes.iter_mut().filter(|pane| pane.alive()).collect();
            runs.sort_by(|a, b| a.simulation.time().total_cmp(&b.simulation.time()));
            let mut kept_up = true;
            for pane in runs {
                let time = pane.simulation.time();
                // A pane with long steps may be behind the reference: its error was measured
                // before.
                if time < self.simulation.time() - 1e-9 {
                    continue;
                }
                kept_up = self.reach(time, budget.saturating_sub(begun.elapsed()));
                if !kept_up {
                    break;
                }
                pane.set_errors(differences(&pane.simulation, &self.simulation));
            }
            self.late = if kept_up { 0 } else { self.late + 1 };
            if self.late > MAX_LATE_FRAMES {
                self.stop("the reference is too slow");
            }
        }
        for pane in panes.iter_mut() {
            if self.stopped.is_some() || !pane.alive() {
                pane.set_errors(vec![]);
            }
        }
        // A common scale makes the colours of the panes comparable.
        let errors = panes.iter().map(|pane| pane.show.colouring.largest_error());
        let largest = errors.fold(0.0, f64::max);
        for pane in panes {
            pane.show.colouring.beside = largest;
        }
    }

    /// Advances to exactly `time` (s), however long that takes, and measures the errors of the
    /// panes there.
    pub fn run_to(&mut self, time: f64, panes: &mut [Pane]) {
        // `follow` handles a blow-up, by calling `reach`.
        let _ = progress::advance(&mut self.simulation, time, |_| {});
        self.follow(panes, Duration::MAX);
        self.predictability.wait();
    }
}

/// Returns the displacements of the particles of `a` from those of `b` (m), n x 3.
fn differences(a: &Simulation, b: &Simulation) -> Vec<f64> {
    let all = a.state().iter().zip(b.state());
    all.take(3 * a.particles()).map(|(a, b)| a - b).collect()
}

/// A search, on its own thread, for the time past which errors say little: small differences have
/// grown 10,000 times by then.
#[derive(Default)]
pub struct Predictability {
    /// The time (s) once it is known; infinite if the scene is not chaotic.
    until: Arc<OnceLock<f64>>,
    ended: Arc<AtomicBool>,
    search: Option<JoinHandle<()>>,
}

impl Predictability {
    /// Starts the search in a scene. Without threads, nothing is found.
    pub fn new(scene: Scene) -> Self {
        let mut this = Self::default();
        let (until, ended) = (this.until.clone(), this.ended.clone());
        let search = move || {
            let go_on = || !ended.load(Ordering::Relaxed);
            if let Ok(Some(found)) = horizon(&scene, f64::INFINITY, &go_on) {
                let is_chaotic = found.lyapunov.is_finite();
                let _ = until.set(if is_chaotic { found.until } else { f64::INFINITY });
            }
        };
        this.search = thread::Builder::new().spawn(search).ok();
        this
    }

    /// Returns the time past which errors say little (s), if the scene is chaotic and the search
    /// has ended.
    pub fn until(&self) -> Option<f64> {
        self.until.get().copied().filter(|until| until.is_finite())
    }

    /// Waits for the end of the search.
    pub fn wait(&mut self) {
        if let Some(search) = self.search.take() {
            let _ = search.join();
        }
    }
}

impl Drop for Predictability {
    fn drop(&mut self) {
        self.ended.store(true, Ordering::Relaxed);
    }
}

/// Continues a fresh run of the same scene from the state of another run, by its own method.
///
/// # Errors
/// The method does not support the present scene of that run.
pub fn continue_from(next: &mut Simulation, run: &Simulation) -> Result<(), Error> {
    let (method, control) = (next.method(), next.control());
    let mut moment = run.moment();
    let time = moment.time();
    let state = &mut moment.run;
    (state.method, state.control) = (method, control);
    (state.since, state.taken, state.shown) = (time, 0, None);
    moment.progress = Progress::default();
    next.restore(&moment)?;
    // Energy of another model is no gain of the method.
    next.set_method(method, control)
}

#[cfg(test)]
mod tests {
    use a3_media::show::{Manner, Show};

    use super::*;

    #[test]
    fn a_reference_that_never_keeps_up_is_stopped_until_the_next_reset() {
        let setup = a3_scenes::find("chain").unwrap().build(None).unwrap();
        let pane = |method: &str| {
            let method = integrators::find(method).unwrap();
            let simulation =
                Simulation::new(setup.scene.clone(), method, Control::Step(0.01)).unwrap();
            Pane::new(simulation, Show::new(setup.presentation.clone(), Manner::default()))
        };
        assert!(ReferenceRun::new(&[pane("t")]).ok().unwrap().is_none());
        let go = |panes: &mut [Pane], time| {
            for pane in panes {
                pane.take_due_steps(time);
            }
        };
        let mut panes = [pane("t"), pane("r")];
        let mut reference = ReferenceRun::new(&panes).ok().flatten().unwrap();
        // A single late frame does no harm.
        go(&mut panes, 0.5);
        reference.follow(&mut panes, Duration::ZERO);
        assert_eq!(panes[0].error, None);
        reference.follow(&mut panes, Duration::MAX);
        assert!(panes[0].error.unwrap() > panes[1].error.unwrap());
        for late in 1..=MAX_LATE_FRAMES + 1 {
            go(&mut panes, 0.5 + 0.01 * f64::from(late));
            assert_eq!(reference.stopped, None);
            reference.follow(&mut panes, Duration::ZERO);
        }
        assert!(reference.stopped.unwrap().contains("too slow"));
        assert_eq!(panes[0].error, None);
        panes.iter_mut().for_each(Pane::reset);
        reference.reset();
        go(&mut panes, 0.5);
        reference.follow(&mut panes, Duration::MAX);
        assert!(panes[0].error.is_some() && reference.stopped.is_none());
    }
}
