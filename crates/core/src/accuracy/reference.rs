//! Reference solution of a scene, and its uncertainty.
//!
//! The reference is a run of DOP853 at a tight tolerance. It is compared with a run of DOP853 at a
//! looser tolerance, and with PEFRL (for a first-order system, the classical Runge-Kutta method) at
//! a step h and at h/2, extrapolated to zero step by Richardson's formula. The largest disagreement
//! is the uncertainty of the reference.

use super::{Errors, Frames, GoOn, Snapshot, run};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, Work, find};
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::stability::{largest_step, spectrum};

/// Tolerances of DOP853, that of the reference first. Tighter ones lose more to rounding than they
/// gain.
const TOLERANCES: [f64; 2] = [1e-12, 1e-11];
/// Step h of the other method, the longer of its two, over its largest stable step, at most.
const SHARE: f64 = 1.0 / 16.0;

/// Reference solution of a scene at each frame.
pub struct Reference {
    /// Times of the reference.
    pub frames: Frames,
    /// Uncertainty of the reference: the largest disagreement of its runs over the frames.
    pub floor: Errors,
    /// Work of all runs that make the reference.
    pub work: Work,
    snapshots: Vec<Snapshot>,
}

impl Reference {
    /// Reference of a scene from its start. `None` if `go_on` returned false.
    ///
    /// # Errors
    /// The scene cannot be run, or one of the runs of the reference blows up.
    pub fn new(scene: &Scene, frames: Frames, go_on: GoOn) -> Result<Option<Self>, Error> {
        let mut work = Work::default();
        let mut trajectory = |method: &'static Method, control: Control| {
            let mut simulation = Simulation::new(scene.clone(), method, control)?;
            let mut snapshots = vec![];
            let end = run(&mut simulation, &frames, go_on, |_, run| {
                snapshots.push(Snapshot::of(run));
            })?;
            work += simulation.work();
            match end {
                None => Ok(None),
                Some(Some(lost)) => Err(Error::BlowUp(lost)),
                Some(None) => Ok(Some(snapshots)),
            }
        };
        let accurate = find("dop853").ok_or_else(missing)?;
        let Some(best) = trajectory(accurate, Control::Tolerance(TOLERANCES[0]))? else {
            return Ok(None);
        };
        let Some(looser) = trajectory(accurate, Control::Tolerance(TOLERANCES[1]))? else {
            return Ok(None);
        };
        let system = scene.model.system();
        let name = if system.mechanics().is_some() {
            "pefrl"
        } else {
            "rk4"
        };
        let other = find(name).ok_or_else(missing)?;
        let modes = spectrum(system, 0.0, &scene.state);
        let limit = largest_step(other, &modes)?.map_or(f64::INFINITY, |limit| limit.step);
        let parts = (frames.spacing() / (SHARE * limit)).ceil().max(1.0);
        let h = frames.spacing() / parts;
        let Some(coarse) = trajectory(other, Control::Step(h))? else {
            return Ok(None);
        };
        let Some(fine) = trajectory(other, Control::Step(0.5 * h))? else {
            return Ok(None);
        };
        let mut floor = Errors::default();
        for (k, best) in best.iter().enumerate() {
            floor = floor
                .max(best.errors(&looser[k]))
                .max(best.errors(&extrapolate(&coarse[k], &fine[k])));
        }
        Ok(Some(Self {
            frames,
            floor,
            work,
            snapshots: best,
        }))
    }

    /// Errors of a run that is at frame k, counted from 1.
    #[must_use]
    pub fn errors(&self, k: u64, run: &Simulation) -> Errors {
        Snapshot::of(run).errors(&self.snapshots[k as usize - 1])
    }
}

/// Error for a method of the reference that is not in the table of methods.
fn missing() -> Error {
    Error::Invalid("the methods that make a reference are not in the table".into())
}

/// Richardson's extrapolation from the steps h and h/2 of a method of order 4, whose leading error
/// cancels: fine + (fine - coarse) / 15.
fn extrapolate(coarse: &Snapshot, fine: &Snapshot) -> Snapshot {
    let both = |coarse: f64, fine: f64| fine + (fine - coarse) / 15.0;
    let all = |coarse: &[f64], fine: &[f64]| {
        let pairs = coarse.iter().zip(fine);
        pairs.map(|(c, f)| both(*c, *f)).collect()
    };
    Snapshot {
        positions: all(&coarse.positions, &fine.positions),
        energy: both(coarse.energy, fine.energy),
        strains: all(&coarse.strains, &fine.strains),
    }
}
