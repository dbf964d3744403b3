//! Scenes and simulations from a scene's name and its options.

use std::sync::Arc;

use a3_core::{
    Control, Disturbances, Grid, Method, Model, Rounded, Scene, Simulation, integrators,
};
use a3_scenes::{Description, Presentation, Setup};

use crate::bounds;
use crate::failure::{Failure, InputError};
use crate::platform::terminal;
use crate::scene_file::Source;

/// Options of a scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct SceneOptions {
    /// Grid of the first cloth, `None` for the scene's own.
    pub grid: Option<Grid>,
    /// Wind, swing and contact of surfaces, in a scene where they do not act from the start.
    pub on: Disturbances,
}

/// A scene, with the options that are given for it.
#[derive(Clone)]
pub struct Request {
    pub source: Source,
    pub options: SceneOptions,
}

/// A run without a window that is ready to start.
pub struct Run {
    pub request: Request,
    pub simulation: Simulation,
    pub presentation: Arc<Presentation>,
    /// End of the run (s).
    pub until: f64,
}

impl Request {
    /// Reads the scene of this name or file.
    pub fn read(typed: &str, options: SceneOptions) -> Result<Self, Failure> {
        let source = find(typed, "--scene")?;
        Ok(Self { source, options })
    }

    /// Returns the same request by a description alone: the grid, the wind and the self-collision
    /// of the options are in it.
    pub fn described(&self) -> Self {
        let SceneOptions { grid, on } = self.options;
        let mut description = Description::clone(&self.source.description);
        if let (Some(grid), Some(cloth)) = (grid, description.cloth.first_mut()) {
            cloth.grid = [grid.rows(), grid.cols()];
        }
        if let (true, Some(wind)) = (on.wind, &mut description.wind) {
            wind.on = true;
        }
        description.self_collision |= on.contact;
        let swing = Disturbances { swing: on.swing, ..Disturbances::default() };
        Self {
            source: self.source.described(description),
            options: SceneOptions { grid: None, on: swing },
        }
    }

    /// Returns the same request with another description.
    pub fn with(&self, description: Description) -> Self {
        Self { source: self.source.described(description), options: self.options }
    }

    /// Builds the scene, with the wind, the swing and the self-collision of the options.
    pub fn scene(&self) -> Result<Scene, Failure> {
        disturbed(self.build()?.scene, self.options.on)
    }

    /// Builds the scene with its presentation and its defaults.
    pub fn build(&self) -> Result<Setup, Failure> {
        let setup = self.source.build(self.options.grid)?;
        for note in &setup.presentation.notes {
            terminal::note(&format!("{}: {note}", setup.scene.name));
        }
        if let Some(network) = setup.scene.model.network() {
            let count = network.particles();
            let held = network.pins().count();
            if count > 1 && held == count && network.all_pins().all(|pin| pin.until.is_none()) {
                let drained = network.fluid().map_or(0, |it| it.members().drained().len());
                let why = if drained == 0 { "are pinned" } else { "are pinned or have flowed out" };
                terminal::note(&format!(
                    "all {count} particles of the scene {} {why}",
                    setup.scene.name
                ));
            }
        }
        if setup.scene.fitted > 0.0 {
            terminal::note(&format!(
                "the velocities at the start do not fit the constraints: impulses changed them by up to {} m/s",
                Rounded(setup.scene.fitted)
            ));
        }
        Ok(setup)
    }

    /// Creates a simulation with this solver, and with the solver's own step or tolerance unless
    /// one is given.
    pub fn simulate(
        &self,
        setup: &Setup,
        solver: &'static Method,
        step: Option<f64>,
    ) -> Result<Simulation, Failure> {
        simulate(self.options.on, setup, solver, step)
    }
}

/// Returns a scene with these disturbances from its start.
pub fn disturbed(scene: Scene, on: Disturbances) -> Result<Scene, Failure> {
    check_disturbances(&scene, on)?;
    scene.disturbed(on).map_err(|why| cross(&why))
}

