//! Another scene, or the same one from its file again.

use std::path::{Path, PathBuf};

use a3_core::{Control, Error, Simulation, integrators};
use a3_scenes::Setup;

use super::origin::Origin;
use super::pane::Pane;
use super::reference::ReferenceRun;
use super::state::Session;
use super::tuning::Tuning;
use crate::holding::shorter_step;
use crate::scene_file::Source;

impl Session {
    /// The names of all scenes: the files that were asked for or opened, then those of the table.
    pub(super) fn scene_names(&self) -> Vec<String> {
        let files = self.asked.iter().map(|origin| &origin.source);
        let files = files.filter(|source| source.path.is_some());
        let table = a3_scenes::SCENES.iter().map(|entry| entry.name.to_owned());
        files
            .map(|source| source.typed.clone())
            .chain(table)
            .collect()
    }

    /// The files that were asked for or opened, the last one first.
    pub fn files(&self) -> impl Iterator<Item = PathBuf> {
        let sources = self.asked.iter().map(|origin| &origin.source);
        let files = sources.filter(|source| !source.is_input());
        let paths = files.filter_map(|source| source.path.as_ref());
        paths.filter_map(|path| std::path::absolute(path).ok())
    }

    /// Files that were opened in earlier windows and are there still.
    pub(super) fn earlier_files(&self) -> Vec<PathBuf> {
        let now: Vec<_> = self.files().collect();
        let earlier = self
            .recent
            .iter()
            .filter(|path| !now.contains(*path) && path.is_file());
        earlier.cloned().collect()
    }

    /// Shows the scene `by` places after the one that is shown, or before it if that is negative.
    pub(super) fn go_to_scene(&mut self, by: isize) {
        let count = self.scene_names().len();
        let next = (self.scene_number as isize + by).rem_euclid(count as isize);
        self.show_scene(next as usize);
    }

    /// Shows the scene of this number among all names. Where that is not possible, a message says
    /// why.
    pub(super) fn show_scene(&mut self, number: usize) {
        let Some(name) = self.scene_names().get(number).cloned() else {
            return;
        };
        let asked = self
            .asked
            .iter()
            .find(|origin| origin.source.typed == name)
            .cloned();
        let origin = asked.map_or_else(|| Source::find(&name).map(Origin::of), Ok);
        match origin.and_then(|origin| Ok((origin.build()?, origin))) {
            Ok((setup, origin)) => {
                self.shown = origin;
                self.scene_number = number;
                self.see_scene(&setup.presentation);
                self.set_scene(&setup);
            }
            Err(why) => self.warn(why),
        }
    }

    /// Shows the scene of a file, with the same solvers and steps where they serve it, and returns
    /// whether that was possible; if not, a message says why, and all goes on.
    pub fn open(&mut self, file: &Path) -> bool {
        let source = Source::find(&file.to_string_lossy());
        match source.and_then(|source| Ok((source.build(None)?, source))) {
            Ok((setup, source)) => {
                let summary = source.description.summary.as_deref();
                let what = summary.map_or(String::new(), |what| format!(": {what}"));
                self.say(format!("opened {}{what}", source.typed));
                self.shown = Origin::of(source);
                let same = |origin: &Origin| origin.source.typed == self.shown.source.typed;
                self.asked.retain(|origin| !same(origin));
                self.asked.insert(0, self.shown.clone());
                self.scene_number = 0;
                self.see_scene(&setup.presentation);
                self.set_scene(&setup);
                true
            }
            Err(why) => {
                self.warn(why);
                false
            }
        }
    }

    /// Loads the scene again from its file, and returns whether that was possible; if not, a
    /// message says why, and all goes on. Camera, solvers and steps stay as they are, unless the
    /// file says others than before.
    pub fn reload(&mut self) -> bool {
        let begun = |origin: &Origin| origin.source.typed == self.begun;
        let Some(number) = self.asked.iter().position(begun) else {
            return false;
        };
        let begun = self.asked[number].clone();
        let old = begun.source.clone();
        let loaded = Source::find(&old.typed).and_then(|source| {
            let origin = Origin { source, ..begun };
            Ok((origin.build()?, origin.source))
        });
        let (setup, source) = match loaded {
            Ok(loaded) => loaded,
            Err(why) => {
                self.warn(why);
                return false;
            }
        };
        let (new, old) = (&source.description, &old.description);
        if new.camera != old.camera {
            self.see_scene(&setup.presentation);
        }
        let run = (new.solver != old.solver || new.step != old.step)
            .then_some(setup.defaults.solver)
            .flatten();
        self.say(format!("loaded {} again", source.typed));
        self.asked[number].source = source;
        self.shown = self.asked[number].clone();
        self.scene_number = number;
        let before = self.first();
        let (windy, swinging) = (before.windy(), before.swinging());
        let touching = before.touching();
        self.set_scene(&setup);
        self.do_to_all(|run| {
            run.set_wind(windy);
            run.set_swinging(swinging);
            // What crosses in the file as it is now begins as the file has it.
            let _ = run.set_touching(touching);
        });
        if let Some(method) = run {
            let control = setup.defaults.control_of(method);
            for pane in &mut self.panes {
                if let Err(why) = pane.simulation.set_method(method, control) {
                    self.readings.message = Some(why.to_string());
                }
                pane.wanted = method;
            }
            self.adapt();
        }
        true
    }

