//! The command line that opens a window with the present run and picture.

use a3_core::{Simulation, StepLimits};
use a3_files::failure::Failure;
use a3_media::show::{Quantity, has_springs};
use a3_render::Style;

use crate::begin;
use crate::session::panel;
use crate::session::{Session, looks, read, write_scene};

/// Returns the command line that opens the present run and the picture of pane `at`, from the
/// beginning. If options cannot express the run, writes a scene file, from whose state a single run
/// continues. A comparison starts from its initial state, because its runs share no later one.
/// Fails if that file cannot be written.
pub fn of(session: &Session, at: usize) -> Result<String, Failure> {
    let mut words = arguments(session, at);
    if !recreates(&words, session) {
        let run = session.runs.first();
        let written = if session.runs.panes.len() == 1 {
            write_scene(session, run)
        } else {
            write_scene(session, &begun_again(run).map_err(Failure::run)?)
        };
        words = arguments_with_scene(session, at, &written.map_err(Failure::Run)?);
    }
    let quoted: Vec<_> = words.iter().map(|word| quote(word)).collect();
    Ok(format!("a3 {}", quoted.join(" ")))
}

/// Returns the arguments, with the scene as the user named it.
fn arguments(session: &Session, at: usize) -> Vec<String> {
    let (origin, run) = (&session.scenes.shown, session.runs.first());
    let description = &origin.source.description;
    let begins_windy = description.wind.as_ref().is_some_and(|wind| wind.on);
    // A comparison begins as its scene says everywhere.
    let is_alone = session.runs.panes.len() == 1;
    let touches = description.self_collision && (is_alone || !description.window_self_collision);
    let mut words = arguments_with_scene(session, at, &origin.source.typed);
    if let Some(grid) = origin.grid {
        words.extend(["--grid".into(), format!("{}x{}", grid.rows(), grid.cols())]);
    }
    for (on, word) in [
        (run.windy() && !begins_windy, "--wind"),
        (run.swinging(), "--swing"),
        (run.touching() && !touches, "--self-collision"),
        (!run.touching() && touches, "--no-self-collision"),
    ] {
        words.extend(on.then(|| word.to_owned()));
    }
    words
}

/// Returns the arguments for `scene`, a name or file that contains the grid, the wind and the
/// swing.
fn arguments_with_scene(session: &Session, at: usize, scene: &str) -> Vec<String> {
    let control = |run: &Simulation| run.control().value();
    let mut words = if session.runs.panes.len() == 1 {
        let run = session.runs.first();
        vec![run.method().name.into(), control(run).to_string()]
    } else {
        let runs = session.runs.panes.iter().map(|pane| &pane.simulation);
        let methods = runs.map(|run| format!("{}:{}", run.method().name, control(run)));
        ["compare".into()].into_iter().chain(methods).collect()
    };
    let StepLimits { absolute, max_step } = session.scenes.shown.limits;
    for (name, limit) in [("--absolute", absolute), ("--max-step", max_step)] {
        let given = limit.map(|limit| [name.into(), limit.to_string()]);
        words.extend(given.into_iter().flatten());
    }
    let show = &session.runs.panes[at].show;
    let mut option = |name: &str, value: &str| words.extend([name.into(), value.into()]);
    option("--scene", scene);
    let is_there = |it: &Quantity| looks::has_quantity(&session.runs.panes, *it);
    if let Some(quantity) = show.colouring.quantity.filter(is_there) {
        option("--colour", quantity.name());
    }
    if let Some(arrows) = show.field.arrows {
        option("--arrows", arrows.name());
    }
    if let (Some(i), 1) = (show.springs_of, session.runs.panes.len()) {
        option("--springs-of", &i.to_string());
    }
    let springs = show.style == Style::Springs && has_springs(session.runs.first());
    for (on, word) in [
        (show.style == Style::Wireframe, "--wireframe"),
        (springs, "--springs"),
        (session.view.camera.is_parallel(), "--orthographic"),
        (show.dark, "--dark"),
        (session.readings.paused, "--paused"),
    ] {
        words.extend(on.then(|| word.to_owned()));
    }
    words
}

/// Returns whether these arguments recreate the run of a session, or the initial state of a
/// comparison. A run that no hand has touched is recreated by its beginning.
fn recreates(words: &[String], session: &Session) -> bool {
    let Ok(made) = read(words).and_then(|opening| begin::session(&opening)) else {
        return false;
    };
    let begins_alike = |now: &Simulation, made: &Simulation| {
        let begun = if session.runs.panes.len() == 1 && session.runs.touched {
            Ok(now.moment())
        } else {
            begun_again(now).map(|run| run.moment())
        };
        begun.is_ok_and(|begun| begun == made.moment())
    };
    let mut pairs = session.runs.panes.iter().zip(&made.runs.panes);
    let described = |session: &Session| session.scenes.shown.source.description.clone();
    panel::tuned(session).is_empty()
        && (!session.scenes.shown.edited || described(session) == described(&made))
        && session.view.camera.shows_as(&made.view.camera)
        && pairs.all(|(now, made)| begins_alike(&now.simulation, &made.simulation))
}

/// Returns a run in its initial state, with its present wind, swing and self-collision.
fn begun_again(run: &Simulation) -> Result<Simulation, a3_core::Error> {
    run.anew(run.method(), run.control())
}

