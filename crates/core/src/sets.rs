//! Disjoint sets, by which connected parts are found (union-find: Tarjan, *Efficiency of a good but
//! not linear set union algorithm*, 1975).

/// Sets of numbers, each known by its smallest member.
pub(crate) struct Sets(Vec<u32>);

impl Sets {
    /// Creates `count` sets of one number each, 0 to `count` - 1.
    pub fn new(count: usize) -> Self {
        Self((0..count as u32).collect())
    }

    /// Returns the smallest number in the set of k.
    pub fn find(&mut self, mut k: u32) -> u32 {
        while self.0[k as usize] != k {
            self.0[k as usize] = self.0[self.0[k as usize] as usize];
            k = self.0[k as usize];
        }
        k
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: u32, b: u32) {
        let (a, b) = (self.find(a), self.find(b));
        self.0[a.max(b) as usize] = a.min(b);
    }
}
