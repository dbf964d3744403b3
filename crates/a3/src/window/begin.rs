//! Sessions from command-line arguments, for windows and for pictures.

use a3_core::{Simulation, StepLimits};
use clap::Parser;

use crate::base::failure::Failure;
use crate::cli::{Cli, Command, Compare, Drawing, Look, SceneArgs, WindowOptions};
use crate::draw::show::{self, Quantity};
use crate::files::checkpoint::Kept;
use crate::files::lessons::{self, Step};
use crate::files::scene_file::Source;
use crate::files::setup::Request;
use crate::window::session::{Beginning, Origin, Session, begins_crossed, offer_at_start};

/// Creates the session of a window on one run. Fails if an option does not fit the scene.
pub fn window(options: &WindowOptions) -> Result<Session, Failure> {
    let mut request = options.what.request()?;
    request.source = request.source.in_window();
    window_on(request, options)
}

/// Creates the session of a window on one run of a scene that was read already.
fn window_on(mut request: Request, options: &WindowOptions) -> Result<Session, Failure> {
    let source = request.source.clone();
    if options.watch && (source.path.is_none() || source.is_input()) {
        return Err(Failure::usage(
            "--watch needs a scene file, as in `--scene flag.toml --watch`",
        ));
    }
    let kept = options.resume.as_deref().map(Kept::read).transpose()?;
    let resumed = kept.map(|kept| kept.checkpoint.run.method);
    let solver = source.solver_or(options.solver.or(resumed));
    let mut setup = request.build()?;
    let touches = request.source.description.self_collision || request.options.on.contact;
    let crossed = touches && begins_crossed(&setup.scene);
    if crossed {
        request.source = request.source.without_touch();
        request.options.on.contact = false;
        setup = request.build()?;
    }
    setup.scene.limits = options.limits.given().or(setup.scene.limits);
    let simulation = begun(
        request.simulate(&setup, solver, options.step)?,
        &options.look,
    )?;
    check_particle(&simulation, options.springs_of)?;
    check_drawing(&simulation, options.look.manner, false)?;
    let beginning = Beginning {
        manner: options.look.manner.of(options.springs_of),
        paused: options.look.paused,
    };
    let mut origin = origin(request, options.limits.given());
    origin.crossed = crossed && !options.look.no_self_collision;
    let mut session = Session::new(origin, &setup, vec![simulation], &beginning)?;
    let is_asked = options.step.is_some() || options.resume.is_some();
    let names_none = session.scenes.shown.source.description.step.is_none();
    if !is_asked
        && names_none
        && let Some(why) = session.runs.fit_steps()
    {
        session.readings.say(why);
    }
    offer_at_start(&mut session);
    Ok(session)
}

/// Creates the session of a comparison. Fails if an option does not fit the scene.
pub fn comparison(options: &Compare) -> Result<Session, Failure> {
    let count = options.methods.len();
    if !(2..=4).contains(&count) {
        return Err(Failure::usage(format!(
            "compare takes 2 to 4 solvers, as in `a3 compare e:0.05 r:0.05`, not {count}"
        )));
    }
    comparison_on(options.what.request()?, options)
}

/// Creates the session of a comparison on a scene that was read already.
fn comparison_on(request: Request, options: &Compare) -> Result<Session, Failure> {
    let mut setup = request.build()?;
    setup.scene.limits = options.limits.given().or(setup.scene.limits);
    let simulations = options
        .methods
        .iter()
        .map(|(solver, step)| begun(request.simulate(&setup, solver, *step)?, &options.look))
        .collect::<Result<Vec<_>, Failure>>()?;
    check_drawing(&simulations[0], options.look.manner, true)?;
    let beginning = Beginning {
        manner: options.look.manner.of(None),
        paused: options.look.paused,
    };
    Session::new(
        origin(request, options.limits.given()),
        &setup,
        simulations,
        &beginning,
    )
}

/// Returns a run that begins with or without self-collision, as the options say.
fn begun(mut run: Simulation, look: &Look) -> Result<Simulation, Failure> {
    if look.no_self_collision {
        run.set_touching(false).map_err(Failure::usage)?;
    }
    Ok(run)
}

/// Creates the session of a step of a lesson, which pauses at the time of the step. Fails if its
/// command line does not fit its scene.
pub fn step(step: &Step) -> Result<Session, Failure> {
    let options = Cli::try_parse_from(step.run.split_whitespace()).map_err(Failure::usage)?;
    let request = |what: &SceneArgs| match lessons::scene(&what.scene) {
        Some(text) => Ok(Request {
            source: Source::carried(&what.scene, text)?,
            options: what.options(),
        }),
        None => what.request(),
    };
    let mut session = match options.command {
        Some(Command::Compare(options)) => comparison_on(request(&options.what)?, &options)?,
        _ => window_on(request(&options.window.what)?, &options.window)?,
    };
    let own = session.tuning.defaults.duration;
    session.tuning.defaults.duration = step.until.or(own);
    Ok(session)
}

fn origin(request: Request, limits: StepLimits) -> Origin {
    Origin {
        source: request.source,
        grid: request.options.grid,
        limits,
        edited: false,
        crossed: false,
    }
}

/// Checks that the scene has the particle whose springs are requested, if one is.
pub fn check_particle(simulation: &Simulation, particle: Option<usize>) -> Result<(), Failure> {
    match (particle, simulation.model().network()) {
        (Some(i), Some(network)) => network
            .check_particle(i)
            .map_err(|e| Failure::usage(format!("--springs-of: {e}"))),
        (Some(_), None) => Err(Failure::usage("--springs-of: this scene has no springs")),
        (None, _) => Ok(()),
    }
}

/// Checks that the scene supports the requested colours, arrows and springs. `compared` says
/// whether the run is part of a comparison, which has errors.
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
            "errors need a reference, which only a3 compare runs: leave out --colour".into()
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

#[cfg(test)]
mod tests {
    use crate::window::session::{frames, session};

    /// A tiny stiff jelly opens with a step that holds, unless a step is asked for.
    #[test]
    fn a_scene_opens_with_a_step_that_holds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("tiny.toml");
        let jelly = "gravity = [0, -9.81, 0]\nfloor = { height = 0 }\n[[jelly]]\ngrid = [2, 2, 2]\n\
            size = [0.02, 0.02, 0.02]\ndensity = 1000\nat = [0, 0.03, 0]\nstiffness = [20, 20, 20]\n";
        let open = |text: &str, more: &[&str]| {
            std::fs::write(&path, text).unwrap();
            session(&[more, &["--scene", path.to_str().unwrap()]].concat())
        };
        let mut opened = open(jelly, &[]);
        let wanted = opened.runs.panes[0].wanted_step.unwrap();
        let step = opened.runs.first().control().step().unwrap();
        let said = opened.readings.message.clone().unwrap();
        let why = format!("the step is {step} s here, since {wanted} s would blow up");
        assert!(step < wanted && said.contains(&why), "{said}");
        frames(&mut opened, 0.2);
        assert!(opened.runs.any_alive());
        let named = format!("solver = 't'\nstep = 0.005\n{jelly}");
        for as_asked in [open(jelly, &["t", "0.005"]), open(&named, &[])] {
            let control = as_asked.runs.first().control();
            assert_eq!(control.step(), Some(0.005));
        }
        // A step that holds stays.
        for scene in ["cloth", "jelly", "boxes"] {
            let step = session(&["--scene", scene]).runs.panes[0].wanted_step;
            assert_eq!(step, None, "{scene}");
        }
    }
}
