//! Lists of scenes and solvers: what they offer, and what is taken from them by arrows, by the
//! mouse, or by typing.

use a3_core::integrators;

use super::keys::Action;
use super::list::{Entry, List, TextKey, Topic};
use super::state::Session;

impl Session {
    /// Opens a list, or closes the one that is open.
    pub(super) fn toggle_list(&mut self, topic: Topic) {
        if self.list.take().is_some_and(|list| list.topic == topic) {
            return;
        }
        let entries = match topic {
            Topic::Scenes => self.scene_entries(),
            Topic::Solvers { pane } => self.solver_entries(pane),
        };
        self.readings.help = false;
        self.list = Some(List::new(topic, entries));
    }

    fn scene_entries(&self) -> Vec<Entry> {
        let names = self.scene_names();
        let count = names.len();
        let earlier = self.earlier_files().into_iter().enumerate();
        let earlier = earlier.map(|(k, path)| Entry {
            number: count + k,
            key: String::new(),
            name: path
                .file_name()
                .unwrap_or_default()
                .to_string_lossy()
                .into(),
            about: path.display().to_string(),
            current: false,
        });
        let names = names.into_iter().enumerate();
        names
            .map(|(number, name)| {
                let asked = || self.asked.iter().find(|o| o.source.typed == name);
                let summary = if let Some(entry) = a3_scenes::find(&name) {
                    entry.description().ok().and_then(|d| d.summary)
                } else {
                    asked().and_then(|origin| origin.source.description.summary.clone())
                };
                Entry {
                    number,
                    key: String::new(),
                    about: summary.unwrap_or_default(),
                    current: number == self.scene_number,
                    name,
                }
            })
            .chain(earlier)
            .collect()
    }

    /// The solvers that serve the scene.
    fn solver_entries(&self, pane: usize) -> Vec<Entry> {
        let run = &self.panes[pane.min(self.panes.len() - 1)].simulation;
        let system = run.model().system();
        let methods = integrators::METHODS.iter().enumerate();
        methods
            .filter(|(_, method)| method.check(system).is_ok())
            .map(|(number, method)| Entry {
                number,
                key: match number {
                    0..=9 => ((number + 1) % 10).to_string(),
                    _ => String::new(),
                },
                name: method.name.into(),
                about: format!("{}, order {}", method.title, method.order),
                current: std::ptr::eq(method, run.method()),
            })
            .collect()
    }

    /// Does what a key means in the list that is open, and returns whether another scene is shown.
    pub fn press_list(&mut self, key: TextKey) -> bool {
        let Some(list) = &mut self.list else {
            return false;
        };
        match key {
            TextKey::Move(by) => {
                let last = list.entries().count().saturating_sub(1);
                list.chosen = list.chosen.saturating_add_signed(by).min(last);
            }
            TextKey::Type(letter) => list.edit(Some(letter)),
            TextKey::Erase => list.edit(None),
            TextKey::Close => self.list = None,
            TextKey::Take => {
                let chosen = list.entries().nth(list.chosen);
                return chosen
                    .map(|entry| entry.number)
                    .is_some_and(|number| self.take(number));
            }
        }
        false
    }

