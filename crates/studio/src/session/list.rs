//! A list to choose from: its entries, and the typed filter.

use a3_core::{Simulation, integrators};

/// The kind of entries in a list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Scenes, for all panes.
    Scenes,
    /// Solvers, for one pane.
    Solvers { pane: usize },
    /// Solvers, for another pane beside one.
    Beside { pane: usize },
}

/// An open list.
pub struct List {
    pub topic: Topic,
    /// The typed words: entries without them are hidden.
    pub filter: String,
    /// Index of the highlighted entry among the visible ones.
    pub chosen: usize,
    all: Vec<Entry>,
}

/// An entry of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Number among all entries.
    pub number: usize,
    /// The key that chooses the entry without the list; empty if there is none.
    pub key: String,
    pub name: String,
    /// A description of one line.
    pub about: String,
    /// Whether the entry is the present scene or solver.
    pub current: bool,
}

/// A key while text is typed: the filter of an open list, or a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextKey {
    /// Move down by a number of entries, or up if it is negative.
    Move(isize),
    Type(char),
    /// Mark the whole text, which the next letter replaces.
    MarkAll,
    Erase,
    Accept,
    Cancel,
}

impl List {
    /// Creates a list, with the current entry highlighted.
    pub fn new(topic: Topic, all: Vec<Entry>) -> Self {
        let mut list = Self { topic, filter: String::new(), chosen: 0, all };
        list.choose_first();
        list
    }

    /// Returns the entries whose names and descriptions contain all typed words.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        let words = self.filter.to_lowercase();
        let words: Vec<_> = words.split_whitespace().map(str::to_owned).collect();
        self.all.iter().filter(move |entry| {
            let text = format!("{} {}", entry.name, entry.about).to_lowercase();
            words.iter().all(|word| text.contains(word))
        })
    }

    /// Handles a key, and returns the number of the entry that it accepts.
    pub fn press(&mut self, key: TextKey) -> Option<usize> {
        match key {
            TextKey::Move(by) => {
                let last = self.entries().count().saturating_sub(1);
                self.chosen = self.chosen.saturating_add_signed(by).min(last);
            }
            TextKey::Type(letter) => self.edit(Some(letter)),
            TextKey::Erase => self.edit(None),
            TextKey::Accept => return self.entries().nth(self.chosen).map(|entry| entry.number),
            TextKey::MarkAll | TextKey::Cancel => {}
        }
        None
    }

    /// Appends a letter to the filter, or removes the last one if `None`.
    fn edit(&mut self, letter: Option<char>) {
        match letter {
            Some(letter) => self.filter.push(letter),
            None => drop(self.filter.pop()),
        }
        self.choose_first();
    }

    /// Highlights the current entry if nothing is typed; otherwise the first whose name contains
    /// the filter, or else the first visible one.
    fn choose_first(&mut self) {
        let typed = self.filter.trim().to_lowercase();
        let best = self.entries().position(|entry| {
            if typed.is_empty() {
                entry.current
            } else {
                entry.name.to_lowercase().contains(&typed)
            }
        });
        self.chosen = best.unwrap_or(0);
    }
}

/// Returns the solvers that can integrate the scene of a run, as entries of a list.
pub fn solvers(run: &Simulation) -> Vec<Entry> {
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

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::session::{RunAction, Session, compared, session};

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
        let name = |session: &Session| session.runs.first().scene().name.clone();
        session.act(RunAction::Scenes, 0);
        type_words(&mut session, "Jel");
        assert!(keys(&mut session, &[TextKey::Accept]));
        assert!(session.list.is_none());
        assert_eq!(name(&session), "jelly");
        // The present scene is highlighted first.
        session.act(RunAction::Scenes, 0);
        assert!(keys(&mut session, &[TextKey::Move(1), TextKey::Accept]));
        assert_eq!(name(&session), a3_scenes::SCENES[9].name);
        session.act(RunAction::PreviousScene, 0);
        assert_eq!(name(&session), "jelly");
        session.act(RunAction::Scenes, 0);
        assert!(keys(&mut session, &[TextKey::Move(-99), TextKey::Accept]));
        assert_eq!(name(&session), "cloth");
        // The scene before the first is the last.
        session.act(RunAction::PreviousScene, 0);
        assert_eq!(name(&session), a3_scenes::SCENES.last().unwrap().name);
        // Nothing matches: Enter does nothing, and Esc closes the list.
        session.act(RunAction::Scenes, 0);
        type_words(&mut session, "zz");
        assert!(!keys(&mut session, &[TextKey::Accept]) && session.list.is_some());
        keys(&mut session, &[TextKey::Erase, TextKey::Erase]);
        assert!(session.list.as_ref().unwrap().entries().count() > 10);
        keys(&mut session, &[TextKey::Cancel]);
        assert!(session.list.is_none());
    }

    #[test]
    fn opened_files_come_first_and_none_comes_twice() {
        let mut session = session(&["v", "0.005"]);
        for _ in 0..2 {
            assert!(session.open(Path::new(STRIP)));
            session.act(RunAction::NextScene, 0);
        }
        session.act(RunAction::Scenes, 0);
        let list = session.list.as_ref().unwrap();
        let names: Vec<_> = list.entries().map(|entry| entry.name.clone()).collect();
        assert_eq!(names[..2], [STRIP, "cloth"]);
        assert_eq!(names.len(), a3_scenes::SCENES.len() + 1);
        assert_eq!(list.entries().position(|entry| entry.current), Some(1));
    }

    #[test]
    fn files_of_earlier_windows_come_last_and_can_be_opened() {
        let mut session = session(&["v", "0.005"]);
        session.scenes.recent = ["/nowhere/gone.toml", STRIP].map(Into::into).to_vec();
        session.act(RunAction::Scenes, 0);
        type_words(&mut session, "strip.toml");
        let list = session.list.as_ref().unwrap();
        assert_eq!(list.entries().count(), 1);
        assert!(keys(&mut session, &[TextKey::Accept]));
        let shown = session.scenes.shown.source.typed.clone();
        assert!(shown.ends_with("strip.toml"), "{shown}");
        // The file now belongs to this window.
        let entries = session.scenes.entries();
        assert_eq!(entries.iter().filter(|it| it.name == "strip.toml").count(), 0);
    }

    #[test]
    fn every_solver_that_fits_the_scene_can_be_chosen() {
        let mut session = compared(&["e:0.01", "r:0.01", "--scene", "chain"], 0.1);
        session.act(RunAction::Solvers, 1);
        type_words(&mut session, "dop853");
        keys(&mut session, &[TextKey::Accept]);
        let names: Vec<_> =
            session.runs.panes.iter().map(|pane| pane.simulation.method().name).collect();
        assert_eq!(names, ["euler", "dop853"]);
        session.act(RunAction::Solvers, 0);
        let count = session.list.as_ref().unwrap().entries().count();
        let serving = integrators::METHODS.iter().filter(|m| !m.plain_only());
        assert_eq!(count, serving.count());
        // The same key again closes it.
        session.act(RunAction::Solvers, 0);
        assert!(session.list.is_none());
        // The scene simple has no masses.
        let mut circle = crate::session::session(&["t", "0.01", "--scene", "simple"]);
        circle.act(RunAction::Solvers, 0);
        let list = circle.list.as_ref().unwrap();
        assert!(list.entries().count() < count && list.entries().all(|e| e.name != "verlet"));
    }
}
