//! From arguments to sessions, of windows and of pictures.

use a3_core::{Simulation, StepLimits};

use crate::cli::{Compare, Drawing, What, WindowOptions};
use crate::failure::Failure;
use crate::session::{Beginning, Origin, Session};
use crate::setup::{build, simulate};
use crate::show::{self, Quantity};

/// The session of a window on one run.
pub fn window(options: &WindowOptions) -> Result<Session, Failure> {
    let what = &options.what;
    if options.watch && (what.scene.path.is_none() || what.scene.is_input()) {
        return Err(Failure::usage(
            "--watch needs a scene file, as in `--scene flag.toml --watch`",
        ));
    }
    let solver = what.scene.solver_or(options.solver);
    let mut setup = build(what)?;
    setup.scene.limits = options.limits.given().or(setup.scene.limits);
    let simulation = simulate(what, &setup, solver, options.step)?;
    check_particle(&simulation, options.springs_of)?;
    check_drawing(&simulation, options.look.manner, false)?;
    let beginning = Beginning {
        manner: options.look.manner.of(options.springs_of),
        paused: options.look.paused,
    };
    Session::new(
        origin(what, options.limits.given()),
        &setup,
        vec![simulation],
        &beginning,
    )
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
    let mut setup = build(what)?;
    setup.scene.limits = options.limits.given().or(setup.scene.limits);
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
    Session::new(
        origin(what, options.limits.given()),
        &setup,
        simulations,
        &beginning,
    )
}

/// The origin of the scene.
fn origin(what: &What, limits: StepLimits) -> Origin {
    Origin {
        source: what.scene.clone(),
        grid: what.grid,
        limits,
    }
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

/// Checks that the scene supports the requested colours, arrows and springs.
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
