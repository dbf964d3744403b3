//! The leanest scene for an error: parts left out together, a coarser grid, and the cheapest solver
//! for what is left of the error. It is measured as a whole.

use a3_core::accuracy::{Candidate, Frames, Metric, Precision, Reference, Scope, choose};
use a3_core::{Control, Method, Scene};
use a3_scenes::{Description, Part, Regridded};

use super::models::{Model, Models};
use crate::base::failure::Failure;
use crate::base::interrupt;
use crate::commands::chart::single::time;
use crate::commands::motion::Motion;

/// Share of the error that the model may make; the time steps may make the rest.
const MODEL_SHARE: f64 = 0.6;
/// Most work of a model without a part, over that of the whole scene: less damping, for example,
/// may take more steps.
const MOST_WORK: f64 = 1.05;
/// Most time of the leanest scene over that of the whole scene: the clock is no better.
pub const MOST_TIME: f64 = 1.05;
/// Share of what is left of the error that the solver is first asked for, and then after each run
/// of the whole that erred too much.
const SHARES: [f64; 4] = [1.0, 0.8, 0.4, 0.2];
/// Uncertainty of the reference over the error.
const UNCERTAINTY: f64 = 0.01;

/// Cheapest solver of a scene.
#[derive(Clone, Copy)]
pub struct Solved {
    pub method: &'static Method,
    pub control: Control,
    /// Error (m) of the run with all that is left out.
    pub error: f64,
    /// Computing time of a simulated second (s).
    pub time: f64,
    /// Work of the run, in evaluations.
    pub work: f64,
}

/// Scene without some of its parts, perhaps on a coarser grid.
pub struct LeanModel {
    pub description: Description,
    /// Parts that are left out.
    pub parts: Vec<Part>,
    /// Factor by which its cells are shorter.
    pub factor: f64,
    /// Error of the model alone (m).
    pub error: f64,
}

impl LeanModel {
    /// The whole scene.
    pub fn whole(models: &Models) -> Self {
        Self {
            description: Description::clone(&models.request.source.description),
            parts: vec![],
            factor: 1.0,
            error: 0.0,
        }
    }

    /// Whether it is the whole scene.
    pub fn is_whole(&self) -> bool {
        self.parts.is_empty() && self.factor == 1.0
    }
}

/// The leanest scene that was found, beside the whole one.
pub struct Answer {
    pub model: LeanModel,
    pub solved: Solved,
    pub whole: Solved,
}

/// Puts the leanest model together that changes the motion by less than the model's share of the
/// error (m). `None` if it was interrupted.
pub fn assemble(models: &Models, all: &[Model], error: f64) -> Result<Option<LeanModel>, Failure> {
    let most = MODEL_SHARE * error;
    let own = &*models.request.source.description;
    let particles = models.scene.model.particles();
    let change = |model: &Model| model.effect.as_ref().map_or(f64::INFINITY, |e| e.change);
    let pays = |model: &&Model| {
        let effect = model.effect.as_ref();
        effect.is_ok_and(|e| e.change <= most && (e.work <= MOST_WORK || model.factor < 1.0))
    };
    let mut small: Vec<_> = all.iter().filter(pays).collect();
    small.sort_by(|a, b| change(a).total_cmp(&change(b)));
    let mut parts: Vec<&Model> = small.iter().copied().filter(|m| m.part.is_some()).collect();
    let coarser = small.iter().filter(|m| m.part.is_none() && m.factor < 1.0);
    let coarsest = coarser.min_by(|a, b| a.factor.total_cmp(&b.factor));
    let mut factor = coarsest.map_or(1.0, |model| model.factor);
    loop {
        let left_out: Vec<Part> = parts.iter().filter_map(|m| m.part.clone()).collect();
        let without = own.without(&left_out);
        let (description, places) = if factor < 1.0 {
            match without.regridded(factor, particles) {
                Ok(Regridded {
                    description,
                    places,
                }) => (description, Some(places)),
                Err(_) => (without, None),
            }
        } else {
            (without, None)
        };
        let found = if left_out.is_empty() && places.is_none() {
            0.0
        } else {
            match models.follow(&description, places.as_deref())? {
                None => return Ok(None),
                Some(Ok(track)) => models.effect(&track).change,
                Some(Err(_)) => f64::INFINITY,
            }
        };
        if found <= most {
            return Ok(Some(LeanModel {
                description,
                parts: left_out,
                factor,
                error: found,
            }));
        }
        // What changes most comes back first: a part, or the grid where all parts are back.
        if parts.pop().is_none() {
            factor = 1.0;
        }
    }
}

