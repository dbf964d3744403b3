//! Seeds and their mutations: repeatable changes of bytes, words and lines.

use std::fs;
use std::path::Path;

/// Words that readers have stumbled over.
#[rustfmt::skip]
const WORDS: [&str; 31] = [
    "1e308", "-1e308", "nan", "inf", "-1", "0", "-0.0", "1e-320", "4e9", "4000000000", "1e9", "1e13",
    "18446744073709551615", "-9223372036854775808", "2147483648", "0x7fffffff", "[]", "{}", "[[", "]",
    "\"", "'''", "#", "true", "null", "a.a.a", "\u{0}", "\u{fffd}", "1, 1", "[0, 0, 0]", "\n",
];

/// Reads the files of a folder of seeds, in the order of their names.
pub fn seeds(folder: &str) -> Vec<Vec<u8>> {
    // Packages in folders of any depth include this.
    let files = Path::new(env!("CARGO_MANIFEST_DIR"))
        .ancestors()
        .find_map(|ancestor| fs::read_dir(ancestor.join("fuzz/seeds").join(folder)).ok())
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let mut files: Vec<_> = files.collect();
    files.sort();
    assert!(!files.is_empty());
    files.iter().map(|file| fs::read(file).unwrap()).collect()
}

/// Generator of pseudorandom numbers (`SplitMix64`).
pub struct Random(pub u64);

impl Random {
    /// Returns a number below `end`.
    pub fn below(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) % end.max(1) as u64) as usize
    }

    /// Returns a seed with up to four changes.
    pub fn mutated(&mut self, seeds: &[Vec<u8>]) -> Vec<u8> {
        let mut bytes = seeds[self.below(seeds.len())].clone();
        for _ in 0..=self.below(4).min(self.below(4)) {
            self.change(&mut bytes);
        }
        bytes
    }

    fn change(&mut self, bytes: &mut Vec<u8>) {
        let at = self.below(bytes.len());
        match self.below(8) {
            // A bit, a byte, a piece, the rest.
            0 if at < bytes.len() => bytes[at] ^= 1 << self.below(8),
            1 if at < bytes.len() => bytes[at] = self.below(256) as u8,
            0 | 1 => {}
            2 => drop(bytes.drain(at..(at + self.below(20)).min(bytes.len()))),
            3 if self.below(4) == 0 => bytes.truncate(at),
            // Lines.
            kind @ (3 | 4) => {
                let line = piece(bytes, at, |b| b == b'\n');
                if kind == 3 {
                    drop(bytes.drain(line));
                } else {
                    let copies = bytes[line.clone()].repeat(1 + self.below(30));
                    bytes.splice(line.end..line.end, copies);
                }
            }
            // Words.
            5 => drop(bytes.splice(at..at, WORDS[self.below(WORDS.len())].bytes())),
            _ => {
                let is_gap = |b: u8| !b.is_ascii_alphanumeric() && !b"._-+".contains(&b);
                let word = piece(bytes, at, is_gap);
                bytes.splice(word, WORDS[self.below(WORDS.len())].bytes());
            }
        }
    }
}

/// Returns the range around a place between two bytes that are ends.
fn piece(bytes: &[u8], at: usize, is_end: impl Fn(u8) -> bool) -> std::ops::Range<usize> {
    let start = bytes[..at].iter().rposition(|b| is_end(*b));
    let end = bytes[at..].iter().position(|b| is_end(*b));
    start.map_or(0, |k| k + 1)..end.map_or(bytes.len(), |k| at + k)
}
