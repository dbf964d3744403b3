//! Judgements as JSON.

use serde::Serialize;

use super::constant::Mistake;
use super::judgement::{Drift, Judgement};
use super::search::Agreement;
use super::words::{difference, is_within};
use super::words::{mistake, question};

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
        let change = match way.mistake() {
            Some(Mistake::Constant(change)) => Some(change),
            _ => None,
        };
        Self {
            title: way.title(),
            solver: way.solver(),
            step: agreement.step,
            points: agreement.trial.pace.points,
            single_precision: agreement.is_single,
            distance: agreement.compared.distance,
            until: agreement.until,
            mistake: mistake(agreement),
            constant: change.map(|change| change.constant.name().0),
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
