//! From arguments to what they ask for: scenes, simulations and sessions.

use std::sync::Arc;

use a3_core::{Control, Method, Scene, Simulation, integrators};
use a3_scenes::{Presentation, Setup};

use crate::bounds;
use crate::cli::{Compare, Drawing, RunOptions, What, WindowOptions};
use crate::failure::Failure;
use crate::session::{Beginning, Origin, Session};
use crate::show::{self, Quantity};

/// The session of a window on one run.
pub fn window(options: &WindowOptions) -> Result<Session, Failure> {
    let what = &options.what;
    if options.watch && what.scene.path.is_none() {
        return Err(Failure::usage(
            "--watch needs a scene file, as in `--scene flag.toml --watch`",
        ));
    }
    let solver = what.scene.solver_or(options.solver);
    let setup = build(what)?;
    let simulation = simulate(what, &setup, solver, options.step)?;
    check_particle(&simulation, options.springs_of)?;
    check_drawing(&simulation, options.look.manner, false)?;
    let beginning = Beginning {
        manner: options.look.manner.of(options.springs_of),
        paused: options.look.paused,
    };
    Session::new(origin(what), setup, vec![simulation], &beginning)
}

/// The session of a comparison.
pub fn comparison(options: &Compare) -> Result<Session, Failure> {
    let count = options.methods.len();
    if !(2..=4).contains(&count) {
        return Err(Failure::usage(format!(
            "compare takes 2 to 4 solvers, as in `a3 compare e:0.05 r:0.05`, not {count}"
        )));
    }
    let what = &options.what;
    let setup = build(what)?;
    let simulations = options
        .methods
        .iter()
        .map(|(solver, step)| simulate(what, &setup, solver, *step))
        .collect::<Result<Vec<_>, Failure>>()?;
    check_drawing(&simulations[0], options.look.manner, true)?;
    let beginning = Beginning {
        manner: options.look.manner.of(None),
        paused: options.look.paused,
    };
    Session::new(origin(what), setup, simulations, &beginning)
}

/// The origin of the scene.
fn origin(what: &What) -> Origin {
    Origin {
        source: what.scene.clone(),
        grid: what.grid,
    }
}

/// The simulation of a run without a window, and what of it is shown.
pub fn simulation(options: &RunOptions) -> Result<(Simulation, Arc<Presentation>), Failure> {
    let what = &options.what;
    let (setup, solver) = (build(what)?, what.scene.solver_or(options.solver));
    let simulation = simulate(what, &setup, solver, options.step)?;
    Ok((simulation, setup.presentation))
}

/// The scene, with the wind, the swing and the self-collision that were asked for.
pub fn scene(what: &What) -> Result<Scene, Failure> {
    // Euler's method serves every scene.
    let run = simulate(what, &build(what)?, &integrators::METHODS[0], None)?;
    Ok(Scene {
        model: run.model().clone(),
        state: run.state().to_vec(),
        ..run.scene().clone()
    })
}

/// The scene with its presentation and its defaults.
fn build(what: &What) -> Result<Setup, Failure> {
    if let Some(count) = what.threads {
        // Only the first scene of a command sets it; the others have it.
        let threads = rayon::ThreadPoolBuilder::new().num_threads(count);
        let _ = threads.build_global();
    }
    what.scene.build(what.grid).map_err(Failure::usage)
}

/// A simulation by this solver, with its own step or tolerance unless one is given.
fn simulate(
    what: &What,
    setup: &Setup,
    solver: &'static Method,
    step: Option<f64>,
) -> Result<Simulation, Failure> {
    let scene = &setup.scene;
    for (asked, there, option) in [
        (what.wind, scene.wind.is_some(), "wind"),
        (what.swing, scene.swing.is_some(), "swing"),
        (what.self_collision, scene.touch.is_some(), "self-collision"),
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
    // Without --wind the wind stays as it is: some scenes begin with it.
    if what.wind {
        simulation.set_wind(true);
        solver
            .check(simulation.model().system())
            .map_err(Failure::usage)?;
    }
    simulation.set_swinging(what.swing);
    if what.self_collision {
        simulation.set_touching(true).map_err(Failure::usage)?;
    }
    Ok(simulation)
}

/// `Ok` if the scene has that particle.
pub fn check_particle(simulation: &Simulation, particle: Option<usize>) -> Result<(), Failure> {
    match (particle, simulation.model().network()) {
        (Some(i), Some(network)) => network
            .check_particle(i)
            .map_err(|e| Failure::usage(format!("--springs-of: {e}"))),
        (Some(_), None) => Err(Failure::usage("--springs-of: this scene has no springs")),
        (None, _) => Ok(()),
    }
}

/// `Ok` if the run, which is one of several that are compared or not, has what it is to be coloured
/// by, the arrows, and the springs.
pub fn check_drawing(
    simulation: &Simulation,
    drawing: Drawing,
    compared: bool,
) -> Result<(), Failure> {
    let scene = &simulation.scene().name;
    let has_none = |what: &str, option: &str| {
        format!("the scene {scene} has no {what} to show: leave out --{option}")
    };
    let colour = drawing.colour.filter(|c| !c.is_in(simulation, compared));
    let arrows = drawing.arrows.filter(|a| !a.is_in(simulation));
    let why = match (colour, arrows) {
        (Some(Quantity::Contact), _) => format!(
            "nothing can touch in the scene {scene}: leave out --colour, or let surfaces touch \
             by --self-collision"
        ),
        (Some(Quantity::Error), _) => {
            "errors are shown where there is a reference, which a3 compare runs: leave out --colour"
                .into()
        }
        (Some(colour), _) => has_none(colour.name(), "colour"),
        (None, Some(arrows)) => has_none(arrows.name(), "arrows"),
        (None, None) if drawing.springs && !show::has_springs(simulation) => {
            has_none("springs", "springs")
        }
        (None, None) => return Ok(()),
    };
    Err(Failure::usage(why))
}

/// `Ok` if the step or the tolerance is within its range.
fn check_control(method: &Method, control: Control) -> Result<(), Failure> {
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
