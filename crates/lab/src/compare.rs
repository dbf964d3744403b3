//! Runs of several methods side by side, as values.

use a3_core::{BlowUp, Control, Error, Method, Scene, Simulation};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::setup::check_control;

use crate::chart::check_scene;

/// Largest number of frames.
const MAX_FRAMES: usize = 1_000_000;

/// Runs of a scene at the same times.
#[derive(Clone, Debug)]
pub struct Comparison {
    /// Times (s): from 0 to the end of the runs, at equal distances.
    pub times: Vec<f64>,
    /// Runs, in the order in which they were asked for.
    pub runs: Vec<ComparedRun>,
    /// Number of particles; 0 for plain numbers.
    particles: usize,
}

/// Run of a comparison.
#[derive(Clone, Debug)]
pub struct ComparedRun {
    /// Method.
    pub method: &'static Method,
    /// Step or tolerance.
    pub control: Control,
    /// States at the times of the comparison, up to the blow-up if there was one: y = [x | v] of a
    /// scene with particles, each of these n x 3 in column-major order (m, m/s).
    pub states: Vec<Vec<f64>>,
    /// Energy (J) at these times; none for scenes that are no networks.
    pub energies: Vec<f64>,
    /// Work (evaluations), with linear algebra.
    pub work: f64,
    /// Blow-up, if there was one.
    pub blow_up: Option<BlowUp>,
}

/// Runs a scene by each of these methods, with its step or tolerance, and records the states at 0
/// and at the ends of `frames` equal parts of the time `until` (s). If the monitor stops the runs,
/// they are as long as they were then.
///
/// # Errors
/// A method does not support the scene or its step or tolerance, there is no frame or more than a
/// million, `until` is not above 0, or a callback fails.
pub fn compare(
    scene: &Scene,
    runs: &[(&'static Method, Control)],
    until: f64,
    frames: usize,
    monitor: &dyn Monitor,
) -> Result<Comparison, Failure> {
    check_scene(scene)?;
    if !(until.is_finite() && until > 0.0) {
        return Err(Failure::usage(format!(
            "the end is a number of seconds above 0, such as 1, not {until}"
        )));
    }
    if !(1..=MAX_FRAMES).contains(&frames) {
        return Err(Failure::usage(format!(
            "the number of frames is from 1 to {MAX_FRAMES}, such as 100, not {frames}"
        )));
    }
    let times: Vec<_> = (0..=frames).map(|k| until * k as f64 / frames as f64).collect();
    monitor.expect(runs.len() as f64);
    let compared = runs.iter().map(|&(method, control)| {
        monitor.stage(method.name);
        check_control(&scene.model, method, control)?;
        let run = follow(scene, method, control, &times, monitor);
        monitor.advance(1.0);
        run
    });
    let runs = compared.collect::<Result<Vec<_>, Failure>>();
    monitor.clear();
    Ok(Comparison { times, runs: runs?, particles: scene.model.particles() })
}

/// Runs a scene by a method, and records the states at these times (s).
fn follow(
    scene: &Scene,
    method: &'static Method,
    control: Control,
    times: &[f64],
    monitor: &dyn Monitor,
) -> Result<ComparedRun, Failure> {
    let mut run = Simulation::new(scene.clone(), method, control)
        .map_err(|e| Failure::usage(format!("scene {}: {e}", scene.name)))?;
    let (mut states, mut energies, mut blow_up) = (vec![], vec![], None);
    for time in times {
        if !monitor.go_on() {
            break;
        }
        match run.advance_to(*time) {
            Ok(()) => {}
            Err(Error::BlowUp(lost)) => {
                blow_up = Some(lost);
                break;
            }
            Err(error) => return Err(Failure::run(error)),
        }
        states.push(run.state().to_vec());
        energies.extend(run.energy().map(|energy| energy.total()));
    }
    Ok(ComparedRun { method, control, states, energies, work: run.work().total(), blow_up })
}

impl Comparison {
    /// Returns the distance of run `a` from run `b` at each time that both reached: the root mean
    /// square over the particles (m) or, without particles, over the numbers of the state. Empty if
    /// there is no such run.
    #[must_use]
    pub fn distance(&self, a: usize, b: usize) -> Vec<f64> {
        let (Some(a), Some(b)) = (self.runs.get(a), self.runs.get(b)) else {
            return vec![];
        };
        let apart = |(a, b): (&Vec<f64>, &Vec<f64>)| {
            let (coordinates, count) = match self.particles {
                0 => (a.len(), a.len()),
                n => (3 * n, n),
            };
            let pairs = a[..coordinates].iter().zip(b);
            let squares: f64 = pairs.map(|(a, b)| (a - b).powi(2)).sum();
            (squares / count as f64).sqrt()
        };
        a.states.iter().zip(&b.states).map(apart).collect()
    }
}