/// Quotes an argument for a shell, if it needs quotes.
fn quote(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "-_./:,=+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.into();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{RunAction, compared, frames, session};

    /// Opens the session of a command line without quotes.
    fn reopen(line: &str) -> Session {
        let words: Vec<_> = line.split(' ').skip(1).collect();
        session(&words)
    }

    #[test]
    fn options_say_what_began_and_what_is_seen() {
        for words in [
            "verlet 0.005 --scene cloth",
            "rk4 0.002 --scene cloth --grid 12x9 --wind --swing --colour strain",
            "dopri5 0.0001 --scene flag --arrows velocity --wireframe --orthographic --dark --paused",
            "verlet 0.005 --scene cloth --no-self-collision",
            "verlet 0.005 --scene mit --self-collision --springs-of 7 --springs --colour contact",
            "compare euler:0.05 rk4:0.01 --scene chain --colour force --paused",
        ] {
            let words: Vec<_> = words.split(' ').collect();
            let line = of(&session(&words), 0).ok().unwrap();
            let made: std::collections::BTreeSet<_> = line.split(' ').skip(1).collect();
            assert_eq!(made, words.iter().copied().collect(), "{line}");
        }
        // A run that no hand has touched starts again, and one that was pulled is in a file.
        let mut later = session(&["verlet", "0.005", "--scene", "cloth"]);
        frames(&mut later, 0.5);
        let line = of(&later, 0).ok().unwrap();
        assert_eq!(line, "a3 verlet 0.005 --scene cloth");
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.toml");
        std::fs::write(&file, a3_scenes::find("cloth").unwrap().text).unwrap();
        let mut pulled = session(&["verlet", "0.005", "--scene", file.to_str().unwrap()]);
        assert!(pulled.runs.grab(210));
        frames(&mut pulled, 0.1);
        pulled.release();
        let line = of(&pulled, 0).ok().unwrap();
        assert!(line.contains("/a3-cloth-1.toml"), "{line}");
        pulled.act(RunAction::Reset, 0);
        let line = of(&pulled, 0).ok().unwrap();
        assert!(line.ends_with("/own.toml"), "{line}");
        // A comparison starts from its initial state.
        let later = compared(&["e:0.05", "r:0.01", "--scene", "simple"], 0.5);
        let line = of(&later, 0).ok().unwrap();
        assert_eq!(line, "a3 compare euler:0.05 rk4:0.01 --scene simple");
    }

    #[test]
    fn what_options_cannot_say_is_in_a_file() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("own.toml");
        std::fs::write(&file, a3_scenes::find("flag").unwrap().text).unwrap();
        let file = file.to_str().unwrap();
        let mut session = session(&["rk4", "0.001", "--scene", file, "--colour", "speed"]);
        let line = of(&session, 0).ok().unwrap();
        assert!(line.contains("/own.toml"), "{line}");
        // Advance the run, move the camera, and tune the scene.
        frames(&mut session, 0.3);
        session.view.camera.orbit(0.3, 0.1);
        panel::tune(&mut session, &[("gravity".into(), 5.0), ("stiffness".into(), 1.5)]).unwrap();
        let line = of(&session, 0).ok().unwrap();
        assert!(line.contains("/a3-flag-1.toml --colour speed"), "{line}");
        let made = reopen(&line);
        assert_eq!(made.runs.first().state(), session.runs.first().state());
        assert_eq!(made.runs.first().control(), session.runs.first().control());
        let gravity = made.runs.first().model().network().and_then(a3_core::Network::gravity);
        assert_eq!(gravity.unwrap().y, -5.0);
        assert!((made.view.camera.eye() - session.view.camera.eye()).norm() < 1e-4);
        // The file and its options then express the whole state, without another file.
        let same = of(&made, 0).ok().unwrap();
        assert_eq!(same, line);
        // So are parts that are left out.
        let names = [("without gravity".to_owned(), 1.0)];
        let mut reduced = crate::session::session(&["rk4", "0.001", "--scene", file]);
        panel::tune(&mut reduced, &names).unwrap();
        let made = reopen(&of(&reduced, 0).ok().unwrap());
        let network = made.runs.first().model().network();
        assert_eq!(network.and_then(a3_core::Network::gravity), None);
        // The panes of a comparison have different states, so its initial state is written.
        let words = ["e:0.001", "r:0.001", "--scene", file];
        let mut several = compared(&words, 0.2);
        panel::tune(&mut several, &[("gravity".into(), 5.0)]).unwrap();
        let line = of(&several, 0).ok().unwrap();
        let made = reopen(&line);
        assert_eq!(made.runs.panes.len(), 2);
        let begun = begun_again(several.runs.first()).unwrap();
        assert_eq!(made.runs.first().state(), begun.state());
        several.act(RunAction::Reset, 0);
        assert!(of(&several, 0).ok().unwrap().contains("a3-flag-4"));
    }

    #[test]
    fn words_are_quoted_for_shells() {
        assert_eq!(quote("docs/a-b_1.toml"), "docs/a-b_1.toml");
        assert_eq!(quote("my scene.toml"), "'my scene.toml'");
        assert_eq!(quote("it's"), r"'it'\''s'");
        assert_eq!(quote(""), "''");
    }
}
