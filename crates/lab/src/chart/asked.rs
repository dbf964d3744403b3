//! Checks of what is asked for against the scene: the solvers, the metric, and the particles and
//! times at which errors are taken; and scenes and units of errors in words.

use a3_core::accuracy::Metric;
use a3_core::{Disturbances, Error, Method, Model, Scene, Spring, SpringKind, integrators};
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

/// Checks that the metric is defined for the scene: energy and momentum need a network, strain
/// needs springs, penetration and impacts need surfaces that touch.
pub fn check_metric(metric: Metric, scene: &Scene) -> Result<(), Failure> {
    let of_contact = matches!(metric, Metric::Penetration | Metric::Impact);
    let network = scene.model.network();
    if of_contact && network.is_none_or(|network| network.contact_layer().is_none()) {
        return Err(Failure::usage(format!(
            "no surfaces touch in the scene {}: ask for another error, or give it self_collision = true",
            scene.name
        )));
    }
    let is_structural = |spring: Spring| spring.kind == SpringKind::Structural;
    if metric == Metric::Strain && network.is_some_and(|it| !it.springs().any(is_structural)) {
        return Err(Failure::usage(format!(
            "the scene {} has no springs: ask for another error than strain",
            scene.name
        )));
    }
    let motion = Metric::of_motion(&scene.model);
    match metric {
        Metric::Phase if !scene.model.system().mass_matrix().is_empty() => {
            Err(Failure::usage(format!(
                "the scene {} has a mass matrix, so that no phase is known: ask for state",
                scene.name
            )))
        }
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

/// Returns the unit of a metric, in words.
pub fn unit(metric: Metric) -> &'static str {
    match metric {
        Metric::Position => "m",
        Metric::State => "of its size",
        Metric::Energy => "J",
        Metric::Strain => "of length",
        Metric::Momentum => "kg m/s",
        Metric::Penetration => "of thickness",
        Metric::Phase | Metric::Impact => "s",
    }
}

/// Says how long runs of a model last: the time of a system of one's own may have any unit.
pub fn lasting(model: &Model, until: f64) -> String {
    match model.network() {
        Some(_) => format!("{until} s"),
        None if (1e-3..1e6).contains(&until.abs()) => format!("t = 0 to {until}"),
        None => format!("t = 0 to {until:e}"),
    }
}

/// Words for a scene: what its data and its chart are called.
pub struct Label {
    /// Name in the data; for a scene from a file, with a hash of its files.
    pub name: String,
    /// Description in the title.
    pub title: String,
    /// What was turned on, for the data.
    pub on: Disturbances,
}

impl Label {
    /// Creates the label of a scene in which these disturbances were turned on, with its name in
    /// the data.
    pub fn asked(on: Disturbances, scene: &Scene, name: String) -> Self {
        Self { name, title: describe(on, scene), on }
    }

    /// Creates the label of a scene as it is.
    pub fn of(scene: &Scene) -> Self {
        Self::asked(Disturbances::default(), scene, scene.name.clone())
    }
}

/// Describes the scene in words: its name, its grid, and the disturbances that were turned on.
pub fn describe(on: Disturbances, scene: &Scene) -> String {
    let grid = scene.grid();
    let grid = grid.map_or(String::new(), |g| format!(" {} × {}", g.rows(), g.cols()));
    let wind = if on.wind { ", wind" } else { "" };
    let swing = if on.swing { ", swing" } else { "" };
    let touch = if on.contact { ", self-collision" } else { "" };
    format!("{}{grid}{wind}{swing}{touch}", scene.name)
}
