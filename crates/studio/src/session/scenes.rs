//! The scenes and files that a session can show.

use std::path::{Path, PathBuf};

use a3_core::Method;
use a3_files::failure::InputError;
use a3_files::scene_file::Source;
use a3_scenes::Setup;

use super::list::Entry;
use super::origin::Origin;

/// The scenes that a session can show, and the one that it shows.
pub struct Scenes {
    /// The scenes of the command line and the opened files, the most recent first.
    asked: Vec<Origin>,
    /// The name or file of the first scene.
    begun: String,
    /// The present scene.
    pub shown: Origin,
    /// The names of all scenes that may be shown; those below if `None`.
    offered: Option<Vec<String>>,
    /// Number of the present scene: first the user's files, then the built-in scenes.
    number: usize,
    /// Files that were opened in earlier windows, the most recent first.
    pub recent: Vec<PathBuf>,
    /// The checkpoint that was last saved or loaded.
    pub checkpoint: Option<PathBuf>,
}

/// A reloaded scene, and the changes in its file.
pub struct Reloaded {
    pub setup: Setup,
    /// Whether the camera in the file has changed.
    pub camera: bool,
    /// The solver of the file, if the file's solver or step has changed.
    pub method: Option<&'static Method>,
}

impl Scenes {
    /// Creates the list of the built-in scenes and the first scene of the session.
    pub fn new(origin: Origin) -> Self {
        let typed = &origin.source.typed;
        let mut table = a3_scenes::SCENES.iter();
        let number = table.position(|entry| entry.name == *typed).unwrap_or(0);
        Self {
            begun: origin.source.typed.clone(),
            offered: None,
            number,
            shown: origin.clone(),
            asked: vec![origin],
            recent: vec![],
            checkpoint: None,
        }
    }

    /// Returns the present scene as it was before it was edited in the window.
    pub fn unedited(&self) -> Origin {
        let shown = &self.shown;
        let typed = &shown.source.typed;
        let before = shown.edited.then(|| self.origin(typed).ok()).flatten();
        before.unwrap_or_else(|| shown.clone())
    }

    /// Adds the scenes that a former session could show, and watches its file.
    pub fn adopt(&mut self, former: Self) {
        let shown = self.shown.source.typed.clone();
        let others = former.asked.into_iter();
        self.asked.extend(others.filter(|origin| origin.source.typed != shown));
        self.begun = former.begun;
        self.offered = former.offered;
        self.recent = former.recent;
        self.checkpoint = former.checkpoint;
        let number = self.names().iter().position(|name| *name == shown);
        self.number = number.unwrap_or(0);
    }

    /// Limits the scenes to those with these names.
    pub fn offer(&mut self, names: Vec<String>) {
        let shown = &self.shown.source.typed;
        self.number = names.iter().position(|name| name == shown).unwrap_or(0);
        self.recent.clear();
        self.offered = Some(names);
    }

    /// Returns whether the scene of a file may not be shown.
    pub fn leaves_out(&self, file: &Path) -> bool {
        let has = |names: &Vec<String>| names.iter().any(|name| Path::new(name) == file);
        self.offered.as_ref().is_some_and(|names| !has(names))
    }

    /// Returns the names of all scenes: first the user's files, then the built-in scenes.
    fn names(&self) -> Vec<String> {
        if let Some(offered) = &self.offered {
            return offered.clone();
        }
        let files = self.asked.iter().map(|origin| &origin.source);
        let files = files.filter(|source| source.path.is_some());
        let table = a3_scenes::SCENES.iter().map(|entry| entry.name.to_owned());
        let files = files.map(|source| source.typed.clone());
        files.chain(table).collect()
    }

    /// Returns the scene of the command line or the opened file with this name.
    fn asked(&self, name: &str) -> Option<&Origin> {
        self.asked.iter().find(|it| it.source.typed == name)
    }

    /// Returns the scene of this name, as it was asked for or as it is found.
    fn origin(&self, name: &str) -> Result<Origin, InputError> {
        let asked = self.asked(name).cloned();
        asked.map_or_else(|| Origin::find(name), Ok)
    }

