//! Lists from which items were removed, and to which others were added.

/// Places of a list from which an edit removed items, and to which it added others.
///
/// ```
/// let gap = a3_scenes::Splice { at: 3, removed: 1, added: 0 };
/// assert_eq!([2, 3, 4].map(|i| gap.number(i)), [Some(2), None, Some(3)]);
/// assert_eq!(gap.back().number(3), Some(4));
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Splice {
    /// Number of the first of these items.
    pub at: usize,
    /// Number of items that were removed.
    pub removed: usize,
    /// Number of items that were added.
    pub added: usize,
}

impl Splice {
    /// Returns the number of item i since the edit; `None` if it was removed.
    #[must_use]
    pub fn number(&self, i: usize) -> Option<usize> {
        match i.checked_sub(self.at) {
            None => Some(i),
            Some(after) if after < self.removed => None,
            Some(after) => Some(self.at + after - self.removed + self.added),
        }
    }

    /// Returns the splice that undoes this one.
    #[must_use]
    pub fn back(self) -> Self {
        Self {
            removed: self.added,
            added: self.removed,
            ..self
        }
    }

    /// Creates the places from which items were removed, and to which others were added.
    pub(crate) fn new(at: usize, removed: usize, added: usize) -> Self {
        Self { at, removed, added }
    }

    /// Edits a list, with `new` items at their places. One that is empty, as if it were not given,
    /// stays so.
    pub(crate) fn of<T>(self, list: &mut Vec<T>, new: impl IntoIterator<Item = T>) {
        if !list.is_empty() {
            list.splice(self.at..self.at + self.removed, new);
        }
    }
}

/// Replaces each item of a list by another one, or removes it.
pub(crate) fn keep<T>(list: &mut Vec<T>, change: impl FnMut(&T) -> Option<T>) {
    *list = list.iter().filter_map(change).collect();
}
