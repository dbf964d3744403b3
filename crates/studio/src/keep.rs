//! Saving and loading the window's run, with its tuning, as a checkpoint.

use std::path::{Path, PathBuf};

use a3_files::checkpoint::{ENDING, Kept};
use a3_files::failure::Failure;
use a3_files::output;
use a3_files::scene_file::Source;

use crate::session::Session;
use crate::session::panel;

/// Saves the run of pane `at` under the first free name, in the folder of its scene file if it has
/// one, and returns the path. Fails if the file cannot be written.
pub fn save(session: &Session, at: usize) -> Result<PathBuf, Failure> {
    let run = &session.runs.panes[at.min(session.runs.panes.len() - 1)].simulation;
    let (shown, own) = (&session.scenes.shown, session.scenes.unedited());
    let mut kept = Kept::new(&own.source, own.grid, run, None);
    if shown.edited {
        let text = shown.source.description.to_toml().map_err(Failure::run)?;
        kept = kept.of_edited(text, &own.source, own.grid, &own.build()?.scene);
    }
    kept.tuned = panel::tuned(session);
    let folder = own.source.path.as_deref().and_then(Path::parent);
    let folder = folder.unwrap_or("".as_ref());
    output::write_new(folder, &run.scene().name, ENDING, &kept.bytes()?)
}

/// Loads a saved run into the window, with its tuning and with the edits of its scene, and releases
/// the grabbed particle or sphere. Fails if the checkpoint cannot be read or is of another scene,
/// or in a comparison.
pub fn load(session: &mut Session, path: &Path) -> Result<(), Failure> {
    if session.runs.panes.len() > 1 {
        return Err(Failure::usage(
            "a checkpoint holds one run, so it cannot be loaded into a comparison",
        ));
    }
    let refuse = |why: String| Failure::usage(format!("{}: {why}", path.display()));
    let (kept, own) = (Kept::read(path)?, session.scenes.unedited());
    if session.scenes.shown.edited {
        kept.check(path, &own.source, own.grid, &own.build()?.scene)?;
    } else {
        kept.check(path, &own.source, own.grid, session.runs.first().scene())?;
    }
    let edited = kept.edited.as_deref().map(Source::written).transpose();
    let edited = edited.map_err(|error| refuse(error.to_string()))?;
    let edited = edited.as_ref().map(|source| &*source.description);
    session.show_edited(edited).map_err(refuse)?;
    panel::tune(session, &kept.tuned).map_err(refuse)?;
    let taken = session.restore(&kept.checkpoint);
    taken.map_err(|why| refuse(why.to_string()))?;
    session.scenes.checkpoint = Some(path.into());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{PanelKey, RunAction, action_beside, apply, frames, session};

    #[test]
    fn a_tuned_run_continues_from_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("own.toml");
        let text = a3_scenes::find("flag").unwrap().text;
        std::fs::write(&scene, text).unwrap();
        let words = ["r", "0.002", "--scene", scene.to_str().unwrap()];
        let mut first = session(&words);
        first.readings.in_window = true;
        first.act(RunAction::Panel, 0);
        // Turn every row, including solver and step.
        for _ in 0..20 {
            for (key, other) in [(PanelKey::Down, false), (PanelKey::Right, true)] {
                let action = action_beside(&first, key, other).unwrap();
                apply(&mut first, action, 0);
            }
        }
        assert!(panel::tuned(&first).len() > 3, "{:?}", panel::tuned(&first));
        frames(&mut first, 0.5);
        let path = save(&first, 0).ok().unwrap();
        assert_eq!(path, folder.path().join("a3-flag-1.checkpoint"));
        let mut second = session(&words[2..]);
        second.readings.in_window = true;
        load(&mut second, &path).map_err(|failure| failure.to_string()).unwrap();
        assert_eq!(panel::tuned(&first), panel::tuned(&second));
        for session in [&mut first, &mut second] {
            frames(session, 0.5);
        }
        let seen = |session: &Session| {
            let run = session.runs.first();
            (run.time(), run.method().name, run.windy(), run.state().to_vec())
        };
        assert!(seen(&first) == seen(&second));
        // Parts that are left out are saved too, also obstacles.
        let parts = ["without gravity".to_owned(), "without sphere".to_owned()];
        let ball = folder.path().join("ball.toml");
        std::fs::write(&ball, a3_scenes::find("mit-sphere").unwrap().text).unwrap();
        let words = ["r", "0.005", "--scene", ball.to_str().unwrap()];
        let [mut third, mut fourth] = [&words; 2].map(|words| session(words));
        panel::tune(&mut third, &parts.clone().map(|part| (part, 1.0))).unwrap();
        frames(&mut third, 0.3);
        let reduced = save(&third, 0).ok().unwrap();
        load(&mut fourth, &reduced).map_err(|failure| failure.to_string()).unwrap();
        assert_eq!(fourth.readings.left_out, ["gravity", "sphere"]);
        for session in [&mut third, &mut fourth] {
            frames(session, 0.3);
        }
        assert!(seen(&third) == seen(&fourth));
        // Loading an untuned run resets the tuning.
        let words = ["r", "0.002", "--scene", scene.to_str().unwrap()];
        let plain = save(&session(&words), 0).ok().unwrap();
        load(&mut second, &plain).map_err(|failure| failure.to_string()).unwrap();
        assert_eq!(panel::tuned(&second), []);
        assert_eq!(second.runs.first().time(), 0.0);
        let mut other = session(&["r", "0.01"]);
        let why = load(&mut other, &path).err().unwrap().to_string();
        assert!(why.contains("of the scene flag, not of cloth"), "{why}");
    }

    /// A run is saved with the edits of its scene, and one without edits comes back too.
    #[test]
    fn an_edited_run_continues_from_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("own.toml");
        std::fs::write(&scene, a3_scenes::find("flag").unwrap().text).unwrap();
        let words = ["r", "0.002", "--scene", scene.to_str().unwrap()];
        let mut first = session(&words);
        frames(&mut first, 0.2);
        let plain = save(&first, 0).ok().unwrap();
        let add = a3_scenes::Edit::AddParticle { position: [0.0, 3.0, 1.0], mass: 0.1 };
        panel::edit(&mut first, &add, "particle").unwrap();
        frames(&mut first, 0.1);
        let edited = save(&first, 0).ok().unwrap();
        let seen = |session: &Session| {
            let run = session.runs.first();
            let edited = session.scenes.shown.edited;
            (edited, run.time(), run.state().to_vec())
        };
        let then = seen(&first);
        frames(&mut first, 0.1);
        let on = seen(&first);
        let mut second = session(&words);
        for session in [&mut first, &mut second] {
            for _ in 0..2 {
                load(session, &edited).ok().unwrap();
                assert!(seen(session) == then);
                frames(session, 0.1);
                assert!(seen(session) == on);
                load(session, &plain).ok().unwrap();
                assert_eq!((seen(session).0, seen(session).2.len()), (false, 6 * 176));
            }
        }
    }
}
