//! Exchange of the scene of all runs for one without some of its parts, or with others, while the
//! motion goes on.

use std::collections::HashSet;
use std::sync::Arc;

use a3_core::contact::Shape;
use a3_core::{Checkpoint, Error, Network, Path, Scene, Simulation};
use a3_scenes::{Part, PartChange, Presentation, Splice};

use super::origin::{Origin, Passage};
use super::pane::Pane;
use super::state::Session;
use super::tuning::Tuning;

/// The runs, their scene and its tuning before an exchange.
pub struct Former {
    simulations: Vec<Simulation>,
    presentation: Arc<Presentation>,
    tuning: Tuning,
    origin: Origin,
    /// How the exchange back to them numbers particles and rigid bodies.
    numbers: [Splice; 2],
}

/// An obstacle in the whole scene: its kind, as in [`PartChange::Obstacle`], and its number among
/// those of its kind.
type ObstacleId = (usize, usize);

/// Continues all runs in the scene without these parts, untuned, and returns what was before. The
/// state, the time, pins, hands, wind, swing and self-collision stay. The timeline begins again.
/// Fails, and changes nothing, if a run has diverged, or if there is no such scene for its solver.
pub fn leave_out(session: &mut Session, left_out: Vec<usize>) -> Result<Former, String> {
    let (origin, parts) = (session.scenes.shown.clone(), session.tuning.parts.clone());
    let passage = Passage::default();
    go_on(session, origin, (parts, left_out), (&passage, &[]))
}

/// Continues all runs, as [`leave_out`] does, in an edited scene, without the same parts as before;
/// or from their states `then` in that scene, the last of which is for all further runs.
pub fn edit(
    session: &mut Session,
    origin: Origin,
    passage: &Passage,
    then: &[Option<Checkpoint>],
) -> Result<Former, String> {
    let whole = origin.build().map_err(|error| error.to_string())?;
    let parts = origin.parts(&whole.scene);
    let tuning = &session.tuning;
    let names = tuning.left_out.iter().map(|k| &tuning.parts[*k].name);
    let left_out = names.filter_map(|name| parts.iter().position(|part| part.name == *name));
    let parts = (parts.clone(), left_out.collect());
    session.release();
    let former = go_on(session, origin, parts, (passage, then))?;
    let panes = session.runs.panes.iter_mut();
    for (pane, before) in panes.zip(&former.simulations) {
        let now = &pane.simulation;
        pane.traces.drop_removed(before, now, passage.particles);
    }
    Ok(former)
}

/// Continues all runs in a scene, without some of its parts.
fn go_on(
    session: &mut Session,
    origin: Origin,
    (parts, left_out): (Vec<Part>, Vec<usize>),
    (passage, then): (&Passage, &[Option<Checkpoint>]),
) -> Result<Former, String> {
    if !session.runs.panes.iter().all(Pane::alive) {
        return Err("A run has blown up: reset it (key r) before you change its parts.".into());
    }
    if session.runs.first().grabbed_obstacle().is_some() {
        session.release();
    }
    session.runs.align();
    let without: Vec<&Part> = left_out.iter().map(|k| &parts[*k]).collect();
    let built = origin.build_without(&without);
    let setup = built.map_err(|error| error.to_string())?;
    let tuning = &session.tuning;
    let next = Tuning {
        own: setup.scene.clone(),
        parts,
        left_out,
        parked: vec![],
        stiffness: 1.0,
        damping: 1.0,
        gusts: 1.0,
        ..tuning.clone()
    };
    let changes = [tuning.changes(), next.changes()];
    let runs = session.runs.all().enumerate();
    let runs = runs.map(|(k, run)| {
        let then = then.get(k).or(then.last()).and_then(Option::as_ref);
        continued(run, &setup.scene, &changes, (passage, then))
    });
    let simulations: Result<Vec<_>, String> = runs.collect();
    let next = Former {
        simulations: simulations?,
        presentation: setup.presentation,
        tuning: next,
        origin,
        numbers: [passage.particles, passage.bodies],
    };
    Ok(exchange(session, next))
}