    /// Takes an entry by its number, closes the list, and returns whether another scene is shown.
    pub fn take(&mut self, number: usize) -> bool {
        match self.list.take().map(|list| list.topic) {
            Some(Topic::Scenes) => {
                let earlier = number.checked_sub(self.scene_names().len());
                let file = earlier.and_then(|k| self.earlier_files().into_iter().nth(k));
                if let Some(file) = file {
                    return self.open(&file);
                }
                self.show_scene(number);
                true
            }
            Some(Topic::Solvers { pane }) => self.act(Action::Solver(number), pane),
            None => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::session::{compared, session};

    const STRIP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/scenes/strip.toml");

    fn keys(session: &mut Session, keys: &[TextKey]) -> bool {
        keys.iter().any(|key| session.press_list(*key))
    }

    fn type_words(session: &mut Session, words: &str) {
        for letter in words.chars() {
            session.press_list(TextKey::Type(letter));
        }
    }

    #[test]
    fn a_scene_is_found_by_typing_and_by_arrows() {
        let mut session = session(&["v", "0.005"]);
        let name = |session: &Session| session.first().scene().name.clone();
        session.act(Action::Scenes, 0);
        type_words(&mut session, "Jel");
        assert!(keys(&mut session, &[TextKey::Take]));
        assert!(session.list.is_none());
        assert_eq!(name(&session), "jelly");
        // The list begins at what is shown.
        session.act(Action::Scenes, 0);
        assert!(keys(&mut session, &[TextKey::Move(1), TextKey::Take]));
        assert_eq!(name(&session), a3_scenes::SCENES[9].name);
        session.act(Action::PreviousScene, 0);
        assert_eq!(name(&session), "jelly");
        session.act(Action::Scenes, 0);
        assert!(keys(&mut session, &[TextKey::Move(-99), TextKey::Take]));
        assert_eq!(name(&session), "cloth");
        // Before the first comes the last.
        session.act(Action::PreviousScene, 0);
        assert_eq!(name(&session), a3_scenes::SCENES.last().unwrap().name);
        // Nothing matches: Enter does nothing, and Esc closes the list.
        session.act(Action::Scenes, 0);
        type_words(&mut session, "zz");
        assert!(!keys(&mut session, &[TextKey::Take]) && session.list.is_some());
        keys(&mut session, &[TextKey::Erase, TextKey::Erase]);
        assert!(session.list.as_ref().unwrap().entries().count() > 10);
        keys(&mut session, &[TextKey::Close]);
        assert!(session.list.is_none());
    }

    #[test]
    fn opened_files_come_first_and_none_comes_twice() {
        let mut session = session(&["v", "0.005"]);
        for _ in 0..2 {
            assert!(session.open(Path::new(STRIP)));
            session.act(Action::NextScene, 0);
        }
        session.act(Action::Scenes, 0);
        let list = session.list.as_ref().unwrap();
        let names: Vec<_> = list.entries().map(|entry| entry.name.clone()).collect();
        assert_eq!(names[..2], [STRIP, "cloth"]);
        assert_eq!(names.len(), a3_scenes::SCENES.len() + 1);
        assert_eq!(list.entries().position(|entry| entry.current), Some(1));
    }

    #[test]
    fn files_of_earlier_windows_come_last_and_can_be_opened() {
        let mut session = session(&["v", "0.005"]);
        session.recent = ["/nowhere/gone.toml", STRIP].map(Into::into).to_vec();
        session.act(Action::Scenes, 0);
        type_words(&mut session, "strip.toml");
        let list = session.list.as_ref().unwrap();
        assert_eq!(list.entries().count(), 1);
        assert!(keys(&mut session, &[TextKey::Take]));
        let shown = session.shown().typed.clone();
        assert!(shown.ends_with("strip.toml"), "{shown}");
        // It is one of the files of this window now.
        assert!(session.earlier_files().is_empty());
    }

    #[test]
    fn every_solver_that_serves_can_be_had() {
        let mut session = compared(&["e:0.01", "r:0.01", "--scene", "chain"], 0.1);
        session.act(Action::Solvers, 1);
        type_words(&mut session, "dop853");
        keys(&mut session, &[TextKey::Take]);
        let names: Vec<_> = session
            .panes
            .iter()
            .map(|pane| pane.simulation.method().name)
            .collect();
        assert_eq!(names, ["euler", "dop853"]);
        session.act(Action::Solvers, 0);
        let count = session.list.as_ref().unwrap().entries().count();
        assert_eq!(count, integrators::METHODS.len());
        // The same key again closes it.
        session.act(Action::Solvers, 0);
        assert!(session.list.is_none());
        // The circle is no system of masses.
        let mut circle = crate::session::session(&["t", "0.01", "--scene", "simple"]);
        circle.act(Action::Solvers, 0);
        let list = circle.list.as_ref().unwrap();
        assert!(list.entries().count() < count && list.entries().all(|e| e.name != "verlet"));
    }
}
