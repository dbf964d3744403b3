//! Runs of the window in checkpoints, with what the panel has tuned: kept by a key, and opened
//! again.

use std::path::{Path, PathBuf};

use crate::base::failure::Failure;
use crate::files::checkpoint::{ENDING, Kept};
use crate::files::output;
use crate::window::hud::panel;
use crate::window::session::Session;

/// Writes the run of pane `at` under the first free name, beside the file of its scene if there is
/// one, and returns that name.
pub fn save(session: &mut Session, at: usize) -> Result<PathBuf, Failure> {
    let run = &session.runs.panes[at.min(session.runs.panes.len() - 1)].simulation;
    let origin = &session.scenes.shown;
    let folder = origin.source.path.as_deref().and_then(Path::parent);
    let mut kept = Kept::new(&origin.source, origin.grid, run, None);
    kept.tuned = panel::tuned(session);
    let folder = folder.unwrap_or("".as_ref());
    let path = output::write_new(folder, &run.scene().name, ENDING, &kept.bytes()?)?;
    session.scenes.checkpoint = Some(path.clone());
    Ok(path)
}

/// Takes the run of a window up where it was kept, tuned alike. A hand lets go.
pub fn load(session: &mut Session, path: &Path) -> Result<(), Failure> {
    if session.runs.panes.len() > 1 {
        return Err(Failure::usage(
            "a checkpoint has one run, so it cannot be opened beside others",
        ));
    }
    let kept = Kept::read(path)?;
    let origin = &session.scenes.shown;
    kept.check(path, &origin.source, origin.grid, session.runs.first())?;
    panel::tune(session, &kept.tuned);
    let taken = session.restore(&kept.checkpoint);
    taken.map_err(|why| Failure::usage(format!("{}: {why}", path.display())))?;
    session.scenes.checkpoint = Some(path.into());
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::hud::panel::{PanelKey, press};
    use crate::window::session::{RunAction, frames, session};

    #[test]
    fn a_tuned_run_goes_on_from_its_file() {
        let folder = tempfile::tempdir().unwrap();
        let scene = folder.path().join("own.toml");
        let text = a3_scenes::find("flag").unwrap().text;
        std::fs::write(&scene, text).unwrap();
        let words = ["r", "0.002", "--scene", scene.to_str().unwrap()];
        let mut first = session(&words);
        first.readings.in_window = true;
        first.act(RunAction::Panel, 0);
        // Every row, solver and step too.
        for _ in 0..20 {
            press(&mut first, PanelKey::Down, false);
            press(&mut first, PanelKey::Right, true);
        }
        assert!(panel::tuned(&first).len() > 3, "{:?}", panel::tuned(&first));
        frames(&mut first, 0.5);
        let path = save(&mut first, 0).ok().unwrap();
        assert_eq!(path, folder.path().join("a3-flag-1.checkpoint"));
        let mut second = session(&words[2..]);
        second.readings.in_window = true;
        load(&mut second, &path).map_err(Failure::message).unwrap();
        assert_eq!(panel::tuned(&first), panel::tuned(&second));
        for session in [&mut first, &mut second] {
            frames(session, 0.5);
        }
        let seen = |session: &Session| {
            let run = session.runs.first();
            (
                run.time(),
                run.method().name,
                run.windy(),
                run.state().to_vec(),
            )
        };
        assert!(seen(&first) == seen(&second));
        // A run that is not tuned takes it back.
        let plain = save(&mut session(&words), 0).ok().unwrap();
        load(&mut second, &plain).map_err(Failure::message).unwrap();
        assert_eq!(panel::tuned(&second), []);
        assert_eq!(second.runs.first().time(), 0.0);
        let mut other = session(&["r", "0.01"]);
        let why = load(&mut other, &path).err().unwrap().message();
        assert!(why.contains("of the scene flag, not of cloth"), "{why}");
    }
}
