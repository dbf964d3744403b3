//! Questions about the scene as it is in the window, and what is done with their answers.

use std::path::Path;

use a3_core::{Model, Network};
use a3_files::output;
use a3_files::rounding::short;
use a3_files::setup::{Request, SceneOptions};
use a3_scenes::snapshot;

use super::action::{MeasureRequest, RunAction};
use super::measuring::{MethodSetting, Question, Task};
use super::save;
use super::state::Session;

/// Ends of the negative decimal logarithm of an error (m).
const DIGITS: [i32; 2] = [1, 8];

/// Carries out a request for the run of pane `at`, and returns whether that changed the scene.
pub fn apply(session: &mut Session, request: MeasureRequest, at: usize) -> bool {
    let measuring = &mut session.measuring;
    match request {
        MeasureRequest::Ask(question) => measuring.question = question,
        MeasureRequest::Toggle if measuring.progress().is_some() => measuring.stop(),
        MeasureRequest::Toggle => {
            let begun = task(session, at).and_then(|(task, of)| session.measuring.begin(task, of));
            if let Err(why) = begun {
                session.readings.warn(why);
            }
        }
        MeasureRequest::Choose => {
            measuring.question = Question::Choose;
            if !session.panel.has(RunAction::Measure) {
                session.toggle(RunAction::Measure);
            }
            if session.measuring.progress().is_none() {
                return apply(session, MeasureRequest::Toggle, at);
            }
        }
        MeasureRequest::Error { finer } => {
            let digits = measuring.digits + if finer { 1 } else { -1 };
            measuring.digits = digits.clamp(DIGITS[0], DIGITS[1]);
        }
        MeasureRequest::Timed(timed) => measuring.timed = timed,
        MeasureRequest::FromStart(from_start) => measuring.from_start = from_start,
        MeasureRequest::Use(row) => {
            if let Some(setting) = offer(session, row) {
                session.use_setting(at, setting);
            }
        }
        MeasureRequest::RowBeside(row) => {
            let setting = offer(session, row);
            return setting.is_some_and(|it| {
                let added = session.add_pane(at, it);
                session.report(added)
            });
        }
        MeasureRequest::RunBeside { curve, run } => {
            let answer = session.measuring.known().map(|known| &known.answer);
            let diagram = answer.and_then(|answer| answer.as_ref().ok()?.diagram.as_ref());
            let setting = diagram.and_then(|it| it.runs.get(curve)?.get(run).copied());
            return setting.is_some_and(|it| {
                let added = session.add_pane(at, it);
                session.report(added)
            });
        }
        MeasureRequest::OpenLean => return open_lean(session),
    }
    false
}

/// Returns the method and setting of a row of the answer.
fn offer(session: &Session, row: usize) -> Option<MethodSetting> {
    let answer = session.measuring.known()?.answer.as_ref().ok()?;
    answer.offers.get(row).copied()
}

/// Writes the leanest scene under the first free name, beside the scene's own file if it has one,
/// and shows it. Returns whether that changed the scene.
fn open_lean(session: &mut Session) -> bool {
    let answer = session.measuring.known().map(|known| &known.answer);
    let Some(text) = answer.and_then(|answer| answer.as_ref().ok()?.lean.as_deref()) else {
        return false;
    };
    let path = session.scenes.shown.source.path.as_deref();
    let folder = path.and_then(Path::parent).unwrap_or("".as_ref());
    let name = format!("{}-lean", session.runs.first().scene().name);
    match output::write_new(folder, &name, "toml", text.as_bytes()) {
        Ok(path) => session.open(&path),
        Err(failure) => {
            session.readings.warn(failure.to_string());
            false
        }
    }
}

