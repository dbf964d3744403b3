//! Parts of the runs of a sweep, as `--only` names them.

use std::fmt;

/// Id of a run: a hash of all that the run depends on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Id(u64);

impl Id {
    /// Creates an id from its number.
    pub fn new(number: u64) -> Self {
        Self(number)
    }

    /// Reads an id as it is printed.
    pub fn parse(text: &str) -> Option<Self> {
        let digits = text.len() == 16 && text.bytes().all(|b| b.is_ascii_hexdigit());
        let number = digits.then(|| u64::from_str_radix(text, 16).ok());
        number.flatten().map(Self)
    }
}

impl fmt::Display for Id {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

/// A share of the runs.
#[derive(Clone, Debug, PartialEq)]
pub enum Only {
    /// The k-th of n shares, counted from 1, of equal length. Runs of one scene stay together,
    /// because they have a reference in common.
    Share(usize, usize),
    /// Runs by their ids.
    Ids(Vec<Id>),
}

impl Only {
    /// Reads a share as it is typed.
    pub fn parse(text: &str) -> Result<Self, String> {
        let right = "a share is K/N with K from 1 to N, such as 3/12, or ids that --plan prints, separated by commas";
        if let Some((k, n)) = text.split_once('/') {
            return match (k.trim().parse(), n.trim().parse()) {
                (Ok(k), Ok(n)) if (1..=n).contains(&k) => Ok(Self::Share(k, n)),
                _ => Err(right.into()),
            };
        }
        let ids = text.split(',').map(|id| Id::parse(id.trim()));
        ids.collect::<Option<_>>()
            .map(Self::Ids)
            .ok_or_else(|| right.into())
    }

    /// Returns the indices of the selected runs among the ids of all runs.
    pub fn of(&self, runs: &[Id]) -> Result<Vec<usize>, String> {
        match self {
            Self::Share(k, n) => {
                // In 128 bits, no product is too large.
                let end = |k: usize| (k as u128 * runs.len() as u128 / *n as u128) as usize;
                Ok((end(k - 1)..end(*k)).collect())
            }
            Self::Ids(ids) => {
                let place = |id: &Id| {
                    runs.iter().position(|run| run == id).ok_or_else(|| {
                        format!("{id}: the sweep has no run of this id; --plan prints them")
                    })
                };
                ids.iter().map(place).collect()
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_typed_as_parts_or_ids() {
        assert_eq!(Only::parse("3/12"), Ok(Only::Share(3, 12)));
        let id = Id::parse("00ff00ff00ff00ff").unwrap();
        assert_eq!(Only::parse("00ff00ff00ff00ff"), Ok(Only::Ids(vec![id])));
        for wrong in [
            "0/3",
            "4/3",
            "1/0",
            "1/",
            "-1/2",
            "1",
            "a,b",
            "",
            "00ff00ff00ff00ff,",
        ] {
            assert!(Only::parse(wrong).is_err(), "{wrong}");
        }
    }
}
