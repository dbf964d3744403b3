//! Tests of deletions: what names particles and bodies by their numbers follows them.

use a3_core::Vector3;
use a3_core::rigid::Body;
use a3_media::show::Target;

use super::{Aim, click};
use crate::session::panel;
use crate::session::{Pick, RulerEnd, RunAction, Session, Tool, frames, session};

const LINKAGE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/linkage.toml");

/// Opens the linkage with the tools.
fn linkage() -> Session {
    let mut session = session(&["r", "0.002", "--scene", LINKAGE]);
    session.act(RunAction::Edit, 0);
    frames(&mut session, 0.1);
    session
}

/// Deletes the body of a particle, and returns the message.
fn delete(session: &mut Session, particle: usize) -> String {
    session.panel.editor.tool = Tool::Delete;
    let aim = Aim {
        eye: Vector3::z(),
        point: Vector3::zeros(),
        normal: None,
        target: Some(Target::Particle(particle)),
        link: None,
    };
    click(session, &aim);
    session.readings.message.clone().unwrap()
}

/// Without its crank, the linkage has no motor, and the coupler falls from the rocker.
#[test]
fn a_crank_takes_its_joints_and_its_motor_along() {
    let mut session = linkage();
    let own = session.scenes.shown.source.description.clone();
    let kept = own.joint[2..].to_vec();
    assert_eq!(delete(&mut session, 0), "Removed: body 0.");
    let now = session.scenes.shown.source.description.clone();
    assert_eq!((now.body.len(), now.joint.len()), (2, 2));
    for (joint, before) in now.joint.iter().zip(&kept) {
        assert_eq!(joint.hinge, before.hinge);
        assert_eq!(joint.body.map(|k| k + 1), before.body);
        assert_eq!(joint.bodies.map(|both| both.map(|k| k + 1)), before.bodies);
    }
    let network = |session: &Session| session.runs.first().model().network().unwrap().clone();
    let hinges = now.joint.iter().filter_map(|joint| joint.hinge.as_ref());
    assert!(hinges.clone().count() == 2 && hinges.clone().all(|it| it.torque.is_none()));
    frames(&mut session, 0.3);
    let run = session.runs.first();
    let off = network(&session).constraint_error(run.state()).unwrap();
    assert!(run.blow_up().is_none() && off < 1e-3, "{off}");
    panel::undo(&mut session, false);
    assert_eq!(session.scenes.shown.source.description, own);
}

/// Plots and the ruler go on with the same bodies and particles, and end with them.
#[test]
fn plots_and_the_ruler_follow_what_they_show() {
    let mut session = linkage();
    let network = session.runs.first().model().network().unwrap();
    let centers: Vec<_> = network.bodies().iter().map(Body::center).collect();
    for k in 0..3 {
        let pane = &mut session.runs.panes[0];
        pane.traces.toggle(Pick::Body(k), &pane.simulation);
    }
    session.act(RunAction::Plots, 0);
    for i in [centers[1], centers[2]] {
        session.panel.plotting.begin_end(RulerEnd::Particle(i));
    }
    let places = |session: &Session| {
        let ends = session.panel.plotting.ruler.iter().flatten();
        let places = ends.map(|end| end.place(session.runs.first()).unwrap());
        places.collect::<Vec<_>>()
    };
    let before = places(&session);
    delete(&mut session, centers[0]);
    let picks = |session: &Session| {
        let all = session.runs.panes[0].traces.iter();
        all.map(|(pick, _)| *pick).collect::<Vec<_>>()
    };
    assert_eq!(picks(&session), [Pick::Body(0), Pick::Body(1)]);
    assert_eq!(places(&session), before);
    frames(&mut session, 0.1);
    for (k, (pick, series)) in session.runs.panes[0].traces.iter().enumerate() {
        // No value jumps: each is still of the same body.
        let rows: Vec<_> = series.rows().collect();
        let moves = rows.windows(2).map(|it| (it[1].values[0] - it[0].values[0]).abs());
        assert!(rows.len() > 3 && moves.fold(0.0, f64::max) < 0.05, "{k}");
        assert_eq!(*pick, Pick::Body(k));
    }
    panel::undo(&mut session, false);
    assert_eq!(picks(&session), [Pick::Body(1), Pick::Body(2)]);
    assert_eq!(places(&session).len(), 2);
    delete(&mut session, centers[2]);
    assert_eq!(picks(&session), [Pick::Body(1)]);
    assert!(session.panel.plotting.ruler.is_none());
}

/// A plot of a spring ends when the spring is removed, and not when its kind is left out.
#[test]
fn a_plot_of_a_spring_ends_with_it() {
    let mut session = session(&["r", "0.002", "--scene", "chain"]);
    session.act(RunAction::Edit, 0);
    session.panel.editor.tool = Tool::Delete;
    let spring = session.runs.first().model().network().unwrap().all_springs().next().unwrap();
    for (i, j) in [(spring.i, spring.j), (spring.i + 2, spring.j + 2)] {
        let pane = &mut session.runs.panes[0];
        pane.traces.toggle(Pick::Spring(i, j), &pane.simulation);
    }
    let aim = Aim {
        eye: Vector3::z(),
        point: Vector3::zeros(),
        normal: None,
        target: None,
        link: Some([spring.i, spring.j]),
    };
    click(&mut session, &aim);
    let said = session.readings.message.clone().unwrap();
    assert!(said.starts_with("Removed"), "{said}");
    let picks: Vec<_> = session.runs.panes[0].traces.iter().map(|it| it.0).collect();
    assert_eq!(picks, [Pick::Spring(spring.i + 2, spring.j + 2)]);
}
