//! A list to choose from, as far as it knows of no session: its entries, and what was typed.

/// What a list offers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Topic {
    /// Scenes, for all panes.
    Scenes,
    /// Solvers, for one pane.
    Solvers { pane: usize },
}

/// A list that is open.
pub struct List {
    pub topic: Topic,
    /// What was typed: entries without it are left out.
    pub filter: String,
    /// The entry that Enter takes, by its place among those that are left.
    pub chosen: usize,
    all: Vec<Entry>,
}

/// An entry of a list.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its number among all entries.
    pub number: usize,
    /// The key that chooses it without the list, if there is one.
    pub key: String,
    pub name: String,
    /// What it is, in a line.
    pub about: String,
    /// Whether it is what is shown now.
    pub current: bool,
}

/// A key with a meaning where something is typed: in a list that is open, or for a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextKey {
    /// Goes so many entries down, or up if it is negative.
    Move(isize),
    Type(char),
    Erase,
    Take,
    Close,
}

impl List {
    /// A list of these entries.
    pub fn new(topic: Topic, all: Vec<Entry>) -> Self {
        let mut list = Self {
            topic,
            filter: String::new(),
            chosen: 0,
            all,
        };
        list.choose_first();
        list
    }

    /// The entries that have all typed words in their names or in what is said of them.
    pub fn entries(&self) -> impl Iterator<Item = &Entry> {
        let words = self.filter.to_lowercase();
        let words: Vec<_> = words.split_whitespace().map(str::to_owned).collect();
        self.all.iter().filter(move |entry| {
            let text = format!("{} {}", entry.name, entry.about).to_lowercase();
            words.iter().all(|word| text.contains(word))
        })
    }

    /// Takes or leaves a letter, `None`, at the end of what was typed.
    pub fn edit(&mut self, letter: Option<char>) {
        match letter {
            Some(letter) => self.filter.push(letter),
            None => drop(self.filter.pop()),
        }
        self.choose_first();
    }

    /// Chooses the current entry, or the first one with what was typed in its name, or else the
    /// first.
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
