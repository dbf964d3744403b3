//! Writing the present state of a run as a scene file.

use std::fmt::{Debug, Write};
use std::path::{Path, PathBuf};

use a3_core::Simulation;
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::rounding::{DIGITS, short};
use a3_files::visible::in_a_line;
use a3_scenes::{Camera, Description, snapshot};

use super::state::Session;

/// Largest number of particles of a scene file that can be read again.
const MAX_PARTICLES: usize = 60_000;

/// Writes a run of the session's scene under the first free name, in the folder of its scene file
/// if it has one, and returns the path. Fails if there are too many particles, or if the file
/// cannot be written.
pub fn write_scene(session: &Session, run: &Simulation) -> Result<String, String> {
    let particles = run.particles();
    if particles > MAX_PARTICLES {
        return Err(format!(
            "a scene file has at most {MAX_PARTICLES} particles, but this run has {particles}"
        ));
    }
    let path = session.scenes.shown.source.path.as_deref();
    let folder = path.and_then(Path::parent);
    let name = &run.scene().name;
    let write = || -> Result<PathBuf, Failure> {
        let text = scene_text(session, run).map_err(Failure::run)?;
        let folder = folder.unwrap_or("".as_ref());
        output::write_new(folder, name, "toml", text.as_bytes())
    };
    write().map(|path| path.display().to_string()).map_err(|failure| failure.to_string())
}

/// Returns the text of the scene file.
fn scene_text(session: &Session, run: &Simulation) -> Result<String, a3_core::Error> {
    let mut description = description(session, run);
    let state = description.state.take();
    let mut text = format!(
        "# The scene {} as it was at t = {} s, written by a3 {}. Its clock begins at 0 again.\n\n{}",
        in_a_line(&run.scene().name),
        short(run.time(), DIGITS),
        env!("CARGO_PKG_VERSION"),
        description.to_toml()?,
    );
    let state = state.unwrap_or_default();
    text += "\n[state]\n";
    write_rows(&mut text, "positions", &state.positions);
    write_rows(&mut text, "velocities", &state.velocities);
    if !state.orientations.is_empty() {
        write_rows(&mut text, "orientations", &state.orientations);
        write_rows(&mut text, "angular_momenta", &state.angular_momenta);
    }
    Ok(text)
}

/// Returns the description of the tuned scene with the present state.
pub fn description(session: &Session, run: &Simulation) -> Description {
    let tuning = &session.tuning;
    let parts: Vec<_> = tuning.left_out.iter().map(|k| &tuning.parts[*k]).collect();
    let mut description = session.scenes.shown.described_without(&parts);
    snapshot::scale_springs(&mut description, tuning.stiffness, tuning.damping);
    snapshot::scale_wind(&mut description, session.tuning.gusts);
    snapshot::begin_with(&mut description, run.model(), &run.moment());
    let triple = |p: nalgebra::Point3<f32>| [p.x, p.y, p.z].map(shortest);
    description.camera = Some(Camera {
        eye: triple(session.view.camera.eye()),
        target: triple(session.view.camera.target()),
    });
    description
}

/// Returns the number of the fewest digits that single precision rounds to this one.
fn shortest(x: f32) -> f64 {
    x.to_string().parse().unwrap_or(f64::from(x))
}

/// Writes an array of rows; their numbers are read back exactly.
fn write_rows(text: &mut String, key: &str, rows: &[impl Debug]) {
    // Writing to a string does not fail.
    let _ = writeln!(text, "{key} = [");
    for row in rows {
        let _ = writeln!(text, "  {row:?},");
    }
    *text += "]\n";
}

#[cfg(test)]
mod tests {
    use a3_core::contact::Shape;
    use a3_core::{Network, Vector3};
    use a3_files::scene_file::Source;

    use super::*;
    use crate::session::panel;
    use crate::session::{RunAction, session};

    fn forces(run: &Simulation) -> Vec<f64> {
        let mut f = vec![0.0; run.state().len()];
        run.model().system().eval_f(run.time(), run.state(), &mut f);
        f
    }

