//! Measurement of the limits of all methods on a scene, at rest and in motion.

use a3_core::stability::{
    Budget, Limit, Mode, Motion, Observation, RestState, fastest, observe_at_rest, rest, spectrum,
};
use a3_core::{Error, Linearized, Method, Scene};
use a3_files::failure::Failure;
use a3_files::monitor::Monitor;
use rayon::prelude::*;

use crate::chart::Label;

/// Largest work of the search for a method's limits in motion, in the unit of a [`Budget`]. It does
/// not depend on the other methods, and so the limits do not.
const MAX_WORK_IN_MOTION: f64 = 1.5e8;
/// Largest work of that for its limits at rest, in the same unit.
const MAX_WORK_AT_REST: f64 = 8e7;

/// Measures the limits of all methods, at rest and in motion at the same time.
pub fn measure(
    scene: &Scene,
    label: &Label,
    methods: &[&'static Method],
    monitor: &dyn Monitor,
) -> Result<Stability, Failure> {
    let go_on = || monitor.go_on();
    // Two adaptive solvers may take the same fixed steps, whose limits are measured once.
    let first = |method: &Method| methods.iter().position(|m| m.shares_integrator(method));
    let measured: Vec<_> = (methods.iter().enumerate())
        .filter_map(|(k, &method)| (first(method) == Some(k)).then_some(method))
        .collect();
    monitor.expect(2.0 + 2.0 * measured.len() as f64);
    monitor.stage("the true motion and the state of rest");
    let at_start = spectrum(scene.model.system(), 0.0, &scene.state);
    let say = |method: &Method, stage| monitor.stage(&format!("{} {stage}", method.name));
    // Nothing is timed here, so methods may be measured in parallel.
    let in_motion = || {
        let motion = Motion::of(scene, go_on)?;
        monitor.advance(1.0);
        let limits = each(&measured, MAX_WORK_IN_MOTION, |method, budget| {
            let Some(motion) = &motion else {
                return Ok(None);
            };
            say(method, "in motion");
            budget.allow(0.6);
            let bounded = motion.bounded(method, budget, go_on)?;
            monitor.advance(0.5);
            say(method, "its errors");
            budget.allow(1.0);
            let longest = bounded.map_or(f64::INFINITY, |seen| seen.held);
            let accurate = motion.accurate(method, longest, budget, go_on)?;
            monitor.advance(0.5);
            let found = (bounded, accurate, budget.limits());
            Ok(go_on().then_some(found))
        });
        Ok::<_, Error>((motion, limits?))
    };
    let at_rest = || {
        let hanging = rest(scene, go_on)?;
        monitor.advance(1.0);
        let limits = each(&measured, MAX_WORK_AT_REST, |method, budget| {
            say(method, "at rest");
            let by_modes = |rest: &RestState| rest.largest_step(method);
            let limit = hanging.as_ref().map(by_modes).transpose()?.flatten();
            let seen = match &hanging {
                Some(rest) => observe_at_rest(rest, method, limit.as_ref(), budget, go_on)?,
                None => None,
            };
            monitor.advance(1.0);
            Ok(go_on().then_some((limit, seen, budget.limits())))
        });
        Ok::<_, Error>((hanging, limits?))
    };
    let (moving, resting) = rayon::join(in_motion, at_rest);
    let (motion, moving) = moving.map_err(Failure::run)?;
    let (hanging, resting) = resting.map_err(Failure::run)?;
    let motion = motion.ok_or_else(Failure::stopped)?;
    let rows: Vec<_> = (measured.iter().zip(resting).zip(moving))
        .filter_map(|((method, rest), moving)| Some(limits(method, rest?, moving?)))
        .collect();
    let row = |method: &'static Method| {
        let row = (rows.iter()).find(|row| row.method.shares_integrator(method))?;
        Some(MethodLimits { method, ..*row })
    };
    let rows: Vec<_> = methods.iter().filter_map(|method| row(method)).collect();
    monitor.clear();
    if rows.is_empty() {
        return Err(Failure::stopped());
    }
    Ok(Stability {
        limits: rows,
        predictable: motion.predictable,
        feedback: scene.model.network().and_then(Linearized::baumgarte_frequency),
        at_rest: hanging.map(|rest| rest.modes),
        at_start,
        complete: monitor.go_on(),
        name: scene.name.clone(),
        title: label.title.clone(),
    })
}

