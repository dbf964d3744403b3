//! The text about a run that blew up.

use a3_core::{BlowUp, Cause, Control};
use a3_files::holding::MIN_HOLD_TIME;
use egui::Ui;

use super::style::{ALARM, text};
use super::words::{digits, seconds, time};
use crate::session::Pane;

/// Writes when the run blew up, which limit the step exceeded, and which step would have been
/// stable.
pub fn explain(ui: &mut Ui, pane: &Pane, blow_up: &BlowUp) {
    ui.label(ALARM.text(&format!("It {blow_up}.")).size(14.5).strong());
    let shown = time(&pane.simulation);
    ui.label(text(format!("The picture shows the time {shown}.")));
    let method = blow_up.method;
    let same = method == pane.simulation.method().title;
    let limit = pane.limit.limit().map(|limit| limit.step);
    let sought = pane.limit.sought().filter(|_| same);
    let until = blow_up.time.max(MIN_HOLD_TIME);
    let sought = sought.map_or(String::new(), |sought| sentence(&sought.clause(until)));
    ui.label(text(match blow_up.control {
        _ if blow_up.cause == Cause::ReadsVelocity => {
            format!("{method} cannot integrate forces that depend on velocity.")
        }
        _ if no_step_is_stable(blow_up) => "A shorter step does not help.".into(),
        Control::Tolerance(tolerance) if matches!(blow_up.cause, Cause::StepTooSmall { .. }) => {
            format!("{method} found no step that meets a tolerance of {tolerance:e}.{sought}")
        }
        Control::Tolerance(tolerance) => {
            format!("A tolerance of {tolerance:e} was too large for {method}.{sought}")
        }
        Control::Step(step) => {
            let past = limit
                .filter(|limit| same && step > *limit)
                .map(|limit| format!(": past its limit here of {} ms", digits(1e3 * limit)));
            let past = past.unwrap_or_default();
            let step = seconds(step);
            format!("A step of {step} s was too long for {method}{past}.{sought}")
        }
    }));
}

/// Returns a clause as a sentence that follows another.
fn sentence(clause: &str) -> String {
    let mut letters = clause.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    let all: String = first.into_iter().chain(letters).collect();
    format!(" {all}.")
}

/// Returns whether pins or moving obstacles left no room between surfaces.
fn is_pinched(blow_up: &BlowUp) -> bool {
    matches!(blow_up.cause, Cause::Pinched { .. })
}

/// Returns whether no step would have been stable.
fn no_step_is_stable(blow_up: &BlowUp) -> bool {
    is_pinched(blow_up) || matches!(blow_up.cause, Cause::Contradiction(_))
}

