//! Many lists, one after another in memory.

/// Lists with numbers 0, 1, ..., each of items in the order in which they were given.
#[derive(Debug, Default)]
pub(super) struct Lists<T> {
    /// Start of each list, and the end of the last one.
    starts: Vec<u32>,
    items: Vec<T>,
}

impl<T: Copy + Default> Lists<T> {
    /// Creates `count` lists, from items with the numbers of their lists.
    pub fn new(count: usize, items: impl Iterator<Item = (u32, T)> + Clone) -> Self {
        let mut starts = vec![0; count + 1];
        for (list, _) in items.clone() {
            starts[list as usize + 1] += 1;
        }
        for list in 0..count {
            starts[list + 1] += starts[list];
        }
        let mut ends = starts.clone();
        let mut all = vec![T::default(); starts[count] as usize];
        for (list, item) in items {
            let end = &mut ends[list as usize];
            all[*end as usize] = item;
            *end += 1;
        }
        Self { starts, items: all }
    }

    /// Returns the items of a list.
    #[inline]
    pub fn of(&self, list: usize) -> &[T] {
        &self.items[self.starts[list] as usize..self.starts[list + 1] as usize]
    }

    /// Returns all items with the numbers of their lists.
    pub fn all(&self) -> impl Iterator<Item = (u32, T)> + Clone {
        let lists = 0..self.starts.len() - 1;
        lists.flat_map(|list| self.of(list).iter().map(move |item| (list as u32, *item)))
    }
}
