//! Tests of the tools, in sessions without a window.

use std::path::Path;

use a3_core::{Simulation, Vector3};
use a3_files::scene_file::Source;
use a3_media::show::Target;

use super::{Aim, Throw, click, join, throw};
use crate::session::panel;
use crate::session::{Measure, RunAction, Session, Tool, compared, frames, session, write_scene};

/// A scene with bodies of many kinds.
const MANY: &str = "gravity = [0, -9.81, 0]\n\
    drag = 0.01\n\
    floor = { height = -1, friction = 0.5, thickness = 0.01 }\n\
    springs = [[2, 9, 8, 0.5, 0.1]]\n\
    torn = [[0, 1]]\n\
    pin = [{ particles = [15] }]\n\
    constraint = [{ rope = [11, 12], length = 1 }]\n\
    [[cloth]]\ngrid = [3, 3]\nwidth = 1\nat = [0, 2, 0]\nmass = 0.1\nstiffness = [40, 20, 10]\n\
    damping = 0.02\npin = [{ at = ['top'] }]\n\
    [[chain]]\nparticles = 3\nfrom = [3, 1, 0]\nto = [4, 1, 0]\nmass = 0.1\nstiffness = 50\n\
    [particles]\npositions = [[3.5, 0.5, 0], [6, 1, 0], [6, 2, 0], [7, 2, 0]]\nmass = 0.2\n\
    springs = [[1, 2, 30, 1, 0.1]]\npin = [{ particles = [2] }]\n\
    [[body]]\nparts = [{ ball = 0.3 }]\nmass = 1\nat = [-3, 1, 0]\n\
    [[body]]\nparts = [{ box = [0.4, 0.4, 0.4] }]\nmass = 1\nat = [-5, 1, 0]\n\
    [[box]]\ncenter = [9, 0, 0]\nsize = [1, 1, 1]\n\
    [camera]\neye = [0, 3, 9]\ntarget = [0, 1, 0]\n";

/// Joints of its bodies: a hinge with a motor, and a ball joint.
const JOINTS: &str = "[[joint]]\nbody = 0\nhinge = { at = [-3, 1, 0], axis = [0, 0, 1], torque = 1 }\n\
    [[joint]]\nbodies = [0, 1]\nball = [-4, 1, 0]\n";

fn open(folder: &Path, text: &str) -> Session {
    let path = folder.join("own.toml");
    std::fs::write(&path, text).unwrap();
    let mut session = session(&["r", "0.002", "--scene", path.to_str().unwrap()]);
    session.act(RunAction::Edit, 0);
    session
}

/// Returns an aim at a point from the front, at nothing.
fn at(point: [f64; 3]) -> Aim {
    Aim {
        eye: Vector3::new(0.0, 3.0, 9.0),
        point: point.into(),
        normal: None,
        target: None,
        link: None,
    }
}

fn use_tool(session: &mut Session, tool: Tool, aim: &Aim) -> String {
    session.panel.editor.tool = tool;
    click(session, aim);
    session.readings.message.clone().unwrap()
}

fn delete(session: &mut Session, target: Target) -> String {
    let aim = Aim { target: Some(target), ..at([0.0; 3]) };
    use_tool(session, Tool::Delete, &aim)
}

/// Returns the position and the velocity of a particle.
fn row(run: &Simulation, i: usize) -> [f64; 6] {
    let (y, n) = (run.state(), run.particles());
    std::array::from_fn(|axis| y[axis * n + i])
}

fn rows(run: &Simulation) -> Vec<[f64; 6]> {
    (0..run.particles()).map(|i| row(run, i)).collect()
}

/// A thrown body flies along a parabola through the point under the pointer.
#[test]
fn a_throw_hits_the_point_under_the_pointer() {
    let folder = tempfile::tempdir().unwrap();
    let text = MANY.replace("drag = 0.01\n", "");
    for tool in [Tool::ThrowBall, Tool::ThrowBox] {
        let mut session = open(folder.path(), &text);
        frames(&mut session, 0.5);
        let (before, time) = (rows(session.runs.first()), session.runs.first().time());
        let aim = at([-1.5, 2.0, 1.0]);
        session.panel.editor.set(Measure::Size, 0.4);
        session.panel.editor.set(Measure::Speed, 8.0);
        use_tool(&mut session, tool, &aim);
        let run = session.runs.first();
        assert_eq!((run.time(), run.method().letter), (time, Some('r')));
        // What was there goes on from the same bits.
        let now = rows(run);
        assert_eq!(now[..before.len()], before);
        let ball = before.len();
        let way = aim.point - aim.eye;
        let start = aim.eye + way * (0.8 / way.norm());
        assert!((run.position(ball) - start).norm() < 1e-12);
        let flight = (aim.point - start).norm() / 8.0;
        session.run_to(time + flight);
        let miss = (session.runs.first().position(ball) - aim.point).norm();
        assert!(miss < 1e-3, "{miss}");
    }
}