/// Returns advice on the keys to press after a blow-up.
pub fn advice(blow_up: &BlowUp) -> String {
    if is_pinched(blow_up) {
        return "Press , to go back, or x to let surfaces pass through one another, then r.".into();
    }
    "Press , or drag the timeline to see how, - for a shorter step, or a digit for another solver; or r to \
     start again."
        .into()
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, Simulation, integrators};
    use a3_media::show::{Manner, Show};

    use crate::hud::{pane, read};
    use crate::session::{Pane, Readings, RunAction, session, times};

    #[test]
    fn a_blow_up_says_which_limit_was_passed() {
        let mut pane = pane("mit", "r", 0.05);
        while pane.simulation.take_steps(1).is_ok() {}
        pane.read_state();
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let words = words.replace('\n', " ");
        for said in [
            "A step of 0.05 s was too long for classical Runge-Kutta: past its limit here of 3",
            "0.03 s would have held",
            "The picture shows the time",
        ] {
            assert!(words.contains(said), "{said} in {words}");
        }
    }

    #[test]
    fn surfaces_without_room_are_named() {
        let pinched = "self_collision = true\n\
            [[cloth]]\ngrid = [3, 3]\nwidth = 1\nmass = 0.1\nstiffness = [40, 20, 1]\n\
            down = [0, 0, 1]\npin = [{ at = ['top', 'bottom'] }]\n\
            [[sphere]]\ncenter = [0, 1, 0]\nradius = 0.2\nshift = { by = [0, -2, 0], end = 1 }\n";
        let setup = a3_scenes::Description::parse(pinched).unwrap();
        let setup = setup.build(None, &mut |_| unreachable!()).unwrap();
        let method = integrators::find("v").unwrap();
        let simulation = Simulation::new(setup.scene, method, Control::Step(0.001)).unwrap();
        let mut pane = Pane::new(simulation, Show::new(setup.presentation, Manner::default()));
        while pane.simulation.take_steps(1).is_ok() {}
        let (words, _) = read(&[pane], &Readings::default(), [1280.0, 720.0]);
        let words = words.replace('\n', " ");
        for said in [
            "surfaces are pinched: pins or moving obstacles leave no room between obstacle 0 and particle 0",
            "A shorter step does not help. Press , to go back",
        ] {
            assert!(words.contains(said), "{said} in {words}");
        }
        assert!(!words.contains("too long"), "{words}");
    }

    #[test]
    fn a_blow_up_names_what_failed_and_nothing_overlaps() {
        let mut pane = pane("mit", "e", 0.05);
        let run = &mut pane.simulation;
        while run.take_steps(1).is_ok() {}
        run.set_method(integrators::find("r").unwrap(), Control::Step(0.01))
            .unwrap();
        let panes = [pane];
        let readings = Readings {
            message: Some("There is no wind here.".into()),
            ..Readings::default()
        };
        for size in [
            [1280.0, 720.0],
            [800.0, 600.0],
            [500.0, 400.0],
            [260.0, 860.0],
        ] {
            let (words, sheets) = read(&panes, &readings, size);
            let words = words.replace('\n', " ");
            assert!(
                words.contains("blew up at step") && words.contains("no wind here"),
                "{words}"
            );
            assert!(
                words.contains("A step of 0.05 s was too long for explicit Euler."),
                "{words}"
            );
            assert!(sheets.len() >= 3);
            for (k, a) in sheets.iter().enumerate() {
                assert!(a.right() <= size[0] + 1.0, "{a:?} in {size:?}");
                assert!(
                    sheets[..k].iter().all(|b| !a.shrink(1.0).intersects(*b)),
                    "{sheets:?} in {size:?}"
                );
            }
        }
    }

    /// Each of the last steps before the blow-up is a moment, up to the last valid state.
    #[test]
    fn a_blow_up_can_be_seen_step_by_step() {
        for (words, step) in [
            (["r", "0.05", "--scene", "mit"], 0.05),
            (["e", "0.002", "--scene", "mit"], 0.002),
        ] {
            let mut session = session(&words);
            session.readings.in_window = true;
            while session.runs.panes[0].alive() {
                session.tick(1.0 / 60.0);
            }
            let end = session.runs.first().blow_up().unwrap().step;
            assert!(session.readings.timeline.unwrap().blew_up);
            let (mut energies, mut steps) = (vec![], vec![]);
            let count = 40.min(end - 1);
            for _ in 0..count {
                session.act(RunAction::Scrub(-1), 0);
                energies.push(session.runs.first().energy().unwrap().total());
                steps.push(session.runs.first().steps());
            }
            // The newest moment is the state before the step that failed.
            let expected: Vec<_> = (0..count).map(|k| end - 2 - k).collect();
            assert_eq!(steps, expected, "{words:?}");
            // The motion grows, and faster and faster, where it does not explode in a few steps.
            let third = energies.len() / 3;
            let [late, middle, early] = [0, third, 2 * third].map(|k| energies[k]);
            assert!(late - middle > middle - early || count < 10, "{energies:?}");
            assert!(session.readings.timeline.unwrap().back < 45.0 * step);
            // It blows up again at the same step.
            session.act(RunAction::Pause, 0);
            while session.runs.panes[0].alive() {
                session.tick(1.0 / 60.0);
            }
            assert_eq!(session.runs.first().blow_up().unwrap().step, end);
        }
    }

    #[test]
    fn in_a_comparison_all_runs_go_back_to_the_steps_before_a_blow_up() {
        let mut session = session(&["compare", "e:0.002", "r:0.01", "--scene", "mit"]);
        session.readings.in_window = true;
        while session.runs.panes[0].alive() {
            session.tick(1.0 / 60.0);
        }
        session.act(RunAction::Scrub(-10), 0);
        let times = times(&session);
        assert!(session.runs.panes[0].alive());
        assert!((times[0] - times[1]).abs() < 0.0101, "{times:?}");
    }
}
