//! Sessions as windows and pictures begin with them.

use a3_core::{Control, Simulation, integrators};
use a3_files::checkpoint::Kept;
use a3_files::failure::Failure;
use a3_files::lessons::{self, Step};
use a3_files::scene_file::Source;
use a3_files::setup::{Request, find};
use a3_media::show::{check_drawing, check_particle};

use super::origin::{Origin, begins_crossed};
use super::state::Session;
use super::view::SEEN_TIME;
use super::words::{Opening, read};

/// Creates the session of a window on one run, or on several side by side. Fails if an option does
/// not fit the scene.
pub fn session(opening: &Opening) -> Result<Session, Failure> {
    let mut source = find(&opening.scene, "--scene")?;
    if opening.methods.len() == 1 {
        source = source.in_window();
    }
    session_on(source, opening)
}

/// Creates the session of a step of a lesson, which pauses at the time of the step. Fails if its
/// command line does not fit its scene.
pub fn step(step: &Step) -> Result<Session, Failure> {
    let words = step.run.split_whitespace().skip(1).map(str::to_owned);
    let opening = read(&words.collect::<Vec<_>>())?;
    let source = match lessons::scene(&opening.scene) {
        Some(text) => Source::carried(&opening.scene, text)?,
        None => find(&opening.scene, "--scene")?,
    };
    let mut session = session_on(source, &opening)?;
    let own = session.tuning.defaults.duration;
    session.tuning.defaults.duration = step.until.or(own);
    // The motion of an accurate run, so that the picture shows what methods do wrong.
    let scene = session.runs.first().scene().clone();
    if let Some(method) = integrators::find("dop853")
        && let Ok(run) = Simulation::new(scene, method, Control::Tolerance(1e-5))
    {
        let until = step.until.unwrap_or(SEEN_TIME);
        session.view.see_motion(&mut session.runs.panes, run, until);
    }
    Ok(session)
}

/// Creates a session on a scene that was read already.
fn session_on(source: Source, opening: &Opening) -> Result<Session, Failure> {
    let request = Request { source, options: opening.options };
    match opening.methods[..] {
        [method] => alone(request, method, opening),
        _ => beside(request, opening),
    }
}

/// Creates a session on one run.
fn alone(
    mut request: Request,
    (solver, step): (Option<&'static a3_core::Method>, Option<f64>),
    opening: &Opening,
) -> Result<Session, Failure> {
    let source = request.source.clone();
    if opening.watch && (source.path.is_none() || source.is_input()) {
        return Err(Failure::usage(
            "--watch needs a scene file, as in `--scene flag.toml --watch`",
        ));
    }
    let kept = opening.resume.as_deref().map(Kept::read).transpose()?;
    let resumed = kept.map(|kept| kept.checkpoint.run.method);
    let solver = source.solver_or(solver.or(resumed));
    let mut setup = request.build()?;
    let touches = request.source.description.self_collision || request.options.on.contact;
    let crossed = touches && begins_crossed(&setup.scene);
    if crossed {
        request.source = request.source.without_touch();
        request.options.on.contact = false;
        setup = request.build()?;
    }
    setup.scene.limits = opening.limits.or(setup.scene.limits);
    let simulation = begun(request.simulate(&setup, solver, step)?, opening)?;
    check_particle(&simulation, opening.manner.springs_of)?;
    check_drawing(&simulation, opening.manner, false)?;
    let mut origin = origin(request, opening);
    origin.crossed = crossed && !opening.no_contact;
    let mut session = Session::new(origin, &setup, vec![simulation], opening)?;
    let is_named = setup.defaults.own_control(solver).is_some();
    let is_asked = step.is_some() || opening.resume.is_some() || is_named;
    if !is_asked && let Some(why) = session.runs.fit_steps() {
        session.readings.say(why);
    }
    session.offer_at_start();
    session.see_motion();
    Ok(session)
}

/// Creates a session on several runs side by side.
fn beside(request: Request, opening: &Opening) -> Result<Session, Failure> {
    let mut setup = request.build()?;
    setup.scene.limits = opening.limits.or(setup.scene.limits);
    let simulations = opening.methods.iter().map(|(solver, step)| {
        let solver = request.source.solver_or(*solver);
        begun(request.simulate(&setup, solver, *step)?, opening)
    });
    let simulations = simulations.collect::<Result<Vec<_>, Failure>>()?;
    check_drawing(&simulations[0], opening.manner, true)?;
    let origin = origin(request, opening);
    let mut session = Session::new(origin, &setup, simulations, opening)?;
    session.see_motion();
    Ok(session)
}

/// Returns a run that begins with or without self-collision, as the options say.
fn begun(mut run: Simulation, opening: &Opening) -> Result<Simulation, Failure> {
    if opening.no_contact {
        run.set_touching(false).map_err(Failure::usage)?;
    }
    Ok(run)
}

fn origin(request: Request, opening: &Opening) -> Origin {
    Origin {
        source: request.source,
        grid: request.options.grid,
        limits: opening.limits,
        edited: false,
        crossed: false,
    }
}

#[cfg(test)]
mod tests {
    use a3_core::StepLength;

    use crate::session::{frames, session};

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
        let [named, longer] = [step, wanted].map(StepLength);
        let why = format!("the step is {named} here, since {longer} would not hold");
        assert!(step < wanted && said.contains(&why), "{said}");
        frames(&mut opened, 0.2);
        assert!(opened.runs.any_alive());
        let named = format!("solver = 't'\nstep = 0.005\n{jelly}");
        for as_asked in [Box::new(open(jelly, &["t", "0.005"])), Box::new(open(&named, &[]))] {
            let control = as_asked.runs.first().control();
            assert_eq!(control.step(), Some(0.005));
        }
        // The scene's step is that of its own solver alone.
        assert!(open(&named, &["rk4"]).runs.panes[0].wanted_step.is_some());
        // A step that holds stays.
        for scene in ["cloth", "jelly", "boxes"] {
            let step = session(&["--scene", scene]).runs.panes[0].wanted_step;
            assert_eq!(step, None, "{scene}");
        }
    }
}
