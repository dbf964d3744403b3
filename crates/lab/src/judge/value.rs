//! The judgement of states as a value.

use std::path::Path;

use a3_core::Scene;
use a3_core::accuracy::{Horizon, horizon};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use a3_files::states::{parse, read};

use super::judgement::{Course, Judgement, judge};
use super::plain::Plain;
use super::summary::Record;
use super::truth::Truth;
use super::words::text;
use crate::chart::{check_motion, check_scene};

/// Largest time that is judged (s).
const MAX_TIME: f64 = 1000.0;

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
            (
                name.into(),
                states.map_err(|why| Failure::usage(format!("{name}: {why}")))?,
            )
        }
    };
    let last = states.times.last().copied().unwrap_or_default();
    let horizon = look_ahead(scene, last, options.until, monitor)?;
    let plain = Plain::of(scene).ok();
    let course = Course {
        monitor,
        scene,
        plain: plain.as_ref(),
        until: horizon.until,
        step: options.step,
    };
    let judged = judge(&course, &mut Truth::new(scene, &horizon, monitor), &states);
    let judged = judged.map_err(|failure| match failure {
        Failure::Usage(why) => Failure::usage(format!("{name}: {why}")),
        failure => failure,
    })?;
    verdict(&name, &judged.ok_or_else(stopped)?, options.within)
}

fn verdict(name: &str, judgement: &Judgement, within: Option<f64>) -> Result<Verdict, Failure> {
    let record = Record::of(name, judgement, within);
    Ok(Verdict {
        text: text(name, judgement, within),
        json: serde_json::to_string(&record).map_err(Failure::run)?,
    })
}

/// Finds how long errors mean something on the scene, up to the last of the states (s) or to
/// `until` (s).
pub fn look_ahead(
    scene: &Scene,
    last: f64,
    until: Option<f64>,
    monitor: &dyn Monitor,
) -> Result<Horizon, Failure> {
    let last = last.min(MAX_TIME);
    let last = until.map_or(last, |until| last.min(until));
    let found = horizon(scene, last, &|| monitor.go_on()).map_err(Failure::run)?;
    let found = found.ok_or_else(stopped)?;
    check_motion(scene, &found)?;
    let is_chaotic = found.lyapunov.is_finite() && until.is_none();
    Ok(Horizon {
        until: if is_chaotic { found.until } else { last },
        ..found
    })
}

/// Creates the failure of a command that was interrupted before all files were judged.
pub fn stopped() -> Failure {
    Failure::Interrupted("interrupted before all files were judged".into())
}