    /// Returns the absolute paths of the user's files, the most recent first.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let sources = self.asked.iter().map(|origin| &origin.source);
        let files = sources.filter(|source| !source.is_input());
        let paths = files.filter_map(|source| source.path.as_ref());
        paths.filter_map(|path| std::path::absolute(path).ok())
    }

    /// Returns the files of earlier windows that still exist and were not opened in this one.
    fn earlier_files(&self) -> Vec<PathBuf> {
        let now: Vec<_> = self.files().collect();
        let earlier = self.recent.iter();
        let earlier = earlier.filter(|path| !now.contains(*path) && path.is_file());
        earlier.cloned().collect()
    }

    /// Returns all scenes, then the files of earlier windows, as entries of a list.
    pub fn entries(&self) -> Vec<Entry> {
        let names = self.names();
        let count = names.len();
        let earlier = self.earlier_files().into_iter().enumerate();
        let earlier = earlier.map(|(k, path)| Entry {
            number: count + k,
            key: String::new(),
            name: path.file_name().unwrap_or_default().to_string_lossy().into(),
            about: path.display().to_string(),
            current: false,
        });
        let names = names.into_iter().enumerate();
        names
            .map(|(number, name)| {
                let summary = if let Some(entry) = a3_scenes::find(&name) {
                    entry.description().ok().and_then(|d| d.summary)
                } else {
                    let asked = self.asked(&name);
                    asked.and_then(|origin| origin.source.description.summary.clone())
                };
                Entry {
                    number,
                    key: String::new(),
                    about: summary.unwrap_or_default(),
                    current: number == self.number,
                    name,
                }
            })
            .chain(earlier)
            .collect()
    }

    /// Returns the file of an earlier window that has this number in the list.
    pub fn earlier_file(&self, number: usize) -> Option<PathBuf> {
        let k = number.checked_sub(self.names().len())?;
        self.earlier_files().into_iter().nth(k)
    }

    /// Returns the number of the scene `by` places after the present one, or before it if `by` is
    /// negative.
    pub fn neighbour(&self, by: isize) -> usize {
        let count = self.names().len() as isize;
        (self.number as isize + by).rem_euclid(count) as usize
    }

    /// Builds the scene of this number, and makes it the present one. Fails if it cannot be built.
    pub fn show(&mut self, number: usize) -> Result<Setup, InputError> {
        let names = self.names();
        let unknown = || InputError::Unknown("There is no such scene.".into());
        let name = names.get(number).ok_or_else(unknown)?;
        let mut origin = self.origin(name)?;
        let setup = origin.begin()?;
        (self.shown, self.number) = (origin, number);
        Ok(setup)
    }

    /// Builds the scene of this number, as [`show`](Self::show) does, without showing it; `None` if
    /// it cannot be built.
    pub fn setup(&self, number: usize) -> Option<Setup> {
        let names = self.names();
        let name = names.get(number)?;
        self.origin(name).ok()?.build().ok()
    }

    /// Builds the scene of a file, and makes it the present one. Fails if the file cannot be read
    /// or built.
    pub fn open(&mut self, file: &Path) -> Result<Setup, InputError> {
        let mut origin = Origin::find(&file.to_string_lossy())?;
        let setup = origin.begin()?;
        self.asked.retain(|it| it.source.typed != origin.source.typed);
        self.shown = origin;
        self.asked.insert(0, self.shown.clone());
        self.number = 0;
        Ok(setup)
    }

    /// Reloads the first scene of the session, and makes it the present one; `None` if it is not in
    /// the list. Fails if it cannot be read or built.
    pub fn reload(&mut self) -> Result<Option<Reloaded>, InputError> {
        let begun = |origin: &Origin| origin.source.typed == self.begun;
        let Some(number) = self.asked.iter().position(begun) else {
            return Ok(None);
        };
        let old = self.asked[number].clone();
        let mut origin =
            Origin { source: Source::find(&old.source.typed)?.in_window(), crossed: false, ..old };
        let setup = origin.begin()?;
        let (new, old) = (&origin.source.description, &old.source.description);
        let ran = (new.solver != old.solver || new.step != old.step).then_some(&setup.defaults);
        let reloaded = Reloaded {
            camera: new.camera != old.camera,
            method: ran.and_then(|defaults| defaults.solver),
            setup,
        };
        self.asked[number] = origin.clone();
        self.shown = origin;
        self.number = number;
        Ok(Some(reloaded))
    }
}

#[cfg(test)]
mod tests {
    use a3_core::{Simulation, StepLength};

    use super::*;
    use crate::session::{RunAction, compared, session};