/// Finds the cheapest solver for the whole scene, at the error (m) that is asked for. `None` if it
/// was interrupted.
pub fn solve_whole(
    models: &Models,
    reference: &Reference,
    error: f64,
) -> Result<Option<Solved>, Failure> {
    let scene = &models.scene;
    let Some(best) = cheapest(scene, reference, error)? else {
        return Ok(None);
    };
    let time = seconds(scene, &best, reference.frames)?;
    Ok(time.map(|time| Solved {
        method: best.method,
        control: best.control,
        error: best.outcome.errors.position,
        time,
        work: best.outcome.work.total(),
    }))
}

/// Finds the cheapest solver for a lean model, so that a run of the whole errs by at most the error
/// (m). `None` if it was interrupted, or no solver was found.
pub fn solve(models: &Models, model: &LeanModel, error: f64) -> Result<Option<Solved>, Failure> {
    let scene = models.build(&model.description)?;
    let own = &*models.request.source.description;
    let places = if model.factor < 1.0 {
        let other = own.regridded(model.factor, models.scene.model.particles());
        other.ok().map(|other| other.places)
    } else {
        None
    };
    let frames = models.points.frames;
    let left = error - model.error;
    let precision = Precision {
        metric: Metric::Position,
        uncertainty: UNCERTAINTY * left,
        max_work: f64::INFINITY,
    };
    // Where another grid has other particles, one of them cannot be followed by its number.
    let scope = Scope {
        particle: models.points.scope.particle.filter(|_| places.is_none()),
        ..models.points.scope
    };
    let reference = Reference::new(&scene, frames, scope, precision, &interrupt::go_on);
    let Some(reference) = reference.map_err(Failure::run)? else {
        return Ok(None);
    };
    for share in SHARES {
        let Some(best) = cheapest(&scene, &reference, share * left)? else {
            return Ok(None);
        };
        let (method, control) = (best.method, best.control);
        let places = places.as_deref();
        let track = match models.points.follow(&scene, (method, control), places)? {
            None => return Ok(None),
            Some(Motion::Lost) => continue,
            Some(Motion::Known(track)) => track,
        };
        let found = models.effect(&track).change;
        if found <= error {
            let time = seconds(&scene, &best, frames)?;
            return Ok(time.map(|time| Solved {
                method,
                control,
                error: found,
                time,
                work: track.work,
            }));
        }
    }
    Ok(None)
}

/// The cheapest solver of a scene for an error (m). `None` if it was interrupted.
fn cheapest(
    scene: &Scene,
    reference: &Reference,
    error: f64,
) -> Result<Option<Candidate>, Failure> {
    let found = choose(
        scene,
        reference,
        Metric::Position,
        error,
        &interrupt::go_on,
        |_| {},
    );
    let found = found.map_err(Failure::run)?;
    Ok(found.and_then(|found| found.into_iter().next()))
}

/// Computing time of a simulated second (s). `None` if it was interrupted.
fn seconds(scene: &Scene, best: &Candidate, frames: Frames) -> Result<Option<f64>, Failure> {
    let time = time(scene, best.method, best.control, &frames, None)?;
    Ok(time.map(|time| time.as_secs_f64() / frames.until))
}
