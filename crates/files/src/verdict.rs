//! Messages about failed runs without a window: a step that would have held, energy that nothing
//! put in, and constraints that are not met.

use std::cell::Cell;
use std::time::Duration;

use a3_core::{Cause, Control, Error, Rounded, Scene, Simulation, StepLength, Unmet, Vector3};

use super::failure::Failure;
use super::holding::{self, Sought};
use super::platform::bar::Bar;
use super::platform::{interrupt, terminal};
use super::processor;

/// Processor time of a search for a step that holds.
const BUDGET: Duration = Duration::from_secs(3);

/// Returns the failure of a run that was to last until the time `until` (s). `kept` is a clause
/// that says what was written.
pub fn lost(run: &Simulation, error: &Error, kept: &str, until: f64) -> Failure {
    let kept = if kept.is_empty() { String::new() } else { format!("; {kept}") };
    Failure::run(format!("{error}{kept}{}", advice(run, error, until)))
}

/// Returns a clause about a step, or a tolerance, that would have held until the time `until` (s),
/// if the step was the cause.
fn advice(run: &Simulation, error: &Error, until: f64) -> String {
    let Error::BlowUp(lost) = error else {
        return String::new();
    };
    if let Some(inside) = inside(run.scene()) {
        return format!("; {inside}");
    }
    match (lost.cause, lost.control) {
        (Cause::ReadsVelocity | Cause::Pinched { .. } | Cause::Contradiction(_), _)
        | (Cause::NotFinite { .. } | Cause::NumberNotFinite { .. }, Control::Tolerance(_)) => {
            String::new()
        }
        _ => format!("; {}", seek(run, until).clause(until)),
    }
}

/// Seeks a step, or a tolerance, that holds until the time `until` (s), with a bar.
fn seek(run: &Simulation, until: f64) -> Sought {
    interrupt::listen();
    let begun = processor::time();
    let bar = Bar::new(BUDGET.as_secs_f64());
    bar.say("looking for a step that holds ");
    let told = Cell::new(0.0);
    let sought = holding::seek(run, until, BUDGET, &|| {
        let taken = processor::time().saturating_sub(begun).as_secs_f64();
        bar.advance(taken - told.replace(taken));
        interrupt::go_on()
    });
    bar.clear();
    sought
}

/// Least depth of a particle inside an obstacle at the start, over the radius of the scene, that is
/// reported.
const MIN_DEPTH: f64 = 1e-6;

/// Returns a clause that names the free particle that begins deepest inside an obstacle, if one
/// does: it is moved out in the first step, and gains the energy of its place there.
fn inside(scene: &Scene) -> Option<String> {
    let (network, n) = (scene.model.network()?, scene.model.particles());
    let least = MIN_DEPTH * scene.extent().1;
    let free = (0..n).filter(|i| !network.is_pinned(*i));
    let depths = free.flat_map(|i| {
        let place = Vector3::from([0, 1, 2].map(|axis| scene.state[axis * n + i]));
        let obstacles = network.obstacles().iter().enumerate();
        obstacles.map(move |(k, obstacle)| (obstacle.depth(0.0, place), i, k))
    });
    let deepest = depths.filter(|(depth, ..)| *depth > least);
    let (depth, i, k) = deepest.max_by(|a, b| a.0.total_cmp(&b.0))?;
    let name = network.obstacles()[k].shape.name();
    Some(format!(
        "particle {i} begins {} m inside the {name} and was moved out; it should begin outside",
        Rounded(depth)
    ))
}

/// Warns on stderr of energy that nothing put into a run, and of constraints that it did not meet.
pub fn warn(run: &Simulation) {
    let (what, better) = match run.control() {
        Control::Step(step) => (format!("the step of {}", StepLength(step)), "shorter"),
        Control::Tolerance(tolerance) => (format!("the tolerance of {tolerance:e}"), "smaller"),
    };
    if let Some(gain) = run.gained() {
        let advice = inside(run.scene()).unwrap_or_else(|| format!("{what} should be {better}"));
        terminal::warn(&format!(
            "warning: the run gained {} J that nothing put in, {} the energy that moves: {advice}",
            Rounded(gain.energy),
            share(gain.share)
        ));
    }
    if let Some(unmet) = run.worst_constraint().filter(Unmet::is_visible) {
        terminal::warn(&format!(
            "warning: {unmet}, was off by {:.2} %: {what} should be {better}",
            100.0 * unmet.share
        ));
    }
    if run.was_nearly_singular() {
        terminal::warn(
            "warning: constraints contradict one another or pins, except at a single place: no force holds particles exactly there, as in a chain that is stretched straight between two pins",
        );
    }
}

/// Returns the words for a share: a percentage, or a number of times.
fn share(share: f64) -> String {
    if share < 1.0 {
        format!("{:.0} % of", 100.0 * share)
    } else {
        format!("{} times", Rounded(share))
    }
}
