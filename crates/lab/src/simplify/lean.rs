//! The leanest scene for an error: parts left out together, a coarser grid, and the cheapest solver
//! for the rest of the error. All of it is measured in one run.

use std::cmp::Reverse;

use a3_core::accuracy::{Candidate, Trial, choose_by};
use a3_core::integrators::METHODS;
use a3_core::{Control, Method};
use a3_files::failure::Failure;
use a3_scenes::{Description, Part, regridded, without};

use super::models::{Model, Models, in_turns};
use crate::chart::measure::time;

/// Share of the error that the model may cause; the time steps may cause the rest.
const MODEL_SHARE: f64 = 0.6;
/// Largest work of a model without a part, over that of the whole scene: without damping, for
/// example, more steps may be necessary.
const MAX_WORK_RATIO: f64 = 1.05;
/// Largest computing time, over that of the whole scene, of a leanest scene that takes more work or
/// has other grids. Computing times vary by a few percent.
pub const MAX_TIME_RATIO: f64 = 0.95;
/// Cheapest solver of a scene.
#[derive(Clone, Copy)]
pub struct Solved {
    pub method: &'static Method,
    pub control: Control,
    /// Error of the run: that of the model and that of the time steps.
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
    /// Factor by which the cells of its grids are shorter; below 1 for coarser grids.
    pub factor: f64,
    /// Error of the model alone.
    pub error: f64,
}

impl LeanModel {
    /// Creates the model that is the whole scene.
    pub fn whole(models: &Models) -> Self {
        Self {
            description: Description::clone(&models.request.source.description),
            parts: vec![],
            factor: 1.0,
            error: 0.0,
        }
    }

    /// Returns whether it has the change of a model.
    pub fn has(&self, model: &Model) -> bool {
        match &model.part {
            Some(part) => self.parts.contains(part),
            None => model.factor < 1.0 && self.factor == model.factor,
        }
    }

    /// Returns whether nothing is left out, and the grids are those of the scene.
    pub fn is_whole(&self) -> bool {
        self.parts.is_empty() && self.factor == 1.0
    }
}

/// Leanest scene that was found, with its solver and that of the whole scene.
pub struct Answer {
    pub model: LeanModel,
    pub solved: Solved,
    pub whole: Solved,
}

/// Assembles the leanest model that changes the motion by at most the model's share of the error.
pub fn assemble(models: &Models, all: &[Model], error: f64) -> Result<LeanModel, Failure> {
    let max_change = MODEL_SHARE * error;
    let own = &*models.request.source.description;
    let particles = models.scene.model.particles();
    let change = |model: &Model| model.effect.as_ref().map_or(f64::INFINITY, |e| e.change);
    let pays = |model: &&Model| {
        let effect = model.effect.as_ref();
        effect.is_ok_and(|e| {
            e.change <= max_change && (e.work <= MAX_WORK_RATIO || model.factor < 1.0)
        })
    };
    let mut small: Vec<_> = all.iter().filter(pays).collect();
    small.sort_by(|a, b| change(a).total_cmp(&change(b)));
    let mut parts: Vec<&Model> = small.iter().copied().filter(|m| m.part.is_some()).collect();
    let coarser = small.iter().filter(|m| m.part.is_none() && m.factor < 1.0);
    let coarsest = coarser.min_by(|a, b| a.factor.total_cmp(&b.factor));
    let mut factor = coarsest.map_or(1.0, |model| model.factor);
    loop {
        let left_out: Vec<Part> = parts.iter().filter_map(|m| m.part.clone()).collect();
        let lean = without(own, &left_out);
        let other = (factor < 1.0).then(|| regridded(&lean, factor, particles).ok());
        let (description, places) = match other.flatten() {
            Some(other) => (other.description, Some(other.places)),
            None => (lean, None),
        };
        let found = if left_out.is_empty() && places.is_none() {
            0.0
        } else {
            let track = models.follow(&description, places.as_deref())?;
            track.map_or(f64::INFINITY, |track| models.change(&track))
        };
        if found <= max_change {
            return Ok(LeanModel { description, parts: left_out, factor, error: found });
        }
        // The part that changes the motion most is restored first, and the grid last.
        if parts.pop().is_none() {
            factor = 1.0;
        }
    }
}

/// Finds the cheapest solver for a model whose run differs from the motion of the whole scene by
/// at most the error: that of the model and of the time steps together. `None` if there is none.
/// `first` is the method that is tried first: the cheaper it is, the fewer runs of others are
/// necessary.
pub fn solve(
    models: &Models,
    model: &LeanModel,
    error: f64,
    first: &str,
) -> Result<Option<Solved>, Failure> {
    let scene = models.build(&model.description)?;
    let own = &*models.request.source.description;
    let places = if model.factor < 1.0 {
        let other = regridded(own, model.factor, models.scene.model.particles());
        other.ok().map(|other| other.places)
    } else {
        None
    };
    let frames = models.compared.frames;
    let go_on = &|| models.monitor.go_on();
    let measure = |method, control| {
        let (by, places) = ((method, control), places.as_deref());
        let run = models.compared.follow(&scene, by, places, go_on)?;
        let work = run.as_ref().map_or(0.0, |track| track.work);
        let error = run.map_or(f64::INFINITY, |track| models.change(&track));
        Ok::<_, Failure>(Some(Trial { error, work, outcome: error }))
    };
    let most = error - models.uncertainty;
    // The accurate run of the whole scene is a candidate, too.
    let max_cost = |found: &[Candidate<f64>]| {
        let least = found.first().map_or(f64::INFINITY, |best| best.work);
        least.min(models.whole.work)
    };
    let mut methods: Vec<_> = METHODS.iter().collect();
    methods.sort_by_key(|method| (method.name != first, Reverse(method.order)));
    let found = choose_by(&methods, &scene, &frames, most, max_cost, measure, |_| {});
    let Some(best) = found?.into_iter().flatten().next() else {
        return Ok(None);
    };
    let time = time(go_on, &scene, best.method, best.control, &frames, None)?;
    Ok(Some(Solved {
        method: best.method,
        control: best.control,
        error: best.outcome,
        time: time.as_secs_f64() / frames.until,
        work: best.work,
    }))
}

/// Times the runs of both scenes again in turns.
pub fn time_in_turns(
    models: &Models,
    model: &LeanModel,
    lean: &mut Solved,
    whole: &mut Solved,
) -> Result<(), Failure> {
    let (scene, frames) = (models.build(&model.description)?, models.compared.frames);
    let runs = [(&scene, &*lean), (&models.scene, &*whole)];
    let runs = runs.map(|(scene, solved)| (scene, solved.method, solved.control));
    let times = in_turns(runs, &frames, &|| models.monitor.go_on())?;
    [lean.time, whole.time] = times.map(|time| time.as_secs_f64() / frames.until);
    Ok(())
}
