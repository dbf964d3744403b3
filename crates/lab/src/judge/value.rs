//! The judgement of states as a value, in words and as JSON.

use std::path::Path;

use a3_core::Scene;
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::states::{parse, read};
use serde::Serialize;

use super::constant::Mistake;
use super::judgement::{Drift, Judgement};
use super::search::Agreement;
use super::trial::Course;
use super::words::{difference, is_within, mistake, question, text};
use crate::chart::check_scene;

/// States of another program.
#[derive(Clone, Copy, Debug)]
pub enum StatesOf<'a> {
    /// File in one of the formats of `a3 judge`.
    File(&'a Path),
    /// Name and contents of an archive (`.npz`) of arrays t, x and perhaps v.
    Npz(&'a str, &'a [u8]),
}

/// Options of a [judgement](judge_states()).
#[derive(Clone, Copy, Debug, Default)]
pub struct JudgeOptions {
    /// Time up to which states are judged (s); by default as long as errors mean something.
    pub until: Option<f64>,
    /// Step of the program (s), if its states are not a whole number of steps apart.
    pub step: Option<f64>,
    /// Largest error that is accepted (m).
    pub within: Option<f64>,
}

/// Judgement of states.
#[derive(Clone, Debug)]
pub struct Verdict {
    /// The judgement in words.
    pub text: String,
    /// The judgement as JSON, as `a3 judge --summary` writes it.
    pub json: String,
}

/// Judges the states of another program on a scene, as `a3 judge` does.
///
/// # Errors
/// The states cannot be read or do not fit the scene, nothing moves, or the reference cannot be
/// computed.
pub fn judge_states(
    scene: &Scene,
    states: StatesOf,
    options: &JudgeOptions,
    monitor: &dyn Monitor,
) -> Result<Verdict, Failure> {
    check_scene(scene)?;
    let particles = scene.model.particles();
    let (name, states) = match states {
        StatesOf::File(path) => (path.display().to_string(), read(path, particles)?),
        StatesOf::Npz(name, bytes) => {
            let states = parse(bytes, "npz", particles);
            (name.into(), states.map_err(|why| Failure::usage(format!("{name}: {why}")))?)
        }
    };
    let last = states.times.last().copied().unwrap_or_default();
    let mut course = Course::new(scene, last, options.until, options.step, monitor)?;
    let judgement = course.judge(&name, &states)?;
    let record = Record::of(&name, &judgement, options.within);
    Ok(Verdict {
        text: text(&name, &judgement, options.within),
        json: serde_json::to_string(&record).map_err(Failure::run)?,
    })
}

/// Judgement of a file, with the keys of the summary.
#[derive(Serialize)]
pub struct Record<'a> {
    file: &'a str,
    /// Last time that is judged (s).
    until: f64,
    /// Times (s).
    times: Vec<f64>,
    /// Root mean square error of the positions at each time (m).
    errors: Vec<f64>,
    /// Largest of these errors (m), its time (s), and the particle that is farthest then.
    error: f64,
    error_time: f64,
    particle: usize,
    /// Uncertainty of the reference (m).
    floor: f64,
    /// Errors of the energy (J): the largest, and that at the end.
    energy_error: Option<f64>,
    energy_error_at_end: Option<f64>,
    /// Largest error of the momentum (kg m/s).
    momentum_error: Option<f64>,
    /// How the first state differs from the start of the scene.
    start: Option<String>,
    /// Step of the program (s).
    step: Option<f64>,
    /// Method that the file agrees with.
    method: Option<Agreed>,
    /// Others that it agrees with as well.
    also: Vec<Agreed>,
    /// Nearest method, if it agrees with none.
    nearest: Option<Agreed>,
    /// Method with a mistake that is much nearer.
    suspect: Option<Agreed>,
    /// Computing time (s).
    seconds: Option<f64>,
    /// First time at which a number is not finite (s).
    not_finite_at: Option<f64>,
    /// Whether the error is within that of --within.
    within: Option<bool>,
}

/// Agreement with a method.
#[derive(Serialize)]
struct Agreed {
    title: &'static str,
    /// Name of the solver of a3.
    solver: Option<&'static str>,
    step: f64,
    /// Number of grid points from one at which a step ends to the next such one.
    points: u64,
    /// Whether it agrees with the program in single precision.
    single_precision: bool,
    /// Largest distance (m).
    distance: f64,
    /// Last time of the agreement (s), if it is not the end.
    until: Option<f64>,
    /// Slip or mistake.
    mistake: Option<String>,
    /// Constant that is another, and its value over that of the scene.
    constant: Option<&'static str>,
    factor: Option<f64>,
    question: Option<String>,
    /// Where the comparison begins.
    start: String,
}

impl Agreed {
    fn of(agreement: &Agreement) -> Self {
        let way = agreement.trial.way;
        let change = way.mistake().and_then(Mistake::change);
        Self {
            title: way.title(),
            solver: way.solver(),
            step: agreement.step,
            points: agreement.trial.pace.points,
            single_precision: agreement.is_single,
            distance: agreement.compared.distance,
            until: agreement.until,
            mistake: mistake(agreement),
            constant: change.map(|change| change.name().0),
            factor: change.map(|change| change.factor),
            question: question(agreement),
            start: format!("{:?}", agreement.trial.start).to_lowercase(),
        }
    }
}

impl<'a> Record<'a> {
    /// Returns the record of the judgement of a file.
    pub fn of(file: &'a str, judgement: &Judgement, within: Option<f64>) -> Self {
        let Judgement { worst, found, .. } = judgement;
        let agreed = |agreement: &Option<Agreement>| agreement.as_ref().map(Agreed::of);
        let largest = |drift: Drift| drift.worst;
        Self {
            file,
            until: judgement.until,
            times: judgement.errors.iter().map(|(t, _)| *t).collect(),
            errors: judgement.errors.iter().map(|(_, e)| *e).collect(),
            error: worst.error,
            error_time: worst.time,
            particle: worst.particle,
            floor: judgement.floor,
            energy_error: judgement.energy.map(largest),
            energy_error_at_end: judgement.energy.map(|drift| drift.end),
            momentum_error: judgement.momentum.map(largest),
            start: judgement.start.as_ref().map(difference),
            step: judgement.step,
            method: agreed(&found.found),
            also: found.also.iter().map(Agreed::of).collect(),
            nearest: agreed(&found.nearest),
            suspect: agreed(&found.suspect),
            seconds: judgement.seconds,
            not_finite_at: judgement.not_finite_at,
            within: within.map(|within| is_within(judgement, within)),
        }
    }
}