/// Creates the task of the question that is shown about the run of pane `at`, and describes what is
/// measured. Its scene is that which key `f` would write, or that after a reset.
///
/// # Errors
/// The run has no initial state that it could be reset to.
pub fn task(session: &Session, at: usize) -> Result<(Task, String), String> {
    let (measuring, run) = (&session.measuring, &session.runs.panes[at].simulation);
    let from_start = measuring.from_start || run.blow_up().is_some();
    let begun = from_start.then(|| run.anew(run.method(), run.control()));
    let begun = begun.transpose().map_err(|why| why.to_string())?;
    let run = begun.as_ref().unwrap_or(run);
    let mut description = save::description(session, run);
    let (own, shown) = (&session.tuning.own, &session.scenes.shown);
    if from_start && run.state() == own.state {
        // Grids of a scene that begins as it is built can be varied.
        description.state = None;
        if pins(run.model()) == pins(&own.model) && !run.swinging() {
            snapshot::pin_as(&mut description, shown.described_without(&[]));
        }
    }
    let source = &shown.source;
    let scene = run.scene();
    let grid =
        scene.grid().map_or(String::new(), |grid| format!(" {} × {}", grid.rows(), grid.cols()));
    let from = if from_start {
        "from its beginning".into()
    } else {
        format!("from {} s on", short(run.time(), 3))
    };
    let task = Task {
        question: measuring.question,
        request: Request {
            source: source.described(description),
            options: SceneOptions::default(),
        },
        error: measuring.error(),
        timed: measuring.timed,
    };
    Ok((task, format!("{}{grid}, {from}", scene.name)))
}

/// Returns the particles that are pinned.
fn pins(model: &Model) -> Vec<usize> {
    let network = model.network().into_iter();
    network.flat_map(Network::pins).map(|(i, _)| i).collect()
}

#[cfg(test)]
mod tests {
    use a3_core::{Control, integrators};
    use a3_files::failure::Failure;
    use a3_files::monitor::Monitor;
    use a3_files::scene_file::Source;
    use a3_scenes::{Description, regridded};

    use super::*;
    use crate::session::measuring::{Answer, Diagram};
    use crate::session::{RunAction, frames, session};

    /// Returns the scene that would be measured.
    fn asked(session: &Session) -> a3_core::Scene {
        task(session, 0).unwrap().0.request.scene().unwrap()
    }

    fn forces(model: &a3_core::Model, state: &[f64]) -> Vec<f64> {
        let mut f = vec![0.0; state.len()];
        model.system().eval_f(0.0, state, &mut f);
        f
    }

