//! Repeatable random numbers.

/// Range of numbers, and whether they are spread over its orders of magnitude.
pub type Range = (f64, f64, bool);

/// Generator of pseudorandom numbers (`SplitMix64`).
pub struct Chance(pub u64);

impl Chance {
    /// Returns a number from 0 to 1.
    pub fn share(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a whole number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        (self.share() * end as f64) as usize
    }

    /// Returns true with a probability of 1 / `times`.
    pub fn once_in(&mut self, times: usize) -> bool {
        self.below(times) == 0
    }

    pub fn from<T: Copy>(&mut self, all: &[T]) -> T {
        all[self.below(all.len())]
    }

    /// Returns a number of a range.
    pub fn within(&mut self, (low, high, spread): Range) -> f64 {
        let share = self.share();
        if spread { low * (high / low).powf(share) } else { low + (high - low) * share }
    }

    /// Returns three numbers of a range.
    pub fn triple(&mut self, range: Range) -> [f64; 3] {
        [(); 3].map(|()| self.within(range))
    }

    /// Returns a unit vector.
    pub fn direction(&mut self) -> [f64; 3] {
        loop {
            let d = self.triple((-1.0, 1.0, false));
            let length = d.iter().map(|x| x * x).sum::<f64>().sqrt();
            if (0.1..1.0).contains(&length) {
                return d.map(|x| x / length);
            }
        }
    }

    /// Returns two unit vectors at a right angle.
    pub fn corner(&mut self) -> [[f64; 3]; 2] {
        let a = self.direction();
        loop {
            let [x, y, z] = self.direction();
            let b = [a[1] * z - a[2] * y, a[2] * x - a[0] * z, a[0] * y - a[1] * x];
            let length = b.iter().map(|x| x * x).sum::<f64>().sqrt();
            if length > 0.1 {
                return [a, b.map(|x| x / length)];
            }
        }
    }
}
