//! Pictures of the screen.

use std::ops::Range;

pub struct Screen {
    width: usize,
    pixels: Vec<[u8; 3]>,
}

/// Returns whether a pixel has the red of surfaces and balls.
pub fn is_red([r, g, b]: [u8; 3]) -> bool {
    r > 100 && r / 2 > g && r / 2 > b
}

/// Returns whether a pixel has the colour of the ball at a grabbed particle.
pub fn is_amber([r, g, b]: [u8; 3]) -> bool {
    r > 170 && g > 100 && g < r && u16::from(b) * 2 < u16::from(g) + 60 && b < 110
}

impl Screen {
    /// Reads the screen from the XWD file of the server.
    pub fn of(bytes: &[u8]) -> Self {
        let word =
            |k: usize| u32::from_be_bytes(bytes[4 * k..4 * k + 4].try_into().unwrap()) as usize;
        let (width, height, stride, start) = (word(4), word(5), word(12), word(0) + 12 * word(19));
        assert_eq!((word(7), word(11)), (0, 32), "four bytes a pixel, blue first");
        let pixel = |x: usize, y: usize| {
            let at = start + y * stride + 4 * x;
            [bytes[at + 2], bytes[at + 1], bytes[at]]
        };
        let pixels =
            (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| pixel(x, y));
        Self { width, pixels: pixels.collect() }
    }

    pub fn count(&self, is: impl Fn([u8; 3]) -> bool) -> usize {
        self.pixels.iter().filter(|pixel| is(**pixel)).count()
    }

    pub fn count_within(
        &self,
        x: Range<i32>,
        y: Range<i32>,
        is: impl Fn([u8; 3]) -> bool,
    ) -> usize {
        let inside = |k: &usize| {
            x.contains(&((k % self.width) as i32)) && y.contains(&((k / self.width) as i32))
        };
        (0..self.pixels.len()).filter(inside).filter(|k| is(self.pixels[*k])).count()
    }

    /// Returns the middle of the first square of a side (px) within these ranges for all of whose
    /// pixels `is` is true.
    pub fn block(
        &self,
        x: Range<i32>,
        y: Range<i32>,
        side: usize,
        is: impl Fn([u8; 3]) -> bool,
    ) -> Option<(i32, i32)> {
        let is_filled = |left: i32, top: i32| {
            let row = |k: usize| (top as usize + k) * self.width + left as usize;
            (0..side).all(|k| {
                let pixels = self.pixels.get(row(k)..row(k) + side);
                pixels.is_some_and(|pixels| pixels.iter().all(|pixel| is(*pixel)))
            })
        };
        let half = side as i32 / 2;
        y.flat_map(|top| x.clone().map(move |left| (left, top)))
            .find(|(left, top)| is_filled(*left, *top))
            .map(|(left, top)| (left + half, top + half))
    }

    /// Returns the mean absolute difference of the channels, from 0 to 255.
    pub fn difference(&self, other: &Self) -> f64 {
        let pairs = self.pixels.iter().flatten().zip(other.pixels.iter().flatten());
        pairs.map(|(a, b)| f64::from(a.abs_diff(*b))).sum::<f64>()
            / (3.0 * self.pixels.len() as f64)
    }

    /// Returns the mean position of the pixels for which `is` is true.
    pub fn middle(&self, is: impl Fn([u8; 3]) -> bool) -> (i32, i32) {
        let places: Vec<_> = (0..self.pixels.len()).filter(|k| is(self.pixels[*k])).collect();
        assert!(!places.is_empty(), "nothing of that colour on the screen");
        let x = places.iter().map(|k| k % self.width).sum::<usize>() / places.len();
        let y = places.iter().map(|k| k / self.width).sum::<usize>() / places.len();
        (x as i32, y as i32)
    }
}