    #[test]
    fn the_scene_is_measured_as_it_is_in_the_window() {
        let mut session = session(&["r", "0.005", "--scene", "chain"]);
        let own = session.runs.first().scene().state.clone();
        session.tuning.stiffness = 3.0;
        session.adjust(|network| network.scale_springs(3.0, 1.0).unwrap());
        session.toggle_pin(3);
        frames(&mut session, 0.5);
        let run = session.runs.first();
        let now = asked(&session);
        assert!(now.state == run.state() && now.state != own);
        assert!(now.model.network().unwrap().is_pinned(3));
        // Nothing here depends on time, so the forces are the same up to rounding.
        let (a, b) = (forces(&now.model, &now.state), forces(run.model(), &now.state));
        for (a, b) in a.iter().zip(&b) {
            assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} {b}");
        }
        // From the start, as after a reset: only a pin by hand is lost.
        apply(&mut session, MeasureRequest::FromStart(true), 0);
        let (task, of) = task(&session, 0).unwrap();
        assert_eq!(of, "chain, from its beginning");
        assert!(task.request.source.description.state.is_none());
        let begun = task.request.scene().unwrap();
        assert_eq!(begun.state, own);
        session.act(RunAction::Reset, 0);
        // Stretched springs show their stiffness.
        let [measured, run, untuned] =
            [&begun.model, session.runs.first().model(), &session.tuning.own.model]
                .map(|model| forces(model, &now.state));
        let near = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-12 * b.abs().max(1.0);
        assert!(measured.iter().zip(&run).all(near));
        assert!(!measured.iter().zip(&untuned).all(near));
    }

    /// The grid of a scene that begins as it was built can be varied where the command varies it,
    /// also with other springs and after some time.
    #[test]
    fn grids_can_be_varied_from_the_beginning() {
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes");
        let files = std::fs::read_dir(folder).unwrap();
        let files = files.map(|file| file.unwrap().path());
        let files = files.filter(|file| file.extension().is_some_and(|it| it == "toml"));
        let files = files.map(|file| file.to_str().unwrap().to_owned());
        let built_in = a3_scenes::SCENES.iter().map(|scene| scene.name.to_owned());
        let mut count = 0;
        for name in built_in.chain(files) {
            let own = Source::find(&name).unwrap();
            let particles = own.build(None).unwrap().scene.model.particles();
            let varies = |scene: &Description| regridded(scene, 0.5, particles).is_ok();
            if !varies(&own.description) {
                continue;
            }
            let mut session = session(&["--scene", &name]);
            frames(&mut session, 0.05);
            let (now, _) = task(&session, 0).unwrap();
            session.measuring.from_start = true;
            let (begun, _) = task(&session, 0).unwrap();
            let asked = [now, begun].map(|task| varies(&task.request.source.description));
            assert_eq!(asked, [false, true], "{name}");
            count += 1;
        }
        assert!(count > 5, "{count} scenes have grids");
        let mut session = session(&["r", "0.005"]);
        session.tuning.stiffness = 2.0;
        session.adjust(|network| network.scale_springs(2.0, 1.0).unwrap());
        frames(&mut session, 0.1);
        session.measuring.from_start = true;
        let begun = asked(&session);
        assert_eq!(pins(&begun.model), pins(&session.tuning.own.model));
    }

    #[test]
    fn a_run_that_blew_up_is_measured_from_its_beginning() {
        let mut session = session(&["e", "2", "--scene", "simple"]);
        while session.runs.first().blow_up().is_none() {
            session.act(RunAction::Step, 0);
        }
        assert_eq!(asked(&session).state, session.runs.first().scene().state);
    }

    /// Answers with a choice and a point of a chart.
    fn found(_: &Task, monitor: &dyn Monitor) -> Result<Answer, Failure> {
        monitor.note("a remark")?;
        let setting = |name, value| {
            let method = integrators::find(name).unwrap();
            (method, method.control(value))
        };
        Ok(Answer {
            offers: vec![setting("dopri5", 1e-5)],
            diagram: Some(Diagram {
                chart: a3_plot::WorkPrecision::default(),
                runs: vec![vec![], vec![setting("rk4", 0.02), setting("rk4", 0.03)]],
            }),
            ..Answer::default()
        })
    }

    #[test]
    fn answers_can_be_used_and_run_beside() {
        let mut session = session(&["t", "0.01", "--scene", "chain"]);
        session.act(RunAction::Measure, 0);
        assert_eq!(session.panel.beside, None, "nothing can answer");
        session.measuring.answerer = Some(found);
        session.act(RunAction::Panel, 0);
        session.act(RunAction::Measure, 0);
        assert!(session.panel.has(RunAction::Measure));
        let measure = |session: &mut Session, request| apply(session, request, 0);
        assert!(!measure(&mut session, MeasureRequest::RowBeside(0)));
        measure(&mut session, MeasureRequest::Toggle);
        while session.measuring.progress().is_some() {
            std::thread::sleep(std::time::Duration::from_millis(2));
            session.measuring.update();
        }
        assert!(!measure(&mut session, MeasureRequest::Use(0)));
        assert!(measure(&mut session, MeasureRequest::RunBeside { curve: 1, run: 1 }));
        assert!(!measure(&mut session, MeasureRequest::RunBeside { curve: 0, run: 0 }));
        let panes = session.runs.panes.iter().map(|pane| &pane.simulation);
        let runs: Vec<_> = panes.map(|run| (run.method().name, run.control())).collect();
        let expected = [("dopri5", Control::Tolerance(1e-5)), ("rk4", Control::Step(0.03))];
        assert_eq!(runs, expected);
        for finer in [true, true, false] {
            measure(&mut session, MeasureRequest::Error { finer });
        }
        assert_eq!(session.measuring.error(), 1e-4);
        // Another scene has other answers.
        session.act(RunAction::NextScene, 0);
        assert!(session.measuring.known().is_none());
    }
}
