//! Models of a scene: without one of its parts, and on other grids.

use std::cmp::Ordering;
use std::time::Duration;

use a3_core::accuracy::{self, Frames, GoOn};
use a3_core::integrators::find;
use a3_core::{Control, Method, Scene, Simulation};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::processor;
use a3_files::rows::Rows;
use a3_files::setup::Request;
use a3_scenes::{Description, Part, Regridded, parts, regridded, without};

use crate::motion::{Compared, Known, Places, Track, grid};

/// Relative tolerances at which the whole scene is tried, the largest first. The first that is
/// accurate enough is that of all models.
const TOLERANCES: [f64; 10] = [1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-11, 1e-12];
/// Tolerance of the run that checks another, over that one's.
const CHECK_RATIO: f64 = 0.1;
/// Error of the time steps in a model that is sought, over the error that is asked for.
const GOAL_UNCERTAINTY: f64 = 0.02;
/// Error of the time steps in a model that is accepted, over the error that is asked for.
const MAX_UNCERTAINTY: f64 = 0.3;
/// Number of tolerances that bring no better agreement, after which none does.
const MAX_STUCK: usize = 3;
/// Factors by which the cells of grids are shorter; below 1 for coarser grids. On a small grid, two
/// factors may give the same grid, which then counts as that of the first.
pub const FACTORS: [f64; 4] = [0.5, 0.25, 0.75, 2.0];

/// Comparison of models of a scene with the whole scene.
pub struct Models<'a> {
    pub request: &'a Request,
    /// Companion of the work, which may stop it.
    pub monitor: &'a dyn Monitor,
    /// Whole scene.
    pub scene: Scene,
    /// Quantity that is compared.
    pub compared: Compared,
    /// Motion of the whole scene.
    pub whole: Track,
    /// Method and tolerance by which all models are integrated.
    pub accurate: (&'static Method, Control),
    /// Error of that run, by its distance from a run of another method.
    pub uncertainty: f64,
}

/// Model of a scene: without a part, or on another grid.
pub struct Model {
    /// Name in the table.
    pub name: String,
    pub description: Description,
    /// Particles of the scene on the model's grids, if these are others.
    pub places: Option<Vec<Vec<(usize, f64)>>>,
    /// Part that is left out; none for another grid.
    pub part: Option<Part>,
    /// Factor by which the cells of its grids are shorter; 1 for the grids of the scene.
    pub factor: f64,
    /// Effect of the model, or the reason why it was not measured.
    pub effect: Result<Known, String>,
}

impl<'a> Models<'a> {
    /// Integrates the whole scene much more accurately than to the error that is asked for, which
    /// two methods of different orders have to agree about.
    ///
    /// # Errors
    /// No run is accurate enough, or the monitor stopped it.
    pub fn new(
        request: &'a Request,
        scene: Scene,
        compared: Compared,
        error: f64,
        monitor: &'a dyn Monitor,
    ) -> Result<Self, Failure> {
        let go_on = &|| monitor.go_on();
        let [method, other] = ["verner65", "dop853"].map(|name| find(name).expect(name));
        let mut best: Option<(Track, f64, f64)> = None;
        let mut stuck = 0;
        for tolerance in TOLERANCES {
            let mut runs = vec![];
            for (method, tolerance) in [(method, tolerance), (other, CHECK_RATIO * tolerance)] {
                let by = (method, Control::Tolerance(tolerance));
                runs.push(compared.follow(&scene, by, None, go_on)?);
            }
            let Ok([Some(track), Some(check)]) = <[_; 2]>::try_from(runs) else {
                continue;
            };
            let uncertainty = compared.distance(&track, &check);
            let is_better = best.as_ref().is_none_or(|best| uncertainty < 0.5 * best.1);
            stuck = if is_better { 0 } else { stuck + 1 };
            if best.as_ref().is_none_or(|best| uncertainty < best.1) {
                best = Some((track, uncertainty, tolerance));
            }
            if uncertainty <= GOAL_UNCERTAINTY * error || stuck == MAX_STUCK {
                break;
            }
        }
        let Some((whole, uncertainty, tolerance)) = best else {
            return Err(Failure::run(format!(
                "the scene {} blows up at every tolerance, so its models cannot be compared",
                scene.name
            )));
        };
        if uncertainty > MAX_UNCERTAINTY * error {
            let unit = compared.unit();
            return Err(Failure::usage(format!(
                "the motion of this scene over {} s is itself known to {uncertainty:.0e} {unit} only: ask for an error \
                 of at least {:.0e} {unit}, or for a shorter --until",
                compared.frames.until,
                uncertainty / MAX_UNCERTAINTY
            )));
        }
        Ok(Self {
            request,
            monitor,
            scene,
            compared,
            whole,
            accurate: (method, Control::Tolerance(tolerance)),
            uncertainty,
        })
    }

