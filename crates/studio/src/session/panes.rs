//! Panes that come and go while the motion goes on: other methods beside the present one.

use a3_core::{Error, Simulation};

use super::continued::continue_from;
use super::list::Topic;
use super::pane::Pane;
use super::question::MethodSetting;
use super::state::Session;

/// Largest number of panes.
pub const MAX_PANES: usize = 4;

/// Adds a pane that continues the run of pane `at` by another method. Errors count from now on, if
/// there were none before. The timeline begins again.
///
/// # Errors
/// There is no room for another pane, the run has blown up, or the method does not support it.
pub fn add(
    session: &mut Session,
    at: usize,
    (method, control): MethodSetting,
) -> Result<(), String> {
    if session.runs.panes.len() >= MAX_PANES {
        return Err(format!("There are {MAX_PANES} panes already: close one."));
    }
    session.release();
    session.runs.align();
    let beside = &session.runs.panes[at];
    if !beside.alive() {
        return Err("This run has blown up: reset it (key r).".into());
    }
    let run = &beside.simulation;
    let continued = || -> Result<Simulation, Error> {
        let mut next = Simulation::new(run.scene().clone(), method, control)?;
        continue_from(&mut next, run)?;
        Ok(next)
    };
    let simulation = continued().map_err(|why| why.to_string())?;
    let mut show = beside.show.clone();
    show.clear_trail();
    show.hovered = None;
    let mut next = Pane::new(simulation, show);
    next.traces = beside.traces.without_values();
    session
        .runs
        .add_pane(next)
        .map_err(|failure| failure.to_string())?;
    session
        .readings
        .read_reference(session.runs.reference.as_ref());
    session.begin_new_run();
    session
        .readings
        .say(format!("{} runs beside.", method.title));
    Ok(())
}

/// Removes a pane, unless it is the only one. Undone changes of knobs of panes are forgotten, and
/// the timeline begins again.
pub fn remove(session: &mut Session, at: usize) -> bool {
    if session.runs.panes.len() < 2 || at >= session.runs.panes.len() {
        return false;
    }
    session.release();
    session.runs.remove_pane(at);
    session.panel.pane = 0;
    session.history.clear();
    session.view.stop_following();
    if let Some(Topic::Solvers { .. } | Topic::Beside { .. }) =
        session.list.as_ref().map(|it| it.topic)
    {
        session.list = None;
    }
    session
        .readings
        .read_reference(session.runs.reference.as_ref());
    session.begin_new_run();
    true
}

/// Sets the method of pane `at` and its step or tolerance, or says why that is impossible.
pub fn set(session: &mut Session, at: usize, (method, control): MethodSetting) {
    let defaults = session.tuning.defaults;
    let set = session.runs.set_method(method, at, &defaults);
    let set = set.and_then(|()| session.runs.set_step_of(at, control.value()));
    session.readings.say(match set {
        Ok(()) => format!("{} is in use.", method.title),
        Err(why) => why.to_string(),
    });
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, integrators};

    use super::*;
    use crate::session::{RunAction, compared, frames, session, times};

    fn setting(method: &str, step: f64) -> MethodSetting {
        (integrators::find(method).unwrap(), Control::Step(step))
    }

    /// The pane goes on from the same state as by a run from there, and errors are distances from
    /// the truth.
    #[test]
    fn a_pane_goes_on_from_the_present_state() {
        let mut session = session(&["r", "0.01", "--scene", "simple"]);
        frames(&mut session, 1.0);
        add(&mut session, 0, setting("euler", 0.05)).unwrap();
        let [rk4, euler] = [0, 1].map(|k| session.runs.panes[k].simulation.state().to_vec());
        assert_eq!(rk4, euler);
        let begun = session.runs.clock;
        frames(&mut session, 2.0);
        let run = &session.runs.panes[1].simulation;
        let steps = ((run.time() - begun) / 0.05).round();
        // A step of Euler's method on the circle lengthens the radius by sqrt(1 + h^2).
        let radius = run.position(0).norm();
        let expected = 1.0025_f64.powf(0.5 * steps);
        assert!((radius - expected).abs() < 1e-6, "{radius} {expected}");
        let error = session.runs.panes[1].error.unwrap();
        assert!(error > radius - 1.0 && error < 0.2, "{error}");
        assert!(session.runs.panes[0].error.unwrap() < 1e-6);
        let times = times(&session);
        assert!(times[0] > 2.9 && (times[0] - times[1]).abs() < 0.051);
    }

    #[test]
    fn panes_come_up_to_four_and_go_down_to_one() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        frames(&mut session, 0.2);
        for step in [0.02, 0.005, 0.001] {
            add(&mut session, 0, setting("rk4", step)).unwrap();
            frames(&mut session, 0.1);
        }
        assert!(add(&mut session, 0, setting("rk4", 0.01)).is_err());
        session.panel.pane = 3;
        assert!(remove(&mut session, 0));
        let steps = |session: &Session| -> Vec<f64> {
            let panes = session.runs.panes.iter();
            panes
                .map(|pane| pane.simulation.control().value())
                .collect()
        };
        assert_eq!(steps(&session), [0.02, 0.005, 0.001]);
        frames(&mut session, 0.1);
        session.act(RunAction::Scrub(-3), 0);
        session.act(RunAction::Pause, 0);
        for _ in 0..2 {
            assert!(remove(&mut session, 1));
        }
        assert!(!remove(&mut session, 0));
        assert_eq!(steps(&session), [0.02]);
        frames(&mut session, 0.1);
        assert!(session.runs.reference.is_none() && session.runs.panes[0].error.is_none());
        session.act(RunAction::Reset, 0);
        assert_eq!(session.runs.first().time(), 0.0);
    }

    #[test]
    fn a_run_that_blew_up_or_an_unfit_method_is_not_continued() {
        let mut session = compared(&["e:0.05", "r:0.01", "--scene", "mit"], 2.0);
        assert!(add(&mut session, 0, setting("rk4", 0.01)).is_err());
        let mut circle = crate::session::session(&["r", "0.01", "--scene", "simple"]);
        assert!(add(&mut circle, 0, setting("verlet", 0.01)).is_err());
        assert_eq!(circle.runs.panes.len(), 1);
        set(&mut circle, 0, setting("trapezoid", 0.03));
        let run = circle.runs.first();
        assert_eq!(
            (run.method().name, run.control()),
            ("trapezoid", Control::Step(0.03))
        );
    }
}