/// Name of an edit, the particles that it adds, and the edit.
type Act<'a> = (&'a str, i32, &'a dyn Fn(&mut Session));

/// Each edit keeps the state of all else, and its undo brings back what it changed.
#[test]
fn every_edit_keeps_the_rest_and_can_be_undone() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = open(folder.path(), MANY);
    frames(&mut session, 0.2);
    let own = session.scenes.shown.source.description.clone();
    let n = session.runs.first().particles();
    let near = |a: [f64; 3]| Aim { normal: Some(Vector3::y()), ..at(a) };
    let joined = |tool, ends| {
        move |session: &mut Session| {
            session.panel.editor.tool = tool;
            join(session, ends);
        }
    };
    let gone = |target| move |session: &mut Session| drop(delete(session, target));
    let disjoin = |ends| {
        move |session: &mut Session| {
            let aim = Aim { link: Some(ends), ..at([0.0; 3]) };
            use_tool(session, Tool::Delete, &aim);
        }
    };
    let acts: [Act; 12] = [
        ("ball", 2, &|it| {
            drop(use_tool(it, Tool::AddBall, &near([2.0, -1.0, 3.0])));
        }),
        ("box", 9, &|it| {
            drop(use_tool(it, Tool::AddBox, &near([2.0, -1.0, 3.0])));
        }),
        ("particle", 1, &|it| {
            drop(use_tool(it, Tool::Particle, &at([2.0, 0.5, 3.0])));
        }),
        ("spring", 0, &joined(Tool::Spring, [3, 13])),
        ("rope", 0, &joined(Tool::Rope, [3, 13])),
        ("rod", 0, &joined(Tool::Rod, [15, 14])),
        ("single", -1, &gone(Target::Particle(13))),
        ("of the cloth", 0, &gone(Target::Particle(4))),
        ("body", -2, &gone(Target::Particle(17))),
        ("listed spring", 0, &disjoin([13, 14])),
        ("spring of the cloth", 0, &disjoin([3, 4])),
        ("rope of the scene", 0, &disjoin([12, 11])),
    ];
    for (k, (name, more, act)) in acts.into_iter().enumerate() {
        let deletes = k > 5;
        let before = rows(session.runs.first());
        act(&mut session);
        let said = session.readings.message.clone().unwrap();
        let edited = session.scenes.shown.source.description.clone();
        assert!(own != edited, "{name}: {said}");
        let after = rows(session.runs.first());
        assert_eq!(after.len() as i32, n as i32 + more, "{name}: {said}");
        let kept = before.iter().filter(|row| after.contains(row)).count();
        assert!(kept as i32 >= n as i32 + more.min(0), "{name}: {kept}");
        frames(&mut session, 0.05);
        let blown = session.runs.first().blow_up();
        assert!(blown.is_none(), "{name}: {blown:?}");
        let there = rows(session.runs.first());
        panel::undo(&mut session, false);
        let run = session.runs.first();
        let back = rows(run);
        assert_eq!(session.scenes.shown.source.description, own, "{name}");
        assert_eq!((run.particles(), session.scenes.shown.edited), (n, false));
        let torn = run.model().network().unwrap().torn();
        assert_eq!(torn, [[0, 1]], "{name}");
        if deletes {
            // A deletion goes back to the states before it.
            assert_eq!(rows(run), before, "{name}");
        }
        // Redoing goes back to where it was undone, and undoing again to what came of that.
        frames(&mut session, 0.05);
        panel::undo(&mut session, true);
        assert_eq!(session.scenes.shown.source.description, edited, "{name}");
        assert_eq!(rows(session.runs.first()), there, "{name}");
        panel::undo(&mut session, false);
        assert_eq!(rows(session.runs.first()), back, "{name}");
        // After a reset, an edit is redone in the state that there is.
        session.act(RunAction::Reset, 0);
        panel::undo(&mut session, true);
        assert_eq!(session.runs.first().time(), 0.0, "{name}");
        panel::undo(&mut session, false);
        frames(&mut session, 0.2);
    }
    // An obstacle is left out, as on the page of parts.
    let said = delete(&mut session, Target::Obstacle(0));
    assert_eq!(session.readings.left_out, ["box"], "{said}");
    panel::undo(&mut session, false);
    assert!(session.readings.left_out.is_empty());
}

