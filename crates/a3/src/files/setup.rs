//! Scenes and simulations from the arguments of the command line.

use std::sync::Arc;

use a3_core::{Control, Method, Rounded, Scene, Simulation, integrators};
use a3_scenes::{Description, Presentation, Setup};

use crate::base::failure::{Failure, InputError};
use crate::base::{bounds, terminal};
use crate::cli::{RunOptions, What};
use crate::files::scene_file::Source;

/// A scene, with the options that the command line gives for it.
pub struct Request {
    pub source: Source,
    pub options: What,
}

/// A run without a window that is ready to start.
pub struct Run {
    pub request: Request,
    pub simulation: Simulation,
    pub presentation: Arc<Presentation>,
    /// End of the run (s).
    pub until: f64,
}

impl Run {
    /// Reads the scene and prepares its run: by the solver that the options name, or else by
    /// `own`, or else by that of the scene.
    pub fn new(options: &RunOptions, own: Option<&'static Method>) -> Result<Self, Failure> {
        let request = Request::read(&options.what)?;
        if let Some(solver) = options.solver.filter(|solver| !solver.is_adaptive()) {
            let given = [
                (options.limits.absolute, "--absolute"),
                (options.limits.max_step, "--max-step"),
            ];
            if let Some((_, option)) = given.iter().find(|(value, _)| value.is_some()) {
                return Err(Failure::usage(format!(
                    "{} takes a step, not a tolerance: leave out {option}",
                    solver.name
                )));
            }
        }
        let duration = request.source.description.duration;
        let until = options.until.or(duration).ok_or_else(|| {
            Failure::usage("the scene has no duration of its own: give --until T in seconds, such as --until 10")
        })?;
        let mut setup = request.build()?;
        let solver = request.source.solver_or(options.solver.or(own));
        setup.scene.limits = options.limits.given().or(setup.scene.limits);
        let simulation = request.simulate(&setup, solver, options.step)?;
        Ok(Self {
            request,
            simulation,
            presentation: setup.presentation,
            until,
        })
    }
}

impl Request {
    /// Reads the scene that the options name.
    pub fn read(options: &What) -> Result<Self, Failure> {
        Ok(Self {
            source: find(&options.scene, "--scene")?,
            options: options.clone(),
        })
    }

    /// Returns the same request by a description alone: the grid, the wind and the self-collision
    /// of the options are in it.
    pub fn described(&self) -> Self {
        let mut options = self.options.clone();
        let mut description = Description::clone(&self.source.description);
        if let (Some(grid), Some(cloth)) = (options.grid.take(), description.cloth.first_mut()) {
            cloth.grid = [grid.rows(), grid.cols()];
        }
        if let (true, Some(wind)) = (std::mem::take(&mut options.wind), &mut description.wind) {
            wind.on = true;
        }
        description.self_collision |= std::mem::take(&mut options.self_collision);
        Self {
            source: self.source.described(description),
            options,
        }
    }

    /// Returns the same request with another description.
    pub fn with(&self, description: Description) -> Self {
        Self {
            source: self.source.described(description),
            options: self.options.clone(),
        }
    }

    /// Builds the scene, with the wind, the swing and the self-collision of the options.
    pub fn scene(&self) -> Result<Scene, Failure> {
        scene_of(&self.options, &self.build()?)
    }

    /// Builds the scene with its presentation and its defaults.
    pub fn build(&self) -> Result<Setup, Failure> {
        let options = &self.options;
        if let Some(count) = options.threads {
            // Only the first call has an effect; later ones fail because the threads are there
            // already.
            let threads = rayon::ThreadPoolBuilder::new().num_threads(count);
            let _ = threads.build_global();
        }
        let setup = self.source.build(options.grid)?;
        for note in &setup.presentation.notes {
            terminal::note(&format!("{}: {note}", setup.scene.name));
        }
        if let Some(network) = setup.scene.model.network() {
            let count = network.particles();
            let held = network.pins().count();
            if count > 1 && held == count && network.all_pins().all(|pin| pin.until.is_none()) {
                terminal::note(&format!(
                    "all {count} particles of the scene {} are pinned",
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
        simulate(&self.options, setup, solver, step)
    }
}

/// Returns a scene as it was built, with the wind, the swing and the self-collision of the options.
pub fn scene_of(options: &What, setup: &Setup) -> Result<Scene, Failure> {
    // Euler's method can run every scene.
    let run = simulate(options, setup, &integrators::METHODS[0], None)?;
    Ok(Scene {
        model: run.model().clone(),
        state: run.state().to_vec(),
        ..run.scene().clone()
    })
}

/// Creates a simulation with these options, as [`Request::simulate`] does.
pub fn simulate(
    options: &What,
    setup: &Setup,
    solver: &'static Method,
    step: Option<f64>,
) -> Result<Simulation, Failure> {
    let scene = &setup.scene;
    for (asked, there, option) in [
        (options.wind, scene.wind.is_some(), "wind"),
        (options.swing, scene.swing.is_some(), "swing"),
        (
            options.self_collision,
            scene.touch.is_some(),
            "self-collision",
        ),
    ] {
        if asked && !there {
            return Err(Failure::usage(format!(
                "the scene {} has no {option}: leave out --{option}",
                scene.name
            )));
        }
    }
    let own = || setup.defaults.control_of(solver);
    let control = step.map_or_else(own, |value| solver.control(value));
    check_control(solver, control)?;
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
    // Without --wind the wind stays as it is: in some scenes it blows from the start.
    if options.wind {
        simulation.set_wind(true);
        solver
            .check(simulation.model().system())
            .map_err(Failure::usage)?;
    }
    simulation.set_swinging(options.swing);
    if options.self_collision {
        simulation.set_touching(true).map_err(|why| {
            Failure::usage(format!(
                "--self-collision: {why}; leave the option out, or move apart what crosses"
            ))
        })?;
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

/// Checks that the step or the tolerance is within its range.
pub fn check_control(method: &Method, control: Control) -> Result<(), Failure> {
    let range = bounds::of(control);
    if range.contains(&control.value()) {
        return Ok(());
    }
    let (low, high) = (range.start(), range.end());
    Err(Failure::usage(match control {
        Control::Step(step) => {
            format!("a step is a number of seconds from {low} to {high}, such as 0.01, not {step}")
        }
        Control::Tolerance(tolerance) => format!(
            "{} takes a relative tolerance from {low:e} to {high}, such as 1e-4, not {tolerance}",
            method.name
        ),
    }))
}
