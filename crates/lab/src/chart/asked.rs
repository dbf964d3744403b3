//! Checks of the command line against the scene: the solvers, the metric, and the particles and
//! times at which errors are taken.

use a3_core::accuracy::Metric;
use a3_core::{Error, Method, Scene, integrators};

use a3_files::bounds::{HORIZONS, OWN_HORIZONS};
use a3_files::failure::Failure;

/// Returns the methods that were asked for, each once. If none was named, these are all that
/// support the scene and repeat no other.
///
/// # Errors
/// A method that was asked for does not support the scene.
pub fn methods(
    scene: &Scene,
    asked: &[Option<&'static Method>],
) -> Result<Vec<&'static Method>, Failure> {
    if asked.iter().all(Option::is_none) {
        let all = integrators::METHODS.iter();
        return Ok(all
            .filter(|m| m.check(scene.model.system()).is_ok())
            .filter(|m| !m.repeats_another(scene.model.system()))
            .collect());
    }
    let asked: Vec<_> = asked.iter().copied().flatten().collect();
    check_methods(scene, &asked)
}

/// Returns the methods that were asked for, each once. If there are none, these are all of the
/// table that support the scene and repeat no other.
///
/// # Errors
/// A method does not support the scene, or two methods have one name.
pub fn check_methods(
    scene: &Scene,
    asked: &[&'static Method],
) -> Result<Vec<&'static Method>, Failure> {
    if asked.is_empty() {
        return methods(scene, &[]);
    }
    let mut methods: Vec<&'static Method> = vec![];
    for &method in asked {
        method
            .check(scene.model.system())
            .map_err(|e| Failure::usage(format!("scene {}: {e}", scene.name)))?;
        match methods.iter().find(|m| m.name == method.name) {
            None => methods.push(method),
            Some(other) if std::ptr::eq(*other, method) => {}
            Some(_) => {
                return Err(Failure::usage(format!(
                    "two methods are called {}: give one of them another name",
                    method.name
                )));
            }
        }
    }
    Ok(methods)
}

/// Checks the end of the runs of a scene (s), if it is given.
pub fn check_until(scene: &Scene, until: Option<f64>) -> Result<Option<f64>, Failure> {
    let allowed = match scene.model.network() {
        Some(_) => HORIZONS,
        None => OWN_HORIZONS,
    };
    until.map(|until| allowed.check(until)).transpose()
}

/// Checks that a scene's state has the length that its system needs, and finite numbers.
pub fn check_scene(scene: &Scene) -> Result<(), Failure> {
    let (expected, found) = (scene.model.system().dim(), scene.state.len());
    let wrong = |why: String| Err(Failure::usage(format!("scene {}: {why}", scene.name)));
    if expected != found {
        return wrong(Error::Dimension { expected, found }.to_string());
    }
    match scene.state.iter().position(|y| !y.is_finite()) {
        Some(k) => wrong(format!("number {k} of the state is not finite")),
        None => Ok(()),
    }
}

/// Checks that the metric is defined for the scene: springs, energy and momentum need a network,
/// penetration and impacts need surfaces that touch.
pub fn check_metric(metric: Metric, scene: &Scene) -> Result<(), Failure> {
    let of_contact = matches!(metric, Metric::Penetration | Metric::Impact);
    let network = scene.model.network();
    if of_contact && network.is_none_or(|network| network.contact_layer().is_none()) {
        return Err(Failure::usage(format!(
            "no surfaces touch in the scene {}: ask for another error, or give it self_collision = true",
            scene.name
        )));
    }
    let motion = Metric::of_motion(&scene.model);
    match metric {
        Metric::Phase => Ok(()),
        metric if metric == motion => Ok(()),
        Metric::State => Err(Failure::usage(format!(
            "the scene {} has particles: ask for position instead of state",
            scene.name
        ))),
        _ if network.is_some() => Ok(()),
        Metric::Energy if scene.model.own_energy(0.0, &scene.state).is_some() => Ok(()),
        _ => Err(Failure::usage(format!(
            "the scene {} has neither energy nor momentum nor springs: ask for {} or phase",
            scene.name,
            motion.name()
        ))),
    }
}

/// Checks that a metric of contact measures something until `until` (s). `still` is the error of a
/// run in which nothing moves: if it is 0, there is no impact, or no surfaces come within a
/// thickness.
pub fn check_contact(metric: Metric, still: f64, until: f64) -> Result<(), Failure> {
    match metric {
        Metric::Impact if still == 0.0 => Err(Failure::usage(format!(
            "no impact begins or ends in {until} s: ask for penetration, or for a longer --until"
        ))),
        Metric::Penetration if still == 0.0 => Err(Failure::usage(format!(
            "no surfaces come nearer than their thickness in {until} s: ask for a longer --until"
        ))),
        _ => Ok(()),
    }
}