/// Calls `find` for each method in parallel, with a budget of work. Returns the results in the
/// order of the methods. The runs of implicit methods take longest, so they begin first.
fn each<T: Send>(
    methods: &[&'static Method],
    work: f64,
    find: impl Fn(&'static Method, &Budget) -> Result<T, Error> + Sync,
) -> Result<Vec<T>, Error> {
    let mut places: Vec<_> = (0..methods.len()).collect();
    places.sort_by_key(|k| !methods[*k].is_implicit());
    let found = places.into_iter().par_bridge();
    let found = found.map(|k| find(methods[k], &Budget::new(work)).map(|found| (k, found)));
    let mut found = found.collect::<Result<Vec<_>, _>>()?;
    found.sort_by_key(|(k, _)| *k);
    Ok(found.into_iter().map(|(_, found)| found).collect())
}

/// Combines the limits of a method at rest and in motion.
fn limits(
    method: &'static Method,
    (rest, seen_at_rest, short_at_rest): (Option<Limit>, Option<Observation>, bool),
    (mut bounded, accurate, short_in_motion): (Option<Observation>, Option<f64>, bool),
) -> MethodLimits {
    // With a step that is unstable at rest, a run from the start may stay bounded, but it never
    // comes to rest.
    if let (Some(seen), Some(limit)) = (&mut bounded, rest)
        && seen.held > 1.1 * limit.step
    {
        seen.failed = seen.failed.min(limit.step);
    }
    MethodLimits {
        method,
        rest,
        seen_at_rest,
        bounded,
        accurate,
        is_short: short_at_rest || short_in_motion,
    }
}

/// Largest stable and largest accurate steps of methods on a scene.
#[derive(Clone, Debug)]
pub struct Stability {
    /// Limits of each method, in the order of the methods.
    pub limits: Vec<MethodLimits>,
    /// Time (s) until which errors mean something: accurate runs are compared with the true motion
    /// until then.
    pub predictable: f64,
    /// Modes at the start, fastest first.
    pub at_start: Vec<Mode>,
    /// Modes at rest, if the scene comes to rest.
    pub at_rest: Option<Vec<Mode>>,
    /// Natural frequency (rad/s) of the feedback that reduces errors of constraints, which is no
    /// motion; `None` without constraints.
    pub feedback: Option<f64>,
    /// Whether all was measured; false if the monitor stopped it.
    pub complete: bool,
    /// Name of the scene.
    pub(super) name: String,
    /// Description of the scene in titles.
    pub(super) title: String,
}

impl Stability {
    /// Returns the fastest motion back and forth at the start and at rest, as far as there is one.
    #[must_use]
    pub fn fastest_motions(&self) -> [Option<Mode>; 2] {
        let at_rest = self.at_rest.as_deref().unwrap_or_default();
        [&self.at_start, at_rest].map(|modes| self.fastest(modes).copied())
    }

    /// Returns the fastest motion of these modes.
    pub(super) fn fastest<'a>(&self, modes: &'a [Mode]) -> Option<&'a Mode> {
        fastest(modes, self.feedback)
    }
}

/// Limits of a method: of the fixed step, also for an adaptive one.
#[derive(Clone, Copy, Debug)]
pub struct MethodLimits {
    /// Method.
    pub method: &'static Method,
    /// Limit by the modes at rest, if the scene comes to rest.
    pub rest: Option<Limit>,
    /// Step at which a disturbance at rest grew tenfold in runs.
    pub seen_at_rest: Option<Observation>,
    /// Step up to which runs from the start stay bounded.
    pub bounded: Option<Observation>,
    /// Largest step of an accurate run (s).
    pub accurate: Option<f64>,
    /// Whether the work limit made runs shorter or fewer than usual.
    pub is_short: bool,
}