/// Checks that a scene has the wind, the swing and the self-collision that are asked for.
fn check_disturbances(scene: &Scene, on: Disturbances) -> Result<(), Failure> {
    for (asked, there, option) in [
        (on.wind, scene.wind.is_some(), "wind"),
        (on.swing, scene.swing.is_some(), "swing"),
        (on.contact, scene.touch.is_some(), "self-collision"),
    ] {
        if asked && !there {
            return Err(Failure::usage(format!(
                "the scene {} has no {option}: leave out --{option}",
                scene.name
            )));
        }
    }
    Ok(())
}

/// Returns the failure of surfaces that cannot begin to touch.
fn cross(why: &a3_core::Error) -> Failure {
    Failure::usage(format!(
        "--self-collision: {why}; leave the option out, or move apart what crosses"
    ))
}

/// Creates a simulation with these disturbances, as [`Request::simulate`] does.
pub fn simulate(
    on: Disturbances,
    setup: &Setup,
    solver: &'static Method,
    step: Option<f64>,
) -> Result<Simulation, Failure> {
    let scene = &setup.scene;
    check_disturbances(scene, on)?;
    let own = || setup.defaults.control_of(solver);
    let control = step.map_or_else(own, |value| solver.control(value));
    check_control(&scene.model, solver, control)?;
    if let Err(e) = solver.check(scene.model.system()) {
        let serve = integrators::METHODS
            .iter()
            .filter(|m| m.check(scene.model.system()).is_ok())
            .map(|m| m.name);
        let serve = serve.collect::<Vec<_>>().join(", ");
        return Err(Failure::usage(format!(
            "scene {}: {e}; the solvers that can run it are {serve}",
            scene.name
        )));
    }
    let mut simulation = Simulation::new(scene.clone(), solver, control).map_err(Failure::usage)?;
    // What is not asked for stays as it is: in some scenes the wind blows from the start.
    if on.wind {
        simulation.set_wind(true);
        solver.check(simulation.model().system()).map_err(Failure::usage)?;
    }
    simulation.set_swinging(on.swing);
    if on.contact {
        simulation.set_touching(true).map_err(|why| cross(&why))?;
    }
    Ok(simulation)
}

/// Reads and builds a scene: one of the built-in ones by its name, or from a file (TOML, JSON, or a
/// mesh).
///
/// # Errors
/// There is no such scene, or its file or its meshes have a fault.
pub fn scene(name: &str) -> Result<Scene, Failure> {
    Ok(Source::find(name)?.build(None)?.scene)
}

/// Finds the scene that an option names.
pub fn find(typed: &str, option: &str) -> Result<Source, Failure> {
    Source::find(typed).map_err(|error| match error {
        InputError::Unknown(why) => Failure::usage(format!("`{option} {typed}`: {why}")),
        error => error.into(),
    })
}

/// Checks the number of solvers that are compared.
pub fn check_count(count: usize) -> Result<(), Failure> {
    if (2..=4).contains(&count) {
        return Ok(());
    }
    Err(Failure::usage(format!(
        "compare takes 2 to 4 solvers, as in `a3 compare e:0.05 r:0.05`, not {count}"
    )))
}

/// Checks that the step or the tolerance is within its range.
pub fn check_control(model: &Model, method: &Method, control: Control) -> Result<(), Failure> {
    let range = bounds::of_model(model, control);
    if range.contains(&control.value()) {
        return Ok(());
    }
    let (low, high) = (range.start(), range.end());
    Err(Failure::usage(match control {
        Control::Step(step) => {
            let typed = |number: f64| match model.network() {
                Some(_) => number.to_string(),
                None => format!("{number:e}"),
            };
            let (low, high) = (typed(*low), typed(*high));
            format!("a step is a number of seconds from {low} to {high}, such as 0.01, not {step}")
        }
        Control::Tolerance(tolerance) => format!(
            "{} takes a relative tolerance from {low:e} to {high}, such as 1e-4, not {tolerance}",
            method.name
        ),
    }))
}
