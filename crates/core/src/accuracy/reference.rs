//! References: DOP853 at two tolerances, and PEFRL with its step halved and extrapolated, or,
//! without masses, classical Runge-Kutta. Their differences are the uncertainty of the reference.

use super::{Errors, Frames, GoOn, Snapshot, run};
use crate::control::Control;
use crate::error::Error;
use crate::integrators::{Method, Work, find};
use crate::scene::Scene;
use crate::simulation::Simulation;
use crate::stability::{largest_step, spectrum};

/// Tolerances of DOP853: tighter ones lose more to rounding than they gain.
const TOLERANCES: [f64; 2] = [1e-12, 1e-11];
/// Longer step of the other family, over its largest stable one.
const SHARE: f64 = 1.0 / 16.0;

/// Reference of a scene: states frame by frame, with their uncertainty.
pub struct Reference {
    /// Times of the states.
    pub frames: Frames,
    /// Uncertainty of the reference.
    pub floor: Errors,
    /// Cost of the reference.
    pub work: Work,
    snapshots: Vec<Snapshot>,
}

impl Reference {
    /// Makes the reference of a scene, as it starts. `None` if it was told to stop.
    ///
    /// # Errors
    /// The scene cannot be run, or the reference itself is lost.
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

    /// The errors of a run that is at frame k, from 1 on.
    #[must_use]
    pub fn errors(&self, k: u64, run: &Simulation) -> Errors {
        Snapshot::of(run).errors(&self.snapshots[k as usize - 1])
    }
}

fn missing() -> Error {
    Error::Invalid("the methods that make a reference are not in the table".into())
}

/// Richardson's extrapolation: the error of order 4 cancels.
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