    /// Checks that a written file gives the same state to the last bit, and the same forces.
    fn check(session: &Session, path: &Path) {
        let source = Source::find(path.to_str().unwrap()).unwrap();
        let run = session.runs.first();
        let setup = source.build(None).unwrap();
        let (scene, defaults) = (setup.scene, setup.defaults);
        let name = &run.scene().name;
        assert_eq!(&scene.name, name);
        assert_eq!(defaults.solver.map(|solver| solver.name), Some(run.method().name));
        assert_eq!(defaults.control, Some(run.control()));
        let again = Simulation::new(scene, run.method(), run.control()).unwrap();
        assert_eq!(again.state(), run.state(), "{name}");
        // With self-collision, skins are built for the tuned springs, so forces differ.
        let touches = |network: &Network| network.contact_layer().is_some();
        if !run.model().network().is_some_and(touches) {
            for (a, b) in forces(run).into_iter().zip(forces(&again)) {
                assert!((a - b).abs() <= 1e-12 * a.abs().max(1.0), "{name}: {a} {b}");
            }
        }
        let eye = a3_media::show::camera(&setup.presentation).eye();
        assert!((eye - session.view.camera.eye()).norm() < 1e-4);
        let pins = |run: &Simulation| {
            let network = run.model().network();
            let pins = network.into_iter().flat_map(Network::pins);
            let free = pins.filter(|(i, _)| run.grabbed() != Some(*i));
            free.map(|(i, _)| i).collect::<Vec<_>>()
        };
        assert_eq!(pins(&again), pins(run), "{name}");
    }

    /// Advances by a second of simulated time, in frames of 60 Hz.
    fn run_on(session: &mut Session) {
        for _ in 0..60 {
            session.tick(1.0 / 60.0);
        }
    }

    fn written(session: &Session, folder: &Path) -> PathBuf {
        let path = folder.join("scene.toml");
        std::fs::write(&path, scene_text(session, session.runs.first()).unwrap()).unwrap();
        path
    }