#[test]
fn what_is_impossible_is_refused_and_changes_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = open(folder.path(), MANY);
    frames(&mut session, 0.2);
    let before = rows(session.runs.first());
    let rod = |session: &mut Session, ends| {
        session.panel.editor.tool = Tool::Rod;
        join(session, ends);
        session.readings.message.clone().unwrap()
    };
    let said = rod(&mut session, [4, 10]);
    assert!(said.starts_with("A rod never changes its length"), "{said}");
    assert!(rod(&mut session, [18, 19]).contains("same rigid body"));
    assert!(rod(&mut session, [3, 3]).contains("Two particles"));
    let said = delete(&mut session, Target::Particle(15));
    assert!(said.starts_with("Removed"), "{said}");
    panel::undo(&mut session, false);
    assert_eq!(rows(session.runs.first()), before);
    let said = use_tool(&mut session, Tool::Delete, &at([0.0; 3]));
    assert!(said.starts_with("There is nothing"), "{said}");
    // A box in the side of another one would cross it.
    let said = use_tool(&mut session, Tool::AddBox, &at([-5.2, 0.8, 0.0]));
    assert!(said.contains("cross"), "{said}");
    assert!(!session.scenes.shown.edited);
    for (scene, tool, why) in [
        ("dam-break", Tool::Delete, "cannot be removed"),
        ("simple", Tool::ThrowBall, "first-order"),
    ] {
        let mut session = crate::session::session(&["r", "0.001", "--scene", scene]);
        session.act(RunAction::Edit, 0);
        let aim = Aim { target: Some(Target::Particle(0)), ..at([0.0; 3]) };
        let said = use_tool(&mut session, tool, &aim);
        assert!(said.contains(why) || said.contains("no masses"), "{said}");
    }
}

/// A scene that was written after edits continues the same motion, and a reset begins the edited
/// scene.
#[test]
fn an_edited_scene_is_written_and_reset() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = open(folder.path(), MANY);
    frames(&mut session, 0.2);
    panel::tune(&mut session, &[("without drag".into(), 1.0), ("gravity".into(), 5.0)]).unwrap();
    use_tool(&mut session, Tool::ThrowBall, &at([0.0, 1.5, 0.0]));
    delete(&mut session, Target::Particle(13));
    use_tool(&mut session, Tool::Particle, &at([3.0, 3.0, 0.0]));
    session.panel.editor.tool = Tool::Spring;
    let n = session.runs.first().particles();
    join(&mut session, [3, 15]);
    // The tuning stays.
    assert_eq!(session.readings.left_out, ["drag"]);
    assert_eq!(panel::tuned(&session)[0], ("gravity".into(), 5.0));
    frames(&mut session, 0.4);
    let name = write_scene(&session, session.runs.first()).unwrap();
    let setup = Source::find(&name).unwrap().build(None).unwrap();
    let run = session.runs.first();
    let mut again = Simulation::new(setup.scene, run.method(), run.control()).unwrap();
    assert_eq!(again.state(), run.state());
    let begun = run.time();
    // Friction magnifies errors of rounding.
    for (time, tolerance) in [(0.2, 1e-11), (1.0, 1e-4)] {
        session.run_to(begun + time);
        again.advance_to(time).unwrap();
        let pairs = again.state().iter().zip(session.runs.first().state());
        let worst = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(worst < tolerance, "{worst} after {time}");
    }
    session.act(RunAction::Reset, 0);
    let run = session.runs.first();
    assert_eq!((run.time(), run.particles()), (0.0, n));
    assert_eq!(run.state(), run.scene().state);
    assert_eq!(row(run, 15)[..3], [3.0, 3.0, 0.0]);
}

#[test]
fn all_panes_of_a_comparison_are_edited() {
    let mut session = compared(&["r:0.01", "r:0.005", "--scene", "cloth"], 0.3);
    session.act(RunAction::Edit, 0);
    use_tool(&mut session, Tool::ThrowBall, &at([0.0, 2.0, 0.5]));
    let runs = session.runs.all();
    let balls: Vec<_> = runs.map(|run| (run.particles(), row(run, 400))).collect();
    assert_eq!(balls.len(), 3);
    assert!(balls.iter().all(|it| *it == balls[0] && it.0 == 402));
    frames(&mut session, 0.1);
    panel::undo(&mut session, false);
    let counts = session.runs.panes.iter();
    assert!(counts.map(|it| it.simulation.particles()).all(|n| n == 400));
}

