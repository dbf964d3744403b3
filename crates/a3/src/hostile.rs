//! Mutated command lines, data of charts, and states of other programs: each is accepted or
//! refused, without a panic.

#[path = "../../scenes/tests/hostile/mutation.rs"]
mod mutation;

use a3_files::rows::{Row, text::read};
use a3_files::states::parse;
use a3_lab::chart::record::Record;
use clap::Parser;
use clap::error::ErrorKind;
use mutation::{Random, seeds};

use crate::cli::{Cli, explain};

/// Number of inputs of each kind.
const INPUTS: usize = 10_000;

/// Gives mutated seeds to a reader, and returns how many it accepted.
fn feed(seeds: &[Vec<u8>], mut takes: impl FnMut(&str) -> bool) -> usize {
    let mut random = Random(1);
    let taken = (0..INPUTS).filter(|_| takes(&String::from_utf8_lossy(&random.mutated(seeds))));
    taken.count()
}

#[test]
fn command_lines_are_taken_or_refused() {
    let lines = seeds("command").concat();
    let lines: Vec<_> = lines.split(|b| *b == b'\n').map(<[u8]>::to_vec).collect();
    let taken = feed(&lines, |line| {
        let words = std::iter::once("a3").chain(line.split_ascii_whitespace());
        let Err(error) = Cli::try_parse_from(words) else {
            return true;
        };
        if !matches!(
            error.kind(),
            ErrorKind::DisplayHelp | ErrorKind::DisplayVersion
        ) {
            let why = explain(&error, &[]).unwrap_err().to_string();
            assert!(!why.is_empty() && !why.contains('\n'), "{line}: {why}");
        }
        false
    });
    assert!(taken > INPUTS / 25, "{taken}");
}

#[test]
fn data_of_charts_are_taken_or_refused() {
    let [csv, json] = &seeds("data")[..] else {
        panic!("other seeds")
    };
    for (seed, is_json) in [(csv, false), (json, true)] {
        let taken = feed(std::slice::from_ref(seed), |text| {
            let Ok(records) = read::<Record>(text, is_json) else {
                return false;
            };
            // These comparisons of runs must not panic either.
            let same = records
                .iter()
                .filter(|r| r.is_same(&records[0]) && !r.is_held());
            assert!(same.count() <= records.len());
            true
        });
        assert!(taken > INPUTS / 25, "{taken}");
    }
}

#[test]
fn states_are_taken_or_refused() {
    let endings = ["json", "csv", "npz", "npz", "json", "csv"];
    let seeds = seeds("states");
    assert_eq!(seeds.len(), endings.len());
    for (seed, ending) in seeds.iter().zip(endings) {
        let original = parse(seed, ending, 2).unwrap();
        assert_eq!(original.times, [0.0, 0.5, 1.0], "{ending}");
        let mut random = Random(1);
        let mut taken = 0;
        for _ in 0..INPUTS {
            let bytes = random.mutated(std::slice::from_ref(seed));
            let Ok(states) = parse(&bytes, ending, 2) else {
                continue;
            };
            taken += 1;
            assert!(states.times.windows(2).all(|pair| pair[0] < pair[1]));
            let rows = states
                .positions
                .iter()
                .chain(states.velocities.iter().flatten());
            assert!(rows.into_iter().all(|row| row.len() == 6));
            let mut numbers = states.positions.iter().flatten();
            assert!(numbers.all(|x| x.is_finite()));
        }
        assert!(taken > INPUTS / 100, "{ending}: {taken}");
    }
}