    #[test]
    fn every_scene_continues_where_it_was_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session(&["r", "0.005"]);
        for entry in a3_scenes::SCENES {
            assert_eq!(session.runs.first().scene().name, entry.name);
            session.tuning.stiffness = 1.5;
            session.tuning.gusts = 2.0;
            session.adjust(|network| {
                network.scale_springs(1.5, 1.0).unwrap();
                network.set_gravity(Vector3::new(0.0, -5.0, 0.0));
                network.set_drag(0.03).unwrap();
                for k in (0..network.obstacles().len()).rev() {
                    match network.obstacles()[k].shape {
                        Shape::Floor => {
                            network.remove_obstacle(k).unwrap();
                        }
                        _ => network.reshape_obstacle(k, Shape::Sphere { radius: 1.25 }).unwrap(),
                    }
                }
            });
            session.runs.change_all(|run| {
                if let Some(wind) = run.scene().wind {
                    run.change_wind(wind.scaled(2.0));
                }
            });
            session.act(RunAction::Wind, 0);
            session.act(RunAction::Swing, 0);
            session.view.camera.orbit(0.4, 0.2);
            run_on(&mut session);
            check(&session, &written(&session, folder.path()));
            // A grabbed particle is not written as pinned.
            let run = session.runs.first();
            let walls = run.model().network();
            let in_wall = |i: &usize| walls.is_some_and(|network| network.is_wall(*i));
            let last = (0..run.particles()).rev().find(|i| !in_wall(i)).unwrap();
            session.runs.grab(last);
            session.runs.pull(Vector3::new(0.3, 0.1, 0.2));
            session.tick(0.01);
            let text = std::fs::read_to_string(written(&session, folder.path())).unwrap();
            assert!(text.starts_with(&format!("# The scene {} as it was at t = ", entry.name)));
            let source = Source::find(folder.path().join("scene.toml").to_str().unwrap()).unwrap();
            let scene = source.build(None).unwrap().scene;
            let network = scene.model.network();
            assert!(network.is_none_or(|network| !network.is_pinned(last)));
            session.release();
            session.act(RunAction::NextScene, 0);
        }
    }

    /// A written scene lacks the parts that are left out.
    #[test]
    fn parts_that_are_left_out_are_not_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session(&["r", "0.005", "--scene", "mit-sphere"]);
        run_on(&mut session);
        for parts in [&["gravity", "bend springs", "sphere"][..], &["drag", "shear springs"]] {
            let named = parts.iter().map(|name| (format!("without {name}"), 1.0));
            panel::tune(&mut session, &named.collect::<Vec<_>>()).unwrap();
            assert_eq!(session.readings.left_out.len(), parts.len());
            run_on(&mut session);
            let path = written(&session, folder.path());
            check(&session, &path);
            let source = Source::find(path.to_str().unwrap()).unwrap();
            let left = a3_scenes::parts(&source.description);
            for name in parts {
                assert!(left.iter().all(|part| part.name != *name), "{name}");
            }
        }
    }

    #[test]
    fn a_grid_from_the_command_line_is_written_too() {
        let folder = tempfile::tempdir().unwrap();
        let mut session = session(&["r", "0.002", "--grid", "12x9"]);
        session.tick(0.1);
        check(&session, &written(&session, folder.path()));
    }

    #[test]
    fn torn_springs_stay_torn() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rag.toml");
        let rag = "tear = 1.3\n\
             [wind]\nvelocity = [3, 0, 1]\n\
             [[cloth]]\ngrid = [6, 5]\nwidth = 1\nmass = 0.01\nstiffness = [20, 10, 5]\ndamping_ratio = 0.1\n\
             pin = [{ at = ['left'] }, { at = ['right'], shift = { by = [0.9, 0, 0], start = 0.1, end = 0.7 } }]\n";
        std::fs::write(&path, rag).unwrap();
        let mut session = session(&["r", "0.002", "--scene", path.to_str().unwrap()]);
        session.act(RunAction::Wind, 0);
        run_on(&mut session);
        let torn = session.runs.first().model().network().unwrap().torn().to_vec();
        assert!(torn.len() > 5, "{torn:?}");
        let path = written(&session, folder.path());
        check(&session, &path);
        let again = Source::find(path.to_str().unwrap()).unwrap();
        let again = again.build(None).unwrap().scene;
        assert_eq!(again.model.network().unwrap().torn(), torn);
    }

    #[test]
    fn the_file_is_beside_its_scene_and_finds_the_mesh() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(
            folder.path().join("leaf.obj"),
            "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n",
        )
        .unwrap();
        let path = folder.path().join("leaf.toml");
        std::fs::write(
            &path,
            "gravity = [0, -9.81, 0]\n[[mesh]]\nfile = 'leaf.obj'\ndensity = 0.3\nstiffness = [40, 10]\n\
             damping_ratio = 0.1\npin = [{ at = ['top'] }]\n",
        )
        .unwrap();
        let mut session = session(&["r", "0.005", "--scene", path.to_str().unwrap()]);
        session.tick(0.1);
        for k in 1..=2 {
            let name = write_scene(&session, session.runs.first()).unwrap();
            let expected = folder.path().join(format!("a3-leaf-{k}.toml"));
            assert_eq!(name, expected.to_str().unwrap());
            check(&session, &expected);
        }
    }

    /// The camera is written by few digits, which are read as the same numbers.
    #[test]
    fn the_camera_is_written_in_short() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/linkage.toml");
        let session = session(&["--scene", path]);
        let camera = description(&session, session.runs.first()).camera.unwrap();
        assert_eq!(camera.target, [0.4, 0.3, 0.0]);
        let eye = session.view.camera.eye();
        for (written, exact) in camera.eye.into_iter().zip([eye.x, eye.y, eye.z]) {
            assert_eq!(written as f32, exact);
            assert!(written.to_string().len() < 12, "{written}");
        }
    }
}
