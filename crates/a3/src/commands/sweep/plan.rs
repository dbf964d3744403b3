//! The runs of a sweep, in order: those of one scene are neighbours.

use a3_core::accuracy::{Metric, Scope};
use a3_core::{Method, Scene, integrators};
use a3_files::failure::Failure;
use a3_files::scene_file::{Hash, Source};
use a3_lab::chart::check_metric;
use a3_lab::chart::measure::stiffened;
use a3_lab::chart::record::VERSION;
use a3_lab::motion::words;
use rayon::prelude::*;
use serde_json::Value;

use super::file::Sweep;
use super::values::{exact, set};
use crate::cli::sweep::Id;

/// Largest number of runs.
const MAX_RUNS: u128 = 1_000_000;

/// A scene with values for its keys.
pub struct Variant {
    /// The scene's name, and a hash of its files.
    pub name: String,
    /// Number of the scene in the sweep.
    scene: usize,
    /// Values of the swept keys, in the order of [`Sweep::names`].
    pub values: Vec<Value>,
    /// Factor of the stiffness of all springs.
    pub stiffness: f64,
    /// End of the runs (s).
    pub until: f64,
    pub metric: Metric,
    pub scope: Scope,
}

/// A run of a sweep.
pub struct Run {
    pub id: Id,
    /// Number of its scene among the variants.
    pub variant: usize,
    pub method: &'static Method,
    /// Step (s), or relative tolerance.
    pub setting: f64,
}

/// All runs of a sweep.
pub struct Plan {
    pub variants: Vec<Variant>,
    pub runs: Vec<Run>,
    /// Messages of solvers that refuse a scene.
    pub refusals: Vec<String>,
}

/// A variant, its runs, and the refusals.
type Planned = (Variant, Vec<Run>, Vec<String>);

impl Plan {
    /// Lists the runs of a sweep.
    pub fn new(sweep: &Sweep) -> Result<Self, Failure> {
        let methods: Vec<&'static Method> = if sweep.methods.is_empty() {
            integrators::METHODS.iter().collect()
        } else {
            sweep.methods.clone()
        };
        let lists = || {
            let keys = sweep.keys.iter().map(|(_, values)| values.len());
            keys.chain(sweep.stiffness.as_ref().map(Vec::len))
        };
        let scenes = lists().fold(sweep.scenes.len() as u128, |n, m| n.saturating_mul(m as u128));
        let each: u128 = methods.iter().map(|m| sweep.settings(m).len() as u128).sum();
        let count = scenes.saturating_mul(each);
        if count > MAX_RUNS {
            return Err(Failure::usage(format!(
                "{}: the sweep has {count} runs; at most {MAX_RUNS} are possible: split it into several files",
                sweep.file
            )));
        }
        let planned = (0..scenes as usize)
            .into_par_iter()
            .map(|k| {
                let mut k = k;
                let mut places: Vec<usize> = lists().collect();
                for place in places.iter_mut().rev() {
                    (k, *place) = (k / *place, k % *place);
                }
                variant(sweep, &methods, k, &places)
            })
            .collect::<Result<Vec<Planned>, String>>()
            .map_err(|why| Failure::usage(format!("{}: {why}", sweep.file)))?;
        let mut plan = Self { variants: vec![], runs: vec![], refusals: vec![] };
        let mut seen = std::collections::BTreeSet::new();
        for (number, (variant, runs, refusals)) in planned.into_iter().enumerate() {
            plan.variants.push(variant);
            // Values that are listed twice give one run.
            let new = runs.into_iter().filter(|run| seen.insert(run.id));
            plan.runs.extend(new.map(|run| Run { variant: number, ..run }));
            for refusal in refusals {
                if !plan.refusals.contains(&refusal) {
                    plan.refusals.push(refusal);
                }
            }
        }
        if plan.runs.is_empty() {
            let why = plan.refusals.first().map_or("", String::as_str);
            return Err(Failure::usage(format!("{}: the sweep has no runs: {why}", sweep.file)));
        }
        Ok(plan)
    }
}

impl Variant {
    /// Returns the file of the scene with these values.
    fn source(&self, sweep: &Sweep) -> Result<Source, String> {
        let source = &sweep.scenes[self.scene];
        if sweep.keys.is_empty() {
            return Ok(source.clone());
        }
        source.with(|scene| {
            let mut keys = sweep.keys.iter().zip(&self.values);
            keys.try_for_each(|((path, _), value)| {
                set(scene, path, value).map_err(|why| format!("keys.{path}: {why}"))
            })
        })
    }

    /// Builds the scene.
    pub fn scene(&self, sweep: &Sweep) -> Result<Scene, Failure> {
        let source = self.source(sweep).map_err(Failure::usage)?;
        stiffened(&source.build(None)?.scene, self.stiffness)
    }
}

/// Returns the scene of this number with the values at these indices, and its runs by these
/// methods.
fn variant(
    sweep: &Sweep,
    methods: &[&'static Method],
    number: usize,
    places: &[usize],
) -> Result<Planned, String> {
    let picked = sweep.keys.iter().zip(places);
    let picked = picked.map(|((_, values), k)| values[*k].clone());
    let mut values: Vec<_> = picked.collect();
    let factors = sweep.stiffness.as_ref();
    let factor = factors.map(|factors| factors[places[places.len() - 1]]);
    values.extend(factor.map(exact));
    let mut variant = Variant {
        name: String::new(),
        scene: number,
        values,
        stiffness: factor.unwrap_or(1.0),
        until: 0.0,
        metric: Metric::Position,
        scope: Scope::default(),
    };
    let source = variant.source(sweep)?;
    let setup = source.build(None).map_err(|error| error.to_string())?;
    let scene =
        stiffened(&setup.scene, variant.stiffness).map_err(|failure| failure.to_string())?;
    variant.name = source.fingerprint(&scene);
    let until = sweep.until.or(source.description.duration);
    variant.until =
        until.ok_or_else(|| format!("the scene {} has no duration: give `until`", scene.name))?;
    check_metric(sweep.error, &scene).map_err(|failure| failure.to_string())?;
    variant.metric = sweep.error;
    variant.scope = sweep.scope.checked(&scene.model).map_err(|why| why.to_string())?;
    let mut hash = Hash::default();
    hash.add(VERSION.bytes().chain([0]));
    hash.add(source.text().bytes().chain([0]));
    let scope = words(variant.scope, &scene.model);
    hash.add(variant.name.bytes().chain(scope.bytes()));
    let numbers = [variant.stiffness, variant.until];
    hash.add(numbers.into_iter().flat_map(f64::to_le_bytes));
    let (mut runs, mut refusals) = (vec![], vec![]);
    for &method in methods {
        if let Err(why) = method.check(scene.model.system()) {
            if !sweep.settings(method).is_empty() {
                refusals.push(format!("scene {}: {why}", scene.name));
            }
            continue;
        }
        runs.extend(sweep.settings(method).iter().map(|&setting| {
            let mut hash = hash;
            hash.add(method.name.bytes().chain(setting.to_le_bytes()));
            Run { id: Id::new(hash.value()), variant: 0, method, setting }
        }));
    }
    Ok((variant, runs, refusals))
}