/// Random edits never panic, and undoing all of them brings back the scene.
#[test]
fn random_edits_can_all_be_undone() {
    let folder = tempfile::tempdir().unwrap();
    let mut session = open(folder.path(), MANY);
    frames(&mut session, 0.1);
    // One scene begins as it is built, and another one in a given state.
    let written = write_scene(&session, session.runs.first()).unwrap();
    let given = std::fs::read_to_string(written).unwrap();
    for (seed, text) in [(1, MANY), (2, &format!("{MANY}{JOINTS}")), (3, &given)] {
        let mut session = open(folder.path(), text);
        let own = session.scenes.shown.source.description.clone();
        let mut seed: u64 = seed;
        let mut next = |most: usize| {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 33) as usize % most
        };
        let mut made = 0;
        for _ in 0..24 {
            let n = session.runs.first().particles();
            let [x, y, z] = [10, 4, 6].map(|range| next(10 * range) as f64 / 10.0);
            let ends = [next(n), next(n)];
            let target = Some(Target::Particle(next(n))).filter(|_| next(3) > 0);
            let aim =
                Aim { target, link: Some(ends).filter(|_| next(3) == 0), ..at([x - 5.0, y, z]) };
            let (tool, ..) = Tool::ALL[next(Tool::ALL.len())];
            let before = session.scenes.shown.source.description.clone();
            if tool.joins() && next(4) > 0 {
                session.panel.editor.tool = tool;
                join(&mut session, ends);
            } else {
                use_tool(&mut session, tool, &aim);
            }
            let changed = session.scenes.shown.source.description != before;
            made += usize::from(changed);
            let finite = session.runs.first().state().iter().all(|y| y.is_finite());
            assert!(finite);
            if session.runs.any_alive() {
                frames(&mut session, 1.0 / 60.0);
            }
            if !session.runs.any_alive() {
                session.act(RunAction::Reset, 0);
            }
        }
        assert!(made > 6, "{made}");
        for _ in 0..made {
            panel::undo(&mut session, false);
            if !session.runs.any_alive() {
                session.act(RunAction::Reset, 0);
            }
        }
        assert_eq!(session.scenes.shown.source.description, own);
        assert!(!session.scenes.shown.edited);
    }
}

/// An obstacle that moves by itself stands in the hand, and moves on about its new place.
#[test]
fn a_dragged_obstacle_moves_on_about_its_new_place() {
    let folder = tempfile::tempdir().unwrap();
    let text = "[particles]\npositions = [[0, 9, 0]]\nmass = 1\n\
        [[box]]\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\n\
        [[box]]\ncenter = [3, 0, 0]\nsize = [1, 1, 1]\nsine = { amplitude = [0, 1, 0], rate = 3 }\n\
        [[capsule]]\nfrom = [6, 0, 0]\nto = [7, 0, 0]\nradius = 0.2\n\
        turn = { about = [6, 1, 0], axis = [0, 0, 1], rate = 1 }\n\
        [[sphere]]\ncenter = [9, 0, 0]\nradius = 0.5\nshift = { by = [0, 0, 4], end = 4 }\n";
    let mut session = open(folder.path(), text);
    let place = |session: &Session, k: usize, later: f64| {
        let run = session.runs.first();
        let path = run.model().network().unwrap().obstacles()[k].path;
        path.at(run.time() + later).position
    };
    frames(&mut session, 0.5);
    for k in 0..4 {
        let way = [0.3, 0.7].map(|later| place(&session, k, later) - place(&session, k, 0.0));
        let (from, time) = (place(&session, k, 0.0), session.runs.first().time());
        assert!(session.runs.grab_obstacle(k));
        let target = from + Vector3::new(0.2, 0.3, -0.1);
        session.runs.pull(target);
        frames(&mut session, 0.2);
        assert!((place(&session, k, 0.0) - target).norm() < 1e-9);
        session.release();
        let now = session.runs.first().time();
        if k != 3 {
            frames(&mut session, 0.1);
        }
        let passed = session.runs.first().time() - now;
        // The motion is that which it would have had, displaced.
        let path = |later: f64| place(&session, k, now - session.runs.first().time() + later);
        let offset = path(time - now) - from;
        for (later, way) in [0.3, 0.7].into_iter().zip(way) {
            let there = path(time - now + later) - offset - from;
            assert!((there - way).norm() < 1e-9 || k == 0, "{k}: {there} {way}");
        }
        assert!((path(0.0) - target).norm() < 1e-9 && passed < 0.2);
        panel::undo(&mut session, false);
        assert!((place(&session, k, time - now - passed) - from).norm() < 1e-9, "{k}");
    }
}