/// Exchanges the runs, their scene and its tuning for others, and returns the former ones.
pub fn exchange(session: &mut Session, next: Former) -> Former {
    let presentation = session.runs.panes[0].show.presentation.clone();
    let runs = &mut session.runs;
    let mut next_runs = next.simulations.into_iter();
    let mut simulations = vec![];
    for (pane, run) in runs.panes.iter_mut().zip(next_runs.by_ref()) {
        simulations.push(pane.exchange(run, &next.presentation, next.numbers));
    }
    for (reference, run) in runs.reference.iter_mut().zip(next_runs) {
        simulations.push(reference.exchange(run));
    }
    session.view.renumber(next.numbers[0]);
    session.panel.plotting.renumber(next.numbers);
    let tuning = std::mem::replace(&mut session.tuning, next.tuning);
    let origin = std::mem::replace(&mut session.scenes.shown, next.origin);
    let parts = &session.tuning.parts;
    let left_out = session.tuning.left_out.iter();
    let names = left_out.map(|k| parts[*k].name.clone());
    session.readings.left_out = names.collect();
    session.begin_new_run();
    Former { simulations, presentation, tuning, origin, numbers: next.numbers.map(Splice::back) }
}

/// Creates a run that continues another one in a scene with other parts. `changes` are those of
/// the parts that are left out before and afterwards.
fn continued(
    run: &Simulation,
    scene: &Scene,
    changes: &[Vec<PartChange>; 2],
    (passage, then): (&Passage, Option<&Checkpoint>),
) -> Result<Simulation, String> {
    if !passage.fits(run.state().len(), scene) {
        return Err("Without this part, the scene has other particles.".into());
    }
    let scene = Scene { limits: run.scene().limits, ..scene.clone() };
    let (method, control) = (run.method(), run.control());
    let go_on = || -> Result<Simulation, Error> {
        let mut next = Simulation::new(scene, method, control)?;
        let mut moment = run.moment();
        if let Some(then) = then {
            moment = then.clone();
            let (time, state) = (moment.time(), &mut moment.run);
            (state.method, state.control) = (method, control);
            (state.since, state.taken, state.shown) = (time, 0, None);
        } else {
            fit(&mut moment, run, &next, changes, passage);
        }
        next.restore(&moment)?;
        // The energy of a part that comes or goes is no gain of the solver.
        next.set_method(method, control)?;
        Ok(next)
    };
    go_on().map_err(|error| error.to_string())
}

/// Fits a checkpoint of a run to a fresh run of the scene with other parts: obstacles that stay
/// keep their paths, springs that are not there cannot be torn, and the wind is the scene's.
fn fit(
    moment: &mut Checkpoint,
    run: &Simulation,
    next: &Simulation,
    [before, after]: &[Vec<PartChange>; 2],
    passage: &Passage,
) {
    let (Some(old), Some(new)) = (run.model().network(), next.model().network()) else {
        return;
    };
    let known = obstacle_ids(old, before);
    let path_of = |id: ObstacleId| -> Option<Path> {
        let (k, _) = known.iter().find(|(_, known)| *known == id)?;
        Some(old.obstacles()[*k].path)
    };
    let obstacles = obstacle_ids(new, after).into_iter();
    moment.obstacles =
        obstacles.map(|(k, id)| (k, path_of(id).unwrap_or(new.obstacles()[k].path))).collect();
    passage.take(moment, run, next);
    if !moment.torn.is_empty() {
        let whole = new.all_springs();
        let ends = whole.map(|spring| [spring.i.min(spring.j), spring.i.max(spring.j)]);
        let there: HashSet<_> = ends.chain(new.torn().iter().copied()).collect();
        moment.torn.retain(|ends| there.contains(ends));
    }
    moment.wind = next.scene().wind.filter(|_| moment.wind.is_some());
    moment.touching &= next.scene().touch.is_some();
}

/// Returns the indices of the obstacles of a network, except floors, with their places in the
/// whole scene. The obstacles of a kind are in the order of the scene.
pub fn obstacle_ids(network: &Network, left_out: &[PartChange]) -> Vec<(usize, ObstacleId)> {
    let mut next = [0; 4];
    let obstacles = network.obstacles().iter().enumerate();
    obstacles
        .filter_map(|(k, obstacle)| {
            let kind = match obstacle.shape {
                Shape::Sphere { .. } => 0,
                Shape::Box { .. } => 1,
                Shape::Capsule { .. } => 2,
                Shape::Mesh(_) => 3,
                Shape::Floor => return None,
            };
            while left_out.contains(&PartChange::Obstacle(kind, next[kind])) {
                next[kind] += 1;
            }
            next[kind] += 1;
            Some((k, (kind, next[kind] - 1)))
        })
        .collect()
}