    /// Begins another scene, with the same solvers and steps where they serve it.
    fn set_scene(&mut self, setup: &Setup) {
        let mut said = None;
        let mut start = |pane: &Pane| {
            let own = pane.simulation.control();
            let control = pane.wanted_step.map_or(own, Control::Step);
            let start = |method| Simulation::new(setup.scene.clone(), method, control);
            // Heun serves every scene.
            start(pane.wanted).or_else(|why| {
                said = Some(format!("{why}: the explicit trapezoid steps in"));
                start(integrators::find("trapezoid").unwrap_or(pane.wanted))
            })
        };
        let simulations: Result<Vec<_>, Error> = self.panes.iter().map(&mut start).collect();
        match simulations {
            Ok(simulations) => {
                self.tuning = Tuning::of(setup.scene.clone());
                self.followed = None;
                self.history.clear();
                self.defaults = setup.defaults;
                for (pane, mut simulation) in self.panes.iter_mut().zip(simulations) {
                    let asked = simulation.control().step();
                    let shorter = shorter_step(&simulation)
                        .filter(|shorter| simulation.set_control(Control::Step(*shorter)).is_ok());
                    pane.wanted_step = asked.filter(|_| shorter.is_some());
                    if let (Some(asked), Some(shorter)) = (pane.wanted_step, shorter) {
                        let solver = simulation.method().title;
                        said = Some(format!(
                            "{solver}: the step is {shorter} s here, since {asked} s would blow up"
                        ));
                    }
                    pane.set_simulation(simulation, setup.presentation.clone());
                }
                // The panes could be built, so the reference can.
                self.reference = ReferenceRun::new(&self.panes).ok().flatten();
                self.clear_timeline();
                self.readings.no_error = None;
                self.start_anew();
            }
            Err(why) => said = Some(why.to_string()),
        }
        if let Some(said) = said {
            self.say(said);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::session::{Action, compared, session};

    const FLAG: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/strip.toml");

    #[test]
    fn a_step_that_a_scene_does_not_hold_is_shortened_and_comes_back() {
        let mut session = compared(&["t:0.02", "i:0.02", "--scene", "pendulum"], 0.1);
        let (mut shortened, mut kept) = (0, 0);
        for _ in 0..a3_scenes::SCENES.len() {
            session.readings.message = None;
            assert!(session.act(Action::NextScene, 0));
            let [heun, implicit] = [0, 1].map(|k| {
                let run = &session.panes[k].simulation;
                (run.scene().name.clone(), run.control().step().unwrap())
            });
            if heun.1 < 0.02 {
                shortened += 1;
                let said = session.readings.message.clone().unwrap();
                let step = format!("the step is {} s here, since 0.02 s would blow up", heun.1);
                assert!(said.contains(&step), "{}: {said}", heun.0);
                if !["boxes", "dominoes", "ball-on-cloth", "t-handle", "drop"].contains(&&*heun.0) {
                    let run = &session.panes[0].simulation;
                    let scene = run.scene().clone();
                    let mut again = Simulation::new(scene, run.method(), run.control()).unwrap();
                    again.advance_to(3.0).unwrap();
                }
            } else {
                kept += 1;
            }
            if session.panes[1].simulation.method().is_implicit() {
                assert_eq!(implicit.1, 0.02, "{}", implicit.0);
            }
        }
        assert!(shortened > 2 && kept > 2, "{shortened} {kept}");
        // A step that is set by hand is wanted from then on.
        while session.panes[0].wanted_step.is_none() {
            session.act(Action::NextScene, 0);
        }
        session.act(Action::ShorterStep, 0);
        assert_eq!(session.panes[0].wanted_step, None);
    }

    #[test]
    fn a_file_is_opened_and_one_that_is_none_is_refused() {
        let mut session = session(&["v", "0.001"]);
        assert!(session.open(Path::new(FLAG)));
        let name = session.first().scene().name.clone();
        assert!(
            session
                .readings
                .message
                .clone()
                .unwrap()
                .contains("strip.toml")
        );
        assert!(!session.open(Path::new("/nowhere/flag.toml")));
        assert!(
            session
                .readings
                .message
                .clone()
                .unwrap()
                .contains("/nowhere/flag.toml")
        );
        assert_eq!(session.first().scene().name, name);
        // It is one of the scenes from now on.
        session.act(Action::NextScene, 0);
        assert_eq!(session.first().scene().name, a3_scenes::SCENES[0].name);
        for _ in 0..a3_scenes::SCENES.len() {
            session.act(Action::NextScene, 0);
        }
        assert_eq!(session.first().scene().name, name);
    }
}