    /// Lists the models to be measured: without each part, and on each other grid. The second value
    /// gives the reason if the grids cannot be changed.
    pub fn all(&self) -> (Vec<Model>, Option<String>) {
        let own = &*self.request.source.description;
        let model = |name, part, description| Model {
            name,
            description,
            places: None,
            part,
            factor: 1.0,
            effect: Err("not measured".into()),
        };
        let parts = parts(own).into_iter();
        let mut all: Vec<_> = parts
            .map(|part| model(part.name.clone(), Some(part.clone()), without(own, [&part])))
            .collect();
        let mut why = None;
        for factor in FACTORS {
            match regridded(own, factor, self.scene.model.particles()) {
                Ok(Regridded { description, places }) => {
                    if all.iter().all(|model| model.description != description) {
                        let name = format!("grid of {}", grid(&description));
                        all.push(Model {
                            places: Some(places),
                            factor,
                            ..model(name, None, description)
                        });
                    }
                }
                Err(reason) => why = why.or(Some(reason)),
            }
        }
        all.sort_by(|a, b| {
            let order = |model: &Model| (model.places.is_some(), model.factor);
            order(a).partial_cmp(&order(b)).unwrap_or(Ordering::Equal)
        });
        let has_grids = all.iter().any(|model| model.places.is_some());
        (all, why.filter(|_| !has_grids))
    }

    /// Measures a model, unless it is known.
    fn measure(&self, model: &mut Model, known: &mut Rows<Known>) -> Result<(), Failure> {
        let like = Known {
            model: model.name.clone(),
            ..Known::new(self.request, &self.scene, self.compared, self.accurate)
        };
        if let Some(known) = known.find(&like) {
            model.effect = Ok(known.clone());
            return Ok(());
        }
        let found = self.follow(&model.description, model.places.as_deref())?;
        let track = match found {
            Ok(track) => track,
            Err(why) => {
                model.effect = Err(why);
                return Ok(());
            }
        };
        let scene = self.build(&model.description)?;
        // The time of the model over that of the whole scene, which runs in turns with it.
        let (method, control) = self.accurate;
        let runs = [&scene, &self.scene].map(|scene| (scene, method, control));
        let [own, whole] = in_turns(runs, &self.compared.frames, &|| self.monitor.go_on())?;
        let row = Known {
            change: self.change(&track),
            time: own.as_secs_f64() / whole.as_secs_f64(),
            work: track.work / self.whole.work,
            ..like
        };
        model.effect = Ok(row.clone());
        known.add(row);
        known.save()
    }

    /// Returns the change of the quantity in a model whose motion is known.
    pub fn change(&self, track: &Track) -> f64 {
        self.compared.distance(&self.whole, track)
    }

    /// Integrates a model. Returns its motion, or the reason why it cannot be integrated.
    pub fn follow(
        &self,
        description: &Description,
        places: Option<&Places>,
    ) -> Result<Result<Track, String>, Failure> {
        let Ok(scene) = self.build(description) else {
            return Ok(Err("a scene without it cannot be built".into()));
        };
        let go_on = &|| self.monitor.go_on();
        let found = self.compared.follow(&scene, self.accurate, places, go_on)?;
        Ok(found.ok_or_else(|| "it blows up".into()))
    }

    /// Builds the scene of another description.
    pub fn build(&self, description: &Description) -> Result<Scene, Failure> {
        self.request.with(description.clone()).scene()
    }
}

/// Measures all models that can be measured and are not known.
pub fn measure_all(
    models: &Models,
    all: &mut [Model],
    known: &mut Rows<Known>,
) -> Result<(), Failure> {
    // A model on a finer grid has more particles and, by an explicit method, shorter steps.
    let weight = |model: &Model| model.factor.powi(4);
    let monitor = models.monitor;
    monitor.expect(all.iter().map(weight).sum());
    monitor.start();
    for model in all {
        monitor.stage(&model.name);
        models.measure(model, known)?;
        monitor.advance(weight(model));
    }
    Ok(())
}

/// Least and largest number of turns.
const TURNS: std::ops::Range<u32> = 3..200;
/// Computing time of all turns after which no other follows.
const ENOUGH: Duration = Duration::from_millis(300);

/// Times two runs in turns, in processor time, so that other work of the machine slows both alike.
/// The shortest time of each counts.
pub fn in_turns(
    runs: [(&Scene, &'static Method, Control); 2],
    frames: &Frames,
    go_on: GoOn,
) -> Result<[Duration; 2], Failure> {
    let (mut best, mut sum) = ([Duration::MAX; 2], Duration::ZERO);
    for turn in 0..TURNS.end {
        if turn >= TURNS.start && sum > ENOUGH {
            break;
        }
        for ((scene, method, control), best) in runs.into_iter().zip(&mut best) {
            let run = Simulation::new(scene.clone(), method, control);
            let mut run = run.map_err(Failure::run)?;
            let begun = processor::time();
            let end = accuracy::run(&mut run, frames, go_on, None);
            let elapsed = processor::time().saturating_sub(begun);
            end.map_err(Failure::run)?.ok_or_else(Failure::stopped)?;
            *best = elapsed.min(*best);
            sum += elapsed;
        }
    }
    Ok(best)
}