/// Throws a light and a heavy ball from the eye to the camera's target, and returns both messages.
fn throw_two(session: &mut Session) -> [String; 2] {
    [1.0, 10.0].map(|mass| {
        let camera = &session.view.camera;
        let [eye, point] =
            [camera.eye(), camera.target()].map(|it| Vector3::from(it.coords).cast::<f64>());
        let aim = Aim { eye, point, ..at([0.0; 3]) };
        throw(session, &aim, Throw { mass, speed: 1.5 });
        session.readings.message.clone().unwrap()
    })
}

/// Checks that a light ball in a liquid is lighter than what it displaces, and a heavy one heavier,
/// and that they are within a liquid that is a sheet.
fn check_floating(session: &Session) {
    let run = session.runs.first();
    let network = run.model().network();
    let Some((network, fluid)) = network.and_then(|it| Some((it, it.fluid()?))) else {
        return;
    };
    let (n, law) = (run.particles(), fluid.law());
    for (k, body) in network.bodies().iter().rev().take(2).enumerate() {
        let wet = body.points().filter(|i| fluid.particles().contains(&(*i as u32)));
        let displaced = wet.count() as f64 * law.mass();
        assert!(displaced > 0.0);
        assert_eq!(network.masses()[body.center()] > displaced, k == 0);
        assert!(law.dimensions == 3 || run.state()[2 * n + body.center()].abs() < 1e-9);
    }
}

fn bodies(session: &Session) -> usize {
    let network = session.runs.first().model().network();
    network.map_or(0, |network| network.bodies().len())
}

/// Into every built-in scene balls are thrown, again and again and at any time, or a line says why
/// not, and the runs stay finite.
#[test]
fn balls_are_thrown_into_every_scene() {
    for entry in a3_scenes::SCENES {
        for start in [0.0, 2.0] {
            let mut session = crate::session::session(&["--scene", entry.name]);
            let before = bodies(&session);
            frames(&mut session, start);
            let said = throw_two(&mut session);
            let added = match entry.name {
                "simple" => 0,
                _ => 2,
            };
            assert_eq!(bodies(&session), before + added, "{}: {said:?}", entry.name);
            check_floating(&session);
            let came_apart = said.iter().any(|said| said.contains("came apart"));
            assert!(!came_apart || entry.name == "mit-sphere", "{said:?}");
            let flies = said.iter().filter(|said| said.starts_with("A ball flies."));
            assert_eq!(flies.count(), added, "{}: {said:?}", entry.name);
            frames(&mut session, 1.0);
            let lost = session.runs.first().blow_up().map(|lost| lost.to_string());
            assert_eq!(lost, None, "{}", entry.name);
            // A reset throws them again.
            session.act(RunAction::Reset, 0);
            assert_eq!(bodies(&session), before + added);
            for _ in 0..3 {
                panel::undo(&mut session, false);
            }
            assert_eq!(bodies(&session), before, "{}", entry.name);
            assert!(!session.scenes.shown.edited);
        }
    }
}

/// Surfaces that begin crossed come apart for a ball, at once and after a reset; without room at
/// the eye, a throw begins beside it.
#[test]
fn a_throw_finds_room() {
    let folder = tempfile::tempdir().unwrap();
    let crossed = "gravity = [0, -9.81, 0]\n\
        [[box]]\ncenter = [0, 0, 0]\nsize = [1, 0.2, 1]\n\
        [[cloth]]\ngrid = [6, 6]\nwidth = 2\nmass = 0.05\nstiffness = [40, 20, 5]\ndamping = 0.01\n\
        at = [0, 0.05, -1]\ndown = [0, 0, 1]\n[camera]\neye = [0, 3, 9]\ntarget = [0, 0, 0]\n";
    let mut session = open(folder.path(), crossed);
    let said = throw_two(&mut session);
    assert!(said[0].contains("came apart"), "{said:?}");
    assert_eq!(bodies(&session), 2, "{said:?}");
    session.act(RunAction::Reset, 0);
    frames(&mut session, 0.5);
    assert!(session.runs.any_alive());
    let masses = session.runs.first().model().network().unwrap();
    let [light, heavy] = [0, 1].map(|k| masses.masses()[masses.bodies()[k].center()]);
    assert!((heavy - 10.0 * light).abs() < 1e-9 * heavy);
}
