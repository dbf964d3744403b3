//! The options of sweeps, and the shares of their runs.

use std::fmt;
use std::path::PathBuf;

use a3_files::arguments::threads;
use clap::Args;

use super::values::picture_size;

#[derive(Args)]
#[command(after_help = "A sweep is a file such as\n\n  \
    scene = \"chain\"                                 # or a list of names and files\n  \
    solver = [\"euler\", \"rk4\", \"dopri5\"]             # by default all that can run the scene\n  \
    step = { from = 1e-4, to = 0.1, count = 12 }      # or a list; of solvers with fixed steps\n  \
    tolerance = [1e-3, 1e-5, 1e-7]                    # of adaptive solvers\n  \
    until = 2                                         # simulated seconds\n\n  \
    [keys]                                            # of the scene's file\n  \
    chain.stiffness = [5, 25, 125]\n  \
    wind.seed = { from = 1, to = 10, count = 10, spacing = \"linear\" }\n\n\
    Each run has a file in the folder, which is there whole or not at all: whatever was killed is run\n\
    again by the same command, and several processes and machines may work in one folder. A run that\n\
    blows up is a result. docs/sweeps.md has recipes for GNU parallel and Slurm.")]
pub struct Sweep {
    /// File that describes the sweep, in TOML
    #[arg(value_name = "FILE.toml")]
    pub file: PathBuf,
    /// Print the runs, one a line: id, scene, solver, step or tolerance, seconds, and the keys
    #[arg(long, conflicts_with_all = ["collect", "status", "only"])]
    pub plan: bool,
    /// Make a share of the runs: the K-th of N, or those with these ids, separated by commas
    #[arg(long, value_name = "K/N|IDS", value_parser = Only::parse)]
    pub only: Option<Only>,
    /// Join the runs that are done into FOLDER.csv and its chart, FOLDER.svg
    #[arg(long, conflicts_with_all = ["status", "only"])]
    pub collect: bool,
    /// Say how many runs are done, have blown up, and are missing
    #[arg(long, conflicts_with = "only")]
    pub status: bool,
    /// Folder of the runs; by default a3-sweep-FILE
    #[arg(long, short, value_name = "FOLDER")]
    pub output: Option<PathBuf>,
    /// Number of threads; by default one for each processor, or as many as the environment variable
    /// `RAYON_NUM_THREADS` says
    #[arg(long, value_name = "N", value_parser = threads, allow_negative_numbers = true)]
    pub threads: Option<usize>,
    /// Width and height of the chart in pixels
    #[arg(long, value_name = "WxH", default_value = "1600x1000", value_parser = picture_size, allow_hyphen_values = true)]
    pub size: (u32, u32),
}

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
        ids.collect::<Option<_>>().map(Self::Ids).ok_or_else(|| right.into())
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
        for wrong in ["0/3", "4/3", "1/0", "1/", "-1/2", "1", "a,b", "", "00ff00ff00ff00ff,"] {
            assert!(Only::parse(wrong).is_err(), "{wrong}");
        }
    }
}