    #[test]
    fn scenes_come_round_and_the_solver_comes_back() {
        let mut session = session(&["v", "0.005"]);
        let mut seen = vec![];
        for _ in 0..a3_scenes::SCENES.len() {
            seen.push((
                session.runs.panes[0].simulation.scene().name.clone(),
                session.runs.panes[0].simulation.method().name,
            ));
            assert!(session.act(RunAction::NextScene, 0));
        }
        let expected: Vec<_> = a3_scenes::SCENES.iter().map(|entry| entry.name).collect();
        assert_eq!(seen.iter().map(|(scene, _)| scene.as_str()).collect::<Vec<_>>(), expected);
        // Verlet cannot integrate the scene simple, and returns with the next one.
        let solvers: Vec<_> = seen.iter().map(|(_, solver)| *solver).collect();
        for (scene, solver) in expected.iter().zip(solvers) {
            assert_eq!(solver, if *scene == "simple" { "trapezoid" } else { "verlet" });
        }
        assert_eq!(session.runs.panes[0].simulation.scene().name, "cloth");
    }

    #[test]
    fn the_grid_of_the_command_line_comes_back() {
        let mut session = session(&["t", "0.005", "--grid", "30x25"]);
        for _ in 0..a3_scenes::SCENES.len() {
            session.act(RunAction::NextScene, 0);
        }
        assert_eq!(session.runs.panes[0].simulation.particles(), 750);
    }

    const FLAG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/strip.toml");

    #[test]
    fn an_unstable_step_is_shortened_for_a_scene_and_comes_back() {
        let mut session = compared(&["t:0.02", "i:0.02", "--scene", "pendulum"], 0.1);
        let (mut shortened, mut kept) = (0, 0);
        for _ in 0..a3_scenes::SCENES.len() {
            session.readings.message = None;
            assert!(session.act(RunAction::NextScene, 0));
            let [heun, implicit] = [0, 1].map(|k| {
                let run = &session.runs.panes[k].simulation;
                (run.scene().name.clone(), run.control().step().unwrap())
            });
            // Implicit Euler gains energy there, if the trial has the time to see it.
            if heun.0 == "jelly" {
                continue;
            }
            if heun.1 < 0.02 {
                shortened += 1;
                let said = session.readings.message.clone().unwrap();
                let step = StepLength(heun.1);
                let step = format!("the step is {step} here, since 0.02 s would not hold");
                assert!(said.contains(&step), "{}: {said}", heun.0);
                if !["boxes", "dominoes", "ball-on-cloth", "t-handle", "drop"].contains(&&*heun.0) {
                    let run = &session.runs.panes[0].simulation;
                    let scene = run.scene().clone();
                    let mut again = Simulation::new(scene, run.method(), run.control()).unwrap();
                    again.advance_to(3.0).unwrap();
                }
            } else {
                kept += 1;
            }
            // Bodies that land in such a step are pushed before their impact.
            let lands = ["boxes", "dominoes", "ball-on-cloth"].contains(&&*heun.0);
            if session.runs.panes[1].simulation.method().is_implicit() && !lands {
                assert_eq!(implicit.1, 0.02, "{}", implicit.0);
            }
        }
        assert!(shortened > 2 && kept > 2, "{shortened} {kept}");
        // A step that the user sets replaces the remembered one.
        while session.runs.panes[0].wanted_step.is_none() {
            session.act(RunAction::NextScene, 0);
        }
        session.act(RunAction::ShorterStep, 0);
        assert_eq!(session.runs.panes[0].wanted_step, None);
    }

    #[test]
    fn a_file_is_opened_and_a_missing_one_is_refused() {
        let mut session = session(&["v", "0.001"]);
        assert!(session.open(Path::new(FLAG)));
        let name = session.runs.first().scene().name.clone();
        assert!(session.readings.message.clone().unwrap().contains("strip.toml"));
        assert!(!session.open(Path::new("/nowhere/flag.toml")));
        assert!(session.readings.message.clone().unwrap().contains("/nowhere/flag.toml"));
        assert_eq!(session.runs.first().scene().name, name);
        // The file is one of the scenes from now on.
        session.act(RunAction::NextScene, 0);
        assert_eq!(session.runs.first().scene().name, a3_scenes::SCENES[0].name);
        for _ in 0..a3_scenes::SCENES.len() {
            session.act(RunAction::NextScene, 0);
        }
        assert_eq!(session.runs.first().scene().name, name);
    }
}
